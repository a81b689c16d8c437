"""Widths of shapes against their definition."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.geometry.widths import half_width
from eeca_pymunk.model.scene import scene_of
from tests.packed import Thing, World, hull


@pytest.mark.parametrize("count", [3, 4, 5, 9, 100])
def test_half_the_width_of_a_polygon_is_that_of_the_narrowest_strip_that_holds_it(count: int) -> None:
    """A strip of the least width has an edge of the polygon on one side."""
    rng = np.random.default_rng(count)
    for _ in range(20):
        corners = np.array(hull(rng, count)) * (1.0, rng.uniform(0.05, 1.0))
        edges = np.roll(corners, -1, axis=0) - corners
        normals = np.stack((edges[:, 1], -edges[:, 0]), axis=1) / np.hypot(*edges.T)[:, None]
        strips = (corners[:, None, :] - corners[None]) @ normals[:, :, None]
        least = strips[..., 0].max(axis=1).min()
        world = World([Thing([([tuple(c) for c in corners], 0.1)], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
        assert half_width(scene_of(world.scene), 0) == pytest.approx(0.1 + 0.5 * least, rel=1e-13)

"""Which shapes are thin."""

from __future__ import annotations

import math

import pymunk
import pytest

from eeca_pymunk.compiled.records import Rows
from eeca_pymunk.geometry.corners import thin
from eeca_pymunk.model.parameters.detection import SLENDER
from eeca_pymunk.model.shapes import Link
from eeca_pymunk.space.world import World


@pytest.mark.parametrize("width", [0.1, 0.2, 0.4, 0.6, 1.0])
def test_the_first_corner_does_not_matter(width: float) -> None:
    """A rhombus of length 2 and area `width` is thin if that is below SLENDER (2 / 2)^2, whichever corner is first."""
    found = []
    for turn in range(4):
        space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
        space.add(body, pymunk.Poly(body, [(1, 0), (0, width / 2), (-1, 0), (0, -width / 2)]))
        world = World(space)
        world.VERTEX[:] = world.VERTEX[[(k + turn) % 4 for k in range(4)]]
        LINK: Rows[Link] = world.LINK
        found.append(thin(LINK[0], world.VERTEX))
    assert found == 4 * [width < SLENDER]


@pytest.mark.parametrize("angle", [0.0, 1.0, math.pi / 2])
def test_planks_are_thin_and_boxes_are_not(angle: float) -> None:
    found = []
    for width in (0.05, 1.0):
        space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
        body.angle = angle
        space.add(body, pymunk.Poly.create_box(body, (2.0, width)))
        world = World(space)
        found.append(thin(world.LINK[0], world.VERTEX))
    assert found == [True, False]

"""Outlines of shapes, as steps take them."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.outlines import corners, local_outline
from scenes.scene import add_disk

# A square as drawing programs give it: with points along its sides, off these by round-off.
DRAWN = [
    (-0.30000000000000004, 0.050000000000000266), (-0.3, -0.2999999999999998), (-0.1, -0.30000000000000027),
    (-0.025000000000000022, -0.30000000000000027), (0.3, -0.2999999999999998), (0.30000000000000004, -0.225),
    (0.30000000000000004, -0.050000000000000266), (0.3, 0.2999999999999998), (0.1, 0.30000000000000027),
    (0.025000000000000022, 0.30000000000000027), (-0.3, 0.2999999999999998), (-0.30000000000000004, 0.225),
]  # fmt: skip


def test_vertices_along_a_side_and_twice_at_a_corner_are_left_out() -> None:
    assert np.allclose(corners(DRAWN), [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)], atol=1e-14)
    twice = [(0.0, 0.0), (1.0, 0.0), (1.0, 1e-16), (0.5, 1.0)]
    assert np.allclose(corners(twice), [(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)], atol=1e-14)


@pytest.mark.parametrize("sides", [3, 8, 100, 1000])
def test_polygons_that_are_nearly_round_keep_all_vertices(sides: int) -> None:
    body = pymunk.Body(1.0, 1.0)
    round_one = [(math.cos(2 * math.pi * k / sides), math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    shape = pymunk.Poly(body, round_one)
    assert len(local_outline(shape)) == len(shape.get_vertices())


@pytest.mark.parametrize(
    ("x", "velocity", "angle", "spin"),
    [
        (-0.05422400468608654, 0.8199179233245939, -0.09138662228635917, 1.2908251207260077),
        (0.002132647936335774, 0.5068930671778104, 0.08276753353463259, -0.09541171212498778),
    ],
)
def test_a_disk_bounces_off_a_drawn_box_as_off_a_box_of_four_vertices(
    x: float, velocity: float, angle: float, spin: float
) -> None:
    """Places and velocities: of edges in one line none may be taken for a corner."""
    ends = []
    for vertices in (DRAWN, [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)]):
        space = pymunk.Space()
        box = pymunk.Body(0.4, 0.02)
        box.position, box.angle, box.angular_velocity = (0.0, 0.7), angle, spin
        space.add(box, pymunk.Poly(box, vertices, radius=0.01))
        add_disk(space, (x, 0.2), 0.15, 0.07, (velocity, 0.5))
        for shape in space.shapes:
            shape.elasticity, shape.friction = 0.8, 0.8
        stepper = ep.EECA(space)
        assert all(stepper.step(1 / 240).converged for _ in range(120))
        ends.append([(*b.position, b.angle, *b.velocity) for b in space.bodies])
    assert np.allclose(ends[0], ends[1], atol=1e-9)

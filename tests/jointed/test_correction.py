"""How bodies with joints are lifted out of what they overlap with."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep

INERTIA, DEEP, ARM, DT = 0.03, 0.015, 0.15, 1 / 60


def pressed(stiffness: float) -> pymunk.Space:
    """A rod whose tip is deep in a wall that carries it along; a spring between it and a heavy disk holds its angle."""
    space = pymunk.Space()
    wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    heavy, rod = pymunk.Body(1e4, 1e4), pymunk.Body(1.0, INERTIA)
    heavy.position, rod.angle = (-3.0, 0.0), 0.3
    rod.position = -rod.rotation_vector.x * 0.5 - 0.02 + DEEP, 0.0
    shapes = pymunk.Segment(wall, (0.1, -5.0), (0.1, 5.0), 0.1), pymunk.Circle(heavy, 0.5)
    spring = pymunk.DampedRotarySpring(heavy, rod, -0.3, stiffness, 0.0)
    wall.velocity = heavy.velocity = rod.velocity = -0.1, 0.0
    space.add(wall, heavy, rod, *shapes, pymunk.Segment(rod, (-0.5, 0.0), (0.5, 0.0), 0.02), spring)
    space.gravity = 0.0, -9.81
    return space


@pytest.mark.parametrize("stiffness", [1e4, 1e6])
def test_bodies_are_not_lifted_against_springs_that_they_can_spare(stiffness: float) -> None:
    """Moved along the wall's normal the rod leaves it at no cost; by its inertia alone it would mostly turn, by x/r
    for a depth x at the arm r, and the wall would do the work k (x/r)^2/2."""
    space = pressed(stiffness)
    ledger = ep.EECA(space).step(DT).ledger
    assert ledger is not None
    assert 0.0 <= ledger.external < 0.01 * 0.5 * stiffness * (DEEP / ARM) ** 2
    wall, _, rod = space.bodies
    assert rod.local_to_world((0.5, 0.0)).x + 0.02 - wall.position.x < 0.01 * DEEP


def test_a_body_without_shapes_lets_the_others_be_lifted() -> None:
    """A box with a bob that has no shape lands on an edge. How far points may move in a correction is relative to the
    smallest body: with the bob's extent, 0, the box stays .015 deep."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    box, bob = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.6, 0.4))), pymunk.Body(0.5, 0.01)
    box.position, box.angle, bob.position = (0.0, 0.5), 0.5, (0.5, 0.8)
    shape = pymunk.Poly.create_box(box, (0.6, 0.4))
    floor.friction = shape.friction = 0.5
    space.add(floor, box, shape, bob, pymunk.PivotJoint(box, bob, box.position))
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert -1e-8 < min(box.local_to_world(corner).y for corner in shape.get_vertices()) < 1e-3


def test_bodies_are_lifted_along_limits_that_the_lift_would_pass() -> None:
    """A rod on a heavy disk, whose tip is deep in a wall that carries both along: by itself it would turn out of it, by
    .03 rad, but may turn by .001 only. A correction that does not know this is undone as the limit closes."""
    space = pymunk.Space()
    wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    heavy, rod = pymunk.Body(1e3, 1e3), pymunk.Body(1.0, INERTIA)
    heavy.position, rod.position = (-0.5, 0.02 - DEEP), (0.0, 0.02 - DEEP)
    wall.velocity = heavy.velocity = rod.velocity = 0.0, 0.1
    limit = pymunk.RotaryLimitJoint(heavy, rod, -1.0, 0.001)
    tip = pymunk.Segment(wall, (0.4, -0.1), (5.0, -0.1), 0.1)
    space.add(wall, tip, heavy, rod, pymunk.Segment(rod, (-0.5, 0.0), (0.5, 0.0), 0.02))
    space.add(limit, pymunk.PivotJoint(heavy, rod, (-0.5, 0.02 - DEEP)))
    ep.EECA(space).step(DT)
    assert rod.local_to_world((0.5, 0.0)).y - 0.02 - wall.position.y > -0.01 * DEEP
    assert rod.angle - heavy.angle < 0.001 + 1e-9

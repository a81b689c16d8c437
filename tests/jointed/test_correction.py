"""How bodies with joints are lifted out of what they overlap with."""

from __future__ import annotations

import numpy as np
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


@pytest.mark.parametrize("first", [0, 1])
def test_a_motor_without_force_does_not_change_a_correction(first: int) -> None:
    """Bodies that overlap are parted along a taut rope; its bound is not what the motor of another component
    aims at."""

    def places(rate: float) -> list[pymunk.Vec2d]:
        space, bodies = pymunk.Space(), []
        for at in ((0.0, 0.0), (0.5, 0.3)):
            body = pymunk.Body(1.0, 0.08)
            body.position = at
            space.add(body, pymunk.Circle(body, 0.4))
            bodies.append(body)
        bodies[1].velocity = -2.0, -1.2
        rope = pymunk.SlideJoint(space.static_body, bodies[0], (1.0, 0.0), (0.0, 0.0), 0.0, 1.0)
        motor = pymunk.SimpleMotor(space.static_body, bodies[1], rate)
        motor.max_force = 0.0
        space.add(*((rope, motor) if first == 0 else (motor, rope)))
        stepper = ep.EECA(space)
        for _ in range(6):
            stepper.step(1 / 60)
        return [body.position for body in bodies]

    assert places(-5.0) == places(0.0) == places(5.0)


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0, 1000.0])
def test_overlaps_in_flight_are_corrected_wherever_they_are(size: float) -> None:
    """It costs nothing, but for round-off of places: half of the starts within 10 of the origin were left as they
    were."""
    rng = np.random.default_rng(1)
    for x, y in rng.uniform(-size, size, (40, 2)):
        space, bodies = pymunk.Space(), []
        space.gravity = 0.0, -10.0
        for (dx, dy), mass in zip(((0.0, 0.0), (0.35, 0.47), (-1.0, 0.2)), (1.0, 0.7, 1.3), strict=True):
            body = pymunk.Body(mass, 0.1)
            body.position = x + dx, y + dy
            circle = pymunk.Circle(body, 0.35)
            circle.elasticity = 0.5
            space.add(body, circle)
            bodies.append(body)
        space.add(pymunk.PinJoint(bodies[0], bodies[2], (0.0, 0.0), (0.1, 0.0)))
        ep.EECA(space).step(1 / 60)
        assert (bodies[0].position - bodies[1].position).length > 0.69, (x, y)

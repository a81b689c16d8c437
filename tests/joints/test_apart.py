"""Pivots whose anchors a program has put apart: they close slowly, and meanwhile act at one point of both bodies."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

from .test_frame import energies


def pair(gap: float, bias: float, partner: pymunk.Body | None = None) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A body and its partner, another one unless given, without weight, held by a pivot whose anchors are so far apart;
    `bias`: part of that which is left after a second."""
    space, a, b = pymunk.Space(), partner or pymunk.Body(0.5, 0.1), pymunk.Body(2.0, 0.3)
    if partner is None:
        a.velocity, a.angular_velocity = (1.0, -0.4), 3.0
    b.position, b.velocity, b.angular_velocity = (1.0, 0.2), (-0.3, 0.8), -1.0
    pivot = pymunk.PivotJoint(a, b, (0.4, 0.1), b.world_to_local(a.local_to_world((0.4, 0.1 + gap))))
    pivot.error_bias = bias
    space.add(a, b, pivot)
    return space, [a, b]


def apart(pivot: pymunk.PivotJoint) -> float:
    return pivot.a.local_to_world(pivot.anchor_a).get_distance(pivot.b.local_to_world(pivot.anchor_b))


def turning(bodies: list[pymunk.Body]) -> float:
    """Angular momentum about the origin."""
    return sum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in bodies)


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 0.1])
@pytest.mark.parametrize("gap", [1e-3, 0.3])
def test_a_pivot_that_stays_apart_keeps_energy_and_angular_momentum(gap: float, dt: float) -> None:
    """As any two bodies with a common point. The gap is that of two halves, one on each body: it does not grow."""
    space, bodies = pair(gap, 1.0)
    (pivot,) = space.constraints
    assert isinstance(pivot, pymunk.PivotJoint)
    stepper = ep.EECA(space)
    start = turning(bodies)
    assert stepper.step(dt).converged  # velocities are projected
    energy = ep.measure(space).kinetic
    for _ in range(100):
        report = stepper.step(dt)
        assert report.converged
        assert report.ledger is not None
        assert abs(report.ledger.external) < 1e-13 * energy
        assert abs(turning(bodies) - start) < 1e-12
        assert abs(ep.measure(space).kinetic - energy) < 1e-12 * energy
        assert 0.0 < apart(pivot) < gap * (1.0 + 1e-12)


@pytest.mark.parametrize("elasticity", [0.0, 1.0])
def test_an_impact_on_it_keeps_angular_momentum(elasticity: float) -> None:
    space, bodies = pair(0.3, 1.0)
    ball = pymunk.Body(1.0, 0.1)
    ball.position, ball.velocity = (2.0, 3.0), (0.0, -4.0)
    shapes = [pymunk.Circle(ball, 0.1), pymunk.Segment(bodies[1], (-0.5, 0.0), (2.5, 0.0), 0.05)]
    for shape in shapes:
        shape.elasticity, shape.friction = elasticity, 0.5
    space.add(ball, *shapes)
    stepper, start, hit = ep.EECA(space), turning([*bodies, ball]), False
    for _ in range(90):
        hit = hit or len(stepper.step(1 / 60).contacts) > 0
        assert abs(turning([*bodies, ball]) - start) < 1e-12 * 13.0
    assert hit


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60])
def test_on_a_wheel_that_turns_it_gives_no_energy_in_the_frame_of_that(dt: float) -> None:
    """But by an error of second order, as that of a pivot which is closed."""
    wheel = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wheel.angular_velocity = 2.0
    space, _ = pair(0.3, 1.0, wheel)
    stepper = ep.EECA(space)
    stepper.step(dt)
    start, scale = energies(space, wheel, dt)
    for _ in range(100):
        assert stepper.step(dt).converged
        assert abs(energies(space, wheel, dt)[0] - start) < (wheel.angular_velocity * dt) ** 2 * scale


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 0.1])
def test_it_closes_at_its_rate_and_gives_no_energy(dt: float) -> None:
    space, _ = pair(0.3, 0.5)
    (pivot,) = space.constraints
    stepper = ep.EECA(space)
    stepper.step(dt)
    last = ep.measure(space).kinetic
    for _ in range(math.ceil(2.0 / dt)):
        assert stepper.step(dt).converged
        now = ep.measure(space).kinetic
        assert now <= last * (1.0 + 1e-12)
        last = now
    assert isinstance(pivot, pymunk.PivotJoint)
    assert apart(pivot) <= 0.3 * 0.5**2

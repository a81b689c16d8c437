"""Bodies that hang on moving ones: what supports do is external work, and only that, in whichever frame."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
import pytest
from pymunk import Vec2d

import eeca_pymunk as ep

DT = 1 / 60
Build = Callable[[pymunk.Space, pymunk.Body, Vec2d], pymunk.Body]


def disk(space: pymunk.Space, at: tuple[float, float], velocity: Vec2d, elasticity: float = 1.0) -> pymunk.Body:
    body = pymunk.Body(1.0, 0.1)
    body.position, body.velocity = at, velocity
    shape = pymunk.Circle(body, 0.2)
    shape.elasticity = elasticity
    space.add(body, shape)
    return body


def struck(elasticity: float) -> Build:
    """A pendulum that hangs from the carrier, and is hit."""

    def build(space: pymunk.Space, carrier: pymunk.Body, boost: Vec2d) -> pymunk.Body:
        bob = disk(space, (0.0, -1.0), boost, elasticity)
        disk(space, (0.41, -1.1), boost + Vec2d(-1.0, 0.0))
        space.add(pymunk.PinJoint(carrier, bob))
        return bob

    return build


def stopped(space: pymunk.Space, carrier: pymunk.Body, boost: Vec2d) -> pymunk.Body:
    """A rope that runs taut."""
    bob = disk(space, (0.0, -0.99), boost + Vec2d(0.3, -1.0))
    space.add(pymunk.SlideJoint(carrier, bob, (0.0, 0.0), (0.0, 0.0), 0.0, 1.0))
    return bob


def torn(space: pymunk.Space, carrier: pymunk.Body, boost: Vec2d) -> pymunk.Body:
    """A bob beyond the end of its rope, which goes on, and hits another one."""
    bob = disk(space, (0.0, -2.0), boost + Vec2d(0.5, -3.0), 0.0)
    disk(space, (0.05, -2.38), boost)
    space.add(pymunk.SlideJoint(carrier, bob, (0.0, 0.0), (0.0, 0.0), 0.2, 1.0))
    return bob


SCENES = {"struck": struck(1.0), "dully": struck(0.5), "stopped": stopped, "torn": torn}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_carrier_that_moves_evenly_is_as_good_as_one_at_rest(name: str, unit: float) -> None:
    seen = []
    for boost in (Vec2d(0.0, 0.0), Vec2d(1.0, 0.3)):
        space = pymunk.Space()
        carrier = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        carrier.velocity = boost
        space.add(carrier)
        bob = SCENES[name](space, carrier, boost)
        for body in space.bodies:  # a longer time unit, too
            body.velocity *= unit
            body.angular_velocity *= unit
        stepper = ep.EECA(space)
        losses, work = 0.0, 0.0
        for _ in range(5):
            book = stepper.step(DT / unit).ledger
            assert book is not None
            assert abs(book.residual) <= 1e-13 * unit * unit
            assert book.restitution >= -1e-13 * unit * unit
            assert book.friction >= -1e-13 * unit * unit
            losses, work = losses + book.restitution, work + book.external
        if boost == Vec2d(0.0, 0.0):
            assert abs(work) <= 1e-13 * unit * unit
        else:
            assert abs(work) > 1e-3 * unit * unit
        velocity = bob.velocity / unit - boost
        seen.append((velocity.x, velocity.y, losses / unit**2))
    assert seen[1] == pytest.approx(seen[0], abs=1e-11)


def test_torques_work_while_bodies_are_lifted() -> None:
    space = pymunk.Space()
    rod = pymunk.Body(1.0, 0.1)
    rod.angle = 0.05
    shape = pymunk.Segment(rod, (0.0, 0.0), (1.0, 0.0), 0.05)
    wall = pymunk.Segment(space.static_body, (0.2, -0.05), (2.0, -0.05), 0.05)
    space.add(rod, shape, wall, pymunk.PivotJoint(space.static_body, rod, (0.0, 0.0)))
    rod.angular_velocity = -1.0
    stepper = ep.EECA(space)
    rod.angle = 0.02  # a turn of 0.03 back into the wall
    angle = rod.angle
    for _ in range(20):
        rod.torque = -3.0
        book = stepper.step(DT).ledger
        assert book is not None
        assert abs(book.residual) <= 1e-14
        assert book.external == pytest.approx(-3.0 * (rod.angle - angle), abs=1e-13)
        angle = rod.angle
    assert angle > 0.02
    assert math.isclose(rod.angular_velocity, 0.0, abs_tol=1e-12)


def test_a_ratchet_driven_by_its_carrier_loses_and_does_not_gain() -> None:
    space = pymunk.Space()
    carrier = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    carrier.angular_velocity = 2.5
    body = pymunk.Body(1.0, 0.1)
    space.add(carrier, body, pymunk.RatchetJoint(carrier, body, 0.0, 0.5))
    stepper = ep.EECA(space)
    lost, worked = 0.0, 0.0
    for _ in range(60):
        book = stepper.step(DT).ledger
        assert book is not None
        assert abs(book.residual) <= 1e-14
        assert book.restitution >= 0.0
        lost, worked = lost + book.restitution, worked + book.external
    # I w^2 / 2 is lost when w is taken over at once, and as much is what the body has then.
    assert body.angular_velocity == pytest.approx(2.5)
    assert lost == pytest.approx(0.5 * 0.1 * 2.5**2)
    assert worked == pytest.approx(0.1 * 2.5**2)

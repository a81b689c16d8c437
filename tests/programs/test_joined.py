"""Compositions with joints: kinds of failures of the soak, each by a scene that had it, and the laws of `joined.py`."""

from __future__ import annotations

import math
from functools import partial

import pymunk
import pytest

import eeca_pymunk as ep

from .compositions import Composition
from .joined import apart, may_contradict, overdone, reach
from .seeds import play


@pytest.mark.parametrize("first", range(0, 40, 10))
def test_random_compositions_with_joints_keep_the_laws(first: int) -> None:
    assert play(partial(Composition, joints=True), range(first, first + 10)) >= 3


def test_what_is_apart_and_what_is_overdone_is_seen() -> None:
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    b.position, b.angle = (2.0, 0.0), 0.5
    space = pymunk.Space()
    pin, gear = pymunk.PinJoint(a, b), pymunk.GearJoint(a, b, 0.5, 1.0)
    groove = pymunk.GrooveJoint(a, b, (0.0, 0.0), (4.0, 0.0), (0.0, 0.0))
    limit = pymunk.RotaryLimitJoint(a, b, 0.0, 1.0)
    for body in (a, b):
        space.add(body, pymunk.Circle(body, 0.1))
    space.add(pin, gear, groove, limit)
    assert max(apart(joint, 2.0) for joint in space.constraints) <= 1e-15
    b.position, b.angle = (2.0, 0.2), 1.25
    assert apart(pin, 2.0) == pytest.approx((4.04**0.5 - 2.0) / 2.0)
    assert apart(gear, 2.0) == pytest.approx(0.75)
    assert apart(groove, 2.0) == pytest.approx(0.1)
    assert apart(limit, 2.0) == pytest.approx(0.25)
    assert reach(pin) == 4.0  # the groove's end
    c = pymunk.Body(1.0, 1.0)
    c.position = 0.0, -5.0
    space.add(c, pymunk.PivotJoint(b, c, (1.0, -1.0)))
    assert reach(pin) == 5.0
    pin.max_force = 1.0
    ep.EECA(space).step(1 / 60)
    assert overdone(pin, 1 / 60) <= 1.0 + 1e-9
    assert overdone(pin, 1 / 6000) > 10.0


@pytest.mark.parametrize("spin", [0.0, 0.4])
@pytest.mark.parametrize("second", ["gear", "heavy", "ratio", "spring", "none"])
def test_what_the_program_turns_may_drive_bodies_against_a_limit(spin: float, second: str) -> None:
    """Where a gear turns the other body another way, that has an infinite moment, or a gear of another ratio than 1 is
    between both."""
    space = pymunk.Space()
    wheel, a, b = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    wheel.angular_velocity = spin
    if second == "heavy":
        b.moment = math.inf
    limit = pymunk.RotaryLimitJoint(a, b, -0.1, 0.1)
    space.add(wheel, a, b, limit, pymunk.GearJoint(wheel, a, 0.0, 1.0))
    if second == "gear":
        space.add(pymunk.GearJoint(wheel, b, 0.0, 2.0))
    elif second == "ratio":
        space.add(pymunk.GearJoint(a, b, 0.0, 2.0))
    elif second == "spring":
        space.add(pymunk.DampedRotarySpring(wheel, b, 0.0, 9.0, 1.0))
    assert may_contradict(limit) == (spin != 0.0 and second in ("gear", "heavy", "ratio"))
    stepper = ep.EECA(space)
    converged = [stepper.step(0.1).converged for _ in range(10)]
    assert all(converged) or may_contradict(limit)
    assert apart(limit, 1.0) <= 1e-8 or not converged[-1]

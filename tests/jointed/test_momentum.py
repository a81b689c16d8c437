"""Free islands with joints keep both momenta, whatever contacts and joints do."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable
from random import Random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.jointed import advance

Join = Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]
KEPT = 1e-12  # over the largest momentum of a body


def body(space: pymunk.Space, place: tuple[float, float], mass: float, speed: float, spin: float = 0.0) -> pymunk.Body:
    """A box of 0.9 by 0.5 that falls."""
    found = pymunk.Body(mass, pymunk.moment_for_box(mass, (0.9, 0.5)))
    found.position, found.velocity, found.angular_velocity = place, (0.0, -speed), spin
    shape = pymunk.Poly.create_box(found, (0.9, 0.5))
    shape.friction, shape.elasticity = 0.6, 0.5
    space.add(found, shape)
    return found


def pin(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.PinJoint(a, b, (0.1, 0.1), (-0.2, 0.0))


def slide(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.SlideJoint(a, b, (0.0, 0.0), (0.0, 0.0), 0.5, 1.1 * a.position.get_distance(b.position))


def spring(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.DampedSpring(a, b, (0.1, 0.0), (0.0, 0.1), 1.0, 50.0, 0.5)


def moments(space: pymunk.Space) -> tuple[FloatArray, float, float]:
    """Linear and angular momentum, and the scale of the latter."""
    now = ep.measure(space)
    scale = sum(b.mass * b.position.length * b.velocity.length for b in space.bodies)
    scale += sum(b.moment * abs(b.angular_velocity) for b in space.bodies)
    return now.linear_momentum, now.angular_momentum, scale


def keep(space: pymunk.Space, dt: float, steps: int) -> list[bool]:
    """Take steps; both momenta stay, and the centre of mass moves with the velocity that it has. Returns which steps
    have converged."""
    stepper, mass, found = ep.EECA(space), sum(b.mass for b in space.bodies), list[bool]()
    start, begun, scale = moments(space)
    centre = sum((b.mass * np.array(b.position) for b in space.bodies), np.zeros(2)) / mass
    for k in range(steps):
        report = stepper.step(dt)
        found.append(report.converged)
        linear, angular, now = moments(space)
        arm = max(b.position.length for b in space.bodies)
        scale = max(scale, now + float(np.hypot(report.impulse, report.friction).sum()) * arm)
        scale = max(scale, sum(abs(c.impulse) for c in space.constraints))
        assert abs(linear - start).max() <= KEPT * scale
        assert abs(angular - begun) <= KEPT * (k + 1) * scale
        there = sum((b.mass * np.array(b.position) for b in space.bodies), np.zeros(2)) / mass
        assert abs(there - centre - (k + 1) * dt * start / mass).max() <= 1e-12 * (k + 1) * arm
    return found


@pytest.mark.parametrize("join", [pin, slide, spring])
@pytest.mark.parametrize("dt", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("mass", [0.1, 1.0, 100.0])
def test_overlaps_are_lifted_about_the_centre_of_mass(join: Join, dt: float, mass: float) -> None:
    space = pymunk.Space()
    for y, n, m, speed in ((0.0, 5, 1.0, 0.0), (3.0, 3, mass, 8.0)):
        chain = [body(space, (1.05 * k + 0.2 * y, y), m * (1 + 2 * (k % 3)), speed, (-1.0) ** k) for k in range(n)]
        for a, b in itertools.pairwise(chain):
            space.add(join(a, b))
    keep(space, dt, 60)


def flight(seed: int) -> pymunk.Space:
    """Three to five chains of two to six bodies, of masses 1 : 100, that turn and fly into each other."""
    R, space = Random(seed), pymunk.Space()
    chains = R.randint(3, 5)
    for c in range(chains):
        speed, spin, last = -3.0 * (c - chains / 2) * R.uniform(0.5, 2.0), R.uniform(-1.0, 1.0), None
        for k in range(n := R.randint(2, 6)):
            place = (6.0 * c + 0.8 * (k - n / 2), R.uniform(-0.3, 0.3))
            one = body(space, place, 10.0 ** R.uniform(-1.0, 1.0), 0.0, spin)
            one.velocity = speed, spin * 0.8 * (k - n / 2)
            if last is not None:
                a, b, middle = last, one, (last.position + one.position) / 2.0
                joints = [
                    pymunk.PivotJoint(a, b, tuple(middle)),
                    pin(a, b),
                    slide(a, b),
                    pymunk.GrooveJoint(a, b, (0.0, 0.0), 1.2 * a.world_to_local(b.position), (0.0, 0.0)),
                    pymunk.DampedSpring(a, b, (0.1, 0.0), (0.0, 0.1), 0.6, 10.0 ** R.uniform(0.0, 5.0), 1.0),
                ]
                space.add(R.choice(joints))
                if R.random() < 0.3:
                    space.add(R.choice((pymunk.RotaryLimitJoint(a, b, -0.3, 0.4), pymunk.RatchetJoint(a, b, 0.0, 0.3))))
            last = one
    return space


@pytest.mark.parametrize("seed", range(12))
def test_mechanisms_in_flight_keep_their_momenta_in_long_steps(seed: int) -> None:
    """In each step, whether contacts and joints converge or not."""
    space = flight(seed)
    stepper = ep.EECA(space)
    linear, angular, scale = moments(space)
    for _ in range(2):
        stepper.step(0.5)
        before, begun, was = linear, angular, scale
        linear, angular, scale = moments(space)
        assert abs(linear - before).max() <= KEPT * max(scale, was)
        assert abs(angular - begun) <= KEPT * max(scale, was)


def test_gears_turn_bodies_alike_wherever_they_are_held() -> None:
    space = pymunk.Space()
    a, b, c = (body(space, (float(k), 0.0), 1.0 + k, 0.0, 2.0) for k in range(3))
    space.add(pymunk.PivotJoint(a, b, (0.5, 0.1)), pymunk.GearJoint(b, c, 0.0, 1.0))
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter(group=1)
    b.angular_velocity = c.angular_velocity = 3.0
    b.velocity = 1.0, 0.5
    assert all(keep(space, 0.05, 60))


@pytest.mark.parametrize("dt", [1 / 60, 1 / 15, 0.5])
def test_arms_fit_the_motion_where_contacts_do_not_converge(dt: float) -> None:
    """Motors far too strong for their chain, whose boxes touch."""
    space = pymunk.Space()
    boxes = []
    for k in range(6):
        one = pymunk.Body(10.0 ** (k % 3), pymunk.moment_for_box(10.0 ** (k % 3), (1.0, 0.5)))
        one.position = 1.02 * k, 0.0
        shape = pymunk.Poly.create_box(one, (1.0, 0.5))
        shape.friction = 0.5
        space.add(one, shape)
        boxes.append(one)
    for k, (a, b) in enumerate(itertools.pairwise(boxes)):
        motor = pymunk.SimpleMotor(a, b, 4.0 * (-1.0) ** k)
        motor.max_force = 1000.0
        space.add(pymunk.PivotJoint(a, b, tuple((a.position + b.position) / 2)), motor)
    assert not all(keep(space, dt, 40))


@pytest.mark.parametrize("factors", [(0.76, 0.76), (-0.9, -0.9), (1.5, 1.5), (0.9, -0.5), (-2.0, 0.5)])
def test_arms_are_found_where_they_turn_bodies_as_much_as_these_move_them(
    monkeypatch: pytest.MonkeyPatch, factors: tuple[float, float]
) -> None:
    """A motion that multiplies errors of the arms by a factor, along and across, of which joining points alone takes
    hundreds of turns or diverges. A contact without impulse does not disturb that."""
    row: Any = SimpleNamespace(a=0, b=1, nx=1.0, ny=0.0, arm_na=0.1, arm_ta=0.2, arm_nb=0.3, arm_tb=-0.4)
    isle: Any = SimpleNamespace(IM=np.ones(2), EXTENT=np.full(2, 10.0))
    motion = SimpleNamespace(MID=np.zeros((2, 2)))
    nothing: Any = None
    interval: Any = SimpleNamespace(isle=isle, ROWS=[copy.copy(row), row], motion=motion, m=2)
    turns: list[int] = []

    def motion_under(A: object, J: object, interval: object, L: FloatArray, *rest: object) -> None:
        turns.append(0)
        along, across = row.arm_tb - row.arm_ta, row.arm_nb - row.arm_na
        motion.MID[1] = 0.5 - factors[0] * (along + 0.5), factors[1] * (across + 0.5) - 0.5

    monkeypatch.setattr(advance, "advance", motion_under)
    advance.advance_aligned(nothing, nothing, interval, np.array([[0.0, 0.0], [1.0, 0.0]]), nothing, True)
    assert (row.arm_tb - row.arm_ta, row.arm_nb - row.arm_na) == pytest.approx((-0.5, -0.5), abs=1e-14)
    assert len(turns) <= 13


@pytest.mark.parametrize("spin", [19.9, 20.0, 20.1])
def test_an_impulse_acts_at_one_place_of_bodies_that_turn_fast(spin: float) -> None:
    """A rod that turns three times in a step falls on a hinge."""
    space = pymunk.Space()
    hinge = [body(space, (float(k), 0.0), 1.0, 0.0, -2.84) for k in range(2)]
    space.add(pymunk.PivotJoint(*hinge, (0.5, 0.0)))
    rod = pymunk.Body(0.3, 0.3 * 0.8**2 / 12)
    rod.position, rod.velocity, rod.angular_velocity = (0.626, 0.836), (0.0, -2.91), spin
    shape = pymunk.Segment(rod, (-0.4, 0.0), (0.4, 0.0), 0.05)
    space.add(rod, shape)
    for one in space.shapes:
        one.friction, one.elasticity = 0.5, 0.0
    for one in (*hinge[0].shapes, *hinge[1].shapes):
        one.filter = pymunk.ShapeFilter(group=1)
    keep(space, 1.0, 1)

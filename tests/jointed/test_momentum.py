"""Free islands with joints keep both momenta, whatever contacts and joints do."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.jointed import advance, correction

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


def flight(seed: int, chains: int, most: int) -> pymunk.Space:
    """Chains of two to `most` bodies, of masses 1 : 100, that turn and fly into each other."""
    R, space = Random(seed), pymunk.Space()
    for c in range(chains):
        speed, spin, last = -3.0 * (c - chains / 2) * R.uniform(0.5, 2.0), R.uniform(-1.0, 1.0), None
        for k in range(n := R.randint(2, most)):
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


@pytest.mark.parametrize(("chains", "seed"), [(2, 12), (2, 53), (3, 7), (3, 12), (3, 53)])
def test_mechanisms_in_flight_keep_their_momenta_in_long_steps(chains: int, seed: int) -> None:
    """In steps of .5 s that do not converge, as joined boxes overlap, and arms of contacts do not fit the motion."""
    space = flight(seed, chains, 3)
    stepper, converged = ep.EECA(space), True
    linear, angular, scale = moments(space)
    for _ in range(4):
        converged = stepper.step(0.5).converged and converged
        before, begun, was = linear, angular, scale
        linear, angular, scale = moments(space)
        assert abs(linear - before).max() <= 100.0 * KEPT * max(scale, was)
        assert abs(angular - begun) <= 100.0 * KEPT * max(scale, was)
    assert not converged


@pytest.mark.parametrize("seed", [15, 40, 42, 46, 48])
def test_joints_that_steps_leave_apart_keep_angular_momentum_as_they_close(seed: int) -> None:
    """Two bodies in flight that turn several times in a step of 10 s, while limits hold them apart."""
    R, space = Random(seed), pymunk.Space()
    bodies = []
    for k in range(2):
        one = pymunk.Body(10.0 ** R.uniform(-1.0, 1.0), 10.0 ** R.uniform(-2.0, 1.0))
        one.position, one.velocity = (0.8 * k, 0.0), (R.uniform(-1.0, 1.0), R.uniform(-1.0, 1.0))
        one.angular_velocity = R.uniform(-5.0, 5.0)
        space.add(one)
        bodies.append(one)
    a, b = bodies
    groove = R.random() < 0.5
    space.add(
        pymunk.GrooveJoint(a, b, (0.0, 0.0), (1.0, 0.0), (0.0, 0.0)) if groove else
        pymunk.SlideJoint(a, b, (0.1, 0.1), (0.0, 0.0), 0.5, 0.9)
    )  # fmt: skip
    space.add(R.choice((pymunk.RatchetJoint(a, b, 0.0, 0.3), pymunk.RotaryLimitJoint(a, b, -0.3, 0.4))))
    if R.random() < 0.5:
        motor = pymunk.SimpleMotor(a, b, 5.0)
        motor.max_force = R.uniform(0.1, 10.0)
        space.add(motor)
    stepper = ep.EECA(space)
    _, angular, scale = moments(space)
    for _ in range(15):
        stepper.step(10.0)
        begun, was = angular, scale
        _, angular, scale = moments(space)
        assert abs(angular - begun) <= 10.0 * KEPT * max(scale, was)


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


def test_angular_momentum_that_arms_give_is_taken_back() -> None:
    """An impulse p whose points on the two bodies are s apart has changed the angular momentum by s x p. The common
    rotation that takes it back changes no linear momentum, and its energy is accounted for."""
    row: Any = SimpleNamespace(a=0, b=1, nx=0.6, ny=0.8, arm_na=0.1, arm_ta=0.2, arm_nb=0.3, arm_tb=-0.4)
    mass, inertia = np.array([2.0, 5.0]), np.array([0.3, 0.7])
    isle: Any = SimpleNamespace(IM=1.0 / mass, II=1.0 / inertia, EXTENT=np.ones(2))
    end, velocities = np.array([[1.0, 2.0, 0.3], [2.5, 1.0, -0.2]]), np.array([[1.0, -0.5, 2.0], [-0.3, 0.8, -1.0]])
    motion: Any = SimpleNamespace(MID=end[:, :2] - 0.1, END=end, V=velocities)
    groups: Any = SimpleNamespace(GROUP=np.array([0, 1]), JOINTED=[0])
    joints: Any = SimpleNamespace(
        COMPONENT=[SimpleNamespace(first_body=0, end_body=0)], STEPPED=[SimpleNamespace(lifted=0.0)]
    )

    def totals() -> tuple[FloatArray, float, float]:
        x, y = end[:, 0], end[:, 1]
        turning = mass @ (x * velocities[:, 1] - y * velocities[:, 0]) + inertia @ velocities[:, 2]
        energy = 0.5 * (mass @ (velocities[:, :2] ** 2).sum(1) + inertia @ velocities[:, 2] ** 2)
        return mass @ velocities[:, :2], float(turning), float(energy)

    n, t, arms = np.array([0.6, 0.8]), np.array([-0.8, 0.6]), row
    apart = motion.MID[1] - motion.MID[0] + (arms.arm_tb - arms.arm_ta) * n - (arms.arm_nb - arms.arm_na) * t
    impulse = 3.0 * n + 0.5 * t
    linear, angular, energy = totals()
    interval: Any = advance.Interval(isle, groups, [row], motion, cast(Any, None), 1, 2, 0.0, 1.0, True)
    correction.keep_angular_momentum(joints, interval, np.array([[3.0, 0.5]]))
    after = totals()
    assert after[0] == pytest.approx(linear, abs=1e-14)
    assert after[1] == pytest.approx(angular - (apart[0] * impulse[1] - apart[1] * impulse[0]), abs=1e-14)
    assert joints.STEPPED[0].lifted == pytest.approx(after[2] - energy, abs=1e-14)


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


def test_disks_that_press_on_each_other_in_flight_turn_alike() -> None:
    """Whatever their order: arms that do not meet in one point, an error of the first order in dt, are divided."""
    spins = []
    for order in ((0, 1), (1, 0)):
        space, disks = pymunk.Space(), []
        for x, v in ((-0.5, -1.0), (0.5, 1.0)):
            body = pymunk.Body(1.0, 0.125)
            body.position, body.velocity = (x, 0.0), (0.0, v)
            disks.append((body, pymunk.Circle(body, 0.5)))
        for i in order:
            space.add(*disks[i])
        bodies = [body for body, _ in disks]
        space.add(pymunk.DampedSpring(*bodies, (0.0, 0.0), (0.0, 0.0), 0.2, 20.0, 0.0))
        stepper = ep.EECA(space)
        for _ in range(40):
            stepper.step(1 / 60)
        spins += [body.angular_velocity for body in bodies]
    assert spins == pytest.approx([spins[0]] * 4, abs=1e-9)

"""Each kind of joint against a closed form or what it promises: springs, motors, gears, friction, supports."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.parameters.joints import NEARLY_HELD
from scenes.linkages import body, empty, pendulum, point_double

from .driving import Driven, error, ledger_closes, momenta, run


@pytest.mark.parametrize("damping", [0.0, 1.5])
@pytest.mark.parametrize("count", [2, 4])
def test_spring_on_a_line(damping: float, count: int) -> None:
    # m = 2, k = 8 from .5 beyond its rest: x = e^(-g t) (cos w t + g/w sin w t)/2, g = c/2m, w^2 = k/m - g^2.
    order = 4 if damping == 0.0 and count == 4 else 2
    errors = []
    for steps in (50, 100):
        space = empty(0.0)
        weight = body(space, 2.0, 1.0, (1.5, 0.0))
        space.add(pymunk.DampedSpring(space.static_body, weight, (0, 0), (0, 0), 1.0, 8.0, damping))
        run(space, 2.0 / steps, steps, order)
        g = damping / 4.0
        w = math.sqrt(4.0 - g * g)
        exact = 1.0 + 0.5 * math.exp(-2 * g) * (math.cos(2 * w) + g / w * math.sin(2 * w))
        errors.append(abs(weight.position.x - exact))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)


def test_stiff_damper_slows_as_native_does() -> None:
    # Damping alone, c h / m = 60: one step leaves exp(-60) of the speed and does not ring.
    space = empty(0.0)
    weight = body(space, 1.0, 1.0, (1.0, 0.0))
    weight.velocity = (1.0, 0.0)
    space.add(pymunk.DampedSpring(space.static_body, weight, (0, 0), (0, 0), 1.0, 0.0, 3600.0))
    run(space, 1 / 60, 1)
    assert abs(weight.velocity.x) < 1e-13
    moderate = empty(0.0)
    weight = body(moderate, 1.0, 1.0, (1.0, 0.0))
    weight.velocity = (1.0, 0.0)
    moderate.add(pymunk.DampedSpring(moderate.static_body, weight, (0, 0), (0, 0), 1.0, 0.0, 60.0))
    run(moderate, 1 / 60, 1)
    assert weight.velocity.x == pytest.approx(math.exp(-1.0), rel=1e-12)


def test_rotary_spring_turns_as_a_harmonic_oscillator() -> None:
    space = empty(0.0)
    a, b = body(space, 1.0, 0.5, (0.0, 0.0)), body(space, 1.0, 1.0, (1.0, 0.0))
    a.angular_velocity = 3.0
    space.add(pymunk.DampedRotarySpring(a, b, 0.0, 5.0, 0.0))
    stepper = run(space, 1 / 120, 120)
    w = math.sqrt(5.0 * (1.0 / 0.5 + 1.0))
    assert a.angle - b.angle == pytest.approx(3.0 / w * math.sin(w), abs=1e-7)
    assert 0.5 * a.angular_velocity + b.angular_velocity == pytest.approx(1.5, abs=1e-13)
    ledger_closes(stepper, 2.25)


def test_motor_spins_up_with_its_force_then_holds_its_rate() -> None:
    space = empty()
    wheel = body(space, 2.0, 0.5, (0.0, 0.0))
    motor = pymunk.SimpleMotor(space.static_body, wheel, -3.0)
    motor.max_force = 1.0
    space.add(pymunk.PivotJoint(space.static_body, wheel, (0, 0), (0, 0)), motor)
    stepper = run(space, 1 / 60, 60)
    assert wheel.angular_velocity == pytest.approx(2.0, abs=1e-13)
    for _ in range(60):
        stepper.step(1 / 60)
    assert wheel.angular_velocity == pytest.approx(3.0, abs=1e-13)
    assert wheel.angle == pytest.approx(0.5 * 1.5 * 3.0 + 0.5 * 3.0, abs=1e-12)
    assert stepper.external == pytest.approx(2.25, abs=1e-13)


@pytest.mark.parametrize("ratio", [2.5, -1.5])
def test_gear_keeps_its_ratio_and_the_energy(ratio: float) -> None:
    space = empty()
    a, b = body(space, 1.0, 0.5, (-1.0, 0.0)), body(space, 1.0, 1.0, (1.0, 0.0))
    a.angular_velocity, b.angular_velocity = 3.0, 3.0 / ratio
    weight = body(space, 0.3, 0.1, (1.5, 0.0))
    weight.velocity = (0.0, 1.5 / ratio)
    ground = space.static_body
    space.add(pymunk.PivotJoint(ground, a, (-1, 0), (0, 0)), pymunk.PivotJoint(ground, b, (1, 0), (0, 0)))
    space.add(pymunk.GearJoint(a, b, 0.0, ratio), pymunk.PivotJoint(b, weight, (0.5, 0.0), (0.0, 0.0)))
    stepper = Driven(space)
    for _ in range(300):
        stepper.step(1 / 60)
        assert abs(a.angle - ratio * b.angle) < 1e-13 * max(1.0, abs(a.angle))
    ledger_closes(stepper, 10.0)


@pytest.mark.parametrize("ratio", [1.0, 10.0, -10.0, 0.1])
def test_a_step_converges_if_its_gears_hold_by_their_own_formula(ratio: float) -> None:
    """`angle_b ratio - angle_a - phase`, as a program computes it, not the angle of b that it means: three gears, whose
    ratios contradict one another by a millionth, give way as their axle turns (random scene 46000216)."""
    space = empty(0.0)
    axle = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    near, far = body(space, 1.0, 1.0, (0.0, 0.0)), body(space, 1.0, 1.0, (5.0, 0.0))
    axle.angular_velocity = near.angular_velocity = 1.0
    far.angular_velocity = 1.0 / ratio
    gears = [pymunk.GearJoint(axle, near, 0.0, 1.0), pymunk.GearJoint(near, far, 0.0, ratio)]
    gears.append(pymunk.GearJoint(axle, far, 0.0, ratio * (1.0 + 1e-6)))
    space.add(axle, *gears)
    stepper, seen = ep.EECA(space), set()
    for _ in range(12):
        report = stepper.step(1 / 60)
        off = max(abs(gear.ratio * gear.b.angle - gear.a.angle - gear.phase) for gear in gears)
        assert report.converged == (off <= NEARLY_HELD)
        seen.add(report.converged)
    assert seen == {True, False}


@pytest.mark.parametrize("ratio", [2.0, -0.5])
def test_a_torque_on_free_wheels_turns_them_by_their_gear_and_moves_neither(ratio: float) -> None:
    """turned_b = turned_a / ratio. The torques of a gear are -T/ratio and T: it is held by what is not modelled."""
    space = empty()
    space.gravity = 0.0, 0.0
    a, b = body(space, 1.0, 2.0, (0.0, 0.0), 0.0), body(space, 3.0, 5.0, (4.0, 0.0), 0.0)
    space.add(pymunk.GearJoint(a, b, 0.0, ratio))
    driven = Driven(space)
    for _ in range(10):
        a.torque = 7.0
        driven.step(0.02)
    spin = 0.2 * 7.0 / (2.0 + 5.0 / ratio**2)
    assert (a.angular_velocity, b.angular_velocity) == pytest.approx((spin, spin / ratio), rel=1e-12)
    assert (a.position, b.position) == ((0.0, 0.0), (4.0, 0.0))


@pytest.mark.parametrize("ratio", [1.0, 4.0, -0.25])
def test_a_gear_closes_as_fast_as_native(ratio: float) -> None:
    """At `max_bias` rad of its formula in a second, then by `error_bias`; pymunk begins one step later."""
    ways: list[list[float]] = []
    for native in (True, False):
        space = empty(0.0)
        wheel = body(space, 1.0, 1.0, (0.0, 0.0))
        gear = pymunk.GearJoint(space.static_body, wheel, 0.1, ratio)
        gear.max_bias = 0.5
        space.add(gear)
        step = space.step if native else ep.EECA(space).step
        ways.append([])
        for _ in range(10):
            step(1 / 60)
            ways[-1].append(ratio * wheel.angle)
    assert ways[1][:-1] == pytest.approx(ways[0][1:], rel=1e-6)


def test_tank_rubs_to_rest_as_coulomb_says() -> None:
    # Top-down friction by a pivot (force 2 on mass 1 at speed 5) and a gear (torque 1 on moment .4 at spin 6).
    space = empty(0.0)
    tank = body(space, 1.0, 0.4, (0.0, 0.0))
    tank.velocity, tank.angular_velocity = (3.0, 4.0), 6.0
    pivot = pymunk.PivotJoint(space.static_body, tank, (0, 0), (0, 0))
    gear = pymunk.GearJoint(space.static_body, tank, 0.0, 1.0)
    pivot.max_bias = gear.max_bias = 0.0
    pivot.max_force, gear.max_force = 2.0, 1.0
    space.add(pivot, gear)
    stepper = Driven(space)
    for _ in range(180):
        stepper.step(1 / 60)
    assert tank.position.length == pytest.approx(25.0 / 4.0, abs=1e-3)
    assert tank.angle == pytest.approx(36.0 / 5.0, abs=1e-3)
    assert tank.velocity.length < 1e-12
    assert stepper.friction == pytest.approx(0.5 * 25.0 + 0.5 * 0.4 * 36.0, rel=1e-12)


def test_kinematic_support_books_its_work() -> None:
    space = empty()
    crank = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    crank.angular_velocity = 2.0
    bob = pymunk.Body(1.0, 0.1)
    bob.position, bob.velocity = (0.5, -1.0), (0.0, 1.0)
    space.add(crank, bob, pymunk.PinJoint(crank, bob, (0.5, 0.0), (0.0, 0.0)))
    stepper, work = Driven(space, 2), 0.0
    for _ in range(300):
        before, x = momenta(space)[2], bob.position.x
        stepper.step(1 / 60)
        # The pin pulls along the chord 2 tan(W h/2) z x r of its circle, r the middle of it: its work is 2 tan(W h/2)/h
        # times the angular momentum that it gives, which is all but that of gravity at the mean of the places.
        moment = momenta(space)[2] - before + 9.81 / 60.0 * 0.5 * (x + bob.position.x)
        work += 120.0 * math.tan(1.0 / 60.0) * moment
    assert crank.angle == pytest.approx(10.0, abs=1e-12)
    assert error(space) < 1e-13
    assert abs(work) > 0.1
    ledger_closes(stepper, 10.0, work)


def test_joints_apart_close_at_natives_rate() -> None:
    space = point_double(1.0, 1.0)
    second = list(space.bodies)[1]
    second.position += (0.1, 0.05)
    gap = error(space)
    stepper = Driven(space)
    wide = []
    for _ in range(30):
        stepper.step(1 / 60)
        wide.append(error(space))
    np.testing.assert_allclose(np.divide(wide[1:], wide[:-1]), 0.9, atol=0.02)
    assert wide[0] < 0.95 * gap
    assert abs(stepper.unexplained()) < 1e-12 * 20.0


def test_pushed_bodies_are_projected_once() -> None:
    space = pendulum()
    bob = next(iter(space.bodies))
    stepper = run(space, 1 / 60, 30)
    along = bob.position.normalized()
    bob.velocity += 2.0 * along
    before = stepper.restitution
    stepper.step(1 / 60)
    assert stepper.restitution - before == pytest.approx(2.0, rel=0.02)
    first = stepper.restitution
    for _ in range(30):
        stepper.step(1 / 60)
    assert stepper.restitution == first


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("rate", [0.0, 0.5])
@pytest.mark.parametrize("heavy", [1e-2, 1e4])
def test_a_motor_of_unlimited_force_follows_what_impulses_do_not_move(heavy: float, rate: float, unit: float) -> None:
    """A wheel at rest, without weight, on a shaft that a program turns: after one step it has the spin of the shaft
    less the rate, and an arm on it, pinned at its end, goes round with both."""
    space, shaft = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shaft.angular_velocity = 2.0
    wheel, arm = pymunk.Body(heavy, heavy * unit**2), pymunk.Body(1.0, unit**2)
    space.add(shaft, wheel, pymunk.PivotJoint(shaft, wheel, (0.0, 0.0)), pymunk.SimpleMotor(shaft, wheel, rate))
    arm.position = (unit, 0.0)
    space.add(arm, pymunk.PivotJoint(wheel, arm, (0.5 * unit, 0.0)), pymunk.SimpleMotor(wheel, arm, 0.0))
    stepper = ep.EECA(space)
    for _ in range(20):
        report = stepper.step(1 / 60)
        assert report.converged, report.unmet
        assert wheel.angular_velocity == pytest.approx(2.0 - rate, rel=1e-9)
        assert arm.angular_velocity == pytest.approx(2.0 - rate, rel=1e-9)

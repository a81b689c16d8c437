"""Pendulums, linkages and chains against published digits, orders of accuracy, energy, momenta, closure."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

from eeca_pymunk.model.joint_steps import EXACT, UNHELD
from scenes import linkages

from ..jointed.measures import energy
from .driving import Driven, drift, error, momenta, run, slopes


def first(space: pymunk.Space) -> tuple[float, float]:
    return tuple(next(iter(space.bodies)).position)  # type: ignore[return-value]


def last(space: pymunk.Space) -> tuple[float, float]:
    return tuple(list(space.bodies)[-1].position)  # type: ignore[return-value]


def angles(space: pymunk.Space) -> tuple[float, float]:
    a, b = (body.position for body in space.bodies)
    return math.atan2(a.x, -a.y), math.atan2(b.x - a.x, a.y - b.y)


@pytest.mark.parametrize(("order", "steps", "cap"), [(2, [120, 240, 480], 7e-5), (4, [60, 120, 240], 1e-9)])
def test_pendulum_reaches_the_published_place(order: int, steps: list[int], cap: float) -> None:
    errors, ratios = slopes(linkages.pendulum, first, linkages.PENDULUM_AT[1.0], 1.0, steps, order)
    assert errors[-1] < cap
    np.testing.assert_allclose(ratios, order, atol=0.1)


def test_pendulum_after_ten_seconds() -> None:
    space = linkages.pendulum()
    run(space, 1 / 240, 2400)
    np.testing.assert_allclose(first(space), linkages.PENDULUM_AT[10.0], atol=1e-7)


def test_pendulum_of_the_issue_keeps_period_and_amplitude() -> None:
    # pymunk issue 216: L = 300, g = 981: T = 4.1012 s, and it comes back to where it was let go.
    space = linkages.pendulum(300.0, 981.0)
    stepper = Driven(space)
    dt, crossings, before = 1 / 120, [], -1.0
    bob = next(iter(space.bodies))
    for k in range(3 * 493):
        stepper.step(dt)
        if before < 0.0 <= bob.position.x:
            crossings.append((k + 1) * dt - dt * bob.position.x / (bob.position.x - before))
        before = bob.position.x
    period = np.diff(crossings)
    np.testing.assert_allclose(period, 300**0.5 * 981**-0.5 * 2.3678419475762 * 9.81**0.5, rtol=1e-4)
    np.testing.assert_allclose(energy(space), 0.0, atol=1e-12 * 300 * 981)


@pytest.mark.parametrize(("order", "steps", "cap"), [(2, [240, 480, 960], 2e-4), (4, [120, 240, 480], 1e-8)])
def test_point_double_pendulum(order: int, steps: list[int], cap: float) -> None:
    half = math.pi / 2.0
    errors, ratios = slopes(
        lambda: linkages.point_double(half, half), angles, linkages.DOUBLE_AT[1.0], 1.0, steps, order
    )
    assert errors[-1] < cap
    np.testing.assert_allclose(ratios, order, atol=0.1)


def test_small_swings_of_a_double_pendulum() -> None:
    space = linkages.point_double(0.1, 0.1)
    run(space, 1 / 60, 600)
    np.testing.assert_allclose(angles(space), linkages.SMALL_DOUBLE_AT_10, atol=1e-5)


def test_rods_of_chrono() -> None:
    space = linkages.rods()
    stepper = run(space, 1 / 120, 120)
    np.testing.assert_allclose(last(space), linkages.RODS_AT[1.0], atol=1e-7)
    for _ in range(480):
        stepper.step(1 / 120)
    np.testing.assert_allclose(last(space), linkages.RODS_AT[5.0], atol=1e-4)


@pytest.mark.parametrize(("steps", "cap"), [(90, 9.0e-6), (360, 3.8e-8)])
def test_bars_beat_runge_kutta_in_minimal_coordinates(steps: int, cap: float) -> None:
    reference = linkages.bars()
    run(reference, 1.5 / 5760, 5760)
    space = linkages.bars()
    run(space, 1.5 / steps, steps)
    assert np.abs(np.subtract(last(space), last(reference))).max() < cap


@pytest.mark.parametrize(("loops", "seconds", "dt"), [(2, 10.0, 1 / 400), (40, 1.0, 1 / 200)])
def test_four_bars_turn_over(loops: int, seconds: float, dt: float) -> None:
    # Kinetic energy against the angle of the crank, all being in step: A w^2 + B cos(phi) = A + B.
    space = linkages.four_bars(loops)
    stepper = Driven(space)
    crank = next(iter(space.bodies))
    a, b = (loops + 1) / 6.0 + loops / 2.0, ((loops + 1) / 2.0 + loops) * linkages.GRAVITY
    worst = 0.0
    for _ in range(round(seconds / dt)):
        stepper.step(dt)
        tilt = math.pi / 2.0 - crank.angle
        worst = max(worst, abs(a * crank.angular_velocity**2 + b * math.cos(tilt) - a - b) / (a + b))
    assert worst < 1e-4
    assert error(space) < 1e-10
    if loops == 2:
        end = crank.local_to_world((0.5, 0.0))
        np.testing.assert_allclose(end, linkages.FOUR_BAR_AT_10[2], atol=1e-4)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize(
    "make",
    [
        linkages.pendulum, lambda: linkages.point_double(1.5, 1.5), linkages.bars, linkages.braced_four_bar,
        lambda: linkages.chain(20, lean=1.0),
    ],
    ids=["pendulum", "double", "bars", "braced", "chain"],
)  # fmt: skip
def test_energy_and_joints_hold_at_sixty_steps_a_second(make, order: int) -> None:  # type: ignore[no-untyped-def]
    steps = 10_000 if make is linkages.pendulum else 1000
    off, apart, stepper = drift(make(), 1 / 60, steps, order)
    assert off < 1e-10
    assert apart < 1e-10
    assert stepper.status < UNHELD


@pytest.mark.parametrize(("count", "end", "dt"), [(20, 1.0, 1 / 60), (100, 1.0, 1 / 240), (20, 1000.0, 1 / 60)])
def test_chains_keep_energy_and_length(count: int, end: float, dt: float) -> None:
    off, apart, stepper = drift(linkages.chain(count, end, 0.5), dt, 120, 2)
    assert off < 1e-11 * 9.81 * count * (count + end)
    assert apart < 1e-10
    assert abs(stepper.gain()) < 1e-11 * 9.81 * count * (count + end)


def test_free_pair_keeps_momentum_and_angular_momentum() -> None:
    space = linkages.empty(0.0)
    a, b = linkages.body(space, 1.0, 0.3, (0.1, 0.2), 0.4), linkages.body(space, 2.0, 0.5, (1.0, -0.3), -1.0)
    a.velocity, a.angular_velocity, b.velocity, b.angular_velocity = (0.5, 1.0), 7.0, (-0.2, 0.3), -4.0
    space.add(pymunk.PivotJoint(a, b, (0.5, 0.1)), pymunk.DampedRotarySpring(a, b, 0.2, 3.0, 0.1))
    start = momenta(space)
    run(space, 1 / 60, 2000)
    np.testing.assert_allclose(momenta(space), start, atol=1e-11)


def test_cloth_falls_with_its_pins_kept() -> None:
    space = linkages.cloth(7)
    off, apart, stepper = drift(space, 1 / 240, 60, 2)
    assert stepper.status == EXACT
    assert off < 1e-11
    assert apart < 1e-10


def test_forty_four_bars_after_ten_seconds() -> None:
    space = linkages.four_bars(40)
    stepper, worst = Driven(space), 0.0
    for _ in range(1000):
        stepper.step(0.01)
        worst = max(worst, abs(energy(space) - stepper.start))
    end = next(iter(space.bodies)).local_to_world((0.5, 0.0))
    np.testing.assert_allclose(end, linkages.FOUR_BAR_AT_10[40], atol=5e-5)
    assert worst < 1e-7  # Exudyn's is .114


def test_squeezer_of_andrews() -> None:
    # Published digits by order 2, the spring's energy stored, the motor's work in the ledger.
    errors, dts = [], (1e-5, 5e-6)
    for dt in dts:
        space = linkages.squeezer()
        stepper = Driven(space)
        for _ in range(round(0.03 / dt)):
            stepper.step(dt)
        k1, k2, k3, _, k5, _, k7 = space.bodies
        known = linkages.SQUEEZER_AT_003
        reached = np.array([k1.angle, k2.angle - k1.angle, k3.angle, k5.angle, k7.angle])
        errors.append(reached - [known[name] for name in ("beta", "theta", "gamma", "delta", "epsilon")])
        assert stepper.external == pytest.approx(linkages.SQUEEZER_WORK, abs=3e-7)
        assert abs(stepper.unexplained()) < 1e-12
        assert error(space) < 1e-15
    assert np.abs(errors[0]).max() < 1e-4
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_units_do_not_matter(unit: float) -> None:
    space = linkages.pendulum(unit, linkages.GRAVITY * unit)
    run(space, 1 / 60, 60)
    reference = linkages.pendulum()
    run(reference, 1 / 60, 60)
    np.testing.assert_allclose(np.divide(first(space), unit), first(reference), atol=1e-13)


def test_two_runs_are_bitwise_equal() -> None:
    ends = []
    for _ in range(2):
        space = linkages.chain(10, lean=0.3)
        run(space, 1 / 60, 100)
        ends.append([tuple(b.position) for b in space.bodies])
    assert ends[0] == ends[1]

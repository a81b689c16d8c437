"""Joints: hard cases; published digits, closed forms and the same bars by their angles; orders, drift, momenta."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.hard_cases import Case, joints, linked
from comparisons.hard_cases.joints import apart, energy
from scenes import linkages
from scenes.bars import Bars

from .audit import Audit
from .running import check, of

Place = Callable[[pymunk.Space], tuple[float, ...]]


@pytest.mark.parametrize("one", of(joints, linked), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


def run(space: pymunk.Space, duration: float, steps: int) -> pymunk.Space:
    stepper = ep.EECA(space)
    for _ in range(steps):
        stepper.step(duration / steps)
    return space


def first(space: pymunk.Space) -> tuple[float, ...]:
    return tuple(next(iter(space.bodies)).position)


def last(space: pymunk.Space) -> tuple[float, ...]:
    return tuple(list(space.bodies)[-1].position)


def angles(space: pymunk.Space) -> tuple[float, ...]:
    a, b = (body.position for body in space.bodies)
    return math.atan2(a.x, -a.y), math.atan2(b.x - a.x, a.y - b.y)


def crank(space: pymunk.Space) -> tuple[float, ...]:
    return tuple(next(iter(space.bodies)).local_to_world((0.5, 0.0)))


def right_angles() -> pymunk.Space:
    return linkages.point_double(0.5 * math.pi, 0.5 * math.pi)


def slopes(
    build: Callable[[], pymunk.Space], place: Place, exact: tuple[float, ...], duration: float, steps: list[int]
) -> tuple[list[float], np.ndarray]:
    """The errors with so many steps, and their slopes in dt."""
    errors = [float(np.abs(np.subtract(place(run(build(), duration, n)), exact)).max()) for n in steps]
    return errors, -np.diff(np.log(errors)) / np.diff(np.log(steps))


# The scene, what of it is known, by whom, at t, with how many steps, how well.
DIGITS = {
    "pendulum, 1 s (IFToMM)": (linkages.pendulum, first, linkages.PENDULUM_AT[1.0], 1.0, 60, 1e-6),
    "pendulum, 10 s (IFToMM)": (linkages.pendulum, first, linkages.PENDULUM_AT[10.0], 10.0, 600, 2e-6),
    "rods, 1 s (Chrono)": (linkages.rods, last, linkages.RODS_AT[1.0], 1.0, 60, 1e-7),
    "rods, 5 s (Chrono)": (linkages.rods, last, linkages.RODS_AT[5.0], 5.0, 600, 1e-4),
    "point masses, 1 s": (right_angles, angles, linkages.DOUBLE_AT[1.0], 1.0, 240, 1e-7),
    "point masses, 5 s": (right_angles, angles, linkages.DOUBLE_AT[5.0], 5.0, 1200, 1e-4),
    "small swings, 10 s": (
        lambda: linkages.point_double(0.1, 0.1), angles, linkages.SMALL_DOUBLE_AT_10, 10.0, 600, 1e-5
    ),
    "two four-bars, 10 s (IFToMM)": (
        lambda: linkages.four_bars(2), crank, linkages.FOUR_BAR_AT_10[2], 10.0, 1000, 1e-6
    ),
    "forty four-bars, 10 s (IFToMM)": (
        lambda: linkages.four_bars(40), crank, linkages.FOUR_BAR_AT_10[40], 10.0, 1000, 5e-5
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", DIGITS)
def test_published_digits(name: str) -> None:
    build, place, exact, duration, steps, tolerance = DIGITS[name]
    space = build()
    # What velocities contradict is made right in the first step.
    stepper = Audit(space)
    start = energy(space)
    for _ in range(steps):
        stepper.step(duration / steps)
    np.testing.assert_allclose(place(space), exact, rtol=0.0, atol=tolerance)
    scale = sum(body.mass for body in space.bodies) * linkages.GRAVITY
    assert abs(energy(space) - start) < 1e-11 * scale  # Exudyn's two and forty four-bars: .114 at the same step
    assert apart(space) < 1e-12
    assert stepper.residual < 1e-12


@pytest.mark.parametrize(("steps", "cap"), [(90, 9.0e-6), (360, 3.8e-8)])
def test_bars_beat_runge_kutta_in_minimal_coordinates(steps: int, cap: float) -> None:
    # Caps are what MuJoCo's fourth order comes to with as many steps.
    near = np.array((0.9, 0.7))
    exact = Bars(np.array((1.0, 1.5)), np.array((0.05, 0.03)), near, np.array((0.9, 1.0)), np.zeros(2), 9.81)
    exact.run(1.5, 6000)
    assert np.hypot(*np.subtract(last(run(linkages.bars(), 1.5, steps)), exact.places()[1])) < cap


@pytest.mark.parametrize(
    ("build", "place", "exact"),
    [
        (linkages.pendulum, first, linkages.PENDULUM_AT[1.0]), (linkages.rods, last, linkages.RODS_AT[1.0]),
        (right_angles, angles, linkages.DOUBLE_AT[1.0]),
    ],
    ids=["pendulum", "rods", "point masses"],
)  # fmt: skip
def test_fourth_order_where_energy_is_kept(
    build: Callable[[], pymunk.Space], place: Place, exact: tuple[float, float]
) -> None:
    _, found = slopes(build, place, exact, 1.0, [60, 120, 240])
    np.testing.assert_allclose(found, 4.0, atol=0.2)


@pytest.mark.parametrize("wall", [False, True], ids=["free", "bounces"])
def test_second_order_where_it_is_lost(wall: bool) -> None:
    """A weight on a damped spring; and one that bounces where the spring is at rest, so that it is where |x| is."""
    c, k, start, duration = 0.8, 40.0, 0.7, 2.0
    decay, rate = 0.5 * c, math.sqrt(k - 0.25 * c * c)
    t = duration
    x = start * math.exp(-decay * t) * (math.cos(rate * t) + decay / rate * math.sin(rate * t))

    def build() -> pymunk.Space:
        space = linkages.empty(0.0)
        body = linkages.body(space, 1.0, math.inf, (start, 0.0))
        # The anchor is far enough for the spring never to fold.
        space.add(pymunk.DampedSpring(space.static_body, body, (-3.0, 0.0), (0.0, 0.0), 3.0, k, c))
        if wall:
            disk, stop = pymunk.Circle(body, 0.1), pymunk.Segment(space.static_body, (-0.1, -1.0), (-0.1, 1.0), 0.0)
            disk.elasticity = stop.elasticity = 1.0
            space.add(disk, stop)
        return space

    errors, found = slopes(build, lambda space: first(space)[:1], (abs(x) if wall else x,), duration, [100, 200, 400])
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(found, 2.0, atol=0.3)


@pytest.mark.parametrize(
    "build", [linkages.pendulum, linkages.bars, linkages.braced_four_bar], ids=["pendulum", "double", "four-bar"]
)
def test_nothing_drifts(build: Callable[[], pymunk.Space]) -> None:
    """2000 steps at 1/60; `comparisons.soak` takes 100 000."""
    space = build()
    stepper, start, off, gap = ep.EECA(space), energy(space), 0.0, 0.0
    for _ in range(2000):
        stepper.step(1 / 60)
        off, gap = max(off, abs(energy(space) - start)), max(gap, apart(space))
    assert off < 1e-11 * 9.81
    assert gap < 1e-12


def test_squeezer_of_andrews() -> None:
    """All fourteen published states by order 2; the motor's work is the published torque over the published turn."""
    errors = []
    known = np.array([linkages.SQUEEZER_AT_003[name] for name in linkages.SQUEEZER_START])
    rates = np.array([linkages.SQUEEZER_RATES_AT_003[name] for name in linkages.SQUEEZER_START])
    for dt in (2e-5, 1e-5):
        space = linkages.squeezer()
        stepper, start = Audit(space), energy(space)
        for _ in range(round(0.03 / dt)):
            stepper.step(dt)
        found = [np.array([getattr(k, name) for k in space.bodies]) for name in ("angle", "angular_velocity")]
        for state in found:
            # theta, phi and omega are angles between bodies.
            state[[1, 3, 5]] -= state[[0, 4, 6]]
        errors.append(np.concatenate((found[0] - known, found[1] - rates)))
        assert stepper.total["external"] == pytest.approx(linkages.SQUEEZER_WORK, abs=2e-6)
        assert energy(space) - start == pytest.approx(stepper.total["external"], abs=1e-12)
        assert apart(space) < 1e-14
    assert np.abs(errors[-1][:7]).max() < 1e-4
    assert np.abs(errors[-1][7:]).max() < 1e-4 * rates.max()
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)

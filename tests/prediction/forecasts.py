"""Forecasts, checked against gaps sampled along the paths."""

from __future__ import annotations

import math

import numpy as np

from eeca_pymunk.geometry.gap import gap, gap_round_off
from eeca_pymunk.prediction.impact_times import time_of_impact
from tests.packed import Thing, World

UNITS = [1e-3, 1.0, 1e3]
FLOOR = [([(-50.0, 0.0), (50.0, 0.0)], 0.0)]


def next_impact(world: World, a: int, b: int, horizon: float = 10.0) -> tuple[float, bool]:
    """`time_of_impact`, the same from b to a."""
    found = time_of_impact(world.scene, a, b, horizon, math.inf)
    assert time_of_impact(world.scene, b, a, horizon, math.inf) == found
    return float(found[0]), bool(found[1])


def first_falling_root(coefficients: list[float]) -> float:
    """Of a polynomial, highest power first, in s >= 0; infinity without one."""
    roots = np.roots(np.trim_zeros(coefficients, "f"))
    real = roots[np.abs(roots.imag) < 1e-9 * np.maximum(np.abs(roots), 1e-9)].real
    slope = np.polyder(np.array(coefficients))
    return float(min((s for s in real if s >= 0.0 and np.polyval(slope, s) < 0.0), default=math.inf))


def check_by_sampling(world: World, a: int, b: int, horizon: float, looks: int = 400) -> str:
    """That no earlier contact is jumped over, and that the one found is one: gaps sampled along the paths."""
    i, j = world.link[a].owner, world.link[b].owner
    start = max(world.body["since"][i], world.body["since"][j])
    t, certain = next_impact(world, a, b, horizon)
    tolerance = gap_round_off(world.scene, a, b)
    end = min(t, horizon)
    for instant in np.linspace(start, end, looks, endpoint=False):
        assert gap(world.scene, a, b, instant)[0] > -4.0 * tolerance
    if not certain:
        assert t >= horizon
        return "later"
    if t == math.inf:
        return "never"
    if t <= horizon:
        assert abs(gap(world.scene, a, b, t)[0]) <= 4.0 * tolerance
        after = t + 1e-6 * (t - start + 1e-3)
        assert gap(world.scene, a, b, after)[0] < tolerance
    return "meets"


def gap_now(things: list[Thing], a: int = 0, b: int = 1) -> float:
    """Gap of things a and b at the later of their clocks."""
    return float(gap(World(things).scene, a, b, max(t.since for t in things))[0])


def static(vertices: list[tuple[float, float]], rounding: float) -> list[tuple[list[tuple[float, float]], float]]:
    """The ground as one shape."""
    return [(vertices, rounding)]

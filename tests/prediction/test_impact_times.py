"""Times of impact of lone disks, against closed forms, roots of polynomials, and gaps sampled along the paths."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.prediction.impact_times import time_of_impact
from eeca_pymunk.prediction.next_event import exit_time, passage, straight_exit
from eeca_pymunk.prediction.roots import disks_meet, falling_root
from tests.packed import Thing, World, disk, hull
from tests.prediction.forecasts import UNITS, check_by_sampling, first_falling_root, gap_now, next_impact, static


def test_flat_root_keeps_its_digits() -> None:
    assert falling_root(1.0, -2.0, 0.0) == 0.5
    assert falling_root(0.0, -1.0, 5.0) == 0.0
    assert falling_root(-1e-17, -1.0, 5.0) == 0.0
    assert falling_root(0.0, 1.0, 0.0) == math.inf
    assert falling_root(1.0, -1.0, 1.0) == math.inf  # turns before it arrives
    assert falling_root(0.0, 2.0, -4.0) == 1.0  # thrown up, falls back
    assert falling_root(-1.0, 1.0, -4.0) == 0.5  # never opens: back where it was
    assert falling_root(0.0, 0.0, 0.0) == math.inf
    assert falling_root(1e-12, -1.0, -1e-3) == pytest.approx(1e-12, rel=1e-15)
    rng = np.random.default_rng(0)
    for g, w, alpha in rng.normal(size=(500, 3)) * (1, 1, 1):
        if g > 0.0:
            expected = first_falling_root([0.5 * alpha, w, g])
            assert falling_root(g, w, alpha) == pytest.approx(expected, rel=1e-9)


def test_grazing_disks_one_billionth_deep() -> None:
    # Offset D - 1e-9: c² = D² - offset², the half chord.
    deep = 1e-9
    half = math.sqrt(deep * (2.0 - deep))
    assert disks_meet(3.0, 1.0 - deep, -1.0, 0.0, 1.0) == pytest.approx(3.0 - half, abs=1e-11)
    assert disks_meet(3.0, 1.0 + deep, -1.0, 0.0, 1.0) == math.inf
    assert disks_meet(1.0, 0.0, 1.0, 0.3, 1.0) == math.inf  # touching, parting
    assert disks_meet(1.0, 0.0, -1.0, 0.3, 1.0) == 0.0
    assert disks_meet(0.5, 0.0, -1.0, 0.3, 1.0) == 0.0  # overlap
    assert disks_meet(0.5, 0.0, 1.0, 0.3, 1.0) == math.inf


@pytest.mark.parametrize("unit", UNITS)
def test_disks_on_their_own_clocks(unit: float) -> None:
    rng = np.random.default_rng(1)
    met = 0
    for _ in range(200):
        pull = (0.0, -9.81 * unit, 0.0)
        things = [
            Thing(disk(0.5 * unit), (*(unit * p), 0.0), (*(unit * v), 0.0), pull, since)
            for p, v, since in zip(
                rng.uniform(-3, 3, (2, 2)), rng.uniform(-2, 2, (2, 2)), rng.uniform(0, 0.3, 2), strict=True
            )
        ]
        outcome = check_by_sampling(World(things), 0, 1, 5.0, 50) if gap_now(things) > 0.0 else ""
        met += outcome == "meets"
    assert met > 15


def test_disks_are_bitwise_symmetric() -> None:
    rng = np.random.default_rng(4)
    for k in range(300):
        pulls = rng.normal(size=(2, 2)) if k % 2 else np.zeros((2, 2))
        p, v, since = rng.uniform(-3, 3, (2, 2)), rng.uniform(-2, 2, (2, 2)), rng.uniform(0, 0.3, 2)
        things = [
            Thing(disk(0.3), (*p[i], 0.0), (*v[i], 0.0), (*pulls[i], 0.0), float(since[i])) for i in range(2)
        ]  # fmt: skip
        one, other = World(things), World(things[::-1])
        found = time_of_impact(one.scene, 0, 1, 5.0, math.inf)
        assert found == time_of_impact(other.scene, 0, 1, 5.0, math.inf)
        # Mirrored in both axes.
        turned = World(
            [Thing(disk(0.3), (*-p[i], 0.0), (*-v[i], 0.0), (*-pulls[i], 0.0), float(since[i])) for i in (0, 1)]
        )
        assert found == time_of_impact(turned.scene, 0, 1, 5.0, math.inf)


@pytest.mark.parametrize("unit", UNITS)
def test_disks_under_different_pulls_are_a_quartic(unit: float) -> None:
    rng = np.random.default_rng(2)
    met = 0
    for _ in range(200):
        d, u, a = rng.uniform(-3, 3, 2), rng.uniform(-2, 2, 2), rng.uniform(-2, 2, 2)
        if math.hypot(*d) < 1.0:
            continue
        world = World(
            [Thing(disk(0.5 * unit)), Thing(disk(0.5 * unit), (*unit * d, 0.0), (*unit * u, 0.0), (*unit * a, 0.0))]
        )
        x, y = np.array([0.5 * a[0], u[0], d[0]]), np.array([0.5 * a[1], u[1], d[1]])
        expected = first_falling_root(list(np.polysub(np.polyadd(np.polymul(x, x), np.polymul(y, y)), [1.0])))
        t, certain = next_impact(world, 0, 1, 4.0)
        if certain and t < math.inf:
            assert t == pytest.approx(expected, rel=1e-9)
            met += 1
        else:
            assert 4.0 <= t <= expected * (1.0 + 1e-9)
    assert met > 30


# A lone disk and what stands still


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("pull", [(0.0, 0.0), (0.3, -1.0)])
@pytest.mark.parametrize("corners", [1, 2, 3, 6])
def test_disk_and_static_shape_by_sampling(corners: int, pull: tuple[float, float], unit: float) -> None:
    rng = np.random.default_rng(corners)
    outcomes = []
    for _ in range(120):
        wall = [(unit * x, unit * y) for x, y in hull(rng, corners, rng.choice([0.1, 1.0]))]
        x = rng.uniform(-3, 3, 2)
        v = rng.uniform(-1, 1, 2) - 0.5 * x
        thing = Thing(disk(unit * 0.3), (*unit * x, 0.0), (*unit * v, 0.0), (unit * pull[0], unit * pull[1], 0.0))
        world = World([thing], static(wall, unit * rng.choice([0.0, 0.2])))
        if gap(world.scene, 0, 1, 0.0)[0] > 0.0:
            outcomes.append(check_by_sampling(world, 0, 1, 4.0, 300))
    assert outcomes.count("meets") > 15
    assert outcomes.count("never") + outcomes.count("later") > 8


def test_disk_thrown_at_a_vertex_is_a_quartic() -> None:
    # Beside the end (0, 0) of a wall that goes to the right and down; the centre ends at distance r from it.
    r, g = 0.25, 9.81
    for x0, v, up in ((-1.0, 1.3, 2.0), (-2.0, 2.1, 3.7), (-1.0, 0.9, 0.5)):
        world = World(
            [Thing(disk(r), (x0, 1.0, 0.0), (v, up, 0.0), (0.0, -g, 0.0))], static([(0.0, 0.0), (1.0, -9.0)], 0.0)
        )
        x, y = np.array([v, x0]), np.array([-0.5 * g, up, 1.0])
        expected = first_falling_root(list(np.polysub(np.polyadd(np.polymul(y, y), np.polymul(x, x)), [r * r])))
        t, certain = next_impact(world, 0, 1)
        # The side is met later than its end, or not at all, on these paths.
        if math.isfinite(expected):
            assert certain
            assert t == pytest.approx(expected, rel=1e-12)


def test_disk_and_sides_in_closed_form() -> None:
    wall = static([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)], 0.1)
    at = {"pose": (0.3, 3.0, 0.0), "rate": (0.1, -2.0, 0.0)}
    assert next_impact(World([Thing(disk(0.4), **at)], wall), 0, 1) == (pytest.approx(0.75, abs=1e-15), True)
    # h = 1.5 - 2 t - 4.905 t²
    thrown = World([Thing(disk(0.4), **at, pull=(0.0, -9.81, 0.0))], wall)
    assert next_impact(thrown, 0, 1)[0] == pytest.approx((-2 + math.sqrt(4 + 4 * 4.905 * 1.5)) / 9.81, rel=1e-15)
    # A corner, straight: the chord of the rounding at (1, 1).
    at = {"pose": (4.0, 1.3, 0.0), "rate": (-1.0, 0.0, 0.0)}
    assert next_impact(World([Thing(disk(0.4), **at)], wall), 0, 1)[0] == pytest.approx(3.0 - 0.4, rel=1e-15)
    at = {"pose": (4.0, 1.5 - 1e-9, 0.0), "rate": (-1.0, 0.0, 0.0)}
    depth = math.sqrt(1e-9 * (1.0 - 1e-9))
    # It grazes the corner before the side's middle, where the side would be 1e-9 deep.
    assert next_impact(World([Thing(disk(0.4), **at)], wall), 0, 1)[0] == pytest.approx(3.0 - depth, abs=1e-10)
    at = {"pose": (4.0, 1.5 + 1e-9, 0.0), "rate": (-1.0, 0.0, 0.0)}
    assert next_impact(World([Thing(disk(0.4), **at)], wall), 0, 1) == (math.inf, True)
    # Touching and parting, sliding, approaching; inside, toward the nearest side and away from it.
    for y, v, expected in (
        (1.5, 1.0, math.inf),
        (1.5, 0.0, math.inf),
        (1.5, -1.0, 0.0),
        (0.9, 1.0, math.inf),
        (0.9, -1.0, 0.0),
    ):
        world = World([Thing(disk(0.4), (0.0, y, 0.0), (0.5, v, 0.0))], wall)
        assert next_impact(world, 0, 1) == (expected, True)
    # Off a side, pulled back to it, from a gap of 0 up to round-off.
    for gap_there in (0.0, 1e-16, -1e-16):
        world = World([Thing(disk(0.4), (0.0, 1.5 + gap_there, 0.0), (0.01, 2.0, 0.0), (0.0, -10.0, 0.0))], wall)
        assert next_impact(world, 0, 1)[0] == pytest.approx(0.4, rel=1e-14)


def test_thrown_disk_that_passes_beside_the_side_it_first_enters() -> None:
    # A post, and a throw that crosses the line of its top beside it, comes back and lands on it.
    post = static([(-0.1, -5.0), (0.1, -5.0), (0.1, 0.0), (-0.1, 0.0)], 0.0)
    ball = Thing(disk(0.05), (2.0, 0.06, 0.0), (-1.0, -0.3, 0.0), (0.0, 0.31, 0.0))
    assert check_by_sampling(World([ball], post), 0, 1, 4.0) == "meets"


@pytest.mark.parametrize("tiny", [0.0, 5e-324, 1e-161, 1e-155, 1e-100])
def test_what_is_too_slow_for_its_square_leaves_no_circle(tiny: float) -> None:
    """An exit at once, again and again, would spend the work of the step, and time would stand still."""
    assert straight_exit(0.5, 0.0, 0.0, tiny, 1.0) > 1e90
    assert straight_exit(-0.5, 0.1, tiny, -tiny, 1.0) > 1e90
    assert exit_time(0.5, 0.0, 0.0, tiny, tiny, 1.0) > 1e40
    assert passage(1e-3, 0.0, tiny) > 1e40

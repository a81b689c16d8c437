"""Times of impact against closed forms, roots of polynomials, and gaps sampled along the paths."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from eeca_pymunk.geometry.gap import gap, touching
from eeca_pymunk.impacts.roots import ball_point, flat
from eeca_pymunk.impacts.times import meet
from eeca_pymunk.impacts.turning import bends
from tests.packed import Thing, World, box, disk, hull, placed

UNITS = [1e-3, 1.0, 1e3]
FLOOR = [([(-50.0, 0.0), (50.0, 0.0)], 0.0)]


def next_impact(world: World, a: int, b: int, horizon: float = 10.0, held: float = -1.0) -> tuple[float, bool]:
    """`meet`, the same from b to a."""
    found = meet(*world.arrays, a, b, world.disks, horizon, held)
    assert meet(*world.arrays, b, a, world.disks, horizon, held) == found
    return float(found[0]), bool(found[1])


def first_falling_root(coefficients: list[float]) -> float:
    """Of a polynomial, highest power first, in s >= 0; infinity without one."""
    roots = np.roots(np.trim_zeros(coefficients, "f"))
    real = roots[np.abs(roots.imag) < 1e-9 * np.maximum(np.abs(roots), 1e-9)].real
    slope = np.polyder(np.array(coefficients))
    return float(min((s for s in real if s >= 0.0 and np.polyval(slope, s) < 0.0), default=math.inf))


def check_by_sampling(world: World, a: int, b: int, horizon: float, looks: int = 400) -> str:
    """That no earlier contact is jumped over, and that the one found is one: gaps sampled along the paths."""
    i, j = world.link[a, 0], world.link[b, 0]
    start = max(world.body[i, 9], world.body[j, 9])
    t, certain = next_impact(world, a, b, horizon)
    tolerance = touching(world.body, world.shape, world.link, a, b, world.disks)
    end = min(t, horizon)
    for instant in np.linspace(start, end, looks, endpoint=False):
        assert gap(*world.arrays, a, b, instant)[0] > -4.0 * tolerance
    if not certain:
        assert t >= horizon
        return "later"
    if t == math.inf:
        return "never"
    if t <= horizon:
        assert abs(gap(*world.arrays, a, b, t)[0]) <= 4.0 * tolerance
        after = t + 1e-6 * (t - start + 1e-3)
        assert gap(*world.arrays, a, b, after)[0] < tolerance
    return "meets"


# Closed forms


def test_flat_root_keeps_its_digits() -> None:
    assert flat(1.0, -2.0, 0.0) == 0.5
    assert flat(0.0, -1.0, 5.0) == 0.0
    assert flat(-1e-17, -1.0, 5.0) == 0.0
    assert flat(0.0, 1.0, 0.0) == math.inf
    assert flat(1.0, -1.0, 1.0) == math.inf  # turns before it arrives
    assert flat(0.0, 2.0, -4.0) == 1.0  # thrown up, falls back
    assert flat(-1.0, 1.0, -4.0) == 0.5  # never opens: back where it was
    assert flat(0.0, 0.0, 0.0) == math.inf
    assert flat(1e-12, -1.0, -1e-3) == pytest.approx(1e-12, rel=1e-15)
    rng = np.random.default_rng(0)
    for g, w, alpha in rng.normal(size=(500, 3)) * (1, 1, 1):
        if g > 0.0:
            expected = first_falling_root([0.5 * alpha, w, g])
            assert flat(g, w, alpha) == pytest.approx(expected, rel=1e-9)


def test_grazing_disks_one_billionth_deep() -> None:
    # Offset D - 1e-9: c² = D² - offset², the half chord.
    deep = 1e-9
    half = math.sqrt(deep * (2.0 - deep))
    assert ball_point(3.0, 1.0 - deep, -1.0, 0.0, 1.0) == pytest.approx(3.0 - half, abs=1e-11)
    assert ball_point(3.0, 1.0 + deep, -1.0, 0.0, 1.0) == math.inf
    assert ball_point(1.0, 0.0, 1.0, 0.3, 1.0) == math.inf  # touching, parting
    assert ball_point(1.0, 0.0, -1.0, 0.3, 1.0) == 0.0
    assert ball_point(0.5, 0.0, -1.0, 0.3, 1.0) == 0.0  # overlap
    assert ball_point(0.5, 0.0, 1.0, 0.3, 1.0) == math.inf


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


def gap_now(things: list[Thing], a: int = 0, b: int = 1) -> float:
    """Gap of things a and b at the later of their clocks."""
    return float(gap(*World(things).arrays, a, b, max(t.since for t in things))[0])


def test_disks_are_bitwise_symmetric() -> None:
    rng = np.random.default_rng(4)
    for k in range(300):
        pulls = rng.normal(size=(2, 2)) if k % 2 else np.zeros((2, 2))
        p, v, since = rng.uniform(-3, 3, (2, 2)), rng.uniform(-2, 2, (2, 2)), rng.uniform(0, 0.3, 2)
        things = [
            Thing(disk(0.3), (*p[i], 0.0), (*v[i], 0.0), (*pulls[i], 0.0), float(since[i])) for i in range(2)
        ]  # fmt: skip
        one, other = World(things), World(things[::-1])
        found = meet(*one.arrays, 0, 1, 2, 5.0, -1.0)
        assert found == meet(*other.arrays, 0, 1, 2, 5.0, -1.0)
        # Mirrored in both axes.
        turned = World(
            [Thing(disk(0.3), (*-p[i], 0.0), (*-v[i], 0.0), (*-pulls[i], 0.0), float(since[i])) for i in (0, 1)]
        )
        assert found == meet(*turned.arrays, 0, 1, 2, 5.0, -1.0)


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


def static(vertices: list[tuple[float, float]], rounding: float) -> list[tuple[list[tuple[float, float]], float]]:
    return [(vertices, rounding)]


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
        if gap(*world.arrays, 0, 1, 0.0)[0] > 0.0:
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


# Shapes that turn


@pytest.mark.parametrize("unit", UNITS)
def test_rod_lands_on_its_corner(unit: float) -> None:
    rod = Thing(box(2.0 * unit, 0.1 * unit), (0.0, unit, math.radians(30)), (0.0, -unit, 0.0))
    world = World([rod], [([(-50.0 * unit, 0.0), (50.0 * unit, 0.0)], 0.0)])
    height = math.sin(math.radians(30)) + 0.05 * math.cos(math.radians(30))
    assert next_impact(world, 0, 1) == (pytest.approx(1.0 - height, rel=1e-14), True)


def test_turning_rod_strikes_the_floor_with_its_end() -> None:
    # A thin rod about a fixed height h < 1: its end is at h - sin(w t).
    for h, w, pull in ((0.5, 1.0, 0.0), (0.999999, 0.3, 0.0), (0.2, -2.0, 0.0), (0.7, 0.1, 0.8)):
        world = World(
            [Thing([([(-1.0, 0.0), (1.0, 0.0)], 0.0)], (3.0, h, 0.0), (0.0, 0.0, w), (0.0, 0.0, pull))], FLOOR
        )
        angle = math.asin(h)
        expected = angle / abs(w) if pull == 0.0 else (math.sqrt(w * w + 2 * pull * angle) - w) / pull
        t, certain = next_impact(world, 0, 1)
        assert certain
        assert t == pytest.approx(expected, rel=1e-9 if h < 0.9 else 1e-6)
    # As high as long: it touches at the top of the turn, where nothing closes any more, and above never.
    world = World([Thing([([(-1.0, 0.0), (1.0, 0.0)], 0.0)], (3.0, 1.0 + 1e-9, 0.0), (0.0, 0.0, 1.0))], FLOOR)
    assert next_impact(world, 0, 1, 10.0) == (math.inf, True) or next_impact(world, 0, 1, 10.0)[0] >= 10.0


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("counts", [(1, 4), (2, 2), (2, 4), (3, 5), (4, 4)])
def test_turning_shapes_by_sampling(counts: tuple[int, int], unit: float) -> None:
    rng = np.random.default_rng(11)
    outcomes = []
    for k in range(40):
        things = []
        for side, count in zip((-1.0, 1.0), counts, strict=True):
            x, v = np.array((side * 1.2, rng.uniform(-0.7, 0.7))), np.array((-side * rng.uniform(0.0, 1.2), 0.0))
            pull = unit * rng.normal(size=2) if k % 2 else np.zeros(2)
            vertices = [(unit * p, unit * q + 0.1 * unit) for p, q in hull(rng, count)]
            things.append(
                Thing(
                    [(vertices, unit * rng.choice([0.0, 0.1]))], (*unit * x, rng.uniform(-3, 3)),
                    (*unit * v, rng.uniform(-3, 3)), (*pull, rng.normal() * (k % 3)), float(rng.uniform(0.0, 0.2)),
                )
            )  # fmt: skip
        if gap_now(things) > 0.0:
            outcomes.append(check_by_sampling(World(things), 0, 1, 2.0, 200))
    assert outcomes.count("meets") > 8


@pytest.mark.parametrize("corners", [1, 2, 4])
def test_turning_shape_and_static_shape_by_sampling(corners: int) -> None:
    rng = np.random.default_rng(21)
    outcomes = []
    for k in range(60):
        wall = static([(x + 40.0, y - 7.0) for x, y in hull(rng, corners, 1.0)], rng.choice([0.0, 0.1]))
        x = rng.uniform(-3, 3, 2)
        v = rng.uniform(-1, 1, 2) - 0.5 * x
        x += (40.0, -7.0)
        pull = (0.0, -1.0, 0.0) if k % 2 else (0.0, 0.0, 0.0)
        world = World([Thing([(hull(rng, 4), 0.0)], (*x, 0.3), (*v, rng.uniform(-3, 3)), pull)], wall)
        if gap(*world.arrays, 0, 1, 0.0)[0] > 0.0:
            outcomes.append(check_by_sampling(world, 0, 1, 3.0, 200))
    assert outcomes.count("meets") > 8
    assert outcomes.count("never") > 4


def test_boxes_that_touch() -> None:
    at = {"shapes": box(1.0, 1.0)}
    for rate, expected in (((-1.0, 0.0, 0.0), 0.0), ((1.0, 0.0, 0.0), None), ((0.0, 1.0, 0.0), None)):
        world = World([Thing(**at), Thing(**at, pose=(1.0, 0.3, 0.0), rate=rate)])
        t, certain = next_impact(world, 0, 1, 0.5)
        assert (t == expected and certain) if expected is not None else t >= 0.5
    # Corners that slide along a face come to nothing; a turn into the face is an impact now.
    world = World([Thing(**at), Thing(**at, pose=(1.0, 0.3, 0.0), rate=(0.0, 0.0, 0.5))])
    assert next_impact(world, 0, 1) == (pytest.approx(0.0, abs=1e-15), True)
    # A box thrown off the floor it lay on comes back when it falls; one that is pulled into it is held.
    world = World([Thing(**at, pose=(0.0, 0.5, 0.0), rate=(0.2, 2.0, 0.0), pull=(0.0, -10.0, 0.0))], FLOOR)
    assert next_impact(world, 0, 1, 1.0) == (pytest.approx(0.4, rel=1e-12), True)
    world = World([Thing(**at, pose=(0.0, 0.5, 0.0), rate=(0.2, -1e-9, 0.0), pull=(0.0, -10.0, 0.0))], FLOOR)
    assert next_impact(world, 0, 1, 1.0) == (0.0, True)
    assert next_impact(world, 0, 1, 0.01, 1e-6)[0] >= 0.01


def test_flat_landing_of_a_box_and_a_plate_that_is_carried() -> None:
    world = World([Thing(box(1.0, 1.0), (0.0, 1.5, 0.0), (0.0, 0.0, 0.0), (0.0, -10.0, 0.0))], FLOOR)
    assert next_impact(world, 0, 1, 1.0) == (pytest.approx(math.sqrt(0.2), rel=1e-13), True)
    plate = Thing([([(0.0, -1.0), (0.0, 1.0)], 0.1)], rate=(1.0, 0.0, 0.0), moves=False)
    world = World([Thing(disk(0.2), (1.0, 0.0, 0.0)), plate])
    assert next_impact(world, 0, 1) == (pytest.approx(0.7, rel=1e-14), True)
    # A turning door sweeps to a disk: edge and centre are apart sin(w t) - r at distance 1.
    door = Thing([([(0.0, 0.0), (3.0, 0.0)], 0.0)], rate=(0.0, 0.0, 0.5), moves=False)
    world = World([Thing(disk(0.2), (0.0, 1.0, 0.0)), door])
    assert next_impact(world, 0, 1)[0] == pytest.approx((math.pi / 2 - math.asin(0.2)) / 0.5, rel=1e-12)


def test_what_cannot_meet_before_the_horizon_is_only_bounded() -> None:
    world = World([Thing(box(1.0, 1.0), rate=(1.0, 0.0, 3.0)), Thing(box(1.0, 1.0), (9.0, 0.0, 0.0))])
    bound, certain = next_impact(world, 0, 1, 1.0)
    assert not certain
    t, certain = next_impact(world, 0, 1, 20.0)
    assert certain
    assert 1.0 <= bound <= t
    # From any bound on, the forecast is the same.
    for _ in range(20):
        bound, done = next_impact(world, 0, 1, bound + 0.2)
        if done:
            break
    assert bound == pytest.approx(t, rel=1e-12)
    parting = World([Thing(box(1.0, 1.0), rate=(-1.0, 0.0, 3.0)), Thing(box(1.0, 1.0), (9.0, 0.0, 0.0))])
    assert next_impact(parting, 0, 1, 1.0) == (math.inf, True)


def test_a_forecast_does_not_depend_on_where_a_clock_stands() -> None:
    # The same parabola, known from a later instant on.
    rng = np.random.default_rng(8)
    times = []
    for since in (0.0, 0.1, 0.3):
        pull, x, v = np.array((0.0, -1.0, 0.2)), np.array((0.0, 3.0, 0.4)), np.array((0.3, -0.5, 1.1))
        at, rate = x + v * since + 0.5 * pull * since**2, v + pull * since
        rng = np.random.default_rng(8)
        world = World([Thing([(hull(rng, 4), 0.05)], tuple(at), tuple(rate), tuple(pull), since)], FLOOR)
        times.append(next_impact(world, 0, 1, 5.0)[0])
    for one, other in pairwise(times):
        assert one == pytest.approx(other, rel=1e-11)


def test_bends_bound_how_points_move_along_axes() -> None:
    rng = np.random.default_rng(13)
    closest = np.zeros(3)  # of what is, to the bound
    h, left = 1e-3, 0.3
    times = np.arange(0.0, left, h)
    for k in range(300):
        speeds = 10.0 ** rng.uniform(-1.0, 1.0, 5)
        things = [
            Thing(
                [(hull(rng, 3, 10.0 ** rng.uniform(-2.0, 0.0)), 0.0)],
                (*(0.2 * i * rng.normal(size=2)), rng.uniform(-3, 3)),
                (*(speeds[0] * rng.normal(size=2)), speeds[1 + i] * rng.normal()),
                (*(speeds[3] * rng.normal(size=2)), (k % 2) * speeds[4] * rng.normal()),
            )
            for i in range(2)
        ]  # fmt: skip
        world = World(things)
        bound = bends(world.body, world.shape, world.link, 0, 1, 0.0, left)
        paths = []
        for thing in things:
            q = [np.array(thing.pose) + np.array(thing.rate) * t + 0.5 * np.array(thing.pull) * t * t for t in times]
            paths.append((np.array([placed(thing.shapes[0][0], pose) for pose in q]), np.array(q)[:, 2]))
        (a, angle_a), (b, angle_b) = paths
        n = rng.uniform(-3, 3) + np.stack((np.zeros_like(times), angle_a, angle_b))
        n = np.stack((np.cos(n), np.sin(n)), axis=2)
        apart = b[:, None] - a[:, :, None]
        fixed, of_a = (np.einsum("tijc,tc->tij", apart, n[c]) for c in (0, 1))
        of_b = np.einsum("tijc,tc->tij", -apart, n[2])
        for c, height in enumerate((fixed, of_a, of_b)):
            bend = np.abs(np.diff(height, 2, axis=0)).max() / h**2
            assert bend <= bound[c] * (1.0 + 1e-6)
            closest[c] = max(closest[c], bend / bound[c])
    assert (closest > 0.4).all()


def test_corner_on_corner_meets_only_where_both_faces_close() -> None:
    for velocity, meets in (((-1.0, -0.1), True), ((-0.1, -1.0), True), ((-1.0, 1.0), False), ((1.0, -1.0), False)):
        world = World([Thing(box(1.0, 1.0)), Thing(box(1.0, 1.0), (1.0, 1.0, 0.0), (*velocity, 0.0))])
        t, certain = next_impact(world, 0, 1, 0.5)
        assert (t == 0.0 and certain) if meets else t >= 0.5


def test_corner_that_comes_back_where_the_other_face_has_left() -> None:
    # x: 1 + t - t² / 2, back at 1 when y is at -5.
    world = World([Thing(box(1.0, 1.0)), Thing(box(1.0, 1.0), (1.0, 1.0, 0.0), (1.0, -3.0, 0.0), (-1.0, 0.0, 0.0))])
    assert next_impact(world, 0, 1, 5.0)[0] >= 5.0


@pytest.mark.parametrize("twist", [0.0, 0.1])
def test_wall_of_a_turning_drum(twist: float) -> None:
    # The wall at distance 3 from the axis comes round to a box that rests inside, 0.1 from its circle.
    wall = [([(3.0, -1.0), (3.0, 1.0)], 0.0)]
    for w in (0.5, -3.0):
        drum = Thing(wall, (0.0, 0.0, 0.3), (0.0, 0.0, w), (0.0, 0.0, twist), moves=False)
        world = World([Thing(box(1.0, 1.0), (0.0, 2.55, 0.0)), drum])
        assert check_by_sampling(world, 0, 1, 0.2) == "later"
        assert check_by_sampling(world, 0, 1, 9.0) == "meets"


def test_bounces_shorter_than_a_part_of_the_horizon_are_not_followed() -> None:
    # Pulled back after 2e-10: that a box rests is looked at again after a sixteenth of the horizon.
    at = {"pose": (0.0, 0.5, 0.0), "rate": (0.0, 1e-9, 0.0), "pull": (0.0, -10.0, 0.0)}
    assert next_impact(World([Thing(box(1.0, 1.0), **at)], FLOOR), 0, 1, 1.0) == (pytest.approx(1 / 16), True)


def test_thrown_disk_that_passes_beside_the_side_it_first_enters() -> None:
    # A post, and a throw that crosses the line of its top beside it, comes back and lands on it.
    post = static([(-0.1, -5.0), (0.1, -5.0), (0.1, 0.0), (-0.1, 0.0)], 0.0)
    ball = Thing(disk(0.05), (2.0, 0.06, 0.0), (-1.0, -0.3, 0.0), (0.0, 0.31, 0.0))
    assert check_by_sampling(World([ball], post), 0, 1, 4.0) == "meets"

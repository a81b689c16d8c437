"""Times of impact of shapes that turn, against closed forms, and gaps sampled along the paths."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.prediction.axes import bends, pulled_along
from eeca_pymunk.prediction.impact_times import time_of_impact
from tests.packed import Thing, World, box, disk, hull, placed
from tests.prediction.forecasts import FLOOR, UNITS, check_by_sampling, gap_now, next_impact, static


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


@pytest.mark.parametrize("both", [True, False])
def test_fast_shapes_by_sampling(both: bool) -> None:
    """Disks that they sweep bound when they meet: with each other, or with one that turns slowly. Many pass each other,
    and the disks of others overlap from the start."""
    rng, outcomes = np.random.default_rng(17), []
    for k in range(80):
        things = []
        for side, count in ((-1.0, 2 + k % 3), (1.0, 4)):
            x, v = np.array((side * rng.uniform(0.6, 1.4), rng.uniform(-1.2, 1.2))), rng.normal(size=2)
            spin = float(rng.choice([-1.0, 1.0]) * (rng.uniform(40.0, 90.0) if both or side < 0.0 else 1.0))
            pull = rng.normal(size=2) * (k % 2)
            shape = (hull(rng, count, 0.6 if side < 0.0 else 1.0), 0.05 * (k % 3))
            things.append(Thing([shape], (*x, rng.uniform(-3, 3)), (*v, spin), (*pull, 0.0)))
        if gap_now(things) > 0.0:
            outcomes.append(check_by_sampling(World(things), 0, 1, 0.7, 2000))
    assert outcomes.count("meets") > 8
    assert len(outcomes) - outcomes.count("meets") > 8


def test_turns_of_a_fan_beside_a_box_are_not_followed() -> None:
    """It reaches up to the box, whose corners are nearer to its hub than the length of both."""
    fan = Thing([([(-1.0, 0.0), (1.0, 0.0)], 0.05)], rate=(0.0, 0.0, 1e5))
    world = World([fan, Thing(box(1.0, 2.0), (1.56, 0.0, 0.0), (0.0, 0.0, 0.1))])
    assert next_impact(world, 0, 1, 0.03) == (0.03, False)
    assert world.scene.COUNT.work < 20.0


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
        if gap(world.scene, 0, 1, 0.0)[0] > 0.0:
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
    # A box thrown off the floor it lay on comes back when it falls; one that is pulled into it meets it now.
    world = World([Thing(**at, pose=(0.0, 0.5, 0.0), rate=(0.2, 2.0, 0.0), pull=(0.0, -10.0, 0.0))], FLOOR)
    assert next_impact(world, 0, 1, 1.0) == (pytest.approx(0.4, rel=1e-12), True)
    world = World([Thing(**at, pose=(0.0, 0.5, 0.0), rate=(0.2, -1e-9, 0.0), pull=(0.0, -10.0, 0.0))], FLOOR)
    assert next_impact(world, 0, 1, 1.0) == (0.0, True)


@pytest.mark.parametrize("unit", UNITS)
def test_a_rod_whose_free_end_sinks_beside_a_plank_that_it_leaves_does_not_meet_it(unit: float) -> None:
    """The common face opens at both of its ends; the end of the rod, which is as near as they are, is beyond it."""
    line = [([(-unit, 0.0), (unit, 0.0)], 0.0)]
    rod = Thing(line, rate=(0.0, 0.2 * unit, 0.5), pull=(0.0, -0.1 * unit, 0.0))
    plank = Thing(box(2.2 * unit, 0.2 * unit), (unit, -0.1 * unit, 0.0))
    t, certain = next_impact(World([rod, plank]), 0, 1, 0.5)
    assert t >= 0.5
    assert not certain or t == math.inf


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


def test_a_search_ends_at_the_latest_instant_that_matters() -> None:
    """An impact before it is the same to the last bit; else the bound is later, and found with less work."""
    rng, fewer = np.random.default_rng(3), 0
    for _ in range(40):
        y, spin = float(rng.uniform(-0.7, 0.7)), float(rng.uniform(20.0, 60.0))
        world = World(
            [
                Thing([(hull(rng, 4), 0.0)], (0.0, 0.0, 0.3), (0.0, 0.0, spin)),
                Thing([(hull(rng, 3), 0.0)], (2.5, y, 0.0), (-0.3, 0.0, -spin)),
            ]
        )
        scene = world.scene
        found = time_of_impact(scene, 0, 1, 5.0, math.inf)
        whole, scene.COUNT.work = scene.COUNT.work, 0.0
        assert time_of_impact(scene, 0, 1, 5.0, 5.0) == found
        assert scene.COUNT.work == whole
        scene.COUNT.work = 0.0
        t, certain = time_of_impact(scene, 0, 1, 5.0, 0.5)
        if t <= 0.5:
            assert (t, certain) == found
        else:
            assert not certain or found[0] == math.inf
            assert t <= found[0]
            fewer += scene.COUNT.work < 0.5 * whole
    assert fewer > 10


def test_looks_at_shapes_of_many_vertices_count_more() -> None:
    """By sixteen pairs of corners, and by six for each of eighty corners, in units of forty."""
    works = []
    for corners in (4, 40):
        turns = [2.0 * math.pi * k / corners for k in range(corners)]
        shape = [([(math.cos(turn), math.sin(turn)) for turn in turns], 0.0)]
        world = World([Thing(shape, rate=(1.0, 0.0, 0.0)), Thing(shape, (3.0, 0.0, 0.0))])
        assert next_impact(world, 0, 1) == (pytest.approx(1.0, rel=1e-12), True)
        works.append(world.scene.COUNT.work)
    assert works[1] / works[0] == pytest.approx((1.0 + 480.0 / 40.0) / (1.0 + 16.0 / 40.0), rel=1e-12)


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
        around_a, around_b, *turning = bends(world.scene, 0, 1, 0.0, left)
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
        bound = around_a + around_b + pulled_along(world.scene, 0, 1, *n[0, 0]), *turning
        for c, height in enumerate((fixed, of_a, of_b)):
            bend = (-np.diff(height, 2, axis=0)).max() / h**2
            assert bend <= bound[c] * (1.0 + 1e-6) + 1e-8
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


def test_a_box_that_hardly_leaves_its_floor_is_back_when_its_fall_is_over() -> None:
    # Up with u, down with a: 2 u / a.
    at = {"pose": (0.0, 0.5, 0.0), "rate": (0.0, 1e-9, 0.0), "pull": (0.0, -10.0, 0.0)}
    assert next_impact(World([Thing(box(1.0, 1.0), **at)], FLOOR), 0, 1, 1.0) == (pytest.approx(2e-10, rel=1e-9), True)


@pytest.mark.parametrize(("apart", "spin"), [(0.0, 0.0), (1e-9, -1e-10), (1e-7, 1e-9)])
@pytest.mark.parametrize("pull", [(0.0, -10.0), (-1.0, -10.0)])
def test_what_slides_along_a_wall_does_not_approach_it(pull: tuple[float, float], apart: float, spin: float) -> None:
    """A face that falls along a wall: no acceleration closes the gap, so a few looks show that it stays open."""
    sliding = Thing(box(1.0, 1.0), (-0.5 - apart, 0.0, 0.0), (0.0, 0.6, spin), (*pull, 0.0))
    world = World([sliding], static([(0.0, -50.0), (0.0, 50.0)], 0.0))
    before = world.scene.COUNT.work
    t, _ = next_impact(world, 0, 1, 0.1)
    assert t >= 0.1
    assert world.scene.COUNT.work - before < 20

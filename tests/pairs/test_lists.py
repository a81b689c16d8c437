"""Near lists against brute force: at the start, and as shapes are listed anew one at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled import table_of
from eeca_pymunk.compiled.records import columns, put
from eeca_pymunk.model.bodies import VELOCITY
from eeca_pymunk.model.parameters.detection import MARGIN_HALVINGS
from eeca_pymunk.model.scene import scene_of
from eeca_pymunk.model.shapes import LEVELS
from eeca_pymunk.pairs import cells, grid, setup
from eeca_pymunk.pairs.rules import mark_pair
from tests.packed import Thing, World, disk

from .scenes import Crowd, crowd

Make = Callable[[np.random.Generator], World]


def absurd(rng: np.random.Generator) -> World:
    """A giant too large for all levels, whose centre is far from the others."""
    world = crowd(rng, np.where(np.arange(20) == 7, 1e200, 1e-3), side=1.0)
    world.body["x"][7] = 1e30
    return world


def pivots(rng: np.random.Generator) -> World:
    """Bodies that impulses turn but do not shift, among others."""
    world = crowd(rng, np.full(30, 0.1), boxes=6, kinematic=4, walls=8)
    world.body["inv_mass"][5:20] = 0.0
    return world


CROWDS: dict[str, Make] = {
    "disks": lambda rng: crowd(rng, np.full(60, 0.1)),
    "one to a thousand": lambda rng: crowd(rng, 10.0 ** rng.uniform(-3.0, 0.0, 50)),
    "one giant": lambda rng: crowd(rng, np.where(np.arange(50) == 7, 1.0, 1e-3), side=2.5),
    "absurd giant": absurd,
    "pivots": pivots,
    "points": lambda rng: crowd(rng, np.where(np.arange(40) % 2, 0.0, 0.1), side=2.0),
    "all points": lambda rng: crowd(rng, np.zeros(20), side=1.0),
    "boxes that turn": lambda rng: crowd(rng, np.full(6, 0.1), boxes=30),
    "few walls": lambda rng: crowd(rng, np.full(40, 0.1), walls=8),
    "a grid of walls": lambda rng: crowd(rng, np.full(30, 0.1), boxes=6, walls=60),
    "sixteen": lambda rng: crowd(rng, np.full(10, 0.1), boxes=4, walls=8),
    "few among many walls": lambda rng: crowd(rng, np.full(4, 0.1), boxes=2, walls=60, side=4.0),
    "one body": lambda rng: crowd(rng, np.full(1, 0.1), walls=40, side=3.0),
    "kinematic": lambda rng: crowd(rng, np.full(20, 0.1), boxes=6, kinematic=8, walls=8),
    "filters": lambda rng: crowd(rng, np.full(40, 0.1), boxes=10, walls=30, kinematic=4, filters=True),
    "small units": lambda rng: crowd(rng, 10.0 ** rng.uniform(-2.0, 0.0, 40), boxes=4, walls=20, unit=1e-3),
    "large units": lambda rng: crowd(rng, 10.0 ** rng.uniform(-2.0, 0.0, 40), boxes=4, walls=20, unit=1e3),
    "far away": lambda rng: crowd(rng, np.full(40, 0.1), boxes=4, walls=20, origin=1e6),
}
every_crowd = pytest.mark.parametrize("kind", CROWDS)


@every_crowd
def test_first_lists_are_complete(kind: str) -> None:
    for seed in range(3):
        Crowd.of(CROWDS[kind](np.random.default_rng(seed))).check()


@every_crowd
def test_lists_stay_complete_as_shapes_leave_one_by_one(kind: str) -> None:
    # Each goes on along its path and is listed anew there, while the others stand where they were listed.
    rng = np.random.default_rng(4)
    near = Crowd.of(CROWDS[kind](rng))
    for turn, s in enumerate(rng.integers(0, near.moving, 150).tolist()):
        near.renew(s, t := 2.0 * float(rng.uniform()))
        if not np.isinf(near.near.MARK["margin"][s]):
            exact = near.centres(t)[s]
            near_round_off = 1e-14 * float(np.abs(exact).max() + near.world.shape["extent"][s])
            np.testing.assert_allclose(columns(near.near.MARK[s], "x", "y"), exact, rtol=0.0, atol=near_round_off)
        if turn % 10 == 9:
            near.check()


@pytest.mark.parametrize("speed", [1.0, 1e9, 1e18, 1e60, 1e300])
def test_one_that_flew_away_neither_breaks_the_grid_nor_fills_the_lists(speed: float) -> None:
    # Beyond 2^50 cells all cells are one.
    world = crowd(np.random.default_rng(1), np.full(200, 0.1))
    world.body[11].vx, world.body[11].vy = speed, -2.0 * speed
    near = Crowd.of(world)
    for s in (11, 12, 11, 5):
        near.renew(s, 1.0)
    world.body[12].x, world.body[12].y = near.centres(1.0)[11]  # somebody else goes there
    put(world.body[12:13], np.zeros((1, 7)), *VELOCITY, "since", "ax", "ay", "angular")
    near.renew(12, 1.0)
    if speed >= 1e9:
        assert near.listed()[12] == [11]
    away = Crowd.of(world).near
    assert away.LIST["number"].mean() <= 30
    Crowd(world, away).check()


def test_half_full_places_are_crowded_too() -> None:
    # Two dense clouds far from one another: margins follow from how shapes stand, not from the empty place between.
    world = crowd(np.random.default_rng(1), np.full(200, 0.1))
    world.body["x"][:100] += 1e4
    near = Crowd.of(world)
    near.check()
    assert near.near.LIST["number"].mean() <= 30


def test_a_container_counts_as_one_neighbour() -> None:
    """Its walls, which surround all others, do not make their margins small."""
    rng, half, margins = np.random.default_rng(1), 2.0, []
    things = [Thing(disk(0.05), (*rng.uniform(-1.9, 1.9, 2), 0.0)) for _ in range(60)]
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    walls: list[tuple[Sequence[tuple[float, float]], float]]
    walls = [([p, q], 0.0) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    for world in (World(things, walls), World([*things, Thing(walls, moves=False)])):
        world.link["categories"] = world.link["mask"] = -1
        near = Crowd.of(world).near
        margins.append(float(np.median(near.MARK["margin"])))
        assert 3.0 < near.LIST["number"][:60].mean() <= 24.0
    assert margins[1] > 0.5 * margins[0]


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_units_and_place_do_not_matter(unit: float) -> None:
    lists = [
        Crowd.of(crowd(np.random.default_rng(2), np.full(50, 0.1), boxes=10, walls=30, unit=u, origin=o)).listed()
        for u, o in ((1.0, 0.0), (unit, 0.0))
    ]
    assert [set(one) for one in lists[0]] == [set(one) for one in lists[1]]


def test_the_same_lists_bit_by_bit_a_second_time() -> None:
    found = []
    for _ in range(2):
        rng = np.random.default_rng(9)
        near = Crowd.of(crowd(rng, 10.0 ** rng.uniform(-1.0, 0.0, 60), boxes=10, walls=30))
        for s in rng.integers(0, near.moving, 100).tolist():
            near.renew(s, float(rng.uniform()))
        found.append((near.listed(), near.near.MARK.tobytes()))
    assert found[0] == found[1]


@pytest.mark.parametrize("walls", [3, 30, 300])
@pytest.mark.parametrize("disks", [3, 60])
def test_lists_made_in_their_place_are_those_of_a_new_scene(disks: int, walls: int) -> None:
    rng = np.random.default_rng(7)
    near = Crowd.of(crowd(rng, 10.0 ** rng.uniform(-1.0, 0.0, disks), boxes=3, walls=walls))
    for s in rng.integers(0, near.moving, 50 if walls < 300 else 0).tolist():
        near.renew(s, float(rng.uniform()))
    table, grown = table_of(near.near), len(near.near.POOL) > setup.pool_sizes(near.moving)[0]
    again, made = setup.refilled(table), Crowd.of(near.world).near
    assert (again is table) != grown
    for name in setup.NEAR:
        one, two = (np.asarray(getattr(scene, name)) for scene in (scene_of(again), made))
        assert one.tobytes() == two.tobytes(), name


def test_a_full_pool_is_told_and_more_room_helps() -> None:
    world = crowd(np.random.default_rng(3), np.full(40, 0.1), walls=30)
    near = Crowd.of(world)
    for room in (0, 8 * near.moving - 1, 8 * near.moving):
        small = near.near._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8))
        assert not grid.build(table_of(small), 0.0)
    Crowd(world, setup.with_more_room(small, 0.0)).check()


def test_room_runs_out_as_lists_grow_and_wander() -> None:
    rng = np.random.default_rng(5)
    near = Crowd.of(crowd(rng, np.full(40, 0.1)))
    near.world.body["vx"] *= 10.0
    near.world.body["vy"] *= 10.0
    room = len(near.near.POOL)
    for turn in range(3000):
        near.renew(int(rng.integers(0, near.moving)), float(rng.uniform()) if turn < 1500 else 0.0)
    assert int(near.near.GRID.pool_end) <= len(near.near.POOL)
    assert len(near.near.POOL) <= 4 * room
    near.check()


def test_flags_follow_their_pairs_and_new_pairs_have_none() -> None:
    world = crowd(np.random.default_rng(6), np.full(40, 0.1), walls=10)
    near = Crowd.of(world)
    pair = next((s, o) for s, found in enumerate(near.listed()) for o in found if o < near.moving)
    n = near.near
    mark_pair(n, *pair, 1)

    def flagged() -> set[tuple[int, int]]:
        return {
            (s, int(o))
            for s, (start, count) in enumerate(columns(n.LIST, "start", "number").tolist())
            for o, flag in zip(n.POOL[start : start + count], n.FLAG[start : start + count], strict=True)
            if flag
        }

    for s in range(near.moving):
        near.renew(s)
    assert flagged() == {pair, pair[::-1]}
    for far in (1e3, -1e3):  # there and back
        world.body["x"][pair[0]] += far
        near.renew(pair[0])
        assert not flagged()
    near.check()


@pytest.mark.parametrize("spread", ["field", "line", "long ones", "one place"])
def test_the_grid_of_walls_holds_what_looking_at_all_finds(spread: str) -> None:
    rng = np.random.default_rng(7)
    start = rng.uniform(0.0, 10.0, (200, 2))
    end = start + rng.normal(size=(200, 2)) * (3.0 if spread == "long ones" else 0.1)
    if spread == "line":
        start[:, 1] = end[:, 1] = 2.0
    elif spread == "one place":
        start[:], end[:] = (1.0, 1.0), (2.0, 1.5)
    ground = [([tuple(a), tuple(b)], 0.01) for a, b in zip(start.tolist(), end.tolist(), strict=True)]
    things = [Thing(disk(r), (x, y, 0.0)) for x, y, r in rng.uniform((-2, -2, 0.01), (12, 12, 1.0), (30, 3)).tolist()]
    world = World(things, ground)
    world.link["categories"] = world.link["mask"] = -1
    gridded = Crowd.of(world)
    assert gridded.near.GRID.columns > 0
    assert len(gridded.near.CSR) < 40 * len(ground) + 2
    gridded.check()
    gridded.near.GRID.columns = 0
    plain = setup.with_more_room(gridded.near, 0.0)
    assert [sorted(found) for found in Crowd(world, plain).listed()] == [sorted(found) for found in gridded.listed()]


def test_levels_hold_circles_of_up_to_half_their_cell() -> None:
    for exponent in np.linspace(-3.0, 16.0, 200):
        radius = 10.0**exponent
        level = cells.level_of(radius, 1e-2)
        assert 1e-2 * 2.0**level >= 2.0 * radius
        assert level == 0 or 1e-2 * 2.0 ** (level - 1) < 2.0 * radius
    assert cells.level_of(1e300, 1e-2) == LEVELS - 1


@pytest.mark.parametrize("ahead", [0.0, 0.3, 0.9])
def test_a_list_drawn_ahead_is_complete_and_its_old_part_comes_first(ahead: float) -> None:
    rng = np.random.default_rng(8)
    world = crowd(rng, np.full(60, 0.1), walls=10)
    near = Crowd.of(world)
    n = near.near
    for s in rng.integers(0, near.moving, 300).tolist():
        world.body[s].x += world.body[s].vx * 0.1
        world.body[s].y += world.body[s].vy * 0.1
        before = near.listed()[s]
        kept = grid.renew_circle(n, s, 0.0, ahead)
        assert kept >= 0
        after = near.listed()[s]
        assert set(after[:kept]) <= set(before)
        assert not {o for o in after[kept:] if o < near.moving} & set(before)
        away = columns(n.MARK[s], "x", "y") - near.centres()[s]
        assert np.hypot(*away) == pytest.approx(ahead * n.MARK["margin"][s], abs=1e-12)
        assert away @ columns(world.body[s], "vx", "vy") >= 0.0
    near.check()


def test_points_in_one_place_do_not_halve_their_margins_for_ever() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -1.0
    for _ in range(100):
        body = pymunk.Body(1.0, 1.0)
        space.add(body, pymunk.Circle(body, 0.0))
    stepper = ep.EECA(space)
    loop = stepper.event_loop
    assert loop is not None
    scene = loop.scene
    assert scene.GRID.halvings == MARGIN_HALVINGS
    assert scene.GRID.cell > 0.0
    stepper.step(1 / 60)

"""Thin shapes among thin walls: planks remember sides, corners have no way out, walls that turn carry planks."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.geometry.corners import find_corners, side_rows, thin
from eeca_pymunk.geometry.sides import corner_of, side_key, side_of, side_row
from eeca_pymunk.model.shapes import Corner, Link, Shape, Side
from tests.packed import scene_with

G = 9.81


def walls(space: pymunk.Space, body: pymunk.Body, *lines: tuple[tuple[float, float], tuple[float, float]]) -> None:
    for p, q in lines:
        wall = pymunk.Segment(body, p, q, 0.0)
        wall.elasticity, wall.friction = 1.0, 0.0
        space.add(wall)


def rod(space: pymunk.Space, x: float, y: float, vx: float) -> pymunk.Body:
    body = pymunk.Body(1.0, 0.3)
    body.position, body.velocity = (x, y), (vx, 0.0)
    shape = pymunk.Segment(body, (-1.0, 0.0), (1.0, 0.0), 0.0)
    shape.elasticity, shape.friction = 0.0, 0.0
    space.add(body, shape)
    return body


BOX = (((-5, 0), (5, 0)), ((5, 0), (5, 5)), ((5, 5), (-5, 5)), ((-5, 5), (-5, 0)))  # end to end
ROOM = (((-9, 0), (9, 0)), ((5, 0), (5, 5)), ((-5, 5), (-5, 0)))  # walls that stand on a floor that goes on


@pytest.mark.parametrize("lines", [BOX, ROOM])
@pytest.mark.parametrize("height", [0.0, 1e-12, 1e-9, 1e-3])
@pytest.mark.parametrize("dt", [1 / 60, 0.1])
def test_a_rod_that_slides_along_a_wall_stays_in_its_corner(
    lines: tuple[tuple[tuple[float, float], tuple[float, float]], ...], height: float, dt: float
) -> None:
    """Of two walls without width that meet, one has no point where a rod in the plane of the other comes: it is stopped
    as by one connected boundary."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    walls(space, space.static_body, *lines)
    body = rod(space, 0.0, height, 1.0)
    stepper = ep.EECA(space)
    for _ in range(round(12.0 / dt)):
        stepper.step(dt)
        for end in (-1.0, 1.0):
            x, y = body.local_to_world((end, 0.0))
            assert abs(x) < 5.0 + 1e-3
            assert y > -1e-3


@pytest.mark.parametrize("turned", [False, True])
def test_the_inner_side_of_a_corner_is_that_of_what_lies_in_it(turned: bool) -> None:
    """Of a floor that a wall stands on, whichever end of the floor is first: upwards; it counts as if it went on."""
    space, floor = pymunk.Space(), ((-5.0, 0.0), (5.0, 0.0))
    space.gravity = 0.0, -G
    walls(space, space.static_body, floor[::-1] if turned else floor, ((5.0, 0.0), (5.0, 3.0)))
    rod(space, 3.8, 0.2, 0.0)
    stepper = ep.EECA(space)
    stepper.step(1e-3)  # sides are remembered
    assert stepper.event_loop is not None
    W, end = np.array(floor[::-1] if turned else floor), 0 if turned else 1
    found = corner_of(stepper.event_loop.scene, W, 1, 0, 4.8, 0.0, 0.0, 1.0, 0.25)
    assert found == (end, 0.0, 1.0)
    assert tuple(W[end]) == (5.25, 0.0)


@pytest.mark.parametrize("along", [-3.9, 3.8, -6.2, 6.1])
@pytest.mark.parametrize("upward", [0.0, 0.2])
def test_a_rod_beside_a_wall_that_stands_on_a_floor_is_on_its_own_side(along: float, upward: float) -> None:
    """Both sides of a wall that ends on another one are inner sides of a corner."""
    space, base = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.gravity, base.velocity = (0.0, -G), (0.0, upward)
    space.add(base)
    walls(space, base, *ROOM)
    body = rod(space, along, 0.3, 0.0)
    stepper = ep.EECA(space)
    for _ in range(90):
        stepper.step(1 / 30)
    assert body.position.x == pytest.approx(along, abs=1e-6)
    assert body.position.y >= base.position.y - 1e-6


def test_what_is_outside_of_a_corner_slides_past_it() -> None:
    """The plane of a wall goes on beyond its end for what is inside of the corner alone."""
    space = pymunk.Space()
    walls(space, space.static_body, *BOX)
    body = rod(space, -8.0, -1e-9, 1.0)
    stepper = ep.EECA(space)
    for _ in range(160):
        stepper.step(0.1)
    assert body.position.x == pytest.approx(8.0, abs=1e-6)
    assert body.position.y <= 0.0


@pytest.mark.parametrize("dt", [1 / 60, 0.1])
def test_a_plank_on_a_wall_that_turns_stays_on_it(dt: float) -> None:
    """The normal turns with the wall, which is large: rows of contacts have that of the middle of the span, though the
    wall's far ends go many times the plank's size. No plank of .02 gets through."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    table = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(table)
    walls(space, table, ((-5, 0), (5, 0)))
    for wall in table.shapes:
        wall.friction = 1.0
    plank = pymunk.Body(1.0, 0.3)
    plank.position = 0.0, 0.01
    shape = pymunk.Poly.create_box(plank, (1.0, 0.02))
    shape.friction, shape.elasticity = 1.0, 0.0
    space.add(plank, shape)
    stepper = ep.EECA(space)
    for k in range(round(4.0 / dt)):
        table.angular_velocity = 0.5 * math.sin(3.0 * k * dt)
        stepper.step(dt)
        heights = [table.world_to_local(plank.local_to_world(v)).y for v in shape.get_vertices()]
        assert min(heights) > -0.02 * dt
        assert max(heights) < 0.04


def test_planks_that_are_pressed_through_a_thin_floor_come_back() -> None:
    """The shortest way out of a plank that is more than half-way through a wall is the wrong one: its side tells."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    walls(space, space.static_body, ((-5, 0), (5, 0)))
    plank = pymunk.Body(1.0, 0.3)
    plank.position = 0.0, 0.011
    shape = pymunk.Poly.create_box(plank, (1.0, 0.02))
    shape.friction, shape.elasticity = 0.5, 0.0
    space.add(plank, shape)
    heavy = pymunk.Body(1e4, 1e3)
    heavy.position, heavy.velocity = (0.0, 0.4), (0.0, -20.0)
    block = pymunk.Poly.create_box(heavy, (0.6, 0.6))
    block.friction, block.elasticity = 0.5, 0.0
    space.add(heavy, block)
    stepper = ep.EECA(space)
    for _ in range(40):
        stepper.step(0.1)
    assert plank.position.y > 0.0
    assert heavy.position.y > 0.3


def test_corners_are_found_where_segments_of_one_body_meet() -> None:
    """End to end, and with an end on the other; the next one about the end, either way, with the angle to it."""
    lines = [((0, 0), (2, 0)), ((2, 0), (2, 1)), ((1, 0), (1, 3)), ((0, 0), (-1, -1)), ((0, 0), (1, 1))]
    LINK = rows(Link, len(lines))
    LINK["first"], LINK["vertices"] = 2 * np.arange(len(lines)), 2
    LINK["owner"][4] = 1  # of another body
    VERTEX = np.zeros((2 * len(lines), 4))
    VERTEX[:, :2] = np.array(lines, float).reshape(-1, 2)
    CORNER = rows(Corner, 4 * len(lines))
    assert all(thin(link, VERTEX) for link in LINK)
    find_corners(LINK, VERTEX, CORNER)
    angles = {row: math.degrees(math.atan2(z, c)) for row, (k, c, z, _) in enumerate(CORNER.tolist()) if k > 0}
    assert {row: CORNER[row].other - 1 for row in angles} == {
        0: 3, 1: 3, 2: 1, 3: 1,  # both ends of the first
        4: 0, 5: 0, 8: 0, 9: 0, 12: 0, 13: 0,
    }  # fmt: skip
    assert [angles[k] for k in (0, 2, 4)] == pytest.approx([-135.0, -90.0, 90.0])
    # On the floor to the left and to the right of the wall that stands on it.
    assert [angles[k] for k in (8, 9)] == pytest.approx([90.0, -90.0])


def test_a_wall_that_lies_on_another_one_is_no_corner() -> None:
    lines = [((0, 0), (5, 0)), ((0, 0), (0, 5)), ((0, 0), (3, 0))]
    LINK = rows(Link, len(lines))
    LINK["first"], LINK["vertices"] = 2 * np.arange(len(lines)), 2
    VERTEX = np.zeros((2 * len(lines), 4))
    VERTEX[:, :2] = np.array(lines, float).reshape(-1, 2)
    CORNER = rows(Corner, 4 * len(lines))
    find_corners(LINK, VERTEX, CORNER)
    assert [corner.other - 1 for corner in CORNER[:2]] == [1, 1]  # at the first end of the floor


def test_planks_are_thin_and_boxes_are_not() -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    shapes = [pymunk.Poly.create_box(body, (1.0, w)) for w in (0.02, 0.1, 0.2, 1.0)]
    space.add(body, *shapes)
    method = ep.EECA(space)
    method.step(0.1)
    loop = method._method
    assert loop is not None
    scene = loop.scene  # type: ignore[attr-defined]
    assert sorted(thin(link, scene.VERTEX) for link in scene.LINK) == [False, False, True, True]


def _remove_others(space: pymunk.Space, stepper: ep.EECA, shape: pymunk.Shape, others: list[pymunk.Body]) -> None:
    other = others.pop()
    space.remove(other, *other.shapes)


def _add_others(space: pymunk.Space, stepper: ep.EECA, shape: pymunk.Shape, others: list[pymunk.Body]) -> None:
    others.append(pymunk.Body(1.0, 1.0))
    others[-1].position = 30.0, 2.0 * len(others)
    space.add(others[-1], pymunk.Circle(others[-1], 0.5))


def _set_friction(space: pymunk.Space, stepper: ep.EECA, shape: pymunk.Shape, others: list[pymunk.Body]) -> None:
    shape.friction = 0.1 + 0.01 * len(others) * stepper.time


def _add_joints(space: pymunk.Space, stepper: ep.EECA, shape: pymunk.Shape, others: list[pymunk.Body]) -> None:
    space.add(pymunk.PinJoint(others.pop(), space.static_body))


def _hear(space: pymunk.Space, stepper: ep.EECA, shape: pymunk.Shape, others: list[pymunk.Body]) -> None:
    space.on_collision(1, 2)


@pytest.mark.parametrize("edit", [_remove_others, _add_others, _set_friction, _add_joints, _hear])
def test_sides_outlive_what_is_edited_elsewhere(edit: Callable[..., None]) -> None:
    """A rod that lies in the plane of a floor without width, and round-off below it, stays on it though the space is
    read anew, shapes have other numbers, and functions are called."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    others = []
    for k in range(8):
        others.append(pymunk.Body(1.0, 1.0))
        others[-1].position = 20.0, 2.0 * k
        space.add(others[-1], pymunk.Circle(others[-1], 0.5))
    walls(space, space.static_body, ((-5, 0), (5, 0)))
    body = rod(space, 0.0, 1e-6, 0.0)
    (shape,) = body.shapes
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(1 / 60)
    body.position = 0.0, 1e-6
    for k in range(60):
        if k in (2, 4, 6, 8, 10):
            edit(space, stepper, shape, others)
        stepper.step(1 / 60)
    assert abs(body.position.y) < 1e-3


@pytest.mark.parametrize("grows", [False, True])
def test_a_rod_that_a_program_nudges_stays_on_its_side(grows: bool) -> None:
    """Placed anew by less than 1e-4 of its size at a time, as a position function does by round-off, it is still on the
    side from which it came, however deep; placed at once farther below, it is on the other one, and falls.
    Whether the space `grows` between the steps, so that it is read again, does not matter."""
    for step, stays in ((-8e-5, True), (-1e-3, False)):
        space = pymunk.Space()
        space.gravity = 0.0, -G
        walls(space, space.static_body, ((-5, 0), (5, 0)))
        body = rod(space, 0.0, 0.0, 0.0)
        stepper = ep.EECA(space)
        for _ in range(10):
            stepper.step(1 / 60)
            body.position += 0.0, step
            if grows:
                walls(space, space.static_body, ((50, 0), (60, 0)))
        stepper.step(1 / 60)
        assert (body.velocity.y == pytest.approx(0.0, abs=1e-9)) == stays


@pytest.mark.parametrize("again", ["walls twice", "tiles"])
def test_walls_that_lie_on_one_another_hide_no_corner(again: str) -> None:
    """Needles stay in a room whose walls the program has added twice, or in overlapping tiles, as in one of single
    walls."""
    for seed in range(4):
        rng, space, half = Random(seed), pymunk.Space(), 1.5
        space.gravity = 0.0, -10.0
        corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        walls = list(zip(corners, [*corners[1:], corners[0]], strict=True))
        for p, q in list(walls):
            end = q if again == "walls twice" else (0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]))
            walls.append((p, end))
        for p, q in walls:
            wall = pymunk.Segment(space.static_body, p, q, 0.0)
            wall.friction = 0.5
            space.add(wall)
        needles = []
        for _ in range(4):
            body = pymunk.Body(1.0, 0.1)
            body.position, body.angle = (rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6)), rng.uniform(0.0, 6.0)
            body.velocity, body.angular_velocity = (rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0)), rng.uniform(-9, 9)
            needle = pymunk.Segment(body, (-0.5, 0.0), (0.5, 0.0), 0.0)
            needle.friction = rng.choice([0.0, 0.5])
            space.add(body, needle)
            needles.append(needle)
        stepper = ep.EECA(space)
        for _ in range(100):
            stepper.step(1 / 60)
        ends = [needle.body.local_to_world(end) for needle in needles for end in (needle.a, needle.b)]
        assert max(max(abs(x), abs(y)) for x, y in ends) < half + 1e-3, seed


@pytest.mark.parametrize("shapes", [4095, 4096, 6144, 8192])
def test_sides_are_remembered_whatever_the_number_of_shapes(shapes: int) -> None:
    """Keys of pairs are their numbers times that one: of a power of 2, up to seven of eight had been lost."""
    A = scene_with(SHAPE=rows(Shape, shapes), SIDE=rows(Side, side_rows(shapes - 1, shapes)))
    for a in range(shapes - 1):
        key = side_key(A, a, shapes - 1)
        side = A.SIDE[side_row(A, key)]
        side.key, side.nx, side.ny = key, 0.0, -1.0
    assert all(side_of(A, a, shapes - 1) == (0.0, -1.0) for a in range(shapes - 1))

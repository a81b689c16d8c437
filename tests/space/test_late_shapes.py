"""Shapes that are moved only when something reads them are where their bodies are, whatever reads them."""

from __future__ import annotations

import gc
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space import late_shapes
from scenes.scene import add_disk

DT = 0.0625
ALL = pymunk.ShapeFilter()


def moved(steps: int = 40, count: int = 3) -> pymunk.Space:
    """A space whose disks, of radius .4 and at velocity (2, 1), have moved; its stepper is gone."""
    space = pymunk.Space()
    for i in range(count):
        add_disk(space, (1.5 * i, 0.0), 0.4, velocity=(2.0, 1.0))
    stepper = ep.EECA(space)
    for _ in range(steps):
        stepper.step(DT)
    return space


def is_late(space: pymunk.Space) -> bool:
    return late_shapes.late_shapes(space).late


Read = Callable[[pymunk.Space, pymunk.Shape, tuple[float, float]], object]
READERS: dict[str, Read] = {
    "point_query": lambda space, shape, at: [info.shape for info in space.point_query(at, 0.0, ALL)] == [shape],
    "point_query_nearest": lambda space, shape, at: (
        getattr(space.point_query_nearest(at, 0.0, ALL), "shape", 0) is shape
    ),
    "segment_query": lambda space, shape, at: [i.shape for i in space.segment_query(at, at, 0.1, ALL)] == [shape],
    "segment_query_first": lambda space, shape, at: (
        getattr(space.segment_query_first((at[0], at[1] + 5.0), at, 0.1, ALL), "shape", 0) is shape
    ),
    "bb_query": lambda space, shape, at: space.bb_query(pymunk.BB(*at, *at), ALL) == [shape],
    "shape_query": lambda space, shape, at: [i.shape for i in space.shape_query(probe(at))] == [shape],
    "bb": lambda space, shape, at: shape.bb.left == pytest.approx(at[0] - 0.4),
    "of the shape: point_query": lambda space, shape, at: shape.point_query(at).distance == pytest.approx(-0.4),
    "of the shape: segment_query": lambda space, shape, at: shape.segment_query((at[0], at[1] + 5.0), at) is not None,
    "shapes_collide": lambda space, shape, at: len(shape.shapes_collide(probe(at)).points) > 0,
    "shapes_collide, as the other one": lambda space, shape, at: len(probe(at).shapes_collide(shape).points) > 0,
}


def probe(at: tuple[float, float]) -> pymunk.Shape:
    """A small disk that is in no space."""
    body = pymunk.Body(1.0, 1.0)
    body.position = at
    shape = pymunk.Circle(body, 0.1)
    shape.held = body  # type: ignore[attr-defined] # shapes do not keep their bodies
    shape.cache_bb()
    return shape


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("hashed", [False, True])
def test_whatever_reads_shapes_finds_them_at_their_bodies(reader: str, hashed: bool) -> None:
    """Also if the stepper is gone. The disks have moved by more than their sizes."""
    space = moved()
    if hashed:
        space.use_spatial_hash(1.0, 100)
    gc.collect()
    assert is_late(space)
    shape = list(space.shapes)[1]
    assert READERS[reader](space, shape, tuple(shape.body.position))
    assert not is_late(space)


def test_pictures_show_shapes_at_their_bodies() -> None:
    space, drawn = moved(), []

    class Options(pymunk.SpaceDebugDrawOptions):
        def draw_circle(self, pos: pymunk.Vec2d, *_: object) -> None:
            drawn.append(tuple(pos))

    space.debug_draw(Options())
    assert sorted(drawn) == sorted(tuple(body.position) for body in space.bodies)


def test_shapes_that_leave_the_space_were_moved_before() -> None:
    space = moved()
    shape = list(space.shapes)[1]
    space.remove(shape)
    assert shape.bb.left == pytest.approx(shape.body.position.x - 0.4)


def test_shapes_that_a_body_leaves_behind_are_where_it_was() -> None:
    space = moved()
    shape = list(space.shapes)[1]
    body, at = shape.body, shape.body.position
    space.remove(body)
    assert [info.shape for info in space.point_query(at, 0.0, ALL)] == [shape]
    assert body.space is None


def test_added_and_removed_bodies_do_not_hinder() -> None:
    space = moved()
    gone = next(iter(space.shapes))
    space.remove(gone, gone.body)
    add_disk(space, (50.0, 0.0), 0.4)
    del gone
    gc.collect()
    for shape in space.shapes:
        assert [info.shape for info in space.point_query(shape.body.position, 0.0, ALL)] == [shape]


def test_steps_of_pymunk_do_not_need_them() -> None:
    """Its own step moves all shapes; what it then finds is not overwritten by earlier poses."""
    space, other = moved(), moved()
    _ = [shape.bb for shape in other.shapes]
    for _ in range(5):
        space.step(DT)
        other.step(DT)
    assert [shape.bb for shape in space.shapes] == [shape.bb for shape in other.shapes]
    assert [body.position for body in space.bodies] == [body.position for body in other.bodies]


def test_functions_of_bodies_find_shapes_where_the_step_begins() -> None:
    space, seen = moved(), []
    stepper = ep.EECA(space)
    stepper.step(DT)
    stepper.step(DT)
    assert is_late(space)
    body = list(space.bodies)[1]
    shape = next(iter(body.shapes))
    before = body.position.x

    def velocity(body: pymunk.Body, gravity: pymunk.Vec2d, damping: float, dt: float) -> None:
        seen.append(shape.bb.left + 0.4)
        pymunk.Body.update_velocity(body, gravity, damping, dt)

    body.velocity_func = velocity
    stepper.step(DT)
    assert seen == [pytest.approx(before)]


def test_what_is_never_read_costs_no_step_of_pymunk() -> None:
    """Whatever the number of shapes; if they are read after each step, it is pymunk's step that moves many of a
    spatial hash."""
    space = pymunk.Space()
    space.use_spatial_hash(1.0, 100)
    for i in range(60):
        add_disk(space, (1.5 * i, 0.0), 0.4, velocity=(2.0, 1.0))
    stepper, taken = ep.EECA(space), ep.EECA(space)._sync._timestamp
    stepper.step(DT)
    first = taken()
    for _ in range(100):
        stepper.step(DT)
    assert taken() == first
    for _ in range(10):
        stepper.step(DT)
        _ = next(iter(space.shapes)).bb
    assert taken() == first + 9


def test_handlers_may_read_and_remove_within_a_step() -> None:
    """There pymunk has moved the shapes, and cannot reindex any."""
    space, seen = moved(), []
    stepper = ep.EECA(space)
    body = list(space.bodies)[1]
    shape = next(iter(body.shapes))
    wall = pymunk.Segment(space.static_body, (body.position.x + 1.0, -50.0), (body.position.x + 1.0, 50.0), 0.0)
    shape.collision_type, wall.collision_type = 1, 2
    space.add(wall)

    def begin(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        seen.append(shape.bb.left + 0.4)
        space.remove(shape, body)

    space.on_collision(1, 2, begin=begin)
    for _ in range(20):
        stepper.step(DT)
    assert seen == [pytest.approx(wall.a.x - 0.4, abs=2.0 * DT)]
    assert body.space is None

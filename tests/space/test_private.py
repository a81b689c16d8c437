"""Every private name of pymunk does what this package takes it to do."""

from __future__ import annotations

import gc
import math

import numpy as np
import pymunk
import pymunk.batch
import pytest

from eeca_pymunk.space import edits
from eeca_pymunk.space.private import batch as private_batch
from eeca_pymunk.space.private import functions as private_functions
from eeca_pymunk.space.private import shapes as private_shapes
from eeca_pymunk.space.private import sleep as private_sleep
from eeca_pymunk.space.private import spaces as private
from scenes.scene import add_disk


def meeting() -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Two disks that overlap and approach."""
    space = pymunk.Space()
    return space, [add_disk(space, (x, 0.0), 0.1, velocity=(-10.0 * x, 0.0)) for x in (-0.09, 0.09)]


def test_all_names_are_there() -> None:
    assert private.missing() == []


def test_a_name_that_is_gone_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(private, "_OF_BODY", ("_velocity_func", "_flight_func"))
    with pytest.raises(ImportError, match=r"pymunk\.Body\._flight_func.*pip install"):
        private.check()


def test_a_type_that_is_gone_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(private, "_TYPES", ("pmBatchedData *", "pmSparseArray *"))
    assert private.missing() == ["pymunk._chipmunk_cffi.ffi: pmSparseArray *"]


def test_handlers() -> None:
    space, _ = meeting()
    assert private.handlers(space) == []
    space.on_collision(1, 2, begin=lambda arbiter, space, data: None)
    space.on_collision(3, post_solve=lambda arbiter, space, data: None)
    space.on_collision(1, 2, separate=lambda arbiter, space, data: None)
    assert len(private.handlers(space)) == 2


def test_phases_are_the_functions_of_a_handler() -> None:
    space, _ = meeting()
    calls: list[str] = []
    space.on_collision(
        begin=lambda *_: calls.append("_begin"),
        pre_solve=lambda *_: calls.append("_pre_solve"),
        post_solve=lambda *_: calls.append("_post_solve"),
        separate=lambda *_: calls.append("_separate"),
    )
    space.step(0.001)
    for body in space.bodies:
        body.position *= 100.0
    space.step(0.001)
    assert tuple(dict.fromkeys(calls)) == private.PHASES
    # What is put in the place of one is called.
    (handler,) = private.handlers(space)
    assert all(callable(getattr(handler, phase)) for phase in private.PHASES)
    other: list[int] = []
    handler._begin = lambda *_: other.append(1) is None  # pymunk 6 wants a bool
    for body in space.bodies:
        body.position *= 0.01
    space.step(0.001)
    assert other == [1]


def test_functions_of_handlers() -> None:
    space, _ = meeting()
    calls: list[str] = []
    assert private.functions(space) == []
    space.on_collision(begin=lambda *_: calls.append("begin"), separate=lambda *_: calls.append("separate"))
    ((handler, begin, pre_solve, post_solve, separate),) = private.functions(space)
    assert [handler] == list(private.handlers(space))
    assert pre_solve is None
    assert post_solve is None
    begin(None, space, None)
    separate(None, space, None)
    assert calls == ["begin", "separate"]


def test_reindexing_anew_moves_shapes_and_no_bodies() -> None:
    """What is left of pymunk's correction of an overlap is forgotten: the next step of dt = 1 moves nothing."""
    space, bodies = meeting()
    for body in bodies:
        body.position, body.velocity = body.position * 0.1, (0.0, 0.0)
    space.step(0.1)
    bodies[0].position = at = (50.0, 0.0)
    pointers = private.pointers(bodies)
    private_shapes.forget_corrections(pointers)
    private_shapes.reindex(space, pointers)
    (shape,) = bodies[0].shapes
    assert shape.bb.left < 50.0 < shape.bb.right
    other = bodies[1].position
    space.step(1.0)
    assert (bodies[0].position, bodies[1].position) == (at, other)


def test_what_shapes_say_of_themselves() -> None:
    shape = pymunk.Circle(pymunk.Body(1.0, 1.0), 1.0)
    shape.elasticity, shape.friction, shape.surface_velocity = 0.25, 0.5, (3.0, -4.0)
    shape.filter = pymunk.ShapeFilter(7, 1 << 31, 3)
    assert private_shapes.surface(shape) == (1.0, 0.25, 0.5, 3.0, -4.0)
    assert private_shapes.filter_of(shape) == shape.filter == (7, 1 << 31, 3)
    shape.collision_type = 5
    assert private_shapes.collision_types([shape, pymunk.Circle(None, 1.0)]) == [5, 0]


def test_shapes_overlap_at_given_poses_and_stay_where_they_are() -> None:
    _, (one, two) = meeting()
    one.center_of_gravity = 0.3, 0.2
    (a,), (b,) = one.shapes, two.shapes
    boxes = [shape.cache_bb() for shape in (a, b)]
    assert private_shapes.overlap((a, b), [(7.0, 0.0, 1.0), (7.1, 0.1, 2.0)])
    assert not private_shapes.overlap((a, b), [(7.0, 0.0, 1.0), (-7.1, 0.1, 2.0)])
    assert [shape.bb for shape in (a, b)] == boxes


def test_values_of_bodies() -> None:
    body = pymunk.Body(2.0, 3.0)
    body.center_of_gravity = 0.5, -0.25
    assert private.body_values(body) == (pymunk.Body.DYNAMIC, 2.0, 3.0, 0.5, -0.25, False, False)
    body.position_func = lambda body, dt: pymunk.Body.update_position(body, dt)
    assert private.body_values(body)[5:] == (False, True)
    body.velocity_func = lambda body, gravity, damping, dt: pymunk.Body.update_velocity(body, gravity, damping, dt)
    assert private.body_values(body)[5:] == (True, True)
    body.body_type = pymunk.Body.KINEMATIC
    assert private.body_values(body)[0] == pymunk.Body.KINEMATIC


def test_bodies_that_sleep() -> None:
    space, bodies = pymunk.Space(), [pymunk.Body(1.0, 1.0) for _ in range(3)]
    space.add(*bodies)
    space.sleep_time_threshold = 1.0
    space.step(0.1)  # before it no body can sleep
    bodies[1].sleep()
    assert private_sleep.sleeping(bodies) == [False, True, False]
    assert private_sleep.asleep(space) == [bodies[1]]


def test_arbiters() -> None:
    space, bodies = meeting()
    assert private.arbiters(space) == []
    space.step(0.001)
    (arbiter,) = private.arbiters(space)
    assert {shape.body for shape in arbiter.shapes} == set(bodies)


def test_bodies_of_arbiters() -> None:
    space, (a, b) = meeting()
    assert private_batch.arbiter_bodies(space) == []
    space.step(0.001)
    assert private_batch.arbiter_bodies(space) == [a.id ^ b.id]


@pytest.mark.parametrize("kind", ["velocity", "position"])
def test_functions_of_bodies(kind: str) -> None:
    edits.counts(pymunk.Space())  # pymunk before 7.3 needs it
    body = pymunk.Body(1.0, 1.0)
    read = getattr(private, f"{kind}_function")
    assert read(body) is None
    function = {"velocity": pymunk.Body.update_velocity, "position": pymunk.Body.update_position}[kind]

    def own(*arguments: object) -> None:
        function(*arguments)  # type: ignore[operator]

    setattr(body, f"{kind}_func", own)
    assert read(body) is own
    setattr(body, f"{kind}_func", function)
    assert read(body) is None


@pytest.mark.parametrize("kind", ["velocity", "position"])
def test_functions_of_bodies_are_left_out(kind: str) -> None:
    space, (body, other) = meeting()
    calls: list[str] = []
    for one in (body, other):
        setattr(one, f"{kind}_func", lambda *_: calls.append("own"))
    left_out = {"velocity": [], "position": [], kind: [body, other]}
    with private_functions.WithoutFunctions(left_out["velocity"], left_out["position"]):
        space.step(0.001)
        assert calls == []
        assert body.position.x == pytest.approx(-0.0891)
        setattr(other, f"{kind}_func", getattr(pymunk.Body, f"update_{kind}"))
    space.step(0.001)
    assert calls == ["own"]


def test_changes_by_velocity_functions() -> None:
    _, (body, other) = meeting()
    body.angular_velocity, start = 2.0, body.velocity

    def fall(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        body.velocity += dt * pymunk.Vec2d(*gravity)
        body.angular_velocity *= damping

    def fail(*_: object) -> None:
        body.velocity = (7.0, 7.0)
        raise KeyError

    body.velocity_func = other.velocity_func = fall
    found = private_functions.velocity_changes([body, other], (0.0, -8.0), 0.5, 0.25)
    assert found == [(0.0, -2.0, -1.0), (0.0, -2.0, 0.0)]
    assert (body.velocity, body.angular_velocity) == (start, 2.0)
    body.velocity_func = fail
    with pytest.raises(KeyError):
        private_functions.velocity_changes([body], (0.0, 0.0), 1.0, 0.25)
    assert body.velocity == start


@pytest.mark.parametrize("threaded", [False, True])
def test_step_without_end_and_finish_step_are_a_step(threaded: bool) -> None:
    found = []
    for whole in (True, False):
        space = pymunk.Space(threaded=threaded)
        bodies = [add_disk(space, (x, 0.0), 0.1, velocity=(-10.0 * x, 0.0)) for x in (-0.09, 0.09)]
        late: list[str] = []

        def begin(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object, late: list[str] = late) -> None:
            space.add(pymunk.Body(3.0, 1.0))
            space.remove(*arbiter.shapes[0].body.shapes)  # type: ignore[union-attr]
            space.add_post_step_callback(lambda *_: late.append("called"), "key")

        space.on_collision(begin=begin)
        if whole:
            space.step(0.001)
        else:
            private.step_without_end(space, 0.001)
            assert len(space.bodies) == 2
            assert len(space.shapes) == 2
            assert late == []
            private.finish_step(space)
        assert math.isclose(space.current_time_step, 0.001)
        assert len(space.shapes) == 1
        assert len(space.bodies) == 3
        assert late == ["called"]
        space.add(pymunk.Body(1.0, 1.0))  # not locked any more
        found.append([(*b.position, *b.velocity) for b in bodies])
    assert found[0] == found[1]


def test_the_time_step_of_the_last_step_is_set() -> None:
    space, _ = meeting()
    space.step(0.001)
    private.set_time_step(space, 0.002)
    assert space.current_time_step == 0.002


def test_watch_sees_settings_contents_and_edits() -> None:
    space, bodies = meeting()
    count, spare = edits.counts(space), pymunk.Body(1.0, 1.0)

    def bump() -> None:
        count[0] += 1

    current = private.watch(space, count, [0])
    space.step(0.001)
    bodies[0].velocity = (9.0, 9.0)
    space.iterations = 3
    assert current()
    for change in (
        lambda: setattr(space, "gravity", (0.0, 1e-9)),
        lambda: setattr(space, "gravity", (1e-9, 1e-9)),
        lambda: setattr(space, "damping", 0.5),
        lambda: setattr(space, "sleep_time_threshold", 1.0),
        lambda: space.add(pymunk.PivotJoint(*bodies, (0.0, 0.0))),
        lambda: space.remove(*space.constraints),
        lambda: space.add(spare),
        lambda: space.remove(spare),
        lambda: space.remove(*bodies[0].shapes),
        # Removing what touches after this would crash pymunk 6.
        lambda: space.on_collision(begin=lambda *_: None),
        lambda: space.add(pymunk.Circle(bodies[0], 1.0)),
        bump,
    ):
        known = count.copy()
        current = private.watch(space, count, known)
        assert current()
        change()
        assert not current()
        known[0] = count[0]
        assert current() == (change is bump)
    assert count[3] == 4  # additions and removals of shapes and bodies


def test_reader_and_writer_are_the_batch_calls_in_memory_of_ours() -> None:
    space, bodies = meeting()
    bodies[1].angle = 0.5
    fields = pymunk.batch.BodyFields.BODY_ID | pymunk.batch.BodyFields.POSITION | pymunk.batch.BodyFields.ANGLE
    floats, ids = np.full(9, -1.0), np.full(3, -1, np.int64)
    read = private_batch.reader(space, fields, floats, ids)
    for _ in range(3):
        read()
        assert ids.tolist() == [bodies[0].id, bodies[1].id, -1]
        assert floats.tolist() == [-0.09, 0.0, 0.0, 0.09, 0.0, 0.5, -1.0, -1.0, -1.0]
    floats[:6] = range(1, 7)
    write = private_batch.writer(space, pymunk.batch.BodyFields.POSITION | pymunk.batch.BodyFields.ANGLE, floats)
    for _ in range(3):
        write()
        assert [(*b.position, b.angle) for b in bodies] == [(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)]
        bodies[0].position = (9.0, 9.0)


def test_memory_of_readers_and_writers_lives_as_long_as_they() -> None:
    space, bodies = meeting()
    read = private_batch.reader(space, pymunk.batch.BodyFields.POSITION, np.zeros(8), np.zeros(8, np.int64))
    write = private_batch.writer(space, pymunk.batch.BodyFields.POSITION, np.arange(4.0))
    gc.collect()
    held = [np.full(8, 7.0) for _ in range(100)]
    for _ in range(100):
        read()
        write()
    assert [tuple(b.position) for b in bodies] == [(0.0, 1.0), (2.0, 3.0)]
    assert all((h == 7.0).all() for h in held)


def test_timestamp_counts_the_steps_of_pymunk() -> None:
    space, _ = meeting()
    now = private.timestamp(space)
    start = now()
    space.step(0.001)
    space.step(0.001)
    assert now() == start + 2


def test_waits() -> None:
    space, _ = meeting()
    assert not private.waits(space)
    space.add_post_step_callback(lambda *_: None, 1)
    assert private.waits(space)
    space.step(0.001)
    assert not private.waits(space)


def test_reader_of_some_bodies_reads_bodies_in_no_space() -> None:
    bodies = [pymunk.Body(1.0, 1.0), pymunk.Body(body_type=pymunk.Body.KINEMATIC)]
    floats = np.full(9, -1.0)
    read = private_batch.reader_of(bodies, pymunk.batch.BodyFields.POSITION | pymunk.batch.BodyFields.ANGLE, floats)
    for k in range(3):
        bodies[1].position, bodies[1].angle = (float(k), 2.0), 3.0
        read()
        assert floats.tolist() == [0.0, 0.0, 0.0, float(k), 2.0, 3.0, -1.0, -1.0, -1.0]

"""pymunk's own shapes are where a step has put the bodies, by either way of syncing."""

from __future__ import annotations

import itertools
import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space import sync
from eeca_pymunk.space.late_shapes import MOST_READ
from eeca_pymunk.space.private import batch as private_batch
from eeca_pymunk.space.private import rest as private_rest
from scenes.scene import add_disk

from ..test_packed_stepper import FreeFlight

DT = 0.0625


def crowd(count: int, hashed: bool = False) -> pymunk.Space:
    """Disks of radius .4 on a grid, all at velocity (2, 1), in a column of gravity."""
    space = pymunk.Space()
    if hashed:
        space.use_spatial_hash(1.0, 100)
    space.gravity = (0.0, -1.0)
    for i in range(count):
        add_disk(space, (i % 10, i // 10), 0.4, velocity=(2.0, 1.0))
    return space


def counted(stepper: ep.Stepper, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The ways taken from now on."""
    ways: list[str] = []
    rest, reindex = sync.Sync.rest, sync.Sync.leave_late
    monkeypatch.setattr(sync.Sync, "rest", lambda self, dt: (ways.append("rest"), rest(self, dt))[1])
    monkeypatch.setattr(sync.Sync, "leave_late", lambda self, dt: (ways.append("reindex"), reindex(self, dt))[1])
    return ways


@pytest.mark.parametrize("hashed", [False, True])
@pytest.mark.parametrize("count", [1, MOST_READ, MOST_READ + 1, 40])
def test_queries_find_the_bodies_where_they_are(count: int, hashed: bool) -> None:
    space = crowd(count, hashed)
    stepper = FreeFlight(space)
    for _ in range(50):
        stepper.step(DT)
        for body in space.bodies:
            found = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
            assert found is not None
            assert found.shape is not None
            assert found.shape.body is body
            assert found.shape.bb.left == pytest.approx(body.position.x - 0.4)
    assert space.current_time_step == DT
    assert space.gravity == (0.0, -1.0)
    assert space.iterations == pymunk.Space().iterations


@pytest.mark.parametrize("hashed", [False, True])
def test_a_spatial_hash_that_is_reindexed_is_renewed_now_and_then(
    hashed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    space = crowd(3, hashed)
    stepper = FreeFlight(space)
    ways = counted(stepper, monkeypatch)
    for _ in range(70):
        stepper.step(DT)
        space.point_query((0.0, 0.0), 0.0, pymunk.ShapeFilter())
    if hashed:
        assert ways == (["rest"] + 32 * ["reindex"]) * 2 + ["rest"] + 3 * ["reindex"]
    else:
        assert ways == ["rest"] + 69 * ["reindex"]


@pytest.mark.parametrize(
    ("count", "hashed", "expected"),
    [(MOST_READ, True, "reindex"), (MOST_READ + 1, True, "rest"), (4 * MOST_READ, False, "reindex")],
)
def test_many_shapes_of_a_spatial_hash_that_are_read_after_each_step_are_moved_by_rest_steps(
    count: int, hashed: bool, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for jointed in (False, True):
        space = crowd(count, hashed)
        if jointed:
            space.add(*[pymunk.PinJoint(a, b) for a, b in itertools.pairwise(space.bodies)])
        stepper = ep.EECA(space) if jointed else FreeFlight(space)
        ways = counted(stepper, monkeypatch)
        for _ in range(3):
            stepper.step(DT)
        assert ways == ["rest", "reindex", "reindex"]
        for _ in range(2):
            space.point_query((0.0, 0.0), 0.0, pymunk.ShapeFilter())
            stepper.step(DT)
        assert ways[3:] == 2 * [expected]
        for body in space.bodies:
            found = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
            assert found is not None
            assert found.shape in body.shapes
        monkeypatch.undo()


def test_what_only_a_step_of_pymunk_does_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    space = crowd(1)
    stepper = FreeFlight(space)
    ways = counted(stepper, monkeypatch)
    stepper.step(DT)
    stepper.step(DT)
    stepper.step(0.5 * DT)
    assert space.current_time_step == 0.5 * DT
    space.step(0.5 * DT)  # old contacts of native steps are to be forgotten
    stepper.step(0.5 * DT)
    stepper.step(0.5 * DT)
    called: list[str] = []
    space.add_post_step_callback(lambda space, key: called.append(key), "key")
    stepper.step(0.5 * DT)
    assert called == ["key"]
    assert ways == ["rest", "reindex", "reindex", "rest", "reindex", "reindex"]


@pytest.mark.parametrize("count", [1, 30])
def test_a_callback_may_add_and_remove_bodies(count: int) -> None:
    space = crowd(count)
    stepper = FreeFlight(space)
    stepper.step(DT)
    first, last = next(iter(space.bodies)), list(space.bodies)[-1]
    expected = last.velocity.y - DT

    def change(space: pymunk.Space, key: str) -> None:
        space.remove(first, *first.shapes)
        add_disk(space, (0.0, 50.0), 0.4)

    space.add_post_step_callback(change, "change")
    stepper.step(DT)
    assert first not in space.bodies
    if count > 1:
        assert last.velocity == (2.0, expected)
    stepper.step(DT)
    assert list(space.bodies)[-1].velocity == (0.0, -DT)


def test_without_sync_pymunks_shapes_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    space = crowd(1)
    stepper = FreeFlight(space, sync=False)
    ways = counted(stepper, monkeypatch)
    before = [s.bb for s in space.shapes]
    stepper.step(DT)
    assert [s.bb for s in space.shapes] == before
    assert ways == []


def standing() -> tuple[pymunk.Space, pymunk.Body]:
    """A box that stands on a floor, and one that flies."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    space.add(pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0))
    for x, y in ((0.0, 0.5), (3.0, 9.0)):
        body = pymunk.Body(2.0, 1.0)
        body.position = (x, y)
        space.add(body, pymunk.Poly.create_box(body, (1.0, 1.0)))
    return space, next(iter(space.bodies))


def heard(body: pymunk.Body) -> list[tuple[float, float]]:
    """The impulses of a body's arbiters."""
    found: list[tuple[float, float]] = []
    body.each_arbiter(lambda arbiter: found.append(tuple(arbiter.total_impulse)))
    return found


def test_arbiters_are_renewed_when_somebody_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    space, box = standing()
    stepper = ep.EECA(space)
    ways = counted(stepper, monkeypatch)
    for _ in range(4):
        stepper.step(DT)
    assert ways == ["rest", "reindex", "reindex", "reindex"]
    flying = list(space.bodies)[1]
    flying.force, motion = (0.0, 3.0), (flying.position, flying.velocity)
    assert heard(box) == [pytest.approx((0.0, 20.0 * DT))]
    assert ((flying.position, flying.velocity), flying.force) == (motion, (0.0, 3.0))
    assert heard(flying) == []
    assert ways[4:] == ["rest"]
    # Who asks once asks again.
    stepper.step(DT)
    assert heard(box) == [pytest.approx((0.0, 20.0 * DT))]
    stepper.step(DT)
    stepper.step(DT)
    assert ways[5:] == ["rest", "rest", "reindex"]


def test_drawing_the_points_of_contacts_renews_arbiters(monkeypatch: pytest.MonkeyPatch) -> None:
    space, box = standing()
    stepper, options = ep.EECA(space), pymunk.SpaceDebugDrawOptions()
    stepper.step(DT)
    box.position = (2.0, 0.5)
    stepper.step(DT)
    ways = counted(stepper, monkeypatch)
    for name in ("segment", "polygon", "fat_segment", "circle", "dot"):
        monkeypatch.setattr(options, f"draw_{name}", lambda *_: None)
    options.flags = pymunk.SpaceDebugDrawOptions.DRAW_SHAPES
    space.debug_draw(options)
    assert ways == []
    options.flags |= pymunk.SpaceDebugDrawOptions.DRAW_COLLISION_POINTS
    space.debug_draw(options)
    assert ways == ["rest"]


def test_where_bodies_may_sleep_arbiters_are_renewed_when_somebody_asks_too(monkeypatch: pytest.MonkeyPatch) -> None:
    space, box = standing()
    space.sleep_time_threshold = 5.0
    stepper = ep.EECA(space)
    ways = counted(stepper, monkeypatch)
    for _ in range(3):
        stepper.step(DT)
    assert heard(box) == [pytest.approx((0.0, 20.0 * DT))]
    for _ in range(2):
        stepper.step(DT)
    assert ways == ["rest", "reindex", "reindex", "rest", "rest", "reindex"]
    assert stepper.reads == 1  # pymunk's steps in between are not steps of the program


@pytest.mark.parametrize("together", [False, True])
def test_a_step_at_rest_leaves_settings_and_what_is_stopped_moves_on(together: bool) -> None:
    space, box = standing()
    space.static_body.velocity = 7.0, 8.0
    box.velocity, box.angular_velocity, box.force, box.torque = (1.0, -2.0), 3.0, (4.0, 5.0), 6.0
    settings = space.gravity, space.iterations, space.collision_bias
    stop, go_on = private_batch.stopper(space, len(space.bodies) + 1) if together else private_rest.stopper(space)
    stop()
    assert (box.velocity, box.angular_velocity, box.force, box.torque) == ((0.0, 0.0), 0.0, (0.0, 0.0), 0.0)
    private_rest.rest(space, DT, False)
    go_on()
    assert space.static_body.velocity == (7.0, 8.0)
    assert (box.velocity, box.angular_velocity, box.force, box.torque) == ((1.0, -2.0), 3.0, (4.0, 5.0), 6.0)
    assert (box.position, space.current_time_step) == ((0.0, 0.5), DT)
    assert (space.gravity, space.iterations, space.collision_bias) == settings


def test_reading_arbiters_calls_no_function_of_a_body() -> None:
    """Arbiters are made when they are read, by a step of pymunk."""
    space, dts = crowd(1), []
    (body,) = space.bodies

    def function(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        dts.append(dt)
        pymunk.Body.update_velocity(body, gravity, damping, dt)

    body.velocity_func = function  # type: ignore[assignment]
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    body.each_arbiter(lambda arbiter: None)
    assert dts == 3 * [DT]


@pytest.mark.parametrize("handler", [False, True])
@pytest.mark.parametrize("joined", ["before", "since", "turned static since"])
def test_reading_arbiters_leaves_what_joints_hold_as_it_is(joined: str, handler: bool) -> None:
    """Arithmetic of pymunk gives nan for a joint of angles between two bodies that cannot turn."""
    space, calls = crowd(3), []
    wheel, other, far = space.bodies
    wheel.moment = math.inf
    if joined != "turned static since":
        other.body_type = pymunk.Body.STATIC

    def join() -> None:
        for joint in (pymunk.GearJoint(wheel, other, 0.0, 1.0), pymunk.DampedRotarySpring(wheel, other, 0.0, 5.0, 1.0)):
            joint.pre_solve = lambda *_: calls.append(joined)
            space.add(joint)

    if joined == "before":
        join()
    if handler:
        space.on_collision(1, 1, begin=lambda *_: None)
    stepper = ep.EECA(space)
    for _ in range(4):
        stepper.step(DT)
    if joined != "before":
        join()
    if joined == "turned static since":
        other.body_type = pymunk.Body.STATIC
    called, before = len(calls), [(body.velocity, body.angular_velocity) for body in space.bodies]
    far.each_arbiter(lambda arbiter: None)
    assert [(body.velocity, body.angular_velocity) for body in space.bodies] == before
    assert len(calls) == called
    stepper.step(DT)


class Picture(pymunk.SpaceDebugDrawOptions):
    """Draws nothing."""

    def draw_circle(self, *_: object) -> None:
        pass

    draw_segment = draw_fat_segment = draw_polygon = draw_dot = draw_circle


def test_pictures_cost_the_next_step_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a picture the next step reindexes as without it; where bodies may sleep it reads nothing anew."""
    space = crowd(4)
    stepper = ep.EECA(space)
    stepper.step(DT)
    ways = counted(stepper, monkeypatch)
    for _ in range(5):
        stepper.step(DT)
        space.debug_draw(Picture())
    assert ways == ["reindex", "rest"] * 5  # the picture's own
    space = crowd(4)
    floor = pymunk.Segment(space.static_body, (-99, -1), (99, -1), 0.1)
    space.add(floor)
    space.sleep_time_threshold = 0.2
    stepper = ep.EECA(space)
    for _ in range(40):
        stepper.step(DT)
        space.debug_draw(Picture())
    assert stepper.reads <= 3


@pytest.mark.parametrize("dt", [0.5 * DT, 2.0 * DT])
def test_a_native_step_after_late_steps_of_another_dt_is_that_of_a_fresh_space(dt: float) -> None:
    """pymunk scales what it has stored of impulses by the ratio of its last two dt: nothing is stored."""
    ends = []
    for late in (False, True):
        space = pymunk.Space()
        space.gravity = (0.0, -1.0)
        add_disk(space, (0.0, 0.4), 0.4)
        space.add(pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0))
        stepper = ep.EECA(space)
        stepper.step(DT)
        for _ in range(3):
            if late:
                stepper.step(dt)
        (body,) = space.bodies
        body.position, body.velocity = (0.0, 0.4), (0.0, 0.0)
        space.reindex_shapes_for_body(body)
        space.step(DT)
        ends.append((*body.position, *body.velocity))
    assert ends[0] == ends[1]

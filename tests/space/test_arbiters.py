"""Arbiters after a step tell what the step did: impulses, lost energy, points; of impacts that are over, too."""

from __future__ import annotations

import gc
import math
import weakref

import numpy as np
import pymunk
import pytest
from pymunk import batch

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Impulse
from eeca_pymunk.model.parameters.rest import REST_SPEED
from eeca_pymunk.space.arbiters import touches_of

DT, G = 1 / 60, 9.81


def scene(*, handler: bool = False, e: float = 0.5, height: float = 0.53) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A box at rest, and a box that is dropped beside it."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.0)
    floor.friction, floor.elasticity = 0.5, 1.0
    space.add(floor)
    bodies = []
    for x, y, elasticity in ((0.0, 0.5, 0.0), (4.0, height, e)):
        body = pymunk.Body(2.0, 2.0 / 6.0)
        body.position = x, y
        shape = pymunk.Poly.create_box(body, (1.0, 1.0))
        shape.friction, shape.elasticity = 0.5, elasticity
        space.add(body, shape)
        bodies.append(body)
    if handler:
        space.on_collision(post_solve=lambda *_: None)
    return space, bodies


Seen = tuple[pymunk.Vec2d, float, list[pymunk.Vec2d], pymunk.Vec2d]


def seen(body: pymunk.Body) -> list[Seen]:
    found: list[Seen] = []
    body.each_arbiter(
        lambda a: found.append((a.total_impulse, a.total_ke, [p.point_a for p in a.contact_point_set.points], a.normal))
    )
    return found


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize("called", ["nothing", "handler", "function"])
def test_impulses_change_momenta(called: str, sync: bool) -> None:
    """Of each body and step: the sum over its arbiters is the change of momentum without gravity's."""
    space, bodies = scene(handler=called == "handler")
    if called == "function":
        bodies[0].velocity_func = lambda *arguments: pymunk.Body.update_velocity(*arguments)
    stepper = ep.EECA(space, sync=sync)
    bounces = 0
    for _ in range(30):
        before = [b.velocity for b in bodies]
        stepper.step(DT)
        for body, velocity in zip(bodies, before, strict=True):
            total = sum((impulse for impulse, *_ in seen(body)), pymunk.Vec2d(0.0, 0.0))
            change = body.mass * (body.velocity - velocity) + pymunk.Vec2d(0.0, body.mass * G * DT)
            # What is put to rest is held to that part of its weight.
            assert abs(total) == pytest.approx(abs(change), abs=REST_SPEED * body.mass * G * DT)
            assert total.dot(change) >= -1e-12, "on the body that asks, as under pymunk"
            bounces += abs(change) > 0.5
    assert bounces >= 2


def test_an_impact_that_is_over_has_its_points_and_lost_energy() -> None:
    """(1 + e) m v, twice the loss (1 - e²) m v²/2 as Chipmunk counts it, and both corners on the floor."""
    space, bodies = scene(e=0.5, height=0.53)
    stepper = ep.EECA(space)
    ball = bodies[1]
    found: list[Seen] = []
    while not found:
        stepper.step(DT)
        found = seen(ball)
    assert ball.position.y > 0.5, "it is in the air again"
    speed = math.sqrt(2 * G * 0.03)
    ((impulse, lost, points, normal),) = found
    assert abs(impulse.y) == pytest.approx(1.5 * 2.0 * speed, rel=1e-9)
    # Two corners, of which each feels its share of the mass: by Chipmunk's formula it is that of a whole one.
    assert lost > 0.0
    assert sorted(p.x for p in points) == pytest.approx([3.5, 4.5])
    assert [p.y for p in points] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert abs(normal.y) == pytest.approx(1.0)


def test_a_disk_loses_as_much_as_under_pymunk() -> None:
    """pymunk is exact for one disk that hits a wall squarely."""
    told = []
    for make in (ep.EECA, ep.Native):
        space = pymunk.Space()
        space.collision_slop = 0.0
        wall = pymunk.Segment(space.static_body, (0, -9), (0, 9), 0.0)
        body = pymunk.Body(2.0, 1.0)
        body.position, body.velocity = (-0.6, 0.0), (3.0, 0.0)
        disk = pymunk.Circle(body, 0.5)
        wall.elasticity, disk.elasticity = 0.5, 0.8
        space.add(wall, body, disk)
        stepper = make(space)
        found: list[Seen] = []
        while not found:
            stepper.step(DT)
            found = seen(body)
        told.append((found[0][0].x, found[0][1], found[0][3].x))
    assert told[0] == pytest.approx(told[1], rel=1e-9)


def test_the_batch_tells_the_same() -> None:
    space, bodies = scene()
    stepper = ep.EECA(space)
    buffers = batch.Buffer()
    fields = batch.ArbiterFields.TOTAL_IMPULSE | batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID
    for _ in range(30):
        stepper.step(DT)
        buffers.clear()
        batch.get_space_arbiters(space, fields, buffers)
        impulses = np.frombuffer(buffers.float_buf()).reshape(-1, 2)
        ids = np.frombuffer(buffers.int_buf(), np.int64).reshape(-1, 2)
        for body in bodies:
            mine = np.abs(impulses[(ids == body.id).any(axis=1), 1]).sum()
            assert mine == pytest.approx(sum(abs(i.y) for i, *_ in seen(body)), abs=1e-12)


def test_looking_changes_nothing_and_native_steps_have_their_own() -> None:
    paths = []
    for look in (False, True):
        space, bodies = scene(handler=True)
        stepper = ep.EECA(space)
        path = []
        for _k in range(20):
            stepper.step(DT)
            if look:
                for body in bodies:
                    seen(body)
            path += [b.position for b in bodies]
        paths.append(path)
    assert paths[0] == paths[1]
    space.step(DT)
    native: list[float] = []
    pymunk.Body.each_arbiter(bodies[0], lambda a: native.append(a.total_impulse.y))
    assert native
    assert native != [0.0]


def test_a_body_that_was_just_added_has_its_contacts() -> None:
    """Also where the step after the addition only leaves shapes late (`Sync.leave_late`)."""
    space, bodies = scene(e=0.0, height=0.5)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    new = pymunk.Body(2.0, 2.0 / 6.0)
    new.position = -4.0, 0.5
    space.add(new, pymunk.Poly.create_box(new, (1.0, 1.0)))
    stepper.step(DT)
    for body in (*bodies, new):
        assert sum(impulse.y for impulse, *_ in seen(body)) == pytest.approx(2.0 * G * DT, rel=1e-9)


def test_a_body_that_has_become_kinematic_since_has_the_impulse_of_the_step() -> None:
    """Its effective mass is infinite, so that none of its energy is lost."""
    space, (_, falling) = scene(height=0.6)
    stepper = ep.EECA(space)
    falling.velocity = (0.0, -20.0)
    stepper.step(DT)
    ((impulse, lost, *_),) = seen(falling)
    falling.body_type = pymunk.Body.KINEMATIC
    assert lost > 0.0
    assert [found[:2] for found in seen(falling)] == [(impulse, 0.0)]


@pytest.mark.parametrize("sync", [(True, True), (True, False), (False, False)])
@pytest.mark.parametrize("handler", [False, True])
def test_arbiters_are_those_of_who_stepped_last(handler: bool, sync: tuple[bool, bool]) -> None:
    """Of two steppers and pymunk itself, in any order: they hold the box at rest, and catch the one that falls. What
    pymunk shows is its own."""
    space, bodies = scene(handler=handler, e=0.0, height=0.53)
    steppers = [ep.EECA(space, sync=each) for each in sync]
    for who in (0, 1, 0, 0, 1, 1, 2, 1, 0, 2, 0, 2, 2, 0, 1, 0):
        before = [b.velocity for b in bodies]
        if who == 2:
            space.step(DT)
        else:
            steppers[who].step(DT)
        for body, velocity in zip(bodies, before, strict=True):
            total = sum((impulse for impulse, *_ in seen(body)), pymunk.Vec2d(0.0, 0.0))
            change = body.mass * (body.velocity - velocity) + pymunk.Vec2d(0.0, body.mass * G * DT)
            assert abs(total) == pytest.approx(abs(change), abs=REST_SPEED * body.mass * G * DT), who


@pytest.mark.parametrize("handled", [False, True])
def test_reading_arbiters_calls_no_handler_that_was_added_since_the_step(handled: bool) -> None:
    """They are made when they are read, by a step of pymunk; also where handlers for other shapes were there before.
    Removals by such a call would wait for the next step, when the shape may be gone."""
    space, (_, falling) = scene()
    if handled:
        space.on_collision(5, 6, pre_solve=lambda *_: None)
    stepper, calls = ep.EECA(space), list[str]()
    for _ in range(20):
        stepper.step(DT)
    for phase in ("begin", "pre_solve", "post_solve", "separate"):
        space.on_collision(**{phase: lambda *_, phase=phase: calls.append(phase)})  # type: ignore[misc]
    assert seen(falling)
    assert calls == []
    stepper.step(DT)
    assert calls == 2 * ["pre_solve"] + 2 * ["post_solve"]


def test_impulses_of_a_pair_count_in_both_orders() -> None:
    """Within a step a pair may be hit as (a, b) and as (b, a): along the opposite normal, on the other shape."""
    a, b = (pymunk.Circle(pymunk.Body(1.0, 1.0), 1.0) for _ in range(2))
    events = rows(Impulse, 2)
    for k, (first, second, side) in enumerate(((0, 1, 1.0), (1, 0, -1.0))):
        event = events[k]
        event.first, event.second, event.when, event.nx, event.ny = first, second, float(k), side * 0.6, side * 0.8
        event.normal, event.tangential, event.px, event.py = 5.0 + k, 0.5, float(k), 0.0
    (touch,) = touches_of(events, (a, b))
    assert (touch.a, touch.b, touch.points) == (a, b, [(1.0, 0.0)])
    np.testing.assert_allclose(touch.impulse, (11.0 * 0.6 - 1.0 * 0.8, 11.0 * 0.8 + 1.0 * 0.6), rtol=1e-15)
    np.testing.assert_allclose(touch.normal, (0.6, 0.8), rtol=1e-15)


@pytest.mark.parametrize("handled", [False, True])
def test_a_pair_that_falls_asleep_has_one_arbiter(handled: bool) -> None:
    """With the impulse of the step in which it does, its weight."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    body = pymunk.Body(1.0, 1.0)
    body.position = 0.0, 0.1
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    space.add(body, pymunk.Poly.create_box(body, (0.2, 0.2)), floor)
    if handled:
        space.on_collision(post_solve=lambda *_: None)
    stepper = ep.EECA(space)
    while not body.is_sleeping:
        stepper.step(1 / 60)
    assert weights(body) == pytest.approx([10.0 / 60.0])


def weights(body: pymunk.Body) -> list[float]:
    """The vertical impulses of the arbiters of a body."""
    impulses: list[float] = []
    body.each_arbiter(lambda arbiter: impulses.append(arbiter.total_impulse.y))
    return impulses


@pytest.mark.parametrize("others_move", [False, True])
def test_arbiters_of_sleeping_bodies_keep_the_impulses_of_their_last_step(others_move: bool) -> None:
    """As pymunk's do, until they wake; those of a pair that was removed are gone."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    floor.elasticity = 1.0
    space.add(floor)
    pile = [pymunk.Body(1.0, 1.0) for _ in range(2)]
    for k, body in enumerate(pile):
        body.position = 0.0, 0.1 + 0.2 * k
        space.add(body, pymunk.Poly.create_box(body, (0.2, 0.2)))
    if others_move:
        ball = pymunk.Body(1.0, 1.0)
        ball.position = 4.0, 3.0
        shape = pymunk.Circle(ball, 0.5)
        shape.elasticity = 1.0
        space.add(ball, shape)
    stepper = ep.EECA(space)
    while not pile[0].is_sleeping:
        stepper.step(1 / 60)
    for _ in range(30):
        stepper.step(1 / 60)
        assert sorted(weights(pile[0])) == pytest.approx([-10.0 / 60.0, 20.0 / 60.0])
        assert weights(pile[1]) == pytest.approx([10.0 / 60.0])
    pile[0].activate()
    stepper.step(1 / 120)
    assert sorted(weights(pile[0])) == pytest.approx([-10.0 / 120.0, 20.0 / 120.0])
    pile[0].sleep()  # by the program
    pile[1].sleep_with_group(pile[0])
    for _ in range(3):
        assert sorted(weights(pile[0])) == pytest.approx([-10.0 / 120.0, 20.0 / 120.0])
        stepper.step(1 / 60)
    assert sorted(weights(space.static_body))[0] == pytest.approx(-20.0 / 120.0)
    pile[1].activate()
    pile[1].position = -3.0, 0.1  # as they sleep again, they do not touch
    space.reindex_shapes_for_body(pile[1])
    stepper.step(1 / 60)
    while not (pile[0].is_sleeping and pile[1].is_sleeping):
        stepper.step(1 / 60)
    stepper.step(1 / 60)
    assert weights(pile[0]) == weights(pile[1]) == pytest.approx([10.0 / 60.0])
    pile[0].activate()
    stepper.step(1 / 60)
    space.remove(pile[1], *pile[1].shapes)
    stepper.step(1 / 60)
    assert weights(pile[0]) == pytest.approx([10.0 / 60.0])


def test_sleeping_bodies_keep_no_shapes_of_others() -> None:
    """They keep the pairs of the step in which they fell asleep, but not what else there was in it."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    space.add(pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0))
    box, ball = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    box.position, ball.position = (-3.0, 0.5), (3.0, 0.2)
    space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)), ball, disk := pymunk.Circle(ball, 0.2))
    ball.velocity = 1.0, 0.0  # without friction it slides on, and stays awake
    stepper = ep.EECA(space)
    while not box.is_sleeping:
        stepper.step(1 / 60)
    assert not ball.is_sleeping
    mover = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    mover.position, mover.velocity = (0.0, 50.0), (1.0, 0.0)
    space.add(mover, pymunk.Circle(mover, 0.2))
    space.remove(ball, disk)
    gone = weakref.ref(disk)
    del disk, ball
    for _ in range(3):
        stepper.step(1 / 60)
    assert weights(box) == [pytest.approx(10.0 / 60, rel=1e-9)]
    gc.collect()
    assert gone() is None

"""Idioms of programs that use pymunk: games, teaching, robots, learning. Each has its own oracle."""

from __future__ import annotations

import copy
import math
import pickle
import threading
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from scenes.scene import add_disk, add_walls

from ..steppers import state

DT = 1 / 60
Make = Callable[[pymunk.Space], ep.Stepper]
both = pytest.mark.parametrize("make", [ep.Native, ep.EECA])
EVERYTHING = pymunk.ShapeFilter()


def ground(gravity: float = 10.0, friction: float = 0.7) -> tuple[pymunk.Space, pymunk.Segment]:
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.1)
    floor.friction = friction
    space.add(floor)
    return space, floor


def box_on(space: pymunk.Space, x: float, y: float = 0.6, size: float = 1.0) -> pymunk.Body:
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (size, size)))
    body.position = (x, y)
    shape = pymunk.Poly.create_box(body, (size, size))
    shape.friction = 0.7
    space.add(body, shape)
    return body


def run(stepper: ep.Stepper, count: int) -> None:
    for _ in range(count):
        stepper.step(DT)


@both
def test_teleported_bodies_go_on_from_where_they_are_put(make: Make) -> None:
    """A screen that wraps around: out on the right, in on the left."""
    space = pymunk.Space()
    ship = add_disk(space, (0.0, 0.0), 0.1, velocity=(7.0, 0.0))
    rock = add_disk(space, (-4.0, 0.0), 0.1)
    rock_shape = next(iter(rock.shapes))
    rock_shape.elasticity = next(iter(ship.shapes)).elasticity = 1.0
    stepper = make(space)
    for _ in range(120):
        stepper.step(DT)
        if ship.position.x > 5.0:
            ship.position = (ship.position.x - 10.0, 0.0)
            space.reindex_shapes_for_body(ship)
    assert rock.velocity.x == pytest.approx(7.0)
    assert ship.velocity.x == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [1, 30])
def test_bodies_teleported_into_one_another_come_apart_without_energy(count: int) -> None:
    space, _ = ground()
    boxes = [box_on(space, 1.5 * k) for k in range(count + 1)]
    stepper = ep.EECA(space)
    run(stepper, 5)
    boxes[0].position = boxes[1].position + pymunk.Vec2d(0.3, 0.2)
    start = ep.measure(space).energy
    run(stepper, 120)
    assert ep.measure(space).energy <= start + 1e-9
    assert all(math.isfinite(b.position.x) and -0.1 < b.position.y < 5.0 for b in boxes)


@both
def test_velocity_set_each_frame(make: Make) -> None:
    """A character that walks: its horizontal velocity is set, gravity has the vertical one."""
    space, _ = ground()
    hero = pymunk.Body(1.0, math.inf)
    hero.position = (0.0, 2.0)
    space.add(hero, pymunk.Circle(hero, 0.3))
    stepper = make(space)
    for _ in range(120):
        hero.velocity = (3.0, hero.velocity.y)
        stepper.step(DT)
    assert hero.position.x == pytest.approx(3.0 * 120 * DT, rel=0.02)
    assert hero.position.y == pytest.approx(0.4, abs=0.11)


@both
def test_impulses_act_at_once(make: Make) -> None:
    space = pymunk.Space()
    body = box_on(space, 0.0)
    stepper = make(space)
    stepper.step(DT)
    body.apply_impulse_at_world_point((2.0, 0.0), (0.0, 1.1))
    body.apply_impulse_at_local_point((0.0, 1.0), (0.0, 0.0))
    stepper.step(DT)
    assert body.velocity == pytest.approx((2.0, 1.0))
    assert body.angular_velocity == pytest.approx(-1.0 / body.moment)


def pass_through(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
    arbiter.process_collision = False


def collide(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
    """As without a handler."""


@both
def test_a_one_way_platform(make: Make) -> None:
    """Up through it, and down onto it."""
    space, _floor = ground()
    platform = pymunk.Segment(space.static_body, (-1.0, 2.0), (1.0, 2.0), 0.1)
    platform.collision_type = 2
    hero = pymunk.Body(1.0, math.inf)
    hero.position, hero.velocity = (0.0, 0.5), (0.0, 9.0)
    feet = pymunk.Circle(hero, 0.3)
    feet.collision_type = 1
    space.add(platform, hero, feet)

    def one_way(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.process_collision = arbiter.shapes[0].body.velocity.y < 0.0  # type: ignore[union-attr]

    space.on_collision(1, 2, begin=one_way)
    stepper = make(space)
    highest = 0.0
    for _ in range(150):
        stepper.step(DT)
        highest = max(highest, hero.position.y)
    assert highest > 4.0
    assert hero.position.y == pytest.approx(2.4, abs=0.11)


@pytest.mark.parametrize("way", [None, "pickle", "state"])
@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
def test_what_passes_a_shape_passes_it_as_long_as_it_is_inside(phase: str, way: str | None) -> None:
    """A ball that bounces between walls within a shape, so fast that pymunk's own step has it outside: it was pushed
    out after as many steps as pymunk keeps arbiters."""
    space = pymunk.Space()
    zone = pymunk.Poly(space.static_body, [(0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)])
    walls = [pymunk.Segment(space.static_body, (x, -3.0), (x, 3.0), 0.0) for x in (0.05, 0.95)]
    zone.collision_type = 1
    ball = add_disk(space, (0.5, 0.45), 0.1, 1.0, (0.0, 0.0))
    space.add(zone, *walls)
    (disk,) = ball.shapes
    disk.collision_type, zone.friction, disk.friction = 2, 1.0, 1.0
    for shape in (*walls, disk):
        shape.elasticity = 1.0
    space.on_collision(1, 2, **{phase: pass_through})
    stepper = ep.EECA(space)
    run(stepper, 3)
    ball.velocity = 210.0, 0.0
    run(stepper, 6)
    if way == "pickle":
        space, stepper = pickle.loads(pickle.dumps((space, stepper)))
        (ball,) = space.bodies
    if way == "state":
        state = stepper.get_state()
        run(stepper, 6)
        stepper.set_state(state)
    run(stepper, 6)
    assert ball.position == pytest.approx((0.5, 0.45), abs=1e-9)
    assert abs(ball.velocity.x) == pytest.approx(210.0)
    ball.velocity = 0.0, 1.0
    run(stepper, 30)
    ball.velocity = 0.0, -1.0
    space.on_collision(1, 2, **{phase: collide})
    run(stepper, 30)
    assert ball.position.y >= 0.6 - 1e-9, "it has been outside, and is asked for again"


@both
def test_bullets_are_made_hit_and_go(make: Make) -> None:
    space = pymunk.Space()
    targets = [add_disk(space, (10.0, 2.0 * k), 0.5, 100.0) for k in range(5)]
    for target in targets:
        next(iter(target.shapes)).collision_type = 2
    bullets: list[pymunk.Body] = []

    def hit(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        for shape in arbiter.shapes:
            space.remove(shape, shape.body)  # type: ignore[arg-type]

    space.on_collision(1, 2, post_solve=hit)
    stepper = make(space)
    for k in range(120):
        if k % 10 == 0 and len(bullets) < 5:
            bullet = add_disk(space, (0.0, 2.0 * len(bullets)), 0.05, 0.1, (60.0, 0.0))
            next(iter(bullet.shapes)).collision_type = 1
            bullets.append(bullet)
        stepper.step(DT)
    assert len(space.bodies) == len(space.shapes) == 0


@both
@pytest.mark.parametrize("handled", [False, True])
def test_each_arbiter_finds_the_ground(make: Make, handled: bool) -> None:
    """How a platform game tells that its hero stands."""
    space, _floor = ground()
    hero = pymunk.Body(1.0, math.inf)
    hero.position = (0.0, 1.0)
    space.add(hero, pymunk.Circle(hero, 0.3))
    crate = box_on(space, 3.0)
    lid = box_on(space, 3.0, 1.6)
    if handled:
        space.on_collision(begin=lambda *_: None)
    stepper = make(space)

    def touched(body: pymunk.Body) -> list[pymunk.Body]:
        found: list[pymunk.Body] = []
        body.each_arbiter(lambda arbiter: found.extend(s.body for s in arbiter.shapes if s.body is not body))
        return found

    stepper.step(DT)
    assert touched(hero) == []
    run(stepper, 60)
    for _ in range(20):
        stepper.step(DT)
        assert touched(hero) == [space.static_body]
        assert set(touched(crate)) == {space.static_body, lid}
        assert touched(lid) == [crate]
    hero.velocity = (0.0, 5.0)
    run(stepper, 3)
    assert touched(hero) == []


@both
def test_what_stays_in_touch_neither_begins_again_nor_separates(make: Make) -> None:
    space, _ = ground()
    for k in range(3):
        box_on(space, 0.0, 0.6 + k)
    calls: list[str] = []
    space.on_collision(
        begin=lambda *_: calls.append("begin"), separate=lambda *_: calls.append("separate"),
        pre_solve=lambda *_: calls.append("pre_solve"),
    )  # fmt: skip
    stepper = make(space)
    run(stepper, 60)
    assert calls.count("separate") == 0
    assert calls.count("begin") == 3
    assert calls.count("pre_solve") >= 3 * 58


@both
def test_queries_between_steps_see_what_native_s_see(make: Make) -> None:
    space, floor = ground()
    body = box_on(space, 0.0, 2.0)
    shape = next(iter(body.shapes))
    stepper = make(space)
    for _ in range(40):
        stepper.step(DT)
        x, y = body.position
        hit = space.segment_query_first((x, 9.0), (x, -9.0), 0.0, EVERYTHING)
        assert hit is not None
        assert hit.shape is shape
        assert hit.point.y == pytest.approx(y + 0.5, abs=1e-6)
        assert shape in space.bb_query(pymunk.BB(x - 0.1, y - 0.1, x + 0.1, y + 0.1), EVERYTHING)
        assert [i.shape for i in space.point_query((x, y), 0.0, EVERYTHING)] == [shape]
    assert floor in [i.shape for i in space.segment_query((0.0, 9.0), (0.0, -9.0), 0.0, EVERYTHING)]


@both
def test_debug_draw_shows_the_end_of_the_step(make: Make) -> None:
    drawn: list[tuple[float, float]] = []

    class Draw(pymunk.SpaceDebugDrawOptions):
        def draw_circle(self, pos: pymunk.Vec2d, *_: object) -> None:  # type: ignore[override]
            drawn.append(tuple(pos))

        def draw_dot(self, *_: object) -> None: ...
        def draw_segment(self, *_: object) -> None: ...
        def draw_fat_segment(self, *_: object) -> None: ...
        def draw_polygon(self, *_: object) -> None: ...

    space, _ = ground()
    body = add_disk(space, (0.0, 5.0), 0.1, velocity=(1.0, 0.0))
    stepper = make(space)
    for _ in range(5):
        stepper.step(DT)
        drawn.clear()
        space.debug_draw(Draw())
        assert drawn == [pytest.approx(tuple(body.position))]


def test_a_joint_of_two_flush_segments_is_no_bump() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    for k in range(10):
        space.add(pymunk.Segment(space.static_body, (k, 0.0), (k + 1.0, 0.0), 0.0))
    box = box_on(space, 1.0, 0.25, 0.5)
    box.velocity = (3.0, 0.0)
    run(ep.EECA(space), 120)
    assert box.position == pytest.approx((7.0, 0.25), abs=1e-6)
    assert box.angle == pytest.approx(0.0, abs=1e-6)


def test_spaces_in_threads_of_their_own_do_not_meet() -> None:
    def play(ends: list[object], gravity: float) -> None:
        space, _ = ground(gravity)
        for k in range(4):
            box_on(space, 0.1 * k, 1.0 + 1.2 * k)
        run(ep.EECA(space), 60)
        ends.append(state(space))

    alone: list[object] = []
    for gravity in (5.0, 10.0):
        play(alone, gravity)
    together: list[list[object]] = [[], []]
    threads = [threading.Thread(target=play, args=(together[k], (5.0, 10.0)[k])) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [ends[0] for ends in together] == alone


@pytest.mark.parametrize("handled", [True, False])
def test_one_space_is_stepped_by_one_thread_at_a_time(handled: bool) -> None:
    """A thread that comes while another one steps gets an error, and breaks nothing: afterwards each may step it."""
    space, _ = ground()
    for k in range(4):
        box_on(space, 0.1 * k, 1.0 + 1.2 * k)
    if handled:
        space.on_collision(pre_solve=lambda *_: None)
    stepper = ep.EECA(space)
    refused: list[str] = []

    def play(go_on: Callable[[], object]) -> None:
        for _ in range(60):
            try:
                go_on()
            except RuntimeError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=play, args=(lambda: stepper.step(DT),)) for _ in range(3)]
    threads.append(threading.Thread(target=play, args=(lambda: stepper.run(20, DT),)))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("another thread" in error for error in refused)
    assert abs(stepper.step(DT).ledger.residual) < 1e-9  # type: ignore[union-attr]
    assert all(0.0 < body.position.y < 4.0 for body in space.bodies)


def test_a_thread_that_comes_within_a_function_of_another_ones_step_is_told_so() -> None:
    space, _ = ground()
    body = box_on(space, 0.0, 1.0)
    stepper = ep.EECA(space)
    kept, told = stepper.get_state(), []

    def come() -> None:
        calls: tuple[Callable[[], object], ...] = (
            lambda: stepper.step(DT), lambda: stepper.run(2, DT), stepper.get_state, lambda: stepper.set_state(kept)
        )  # fmt: skip
        for call in calls:
            with pytest.raises(RuntimeError, match="another thread"):
                call()
            told.append(call)

    def push(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        if not told:
            other = threading.Thread(target=come)
            other.start()
            other.join()
        pymunk.Body.update_velocity(body, gravity, damping, dt)

    body.velocity_func = push
    stepper.step(DT)
    assert len(told) == 4
    body.velocity_func = pymunk.Body.update_velocity
    run(stepper, 2)


@pytest.mark.parametrize("way", [copy.deepcopy, lambda s: s.copy(), lambda s: pickle.loads(pickle.dumps(s))])
def test_a_saved_game_goes_on_as_the_first_did(way: Callable[[pymunk.Space], pymunk.Space]) -> None:
    space, _ = ground()
    add_disk(space, (0.0, 3.0), 0.3, velocity=(1.0, 0.0))
    add_walls(space, [((4.0, -5.0), (4.0, 5.0))])
    stepper = ep.EECA(space)
    run(stepper, 30)
    saved = way(space)
    stepper.refresh()
    run(stepper, 60)
    run(ep.EECA(saved), 60)
    assert state(saved) == state(space)


@both
def test_a_room_that_is_reset_many_times(make: Make) -> None:
    """Environments for learning empty a space and fill it again, or make a new one."""
    space, floor = ground()
    stepper = make(space)
    heights = []
    for _ in range(5):
        for thing in (*space.shapes, *space.bodies):
            if thing is not floor:
                space.remove(thing)
        boxes = [box_on(space, 2.0 * k, 1.0) for k in range(3)]
        run(stepper, 40)
        heights.append([b.position.y for b in boxes])
    assert all(h == pytest.approx(heights[0], abs=0.2) for h in heights)


def test_nobody_is_lifted_through_a_wall() -> None:
    """Disks that are made at one place, in a box of thin walls, come apart inside it."""
    space = pymunk.Space()
    space.gravity = (0.0, -980.0)
    corners = [(-40.0, 0.0), (40.0, 0.0), (40.0, 200.0), (-40.0, 200.0)]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        space.add(pymunk.Segment(space.static_body, a, b, 1.0))
    bodies = [add_disk(space, (0.1 * i, 60.0), 10.0) for i in range(12)]
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.0, 0.5
    stepper = ep.EECA(space)
    for _ in range(240):
        stepper.step(1 / 60)
    assert all(-40.0 < b.position.x < 40.0 and 0.0 < b.position.y < 200.0 for b in bodies)


def crowd() -> pymunk.Space:
    """A chain that falls on a slope, boxes that pile up, a disk that bounces, a spring."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    floor = pymunk.Segment(space.static_body, (-9.0, -1.2), (9.0, -1.4), 0.0)
    floor.friction = floor.elasticity = 0.5
    space.add(floor)
    last = space.static_body
    for i in range(4):
        body = pymunk.Body(1.0, 0.1)
        body.position = (i + 0.5, 0.0)
        shape = pymunk.Poly.create_box(body, (0.9, 0.2))
        shape.friction = 0.5
        joint = pymunk.PivotJoint(last, body, (float(i), 0.0))
        joint.collide_bodies = False
        space.add(body, shape, joint)
        last = body
    for i in range(5):
        body = pymunk.Body(1.0, 0.1)
        body.position = (-3.0 + 0.1 * i, 0.8 * i)
        shape = pymunk.Poly.create_box(body, (0.7, 0.7)) if i else pymunk.Circle(body, 0.35)
        shape.friction, shape.elasticity = 0.4, 0.6
        space.add(body, shape)
    space.add(pymunk.DampedSpring(space.static_body, body, (-3.0, 5.0), (0.0, 0.0), 1.0, 1.0, 0.1))
    return space


def places(space: pymunk.Space) -> list[tuple[float, ...]]:
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies]


WAYS = {"deepcopy": copy.deepcopy, "pickle": lambda s: pickle.loads(pickle.dumps(s))}


@pytest.mark.parametrize("way", [*WAYS.values(), copy.copy], ids=[*WAYS, "copy"])
def test_a_run_that_is_saved_goes_as_one_that_is_not(way: Callable[[ep.EECA], ep.EECA]) -> None:
    saved, plain = ep.EECA(crowd()), ep.EECA(crowd())
    for _ in range(60):
        way(saved)
        for stepper in (saved, plain):
            stepper.step(1 / 60)
        assert places(saved.space) == places(plain.space)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("steps", [0, 1, 40])
def test_a_copy_of_a_stepper_goes_on_as_its_original(way: Callable[[ep.EECA], ep.EECA], steps: int) -> None:
    stepper = ep.EECA(crowd())
    for _ in range(steps):
        stepper.step(1 / 60)
    other = way(way(stepper))
    for _ in range(60):
        stepper.step(1 / 60)
        other.step(1 / 60)
        assert places(other.space) == places(stepper.space)


def test_a_copy_of_another_version_begins_without_contact_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its arrays are not those of this version's kernels, which write beyond the ends of shorter ones, and its records
    have other fields: they are not even unpickled."""
    stepper = ep.EECA(crowd())
    for _ in range(20):
        stepper.step(1 / 60)
    saved = pickle.dumps(stepper)
    monkeypatch.setattr("eeca_pymunk.saved.sources_hash", lambda: "another")
    monkeypatch.setattr("eeca_pymunk.impacts.remembering.Remembering.__setstate__", None)
    other = pickle.loads(saved)
    fresh = ep.EECA(copy.deepcopy(other.space))
    for _ in range(30):
        other.step(1 / 60)
        fresh.step(1 / 60)
        assert places(other.space) == places(fresh.space)


def test_what_was_changed_in_a_copy_is_found() -> None:
    stepper = ep.EECA(crowd())
    for _ in range(20):
        stepper.step(1 / 60)
    for change in ("friction", "mass", "joint", "shape"):
        other = copy.deepcopy(stepper)
        space = other.space
        body = list(space.bodies)[6]
        shape = next(iter(body.shapes))
        if change == "friction":
            shape.friction = 0.0
        elif change == "mass":
            body.mass = 7.0
        elif change == "joint":
            list(space.constraints)[1].max_force = 1.0
        else:
            space.remove(shape)
        fresh = ep.EECA(copy.deepcopy(space))
        for _ in range(30):
            other.step(1 / 60)
            fresh.step(1 / 60)
        assert places(other.space) == places(fresh.space)


def test_from_the_same_start_a_refreshed_stepper_goes_the_same_way() -> None:
    space = crowd()
    stepper = ep.EECA(space)
    start = [(b.position, b.angle, b.velocity, b.angular_velocity) for b in space.bodies]
    ends = []
    for steps in (50, 20, 50):
        stepper.refresh()
        for body, (*pose, spin) in zip(space.bodies, start, strict=True):
            body.position, body.angle, body.velocity = pose
            body.angular_velocity = spin
        for _ in range(steps):
            stepper.step(1 / 60)
        ends.append(places(space))
    assert ends[0] == ends[2]


@pytest.mark.parametrize("way", [copy.deepcopy, lambda stepper: pickle.loads(pickle.dumps(stepper))])
@pytest.mark.parametrize("edit", ["a joint", "a body", "a shape", "a value", "a joint's value", "a wall"])
def test_what_was_changed_since_the_last_step_is_part_of_a_copy(way: Callable[[ep.EECA], ep.EECA], edit: str) -> None:
    """Results of earlier steps hold for what has not changed, in the copy as in its original."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1)
    floor.friction = 0.5
    space.add(floor)
    wall = pymunk.Body(body_type=pymunk.Body.STATIC)
    wall.position = (-4.0, 1.0)
    space.add(wall, pymunk.Segment(wall, (0.0, -1.0), (0.0, 1.0), 0.1))
    for k in range(6):
        body = pymunk.Body(1.0 + k, 1.0)
        body.position, body.angle = (0.1 * k, 1.0 + 0.9 * k), 0.1 * k
        box = pymunk.Poly.create_box(body, (1.0, 0.8))
        box.friction = 0.5
        space.add(body, box)
    low, high = list(space.bodies)[1::5]
    rope = pymunk.SlideJoint(space.static_body, high, (0, 9), (0, 0), 0.0, 4.0)
    space.add(rope)
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(1 / 60)
    other = pymunk.Body(1.0, 1.0)
    other.position = (3.0, 0.6)
    if edit == "a joint":
        space.add(pymunk.PinJoint(low, high))
    elif edit == "a body":
        space.add(other, pymunk.Circle(other, 0.5))
    elif edit == "a shape":
        space.remove(next(iter(high.shapes)))
    elif edit == "a value":
        floor.friction, low.mass = 0.1, 5.0
    elif edit == "a wall":
        wall.position = (-0.6, 1.0)
        space.reindex_shapes_for_body(wall)
    else:
        rope.max, rope.anchor_b = 3.5, (0.1, 0.0)
    twin = way(stepper)
    for _ in range(10):
        stepper.step(1 / 60)
        twin.step(1 / 60)
    places = [[(b.position, b.angle, b.velocity) for b in one.space.bodies] for one in (stepper, twin)]
    assert places[0] == places[1]

"""What functions of a program do besides what they are for: as under pymunk."""

from __future__ import annotations

import gc
import math
import weakref
from collections.abc import Callable
from typing import Any

import pymunk
import pytest

import eeca_pymunk as ep

DT = 0.1
Step = Callable[[float], object]


def ball(space: pymunk.Space, x: float, mass: float = 1.0) -> pymunk.Body:
    body = pymunk.Body(mass, mass)
    body.position = x, 0.0
    circle = pymunk.Circle(body, 0.5)
    circle.elasticity = 1.0
    space.add(body, circle)
    return body


def both(play: Callable[[pymunk.Space, Step], Any]) -> list[Any]:
    """What a program returns under pymunk, and under EECA."""
    found = []
    for native in (True, False):
        space = pymunk.Space()
        stepper: list[ep.EECA] = []

        def step(dt: float, space: pymunk.Space = space, native: bool = native, made: list[ep.EECA] = stepper) -> None:
            if native:
                space.step(dt)
                return
            if not made:
                made.append(ep.EECA(space))
            made[0].step(dt)

        found.append(play(space, step))
    return found


@pytest.mark.parametrize("what", ["force", "impulse", "place", "kinematic"])
def test_velocity_functions_may_push_and_move_other_bodies(what: str) -> None:
    def play(space: pymunk.Space, step: Step) -> list[float]:
        one, other = ball(space, 0.0), ball(space, 5.0)
        if what == "kinematic":
            other.body_type = pymunk.Body.KINEMATIC
        times = [0]

        def push(body: pymunk.Body, gravity: Any, damping: float, dt: float) -> None:
            pymunk.Body.update_velocity(body, gravity, damping, dt)
            times[0] += 1
            if what == "force":
                other.apply_force_at_world_point((1.0, 0.0), other.position)
            elif what == "impulse" and times[0] == 2:
                other.apply_impulse_at_world_point((1.0, 0.0), other.position)
            elif what == "place" and times[0] == 2:
                other.position = 8.0, 0.0
            elif what == "kinematic" and times[0] == 1:
                other.velocity = 1.0, 0.0

        one.velocity_func = push
        for _ in range(10):
            step(DT)
        return [other.velocity.x, other.position.x]

    native, ours = both(play)
    assert ours[0] == pytest.approx(native[0], abs=1e-9)
    assert ours[1] == pytest.approx(native[1], abs=DT)  # pymunk moves with the velocities of the step before


@pytest.mark.parametrize("what", ["thrust", "turn back", "impulse", "other", "platform"])
def test_position_functions_may_push_and_move_bodies(what: str) -> None:
    def play(space: pymunk.Space, step: Step) -> list[float]:
        one, other = ball(space, 0.0), ball(space, 20.0)
        one.velocity = (5.0, 0.0) if what == "turn back" else (0.0, 0.0)
        if what == "platform":
            one.body_type = pymunk.Body.KINEMATIC
        times = [0]

        def move(body: pymunk.Body, dt: float) -> None:
            pymunk.Body.update_position(body, dt)
            times[0] += 1
            if what == "thrust" and times[0] < 10:
                body.apply_force_at_world_point((1.0, 0.0), body.position)
            elif what == "turn back" and body.position.x > 2.0 and body.velocity.x > 0.0:
                body.velocity = -body.velocity
            elif what == "impulse" and times[0] == 2:
                body.apply_impulse_at_world_point((1.0, 0.0), body.position)
            elif what == "other" and times[0] == 2:
                other.position = 30.0, 0.0
            elif what == "platform":
                body.velocity = 1.0, 0.0

        one.position_func = move
        for _ in range(10):
            step(DT)
        return [one.velocity.x, other.position.x, one.position.x]

    native, ours = both(play)
    assert ours[:2] == pytest.approx(native[:2], abs=1e-9)
    assert ours[2] == pytest.approx(native[2], abs=DT)  # pymunk moves with the velocities of the step before


@pytest.mark.parametrize("phase", ["post_solve", "separate"])
def test_forces_of_handlers_after_the_motion_act_in_the_next_step(phase: str) -> None:
    """A ball bounces once off a wall: F dt/m of the force."""
    space = pymunk.Space()
    body, wall = ball(space, 0.0), pymunk.Segment(space.static_body, (2.0, -9.0), (2.0, 9.0), 0.0)
    wall.elasticity, body.velocity = 1.0, (5.0, 0.0)
    wall.collision_type, next(iter(body.shapes)).collision_type = 2, 1
    space.add(wall)
    calls = []

    def push(*_: Any) -> None:
        calls.append(1)
        body.force = 0.0, 60.0

    space.on_collision(1, 2, **{phase: push})
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(DT)
    assert calls == [1]
    assert body.velocity == pytest.approx((-5.0, 6.0), abs=1e-9)


def test_functions_of_kinematic_bodies_are_called_while_all_sleep() -> None:
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.5
    space.add(pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0))
    box = pymunk.Body(1.0, 1.0)
    box.position = 0.0, 0.5
    platform = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    platform.position = 5.0, 5.0
    calls = [0]

    def drive(body: pymunk.Body, *_: Any) -> None:
        calls[0] += 1
        body.velocity = (1.0, 0.0) if calls[0] > 60 else (0.0, 0.0)

    platform.velocity_func = drive
    space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)), platform, pymunk.Circle(platform, 0.2))
    stepper = ep.EECA(space)
    for _ in range(120):
        stepper.step(1 / 60)
    assert box.is_sleeping
    assert calls[0] == 120
    assert platform.position.x == pytest.approx(6.0, abs=0.02)


def test_handlers_and_joints_may_replace_their_functions_within_a_step() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    body, floor = ball(space, 0.0), pymunk.Segment(space.static_body, (-9.0, -0.5), (9.0, -0.5), 0.0)
    floor.collision_type, next(iter(body.shapes)).collision_type = 2, 1
    space.add(floor)
    joint = pymunk.PinJoint(space.static_body, body, (0.0, 5.0))
    space.add(joint)
    told: list[str] = []

    def second(*_: Any) -> None:
        told.append("second")

    def first(*_: Any) -> None:
        told.append("first")
        space.on_collision(1, 2, pre_solve=second)

    def once(joint: pymunk.Constraint, space: pymunk.Space) -> None:
        told.append("once")
        joint.pre_solve = lambda *_: told.append("again")

    space.on_collision(1, 2, pre_solve=first)
    joint.pre_solve = once
    stepper = ep.EECA(space)
    for _ in range(5):
        stepper.step(1 / 60)
    assert (told.count("first"), told.count("once"), told.count("again")) == (1, 1, 4)
    assert told.count("second") >= 4


def test_functions_may_end_those_of_other_bodies() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    one, other = ball(space, 0.0), ball(space, 5.0)

    def end(body: pymunk.Body, gravity: Any, damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        other.velocity_func = pymunk.Body.update_velocity
        other.position_func = pymunk.Body.update_position

    one.velocity_func = end
    other.velocity_func = lambda body, *_: None
    other.position_func = lambda body, dt: None
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    assert other.velocity.y == pytest.approx(one.velocity.y, abs=10.0 * DT + 1e-9)


@pytest.mark.parametrize("sync", [True, False])
def test_removed_shapes_are_freed(sync: bool) -> None:
    space = pymunk.Space()
    ball(space, -50.0)
    stepper, shapes = ep.EECA(space, sync=sync), []
    for k in range(20):
        body = ball(space, float(k))
        shapes.append(weakref.ref(next(iter(body.shapes))))
        stepper.step(0.01)
        space.remove(body, *body.shapes)
        del body
    for _ in range(3):
        stepper.step(0.01)
    gc.collect()
    assert sum(shape() is not None for shape in shapes) == 0


@pytest.mark.parametrize("how", ["moved", "returns", "set again"])
def test_masses_follow_those_of_shapes(how: str) -> None:
    """dv = F dt / m, with the mass that pymunk gives the body."""

    def play(space: pymunk.Space, step: Step) -> list[float]:
        bodies = [pymunk.Body(), pymunk.Body()]
        circles = []
        for k, body in enumerate(bodies):
            body.position = 10.0 * k, 0.0
            circle = pymunk.Circle(body, 0.5)
            circle.mass = 2.0
            circles.append(circle)
            space.add(body, circle)
        more = pymunk.Circle(bodies[0], 0.2)
        more.mass = 3.0
        space.add(more)
        step(DT)
        if how == "moved":
            space.remove(more)
            more.body = bodies[1]
            space.add(more)
        elif how == "returns":
            bodies[1].mass = 8.0
            space.remove(circles[1])
            space.add(circles[1])
        else:
            bodies[1].mass = 8.0
            circles[1].mass = 2.0
        for body in bodies:
            body.force = 1.0, 0.0
        step(DT)
        return [body.velocity.x for body in bodies]

    native, ours = both(play)
    assert ours == pytest.approx(native, rel=1e-9)


@pytest.mark.parametrize(("name", "value"), [("friction", math.inf), ("friction", -1.0), ("restitution", math.nan)])
def test_values_that_make_no_sense_are_refused(name: str, value: float) -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    body, floor = ball(space, 0.0), pymunk.Segment(space.static_body, (-9.0, -0.5), (9.0, -0.5), 0.0)
    floor.collision_type, next(iter(body.shapes)).collision_type = 2, 1
    space.add(floor)
    space.on_collision(1, 2, pre_solve=lambda arbiter, *_: setattr(arbiter, name, value))
    with pytest.raises(ValueError, match=f"{name} {value}"):
        ep.EECA(space).step(DT)


def test_what_a_step_that_failed_has_asked_for_is_asked_for_once() -> None:
    space = pymunk.Space()
    one, fails = ball(space, 0.0), [True]

    def add(body: pymunk.Body, gravity: Any, damping: float, dt: float) -> None:
        if len(space.bodies) == 1:
            more = pymunk.Body(1.0, 1.0)
            space.add(more, pymunk.Circle(more, 0.1))
        if fails.pop() if fails else False:
            raise ZeroDivisionError

    one.velocity_func = add
    stepper = ep.EECA(space)
    with pytest.raises(ZeroDivisionError):
        stepper.step(DT)
    stepper.step(DT)
    assert len(space.bodies) == 2


def test_a_state_is_not_asked_for_within_a_step() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    body = ball(space, 0.0)
    stepper = ep.EECA(space)

    def ask(body: pymunk.Body, gravity: Any, damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        assert "gravity" in stepper.model
        with pytest.raises(RuntimeError, match="get_state"):
            stepper.get_state()

    body.velocity_func = ask
    for _ in range(10):
        stepper.step(DT)
    assert (body.position.y, body.velocity.y) == pytest.approx((-5.0, -10.0))


@pytest.mark.parametrize("speed", [math.inf, math.nan])
def test_a_velocity_that_is_not_finite_is_refused_also_of_another_body(speed: float) -> None:
    space = pymunk.Space()
    one, other = ball(space, 0.0), ball(space, 20.0)

    def move(body: pymunk.Body, dt: float) -> None:
        pymunk.Body.update_position(body, dt)
        other.velocity = speed, 0.0

    one.position_func = move
    with pytest.raises(ValueError, match=r"velocity\.x"):
        ep.EECA(space).step(DT)
    assert other.position == (20.0, 0.0)
    assert other.velocity == (0.0, 0.0)


@pytest.mark.parametrize("by", [
    "velocity_func", "position_func", "pre_solve", "post_solve", "joint.pre_solve", "joint.post_solve",
])  # fmt: skip
def test_what_rests_on_a_floor_that_a_function_moves_falls_from_the_next_step_on(by: str) -> None:
    """A trap door: whatever function opens it, as if it had been moved between the steps."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    floor, box = pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(1.0, 1.0)
    box.position = 0.0, 1.0
    space.add(floor, pymunk.Segment(floor, (-5.0, 0.0), (5.0, 0.0), 0.5))
    space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)))
    one, other = ball(space, 50.0), ball(space, 50.5)
    for body, kind in ((one, 1), (other, 2)):
        next(iter(body.shapes)).collision_type = kind
    spring = pymunk.DampedSpring(one, other, (0.0, 0.0), (0.0, 0.0), 0.5, 10.0, 0.0)
    space.add(spring)
    calls = [0]

    def move(*_: object) -> None:
        calls[0] += 1
        if calls[0] == 5:
            floor.position = 0.0, -3.0

    def after(own: Callable[..., None]) -> Callable[..., None]:
        return lambda *given: (own(*given), move())[0]

    if by == "velocity_func":
        one.velocity_func = after(pymunk.Body.update_velocity)
    elif by == "position_func":
        one.position_func = after(pymunk.Body.update_position)
    elif by.startswith("joint."):
        setattr(spring, by.removeprefix("joint."), move)
    else:
        space.on_collision(1, 2, **{by: move})
    stepper, heights = ep.EECA(space), list[float]()
    for _ in range(10):
        stepper.step(0.01)
        heights.append(box.position.y)
    assert floor.position == (0.0, -3.0)
    exact = [1.0 - 5.0 * (0.01 * max(k - 4, 0)) ** 2 for k in range(10)]
    assert heights == pytest.approx(exact, abs=1e-12)


def test_bodies_whose_position_functions_push_one_another_are_pushed() -> None:
    space = pymunk.Space()
    pair = [ball(space, 0.0), ball(space, 20.0)]
    for one, other in (pair, pair[::-1]):

        def move(body: pymunk.Body, dt: float, other: pymunk.Body = other) -> None:
            pymunk.Body.update_position(body, dt)
            other.apply_force_at_world_point((0.0, 1.0), other.position)

        one.position_func = move
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    assert [body.velocity.y for body in pair] == pytest.approx([2.0 * DT, 2.0 * DT], abs=1e-14)


def test_a_floor_that_is_moved_while_a_sleeper_is_woken_moves_once() -> None:
    """A step that reads what has woken gathers the floor where it was put; its displacement is not added again."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.2
    floor, box, falling = (pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0))
    box.position, falling.position = (0.0, 1.0), (3.0, 8.0)
    circle = pymunk.Circle(falling, 0.5)
    circle.collision_type = 1
    space.add(floor, pymunk.Segment(floor, (-1.0, 0.0), (1.0, 0.0), 0.5), box, pymunk.Poly.create_box(box, (1.0, 1.0)))
    wall = pymunk.Segment(space.static_body, (2.0, 0.0), (4.0, 0.0), 0.5)
    space.add(falling, circle, wall)
    asleep = []

    def open_trap(*_: object) -> None:
        if not asleep:
            asleep.append(box.is_sleeping)
            floor.position = 0.0, -3.0
            box.velocity = 0.0, 0.0

    space.on_collision(1, 0, post_solve=open_trap)
    stepper = ep.EECA(space)
    for _ in range(200):
        stepper.step(0.01)
    assert asleep == [True]
    assert floor.position == (0.0, -3.0)
    assert box.position == pytest.approx((0.0, -2.0), abs=1e-9)

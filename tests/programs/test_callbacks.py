"""What programs do from within callbacks, as pymunk allows it: removing twice, or in `separate`; post-step calls."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from scenes.scene import add_disk

DT = 1 / 60
Make = Callable[[pymunk.Space], ep.Stepper]
both = pytest.mark.parametrize("make", [ep.Native, ep.EECA])


def meeting() -> tuple[pymunk.Space, pymunk.Body, pymunk.Body]:
    """A disk that flies to one at rest and past it, 1/6 length units before it touches."""
    space = pymunk.Space()
    a = add_disk(space, (0.0, 0.0), 0.1, velocity=(5.0, 0.0))
    b = add_disk(space, (0.35, 0.0), 0.1)
    return space, a, b


def run(stepper: ep.Stepper, count: int) -> None:
    for _ in range(count):
        stepper.step(DT)


@both
@pytest.mark.parametrize("phases", [("begin",), ("begin", "post_solve"), ("pre_solve", "post_solve"), ("separate",)])
def test_a_shape_and_its_body_are_removed_in_callbacks_once_or_twice(make: Make, phases: tuple[str, ...]) -> None:
    space, a, b = meeting()
    called: list[str] = []

    def remove(arbiter: pymunk.Arbiter, space: pymunk.Space, data: str) -> None:
        called.append(data)
        for shape in arbiter.shapes:
            if shape.body is b:
                space.remove(shape, b)

    for phase in phases:
        space.on_collision(**{phase: remove}, data=phase)  # type: ignore[arg-type]
    run(make(space), 30)
    assert called[: len(phases)] == list(phases)
    assert set(space.bodies) == {a}
    assert len(space.shapes) == 1


@both
def test_removal_in_begin_calls_separate_which_removes_the_same_again(make: Make) -> None:
    space, a, b = meeting()
    called: list[str] = []

    def remove(arbiter: pymunk.Arbiter, space: pymunk.Space, data: str) -> None:
        called.append(data)
        space.remove(*b.shapes)

    space.on_collision(begin=remove, data="begin")
    space.on_collision(separate=remove, data="separate")
    run(make(space), 30)
    assert called == ["begin", "separate"]
    assert len(space.shapes) == 1
    assert not set(b.space.shapes) & set(b.shapes)  # type: ignore[union-attr]
    assert a in space.bodies


@both
def test_a_body_with_many_contacts_is_removed_by_each_of_them(make: Make) -> None:
    space = pymunk.Space()
    for k in range(4):
        add_disk(space, (0.15 * k, 0.0), 0.1)
    middle = list(space.bodies)[1]

    def remove(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if middle in (shape.body for shape in arbiter.shapes):
            space.remove(middle, *middle.shapes)

    space.on_collision(begin=remove, pre_solve=remove, post_solve=remove, separate=remove)
    run(make(space), 3)
    assert middle not in space.bodies
    assert len(space.bodies) == len(space.shapes) == 3


@pytest.mark.skipif(not hasattr(pymunk.Space, "_remove"), reason="pymunk 7.0.0 keeps this for its next step")
@both
def test_separate_outside_a_step_may_remove_more(make: Make) -> None:
    space, a, b = meeting()
    space.gravity = (5.0, 0.0)
    touching: list[int] = []
    space.on_collision(
        begin=lambda *_: touching.append(1),
        pre_solve=lambda arbiter, space, data: setattr(arbiter, "process_collision", False),
        separate=lambda arbiter, space, data: space.remove(a, *a.shapes),
    )
    stepper = make(space)
    for _ in range(20):
        if not touching:
            stepper.step(DT)
    assert touching
    space.remove(*b.shapes)
    assert not space.shapes
    run(stepper, 10)
    assert set(space.bodies) == {b}


@both
def test_what_a_callback_adds_flies_from_the_next_step(make: Make) -> None:
    space, _, _ = meeting()
    shots: list[pymunk.Body] = []

    def fire(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if not shots:
            shot = pymunk.Body(0.1, 0.1)
            shot.position, shot.velocity = (0.0, 5.0), (6.0, 0.0)
            shots.append(shot)
            space.add(shot, pymunk.Circle(shot, 0.01))

    space.on_collision(begin=fire)
    stepper = make(space)
    for _ in range(20):
        if not shots:
            stepper.step(DT)
    assert shots[0].position == (0.0, 5.0)
    stepper.step(DT)
    assert shots[0].position.x == pytest.approx(6.0 * DT)


@both
@pytest.mark.parametrize("crowded", [False, True])
@pytest.mark.parametrize("handled", [False, True])
def test_post_step_callbacks_see_velocities_and_may_change_them(make: Make, crowded: bool, handled: bool) -> None:
    space, a, b = meeting()
    b.position = (9.0, 0.0)
    if crowded:
        for k in range(20):
            add_disk(space, (k, 9.0), 0.1)
    if handled:
        space.on_collision(begin=lambda *_: None)
    seen: list[tuple[float, float]] = []

    def jump(space: pymunk.Space, key: pymunk.Body, up: float) -> None:
        seen.append(key.velocity)
        key.velocity += (0.0, up)

    stepper = make(space)
    run(stepper, 2)
    assert space.add_post_step_callback(jump, a, 2.0)
    assert not space.add_post_step_callback(jump, a, 3.0)
    run(stepper, 1)
    assert seen == [(5.0, 0.0)]
    assert a.velocity == (5.0, 2.0)
    run(stepper, 1)
    assert len(seen) == 1
    assert a.position.y == pytest.approx(2.0 * DT)
    assert b.velocity == (0.0, 0.0)


def test_a_post_step_callback_may_ask_for_another() -> None:
    """pymunk raises RuntimeError here, as its dictionary grows while it is walked."""
    space, _a, _ = meeting()
    seen: list[str] = []

    def first(space: pymunk.Space, key: str) -> None:
        seen.append(key)
        space.add_post_step_callback(lambda space, key: seen.append(key), "second")

    space.add_post_step_callback(first, "first")
    stepper = ep.EECA(space)
    run(stepper, 1)
    assert seen == ["first"]
    run(stepper, 2)
    assert seen == ["first", "second"]


@pytest.mark.parametrize("handled", [False, True])
def test_a_post_step_callback_that_raises_comes_after_a_whole_step(handled: bool) -> None:
    space, a, _ = meeting()
    if handled:
        space.on_collision(begin=lambda *_: None)

    def fail(space: pymunk.Space, key: str) -> None:
        raise RuntimeError(key)

    space.add_post_step_callback(fail, "late")
    stepper = ep.EECA(space)
    with pytest.raises(RuntimeError, match="late"):
        stepper.step(DT)
    assert stepper.time == DT
    assert a.position.x == pytest.approx(5.0 * DT)
    assert a.velocity == (5.0, 0.0)
    stepper.step(DT)


def test_a_space_whose_step_is_ours_is_stepped_by_ours() -> None:
    """A program may replace `step` of its space, or of all spaces, by ours: nothing of ours calls it."""

    class Ours(pymunk.Space):
        stepper: ep.EECA | None = None

        def step(self, dt: float) -> None:
            self.stepper = self.stepper or ep.EECA(self)
            self.stepper.step(dt)

    for handled in (False, True):
        space = Ours()
        for k in range(20):
            add_disk(space, (k, 0.0), 0.1, velocity=(1.0, 0.0))
        if handled:
            space.on_collision(begin=lambda *_: None)
        for _ in range(3):
            space.step(DT)
        assert next(iter(space.bodies)).position.x == pytest.approx(3 * DT)
        assert space.current_time_step == DT


def test_gears_of_bodies_that_do_not_turn_do_not_make_nan_of_what_handlers_see() -> None:
    """pymunk's own step divides by the sum of the inverse moments, 0, so that a rehearsal of it gives nan."""
    space = pymunk.Space()
    bodies = [pymunk.Body(1.0, math.inf) for _ in range(2)]
    for i, body in enumerate(bodies):
        body.position, body.velocity = (i * 0.9, 0.0), (-0.5 * i, 0.0)
        space.add(body, pymunk.Circle(body, 0.5))
    space.add(pymunk.GearJoint(*bodies, 0.0, 1.0))
    seen = []

    def kick(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        seen.append(bodies[0].angular_velocity)
        bodies[0].velocity += (0.0, 1.0)

    space.on_collision(post_solve=kick)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(0.01)
    assert len(seen) > 0
    assert math.isnan(seen[0])
    assert bodies[0].velocity.y == pytest.approx(len(seen))
    assert all(math.isfinite(v) for b in bodies for v in (*b.position, *b.velocity, b.angle, b.angular_velocity))


def resting() -> tuple[pymunk.Space, pymunk.Body]:
    """A disk on the floor under gravity, hung from a spring."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    body = add_disk(space, (0.0, 0.1), 0.1)
    space.add(floor, pymunk.DampedSpring(space.static_body, body, (0.0, 2.0), (0.0, 0.0), 1.0, 3.0, 0.0))
    return space, body


@pytest.mark.parametrize("within", [False, True])
@pytest.mark.parametrize(
    "function", ["begin", "pre_solve", "post_solve", "velocity", "position", "joint before", "joint after", "force"]
)
def test_a_step_within_a_step_is_refused_and_nothing_changed(function: str, within: bool) -> None:
    space, body = resting()
    spring = next(iter(space.constraints))
    assert isinstance(spring, pymunk.DampedSpring)
    stepper = ep.EECA(space)
    again = True

    def step(*arguments: object) -> float:
        if again:
            (space if within else stepper).step(DT)
        return 0.0

    if function == "velocity":
        body.velocity_func = step
    elif function == "position":
        body.position_func = step
    elif function == "joint before":
        spring.pre_solve = step
    elif function == "joint after":
        spring.post_solve = step
    elif function == "force":
        spring.force_func = step
    else:
        space.on_collision(**{function: step})

    def place() -> tuple[object, ...]:
        return body.position, body.angle, body.velocity, body.angular_velocity

    before = place()
    with stepper if within else contextlib.nullcontext():
        for _ in range(1 if function == "begin" else 2):  # pymunk begins a contact once
            with pytest.raises(RuntimeError, match=r"from within its own step.*add_post_step_callback"):
                space.step(DT) if within else stepper.step(DT)
            assert place() == before
            assert stepper.time == 0.0
    again = False
    assert stepper.step(DT).time == DT


@pytest.mark.parametrize("function", ["pre_solve", "velocity"])
def test_no_state_is_set_within_a_step(function: str) -> None:
    """pymunk would end the process."""
    space, body = resting()
    stepper = ep.EECA(space)
    stepper.step(DT)
    before, place = stepper.get_state(), (*body.position, body.angle, *body.velocity, body.angular_velocity)

    def back(*_: object) -> None:
        stepper.set_state(before)

    if function == "velocity":
        body.velocity_func = back
    else:
        space.on_collision(pre_solve=back)
    with pytest.raises(RuntimeError, match="from within its own step"):
        stepper.step(DT)
    assert place == (*body.position, body.angle, *body.velocity, body.angular_velocity)


def test_no_step_within_a_step_after_the_function_of_a_spring() -> None:
    space = pymunk.Space()
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    spring = pymunk.DampedSpring(a, b, (0.0, 0.0), (1.0, 0.0), 1.0, 10.0, 0.0)
    spring.force_func = lambda spring, distance: 1.0 - distance
    space.add(a, b, spring)
    stepper = ep.EECA(space)
    a.position_func = lambda body, dt: stepper.step(dt) and None
    with pytest.raises(RuntimeError, match="from within its own step"):
        stepper.step(DT)


def test_another_space_may_be_stepped_within_a_step() -> None:
    (space, _), (other, _) = resting(), resting()
    second = ep.EECA(other)
    space.on_collision(begin=lambda *_: second.step(DT) and None)
    ep.EECA(space).step(DT)
    assert second.time == DT


def test_a_post_step_callback_may_step_again() -> None:
    space, _, _ = meeting()
    stepper = ep.EECA(space)
    space.add_post_step_callback(lambda *_: stepper.step(DT), 1)
    stepper.step(DT)
    assert stepper.time == 2 * DT


@pytest.mark.parametrize("hooked", [False, True])
def test_what_a_post_step_callback_raises_comes_when_the_step_has_been_taken(hooked: bool) -> None:
    (space, body, _), (_, twin, _) = runs = meeting(), meeting()
    steppers = [ep.EECA(run[0]) for run in runs]
    if hooked:
        for one in runs:
            one[0].on_collision(begin=lambda *_: None)

    def fail(*arguments: object) -> None:
        raise KeyError

    space.add_post_step_callback(fail, 1)
    with pytest.raises(KeyError):
        steppers[0].step(DT)
    steppers[1].step(DT)
    assert steppers[0].time == DT
    for _ in range(6):
        assert (body.position, body.velocity) == (twin.position, twin.velocity)
        assert [one.step(DT).time for one in steppers] == [steppers[0].time] * 2


@pytest.mark.parametrize("sync", [True, False])
def test_functions_read_the_time_step_that_they_are_in(sync: bool) -> None:
    found = []
    for make in (ep.Native, lambda space: ep.EECA(space, sync=sync)):
        space, a, b = meeting()
        read: dict[str, list[float]] = {}

        def note(name: str, space: pymunk.Space = space, read: dict[str, list[float]] = read) -> None:
            read.setdefault(name, []).append(space.current_time_step)

        def velocity(body: pymunk.Body, gravity: pymunk.Vec2d, damping: float, dt: float, note=note) -> None:  # type: ignore[no-untyped-def]
            note("velocity")
            pymunk.Body.update_velocity(body, gravity, damping, dt)

        def position(body: pymunk.Body, dt: float, note=note) -> None:  # type: ignore[no-untyped-def]
            note("position")
            pymunk.Body.update_position(body, dt)

        a.velocity_func, a.position_func = velocity, position
        spring = pymunk.DampedSpring(a, b, (0.0, 0.0), (0.0, 0.0), 1.0, 1.0, 0.0)
        spring.pre_solve = lambda *_, note=note: note("before")
        spring.post_solve = lambda *_, note=note: note("after")
        space.add(spring)
        stepper = make(space)
        for dt in (0.01, 0.02, 0.005):
            stepper.step(dt)
        found.append(read)
    assert found[1] == found[0]
    assert set(found[0]) == {"velocity", "position", "before", "after"}


def test_velocity_functions_get_the_gravity_that_pre_solve_has_set_in_this_step() -> None:
    def gravities(stepped: bool) -> list[float]:
        space, got = pymunk.Space(), list[float]()
        space.gravity = (0.0, -1.0)
        a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
        b.position = (0.0, 3.0)
        joint = pymunk.PinJoint(a, b)

        def pull(joint: pymunk.Constraint, space: pymunk.Space) -> None:
            space.gravity = (0.0, 2.0 * space.gravity.y)

        def note(body: pymunk.Body, gravity: pymunk.Vec2d, damping: float, dt: float) -> None:
            got.append(gravity[1])
            pymunk.Body.update_velocity(body, gravity, damping, dt)

        joint.pre_solve, a.velocity_func = pull, note
        space.add(a, b, joint)
        step = ep.EECA(space).step if stepped else space.step
        for _ in range(4):
            step(0.01)
        return got

    assert gravities(True) == gravities(False) == [-2.0, -4.0, -8.0, -16.0]


FUNCTIONS = ["velocity_func", "position_func", "force_func", "pre_solve", "post_solve"]


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize("handled", [False, True])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_functions_add_and_remove_waits_for_the_end_of_the_step(name: str, handled: bool, sync: bool) -> None:
    """Within the step the space keeps its bodies, so that no other body gets what belongs to one that is gone."""
    space, a, b = meeting()
    c, new = add_disk(space, (0.0, 3.0), 0.1, velocity=(1.0, 0.0)), pymunk.Body(1.0, 1.0)
    new.velocity = (2.0, 0.0)
    spring = pymunk.DampedSpring(a, c, (0.0, 0.0), (0.0, 0.0), 3.0, 0.0, 0.0)
    space.add(spring)
    if handled:
        space.on_collision(begin=lambda *_: None)
    seen = []

    def change(*arguments: object) -> float:
        if not seen:
            space.remove(*b.shapes, b)
            space.add(new)
            seen.append((b in space.bodies, new in space.bodies))
        if isinstance(arguments[0], pymunk.Body):
            getattr(pymunk.Body, "update_" + name[:8])(*arguments)
        return 0.0

    setattr(a if name in FUNCTIONS[:2] else spring, name, change)
    stepper = ep.EECA(space, sync=sync)
    stepper.step(DT)
    assert seen == [(True, False)]
    assert set(space.bodies) == {a, c, new}
    stepper.step(DT)
    assert (space.static_body.position, space.static_body.velocity) == ((0.0, 0.0), (0.0, 0.0))
    assert [body.position.x for body in (a, c, new)] == pytest.approx([10.0 * DT, 2.0 * DT, 2.0 * DT], rel=1e-12)

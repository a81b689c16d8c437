"""What programs do from within callbacks, as pymunk allows it: removing twice, or in `separate`; post-step calls."""

from __future__ import annotations

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
    assert not b.space.shapes & b.shapes  # type: ignore[union-attr]
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

"""What handlers of pymunk 6 return means under ours what it means there; handlers of pymunk 7 return nothing."""

from __future__ import annotations

import functools
import math
import warnings
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.private import spaces as private
from eeca_pymunk.space.private import versions as private_versions
from scenes.scene import add_disk

DT = 1 / 60
Make = Callable[[pymunk.Space], ep.Stepper]
both = pytest.mark.parametrize("make", [ep.Native, ep.EECA])
answering = pytest.mark.skipif(not private_versions.BY_RETURN, reason="handlers of pymunk 7 return nothing")


def thrown_at_a_wall() -> tuple[pymunk.Space, pymunk.Body]:
    """A disk that flies to a thick wall, reaches it in its seventh step, and would be past it after 14."""
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 0.0), 0.1, velocity=(4.0, 0.0))
    wall = pymunk.Segment(space.static_body, (0.63, -1.0), (0.63, 1.0), 0.1)
    wall.elasticity = 1.0
    space.add(wall)
    for shape in space.shapes:
        shape.collision_type = 1
    return space, disk


def run(stepper: ep.Stepper, count: int) -> None:
    for _ in range(count):
        stepper.step(DT)


@answering
@both
def test_a_begin_that_returns_false_rejects_until_the_shapes_separate(make: Make) -> None:
    space, disk = thrown_at_a_wall()
    calls: list[str] = []
    answers = iter([False, True])

    def begin(*_: object) -> bool:
        calls.append("begin")
        return next(answers)

    handler = space.add_collision_handler(1, 1)  # type: ignore[attr-defined]
    handler.begin = begin
    handler.pre_solve = lambda *_: calls.append("pre_solve") or True
    handler.separate = lambda *_: calls.append("separate")
    stepper = make(space)
    run(stepper, 30)
    assert calls == ["begin", "separate"]
    assert disk.position.x == pytest.approx(30 * DT * 4.0)
    disk.velocity = (-4.0, 0.0)  # back to the wall, where it is taken this time
    run(stepper, 30)
    assert calls[2:4] == ["begin", "pre_solve"]
    assert disk.velocity.x == pytest.approx(4.0)


@answering
@both
@pytest.mark.parametrize("kind", ["pair", "wildcard", "default"])
def test_a_pre_solve_that_returns_false_rejects_for_its_step(make: Make, kind: str) -> None:
    """A wall that lets a disk in, and throws it out again before it is through."""
    space, disk = thrown_at_a_wall()
    handler = {
        "pair": lambda: space.add_collision_handler(1, 1),  # type: ignore[attr-defined]
        "wildcard": lambda: space.add_wildcard_collision_handler(1),  # type: ignore[attr-defined]
        "default": lambda: space.add_default_collision_handler(),  # type: ignore[attr-defined]
    }[kind]()
    handler.pre_solve = lambda arbiter, space, data: disk.position.x > 0.5
    stepper = make(space)
    farthest = 0.0
    for _ in range(30):
        stepper.step(DT)
        farthest = max(farthest, disk.position.x)
    assert 0.44 < farthest < 0.7  # it touches at .43
    assert disk.velocity.x < 0.0


@answering
def test_an_answer_that_is_no_bool_is_a_warning_and_the_collision_takes_place() -> None:
    space, disk = thrown_at_a_wall()
    space.add_collision_handler(1, 1).begin = lambda *_: None  # type: ignore[attr-defined]
    with pytest.warns(UserWarning, match="should return a bool") as told:
        run(ep.EECA(space), 20)
    assert told[0].filename == __file__
    assert disk.velocity.x == pytest.approx(-4.0)


@answering
def test_a_function_that_has_no_code_is_called_and_answers() -> None:
    space, disk = thrown_at_a_wall()
    space.add_collision_handler(1, 1).begin = functools.partial(lambda answer, *_: answer, False)  # type: ignore[attr-defined]
    stepper = ep.EECA(space)
    run(stepper, 30)
    assert disk.position.x == pytest.approx(2.0)


@answering
def test_what_a_handler_raises_is_raised_and_the_step_is_undone() -> None:
    space, disk = thrown_at_a_wall()

    def fail(*_: object) -> bool:
        raise KeyError("from a handler")

    handler = space.add_collision_handler(1, 1)  # type: ignore[attr-defined]
    stepper = ep.EECA(space)
    run(stepper, 3)
    handler.begin = fail  # seen, though the handler itself is no other
    with pytest.raises(KeyError, match="from a handler"):
        run(stepper, 10)
    assert disk.position.x == pytest.approx(6 * DT * 4.0)  # the seventh step is the one that meets the wall


def test_arbiters_tell_whether_a_handler_has_rejected_the_collision() -> None:
    for phase in ("begin", "pre_solve", "post_solve"):
        space, disk = thrown_at_a_wall()

        def reject(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
            arbiter.process_collision = False

        if phase != "post_solve":
            space.on_collision(1, 1, **{phase: reject})  # type: ignore[arg-type]
        disk.position = (0.45, 0.0)
        space.step(DT)
        (arbiter,) = private.arbiters(space)
        assert private_versions.processed(arbiter) == (phase == "post_solve")
        # A pair that touches no more is not rejected: nobody was asked.
        disk.position, disk.velocity = (-5.0, 0.0), (0.0, 0.0)
        space.step(DT)
        assert [private_versions.processed(one) for one in private.arbiters(space) if private_versions.BY_RETURN] in (
            [],
            [True],
        )


def test_answers_of_begin_and_pre_solve_are_returned() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for found in (True, False):
            assert private_versions.to_return(found, print) is (found if private_versions.BY_RETURN else None)
        assert private_versions.to_return(math.pi, print) is (True if private_versions.BY_RETURN else None)

"""Every private name of pymunk does what this package takes it to do."""

from __future__ import annotations

import math

import pymunk
import pytest

from eeca_pymunk.space import private
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
    handler._begin = lambda *_: other.append(1)
    for body in space.bodies:
        body.position *= 0.01
    space.step(0.001)
    assert other == [1]


def test_arbiters() -> None:
    space, bodies = meeting()
    assert private.arbiters(space) == []
    space.step(0.001)
    (arbiter,) = private.arbiters(space)
    assert {shape.body for shape in arbiter.shapes} == set(bodies)


@pytest.mark.parametrize("kind", ["velocity", "position"])
def test_functions_of_bodies(kind: str) -> None:
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
def test_replaced_functions_are_called_in_the_place_of_the_bodys_own(kind: str) -> None:
    space, (body, _) = meeting()
    calls: list[str] = []
    setattr(body, f"{kind}_func", lambda *_: calls.append("own"))
    own = getattr(private, f"{kind}_function")(body)
    private.replace_functions(body, **{"velocity": None, "position": None, kind: lambda *_: calls.append("other")})
    space.step(0.001)
    private.replace_functions(body, **{"velocity": None, "position": None, kind: own})
    space.step(0.001)
    assert calls == ["other", "own"]


@pytest.mark.parametrize("threaded", [False, True])
def test_step_alone_and_finish_step_are_a_step(threaded: bool) -> None:
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
            private.step_alone(space, 0.001)
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

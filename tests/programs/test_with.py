"""`with ep.EECA(space):` for programs whose call of `space.step` cannot be changed."""

from __future__ import annotations

import copy

import pymunk
import pytest

import eeca_pymunk as ep

from ..steppers import one_disk, state

DT = 1 / 60


def game(space: pymunk.Space, count: int) -> None:
    """Somebody else's main loop."""
    for _ in range(count):
        space.step(DT)


def test_within_the_space_steps_by_ours_and_afterwards_by_its_own() -> None:
    spaces = [one_disk(gravity=9.81)[0] for _ in range(2)]
    other = one_disk(gravity=9.81)[0]
    with ep.EECA(spaces[0]) as stepper:
        game(spaces[0], 60)
        assert stepper.time == pytest.approx(1.0)
        game(other, 1)  # another space is as ever
        assert "step" not in vars(other)
    direct = ep.EECA(spaces[1])
    for _ in range(60):
        direct.step(DT)
    assert state(spaces[0]) == state(spaces[1])
    game(spaces[0], 1)
    spaces[1].step(DT)
    assert stepper.time == pytest.approx(1.0)
    assert state(spaces[0]) == state(spaces[1])


def test_an_error_within_leaves_the_space_its_own_step() -> None:
    space, _ = one_disk()
    with pytest.raises(RuntimeError), ep.EECA(space):
        raise RuntimeError
    assert "step" not in vars(space)


def test_one_after_the_other_and_not_within() -> None:
    space, _ = one_disk()
    with ep.EECA(space), pytest.raises(ValueError, match="step of its own"), ep.EECA(space, ep.Midstep()):
        pass
    with ep.EECA(space, ep.Midstep()) as stepper:
        game(space, 2)
    assert stepper.time == pytest.approx(2 * DT)


def test_a_copy_made_within_has_a_stepper_of_its_own() -> None:
    space, body = one_disk()
    with ep.EECA(space) as stepper:
        game(space, 3)
        twin = copy.deepcopy(space)
        game(twin, 3)
        assert stepper.time == pytest.approx(3 * DT)
        assert next(iter(twin.bodies)).position != body.position
        game(space, 3)
    assert state(twin) == state(space)

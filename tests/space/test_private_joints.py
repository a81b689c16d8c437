"""Every private name of pymunk's constraints, and of its sleepers, does what this package takes it to do."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

from eeca_pymunk.space.private import batch as private_batch
from eeca_pymunk.space.private import joints as private_joints
from eeca_pymunk.space.private import sleep as private_sleep
from eeca_pymunk.space.private import spaces as private
from eeca_pymunk.space.private import versions as private_versions

DT = 0.01


def hanging() -> tuple[pymunk.Space, pymunk.Body, pymunk.PinJoint]:
    """A weight on a pin."""
    space, body = pymunk.Space(), pymunk.Body(2.0, 1.0)
    space.gravity = (0.0, -10.0)
    body.position = (0.0, -1.0)
    pin = pymunk.PinJoint(space.static_body, body)
    space.add(body, pin)
    return space, body, pin


def noting(calls: list[str], name: str) -> Callable[..., None]:
    return lambda *_: calls.append(name)


def test_bounds_of_a_constraint() -> None:
    _, _, pin = hanging()
    pin.max_force, pin.error_bias, pin.max_bias = 3.0, 0.25, 0.5
    assert private_joints.bounds(pin) == (3.0, 0.25, 0.5)


def test_replaced_functions_of_a_constraint_are_called_in_the_place_of_its_own() -> None:
    space, _, pin = hanging()
    calls: list[str] = []
    pin.pre_solve, pin.post_solve = noting(calls, "own before"), noting(calls, "own after")
    before, after = pin.pre_solve, pin.post_solve
    private_joints.replace_functions(pin, noting(calls, "before"), noting(calls, "after"))
    space.step(DT)
    private_joints.replace_functions(pin, before, after)
    space.step(DT)
    assert calls == ["before", "after", "own before", "own after"]


def test_silent_constraints_call_nobody_and_go_on_holding() -> None:
    space, body, pin = hanging()
    calls: list[str] = []
    pin.pre_solve, pin.post_solve = noting(calls, "before"), noting(calls, "after")
    with private_joints.silent([pin]):
        space.step(DT)
    assert calls == []
    assert body.velocity.length < 1e-9
    space.step(DT)
    assert calls == ["before", "after"]


def test_functions_are_called_again_after_an_error_among_silent_constraints() -> None:
    space, _, pin = hanging()
    calls: list[str] = []
    pin.pre_solve = noting(calls, "before")
    with pytest.raises(KeyError), private_joints.silent([pin]):
        raise KeyError
    space.step(DT)
    assert calls == ["before"]


def test_constraints_with_cleared_max_forces_exert_none_and_lose_their_impulses() -> None:
    space, body, pin = hanging()
    pin.max_force = 50.0
    space.step(DT)
    assert pin.impulse == pytest.approx(0.2)
    held = private_joints.clear_max_forces([pin])
    assert pin.max_force == 0.0
    space.step(DT)
    assert pin.impulse == 0.0
    private_joints.restore_max_forces(held)
    assert body.velocity.y == pytest.approx(-10.0 * DT)
    assert pin.max_force == 50.0


@pytest.mark.parametrize("rotary", [False, True])
def test_law_of_a_spring_is_its_own_function_and_another_may_stand_in(rotary: bool) -> None:
    space, body, pin = hanging()
    space.remove(pin)
    space.gravity = (0.0, 0.0)
    ground = space.static_body
    spring: pymunk.DampedSpring | pymunk.DampedRotarySpring
    spring = (
        pymunk.DampedRotarySpring(ground, body, 0.0, 1.0, 0.0)
        if rotary
        else pymunk.DampedSpring(ground, body, (0, 0), (0, 0), 1.0, 1.0, 0.0)
    )
    space.add(spring)
    assert private_joints.law_of(spring) in (None, getattr(type(spring), "spring_torque" if rotary else "spring_force"))

    def push(spring: object, x: float) -> float:
        return 4.0

    def none(spring: object, x: float) -> float:
        return 0.0

    if isinstance(spring, pymunk.DampedSpring):
        spring.force_func = push
    else:
        spring.torque_func = push
    assert private_joints.law_of(spring) is push
    with private_joints.with_laws([spring], [none]):
        space.step(DT)
    assert (body.velocity.length, body.angular_velocity) == (0.0, 0.0)
    assert private_joints.law_of(spring) is push
    space.step(DT)
    assert abs(body.angular_velocity if rotary else body.velocity.y) == pytest.approx(
        4.0 * DT / (1.0 if rotary else 2.0)
    )


def resting() -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Two disks on a floor, far from each other."""
    space, bodies = pymunk.Space(), []
    space.gravity = (0.0, -10.0)
    space.add(pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0))
    for x in (-3.0, 3.0):
        body = pymunk.Body(1.0, 1.0)
        body.position = (x, 0.45)
        space.add(body, pymunk.Circle(body, 0.5))
        bodies.append(body)
    space.step(DT)
    return space, bodies


def test_ordered_finds_who_falls_asleep_or_wakes_comes_or_goes() -> None:
    space, bodies = resting()
    space.sleep_time_threshold = 100.0

    def ordered() -> Callable[[], bool]:
        found = pymunk.batch.Buffer()
        pymunk.batch.get_space_bodies(space, pymunk.batch.BodyFields.BODY_ID, found)
        return private_batch.ordered(space, np.frombuffer(found.int_buf(), np.int64).copy())

    def bring() -> None:
        space.add(pymunk.Body(1.0, 1.0))

    def exchange() -> None:
        space.remove(list(space.bodies)[-1])
        bring()

    for change in (bodies[0].sleep, bodies[0].activate, bodies[1].sleep, bodies[0].sleep, bodies[1].activate, bring,
                   exchange):  # fmt: skip
        unchanged = ordered()
        assert unchanged()
        change()
        assert not unchanged()
        assert not unchanged()


@pytest.mark.parametrize("change", [("position", (0.0, 1e-9)), ("angle", 1e-9), ("velocity", (0.0, 1e-300))])
def test_unmoved(change: tuple[str, object]) -> None:
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    still = private_sleep.unmoved([lift])
    assert still()
    setattr(lift, *change)
    assert not still()
    setattr(lift, change[0], 0.0 if change[0] == "angle" else (0.0, 0.0))
    assert still()
    lift.angular_velocity = -1.0
    assert not still()


def test_touching_are_the_pairs_of_the_last_step_and_of_bodies_that_woke() -> None:
    space = pymunk.Space()
    space.sleep_time_threshold = 10.0
    left, right = bodies = [pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)]
    right.position = 0.99, 0.0
    space.add(*bodies, *(pymunk.Circle(body, 0.5) for body in bodies))

    def touching() -> list[frozenset[int]]:
        return [frozenset(pair) for pair in private_batch.touching(space).tolist()]

    both = [frozenset(body.id for body in bodies)]
    assert touching() == []
    space.step(DT)
    assert touching() == both
    left.sleep()
    right.sleep_with_group(left)
    assert touching() == []
    right.activate()
    assert touching() == both
    left.position = -3.0, 0.0
    space.step(DT)
    assert touching() == []


def test_while_locked_nothing_comes_or_goes() -> None:
    space, bodies = resting()
    with private.locked(space):
        space.add(pymunk.Body(1.0, 1.0))
        space.remove(bodies[0])
        assert len(space.bodies) == 2
    private.finish_step(space)
    assert len(space.bodies) == 2
    assert bodies[0] not in space.bodies
    with pytest.raises(KeyError), private.locked(space):
        raise KeyError
    space.add(pymunk.Body(1.0, 1.0))
    assert len(space.bodies) == 3


@pytest.mark.parametrize("name", ["velocity_func", "position_func"])
def test_a_function_that_is_pymunks_again_is_forgotten(name: str) -> None:
    body = pymunk.Body(1.0, math.inf)
    read = private.velocity_function if name == "velocity_func" else private.position_function
    setattr(body, f"_{name}", private_versions.DEFAULTS[name])  # as pymunk before 7.3 leaves it
    private_versions.forget_function(body, name, private_versions.DEFAULTS[name])
    assert read(body) is None

    def own(*_: object) -> None: ...

    setattr(body, f"_{name}", own)
    private_versions.forget_function(body, name, own)
    assert read(body) is own


def test_centres_and_kinds_of_bodies_that_joints_hold() -> None:
    body = pymunk.Body(2.0, 1.0)
    body.center_of_gravity = (0.25, 1.5)
    kinds = {pymunk.Body.DYNAMIC: 0.0, pymunk.Body.KINEMATIC: 1.0, pymunk.Body.STATIC: -1.0}
    for kind, number in kinds.items():
        body.body_type = kind
        assert private_joints.centre_and_kind(body) == (0.25, 1.5, number)


def test_bodies_that_move_on() -> None:
    body = pymunk.Body(2.0, 1.0)
    body.velocity, body.angular_velocity = (3.0, 4.0), 5.0
    kept = private_joints.motions(private.pointers([body]))
    body.velocity, body.angular_velocity = (0.0, 1.0), 2.0
    private_joints.restore_motions(kept)
    assert (body.velocity, body.angular_velocity) == ((3.0, 4.0), 5.0)


def test_constraints_of_bodies_that_are_awake() -> None:
    space, bodies = pymunk.Space(), [pymunk.Body(2.0, 1.0) for _ in range(4)]
    pins = [pymunk.PinJoint(bodies[0], bodies[1], (1, 0)), pymunk.PinJoint(bodies[2], bodies[3], (1, 0))]
    space.sleep_time_threshold = 1.0
    space.add(*bodies, *pins)
    bodies[0].sleep()
    bodies[1].sleep_with_group(bodies[0])
    assert private_joints.awake(pins) == pins[1:]
    assert bodies[0].is_sleeping
    # pymunk cannot free constraints of bodies that sleep.
    bodies[0].activate()
    space.remove(*pins)

"""Rollouts are what the stepper does from the same states, bit by bit, for any number of threads."""

from __future__ import annotations

import threading

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk import rollouts
from eeca_pymunk.compiled.kernels import prepare
from tests.bitwise import CASES, CLOSURES
from tests.test_states import moving, poses

SLOW = not prepare().entries  # kernels as plain Python
NAMES = ("pool break", "motor and spring") if SLOW else sorted(set(CASES) - {"handlers"})
STEPS, K = (2, 2) if SLOW else (12, 4)


def starts(name: str, closure: str) -> tuple[ep.EECA, np.ndarray, float]:
    """A stepper, and (K, b, 6) states of its space."""
    space, dt = CASES[name][0]()
    stepper = ep.EECA(space, CLOSURES[closure]())
    states = [poses(space)]
    while len(states) < K:
        stepper.run(5, dt)
        states.append(poses(space))
    return stepper, np.array(states), dt


@pytest.mark.parametrize("closure", sorted(CLOSURES))
@pytest.mark.parametrize("name", NAMES)
def test_a_rollout_is_its_steps(name: str, closure: str) -> None:
    stepper, states, dt = starts(name, closure)
    before = stepper.get_state()
    found = [ep.rollout(stepper, states, STEPS, dt, threads=n) for n in (1, 2, 3)]
    np.testing.assert_array_equal(stepper.get_state(), before)  # the space is left as it is
    space = stepper.space
    for k, state in enumerate(states):
        stepper.set_state(state)
        for t in range(STEPS):
            stepper.step(dt)
            np.testing.assert_array_equal(found[0][k, t], poses(space))
    for other in found[1:]:
        np.testing.assert_array_equal(found[0], other)


def gas(speeds: float = 1.0) -> tuple[ep.EECA, list[pymunk.Body]]:
    space = pymunk.Space()
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    for i, corner in enumerate(corners):
        wall = pymunk.Segment(space.static_body, corner, corners[(i + 1) % 4], 0.0)
        wall.elasticity = 1.0
        space.add(wall)
    random = np.random.default_rng(4)
    for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.0, 0.0), (-0.5, 0.5), (0.5, 0.5)):
        body = pymunk.Body(1.0, 1.0)
        body.position, body.velocity = (x, y), tuple(speeds * random.normal(size=2))
        ball = pymunk.Circle(body, 0.15)
        ball.elasticity = 1.0
        space.add(body, ball)
    return ep.EECA(space), moving(space)


def test_frames_are_kept_at_a_coarse_rate_and_energy_stays() -> None:
    stepper, _ = gas()
    states = np.repeat(poses(stepper.space)[None], 6, axis=0)
    states[:, :, 3:5] *= np.linspace(0.5, 2.0, 6)[:, None, None]
    fine = ep.rollout(stepper, states, 60, 1 / 60)
    np.testing.assert_array_equal(ep.rollout(stepper, states, 62, 1 / 60, every=20), fine[:, 19::20])
    energy = 0.5 * (fine[..., 3:5] ** 2).sum(axis=(2, 3))
    start = 0.5 * (states[..., 3:5] ** 2).sum(axis=(1, 2))
    np.testing.assert_allclose(energy, np.repeat(start[:, None], 60, axis=1), rtol=1e-13)


def test_all_that_is_known() -> None:
    stepper, _ = gas()
    start = poses(stepper.space)
    states = np.stack([start, start * [1, 1, 1, 2, 2, 1]])
    known = ep.rollout(stepper, states, 120, 1 / 60, every=30, full=True)
    assert (known.unmet == 0).all()
    assert known.ledger.shape == (2, 4, 6)
    assert np.abs(known.ledger).max() < 1e-13  # an elastic gas
    for k, state in enumerate(states):
        stepper.set_state(state)
        recording = ep.record(stepper, 2.0, 1 / 60, every=30)
        events = known.events_of(k)
        assert len(events) > 5
        for name in ("time", "bodies", "point", "normal", "impulse", "friction"):
            np.testing.assert_array_equal(getattr(events, name), getattr(recording.events, name))
        np.testing.assert_array_equal(known.frames[k, :, :, :2], recording.position[1:])
    assert known.first.tolist() == [0, len(known.events_of(0)), len(known.events)]


def test_controls_are_forces_held_over_the_steps_up_to_each_frame() -> None:
    stepper, bodies = gas()
    states = poses(stepper.space)[None].repeat(2, axis=0)
    controls = np.random.default_rng(1).normal(size=(2, 5, 5, 3))
    found = ep.rollout(stepper, states, 20, 1 / 60, every=4, controls=controls)
    for k in range(2):
        stepper.set_state(states[k])
        for t in range(5):
            for _ in range(4):
                for body, (fx, fy, torque) in zip(bodies, controls[k, t].tolist(), strict=True):
                    body.force, body.torque = (fx, fy), torque
                stepper.step(1 / 60)
            np.testing.assert_array_equal(found[k, t], poses(stepper.space))


def test_certified_rollouts_have_the_controls_that_they_had() -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    space.add(body, pymunk.Circle(body, 1.0))
    stepper, states, controls = ep.EECA(space), np.zeros((2, 1, 6)), np.ones((2, 5, 1, 3))
    driven = ep.rollout(stepper, states, 5, 0.1, controls=controls, full=True)
    with pytest.raises(ValueError, match="had controls"):
        ep.certify(stepper, driven)
    assert ep.certify(stepper, driven, controls=controls).max() < 1e-14
    free = ep.rollout(stepper, states, 5, 0.1, full=True)
    with pytest.raises(ValueError, match="no controls"):
        ep.certify(stepper, free, controls=controls)


def test_copies_follow_edits_of_the_space() -> None:
    stepper, bodies = gas()
    states = poses(stepper.space)[None]
    first = ep.rollout(stepper, states, 30, 1 / 60)
    stepper.space.gravity = (0.0, -5.0)
    second = ep.rollout(stepper, states, 30, 1 / 60)
    motor = pymunk.SimpleMotor(stepper.space.static_body, bodies[0], 1.0)
    stepper.space.add(motor)
    third = ep.rollout(stepper, states, 30, 1 / 60)
    motor.rate = 2.0
    fourth = ep.rollout(stepper, states, 30, 1 / 60)
    for one, other in ((first, second), (second, third), (third, fourth)):
        assert (one != other).any()
    stepper.set_state(states[0])
    stepper.run(30, 1 / 60)
    np.testing.assert_array_equal(fourth[0, -1], poses(stepper.space))


def slow_down(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
    arbiter.restitution = 0.5


def test_functions_are_called_on_a_copy() -> None:
    stepper, _ = gas()
    stepper.space.on_collision(pre_solve=slow_down)
    states = poses(stepper.space)[None]
    found = ep.rollout(stepper, states, 30, 1 / 60, full=True)
    np.testing.assert_array_equal(poses(stepper.space), states[0])
    assert found.ledger[0, -1, 2] > 0.1  # restitution
    stepper.set_state(states[0])
    stepper.run(30, 1 / 60)
    np.testing.assert_array_equal(found.frames[0, -1], poses(stepper.space))
    stepper.space.on_collision(pre_solve=lambda *_: None)
    with pytest.raises(ep.UnsupportedFeature, match="give functions that stand in a module"):
        ep.rollout(stepper, states, 30, 1 / 60)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_space_is_held_by_one_thread_until_all_its_rollouts_are_computed(
    compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    stepper, bodies = gas()
    if not compiled:
        bodies[0].center_of_gravity = (0.05, 0.0)  # the rollouts are a Python loop on the space itself
    states = poses(stepper.space)[None].repeat(3, axis=0)
    assert stepper.compiles() == compiled
    kept, told, caller = stepper.get_state(), [], threading.current_thread()
    expected = ep.rollout(stepper, states, 3, 1 / 60, threads=1)

    def come() -> None:
        for call in (
            lambda: ep.rollout(stepper, states, 3, 1 / 60), lambda: stepper.step(1 / 60),
            lambda: stepper.run(2, 1 / 60), stepper.get_state, lambda: stepper.set_state(kept),
        ):  # fmt: skip
            with pytest.raises(RuntimeError, match=r"rollout.*while another thread"):
                call()
            told.append(call)

    class Bar(rollouts.tqdm):  # type: ignore[type-arg]
        def update(self, n: float | None = 1) -> bool | None:  # in between
            if threading.current_thread() is caller:
                other = threading.Thread(target=come)
                other.start()
                other.join()
            return super().update(n)

    monkeypatch.setattr(rollouts, "tqdm", Bar)
    found = ep.rollout(stepper, states, 3, 1 / 60, threads=1)
    assert len(told) == (5 if compiled else 5 * len(states))  # compiled: one call for all three
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(stepper.get_state(), kept)
    stepper.step(1 / 60)  # it is free again


def test_bad_arguments_are_named() -> None:
    stepper, _ = gas()
    good = poses(stepper.space)[None]
    before = stepper.get_state()
    bad = good.copy()
    bad[0, 2, 1] = np.nan
    for arguments, said in (
        ({"states": good[0], "steps": 1, "dt": 0.1}, r"give \(K, 5, 6\)"),
        ({"states": bad, "steps": 1, "dt": 0.1}, r"states\[\(0, 2, 1\)\] is nan"),
        ({"states": good, "steps": 0, "dt": 0.1}, "give numbers > 0"),
        ({"states": good, "steps": 1, "dt": 0.0}, "give numbers > 0"),
        ({"states": good, "steps": 1, "dt": 0.1, "every": 2}, "every <= steps"),
        ({"states": good, "steps": 2, "dt": 0.1, "controls": np.zeros((1, 2, 5))}, r"give \(1, 2, 5, 3\)"),
        ({"states": good, "steps": 2, "dt": 0.1, "threads": 0}, "threads = 0: give a whole number >= 1"),
        ({"states": good, "steps": 2, "dt": 0.1, "threads": -1}, "threads = -1"),
        ({"states": good, "steps": 2, "dt": 0.1, "every": -1}, "every = -1"),
        ({"states": 1e200 * good, "steps": 2, "dt": 0.1}, "rollout 0, after 0 steps"),
    ):
        with pytest.raises(ValueError, match=said):
            ep.rollout(stepper, **arguments)  # type: ignore[call-overload]
        np.testing.assert_array_equal(stepper.get_state(), before)
    for name in ("steps", "every", "threads"):
        with pytest.raises(TypeError, match=rf"{name} = 1\.5: give a whole number"):
            ep.rollout(stepper, **{"states": good, "steps": 2, "dt": 0.1, name: 1.5})  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="give an EECA"):
        ep.rollout(ep.Native(stepper.space), good, 1, 0.1)  # type: ignore[call-overload]
    assert ep.rollout(stepper, good[:0], 3, 0.1).shape == (0, 3, 5, 6)


def film(case: int) -> np.ndarray:
    """For workers of processes: 20 rollouts."""
    stepper, _ = gas()
    states = poses(stepper.space)[None].repeat(20, axis=0)
    states[:, :, 3:5] += np.random.default_rng(case).normal(size=(20, 5, 2))
    return ep.rollout(stepper, states, 30, 1 / 60, every=30, threads=1)

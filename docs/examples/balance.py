"""A pole on a cart as an environment of gymnasium: with save and restore, and as a vector of copies on threads.

pip install gymnasium
python docs/examples/balance.py
"""

from __future__ import annotations

import math
import time
from typing import Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt
import pymunk
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

import eeca_pymunk as ep

DT = 1 / 50  # s
PUSH = 10.0  # N at action 1
TRACK, LEAN = 2.4, 0.2  # m and rad at which an episode ends
LONGEST = 500  # steps of an episode

Observation = npt.NDArray[np.float32]
State = npt.NDArray[np.float64]
OBSERVATIONS = gymnasium.spaces.Box(-np.inf, np.inf, (4,), np.float32)
ACTIONS = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)


def cart_and_pole() -> tuple[pymunk.Space, pymunk.Body, pymunk.Body]:
    """A cart of 1 kg on a track, and a pole of .1 kg and 1 m on it."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    cart, pole = pymunk.Body(1.0, math.inf), pymunk.Body(0.1, 0.1 / 12.0)
    pole.position = (0.0, 0.5)
    space.add(cart, pole)
    space.add(pymunk.GrooveJoint(space.static_body, cart, (-100.0, 0.0), (100.0, 0.0), (0.0, 0.0)))
    space.add(pymunk.PivotJoint(cart, pole, (0.0, 0.0), (0.0, -0.5)))
    return space, cart, pole


def states_at(start: npt.NDArray[np.float64]) -> State:
    """(K, 2, 6) poses and velocities of cart and pole from (K, 4): place, angle, and their rates."""
    x, angle, v, spin = start.T
    c, s = 0.5 * np.cos(angle), -0.5 * np.sin(angle)
    zero = np.zeros_like(x)
    cart = np.stack((x, zero, zero, v, zero, zero), axis=-1)
    pole = np.stack((x + s, c, angle, v - spin * c, spin * s, spin), axis=-1)
    return np.stack((cart, pole), axis=1)


def observed(states: State) -> Observation:
    """(K, 4) place, angle, and their rates."""
    return states[:, (0, 1, 0, 1), (0, 2, 3, 5)].astype(np.float32)


def fallen(seen: Observation) -> npt.NDArray[np.bool_]:
    """(K,) whether the cart has left its track, or the pole leans too far."""
    ended: npt.NDArray[np.bool_] = (np.abs(seen[:, 0]) > TRACK) | (np.abs(seen[:, 1]) > LEAN)
    return ended


class Balance(gymnasium.Env[Observation, Observation]):
    """Keep the pole up by pushing the cart: reward 1 for each step, action -1 to 1 times 10 N."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}
    observation_space, action_space = OBSERVATIONS, ACTIONS

    def __init__(self, render_mode: str | None = None) -> None:
        self.render_mode = render_mode
        self.space, self.cart, self.pole = cart_and_pole()
        self.stepper = ep.EECA(self.space)
        self.steps = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:  # fmt: skip
        super().reset(seed=seed)
        # Poses and velocities alone: what was before leaves no trace.
        self.stepper.set_state(states_at(self.np_random.uniform(-0.05, 0.05, (1, 4)))[0])
        self.steps = 0
        return self.seen(), {}

    def step(self, action: Observation) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        self.cart.force = (PUSH * float(np.clip(action[0], -1.0, 1.0)), 0.0)
        report = self.stepper.step(DT)
        self.steps += 1
        seen = self.seen()
        return seen, 1.0, bool(fallen(seen[None])[0]), self.steps >= LONGEST, {"converged": report.converged}

    def seen(self) -> Observation:
        """(4,) place, angle, and their rates."""
        return np.array(
            [self.cart.position.x, self.pole.angle, self.cart.velocity.x, self.pole.angular_velocity], np.float32
        )

    def save(self) -> tuple[npt.NDArray[np.int64], int]:
        """All that decides what comes, for `restore`."""
        return self.stepper.get_state(), self.steps

    def restore(self, saved: tuple[npt.NDArray[np.int64], int]) -> None:
        """Go back: the same actions then give the same observations, bit by bit."""
        state, self.steps = saved
        self.stepper.set_state(state)


class Balances(VectorEnv[Observation, Observation, npt.NDArray[np.bool_]]):
    """`count` of them, stepped together by `ep.rollout`; those that have ended begin anew in the step after."""

    metadata: ClassVar[dict[str, Any]] = {"autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, count: int, threads: int | None = None) -> None:
        self.num_envs, self.threads = count, threads
        self.single_observation_space, self.single_action_space = OBSERVATIONS, ACTIONS
        self.observation_space, self.action_space = batch_space(OBSERVATIONS, count), batch_space(ACTIONS, count)
        self.stepper = ep.EECA(cart_and_pole()[0])
        self.states, self.steps, self.ended = np.zeros((count, 2, 6)), np.zeros(count, int), np.zeros(count, bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:  # fmt: skip
        super().reset(seed=seed if isinstance(seed, int) else None)
        self._begin(np.ones(self.num_envs, bool))
        return observed(self.states), {}

    def _begin(self, which: npt.NDArray[np.bool_]) -> None:
        self.states[which] = states_at(self.np_random.uniform(-0.05, 0.05, (int(which.sum()), 4)))
        self.steps[which], self.ended[which] = 0, False

    def step(
        self, actions: Observation
    ) -> tuple[Observation, State, npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]:
        push = np.zeros((self.num_envs, 1, 2, 3))
        push[:, 0, 0, 0] = PUSH * np.clip(actions[:, 0], -1.0, 1.0)
        new = self.ended.copy()
        moved = ep.rollout(self.stepper, self.states, 1, DT, controls=push, threads=self.threads)[:, 0]
        self.states, self.steps = moved, self.steps + 1
        self._begin(new)
        seen = observed(self.states)
        terminated = fallen(seen) & ~new
        truncated = self.steps >= LONGEST
        self.ended = terminated | truncated
        return seen, np.where(new, 0.0, 1.0), terminated, truncated, {}


def held(seen: Observation) -> Observation:
    """Actions (..., 1) of a linear controller."""
    push: Observation = (seen @ np.array([0.1, -3.0, 0.2, -0.6], np.float32))[..., None]
    return np.clip(push, -1.0, 1.0)


def main() -> None:
    """Balance one pole, then many at once."""
    env = Balance()
    seen, _ = env.reset(seed=1)
    total, done = 0.0, False
    while not done:
        seen, reward, terminated, truncated, _ = env.step(held(seen))
        total, done = total + reward, terminated or truncated
    print(f"one pole: {total:.0f} of {LONGEST} steps")
    poles = Balances(256)
    many, _ = poles.reset(seed=1)
    begun, falls = time.perf_counter(), 0
    for _ in range(LONGEST):
        many, _, terminated, _, _ = poles.step(held(many))
        falls += int(terminated.sum())
    rate = 256 * LONGEST / (time.perf_counter() - begun)
    print(f"256 poles: {falls} fell in {LONGEST} steps; {rate:,.0f} steps of a pole per second")


if __name__ == "__main__":
    main()

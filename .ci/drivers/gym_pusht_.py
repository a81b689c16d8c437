"""gym-pusht: 250 actions of a tip that is drawn through the T; then a reset with the same seed and the same again."""

import sys

from watched import tell, watch

watch(sys.argv)
import gymnasium
import gym_pusht  # noqa: F401
import numpy as np

env = gymnasium.make("gym_pusht/PushT-v0", obs_type="state", max_episode_steps=10_000)


def episode():
    state, _ = env.reset(seed=3)
    goal = state[2:4]
    for k in range(250):
        action = goal + np.array([1.0, 0.3]) * (240.0 * min(1.0, k / 150) - 150.0)
        state, reward, *_ = env.step(np.clip(action, 0, 512))
    return state, reward


first, reward = episode()
second, _ = episode()
tell({
    "T x": first[2], "T y": first[3], "T angle": first[4], "coverage": reward,
    "differs after a reset": np.abs(first - second).max(),
})  # fmt: skip

"""PettingZoo's pistonball: 20 pistons raised in a wave, 250 cycles at most; then a reset with the same seed."""

import os
import sys

from watched import tell, watch

os.environ["SDL_VIDEODRIVER"] = "dummy"
watch(sys.argv)
import numpy as np
from pettingzoo.butterfly import pistonball_v6

env = pistonball_v6.parallel_env(n_pistons=20, continuous=True, max_cycles=250)


def episode():
    env.reset(seed=42)
    total, places = 0.0, []
    for k in range(250):
        if not env.agents:
            break
        actions = {
            name: np.array([np.sin(0.15 * k + 0.4 * i)], np.float32) for i, name in enumerate(env.possible_agents)
        }
        _, rewards, *_ = env.step({name: actions[name] for name in env.agents})
        total += sum(rewards.values()) / 20
        places.append(tuple(env.unwrapped.ball.position))
    return np.array(places), total


first, reward = episode()
second, _ = episode()
count = min(len(first), len(second))
tell({
    "ball x": first[-1, 0], "ball y": first[-1, 1], "cycles": len(first), "reward": reward,
    "differs after a reset": np.abs(first[:count] - second[:count]).max(),
})  # fmt: skip

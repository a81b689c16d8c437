"""viva-munk's PymunkProcess: a colony of rod-shaped and bending cells and particles that is jittered in a chamber."""

import random
import sys

from watched import tell, watch

watch(sys.argv)
import numpy as np
from viva_munk.core import build_core
from viva_munk.processes.multibody import PymunkProcess, make_initial_state

random.seed(1)
np.random.seed(1)  # noqa: NPY002 - what it draws from
process = PymunkProcess({"env_size": 300.0, "jitter_per_second": 0.05, "barriers": []}, core=build_core())
state = make_initial_state(12, 30, 300.0, seed=4)
inputs = {"segment_cells": state["cells"], "bending_cells": {}, "circle_particles": state["particles"]}
for _ in range(30):
    process.update(inputs, 1.0)
bodies = list(process.space.bodies)
tell({
    "bodies": len(bodies), "mean x": sum(b.position.x for b in bodies) / len(bodies),
    "fastest at the end": max(b.velocity.length for b in bodies),
})  # fmt: skip

"""Recording: run a stepper and keep the trajectory."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pymunk
from tqdm import tqdm

from .bodies import ANGLE, POSITION, VELOCITY, Bodies, FloatArray
from .invariants import invariants
from .stepper import Stepper, check_dt


def versions() -> dict[str, str]:
    """Versions of what a result depends on."""
    from importlib.metadata import version

    return {
        "python": sys.version.split()[0],
        **{name: version(name) for name in ("eeca-pymunk", "pymunk", "numpy")},
    }


@dataclass
class Recording:
    """T moments of N dynamic bodies, in the order of `space.bodies`.

    Attributes:
        time: (T,).  position: (T, N, 2) length.  angle: (T, N) rad.  velocity: (T, N, 2) length/time.
        energy: (T,) kinetic plus gravity.  momentum: (T, 2).
        parameters: what the run was made with, and the versions.
    """

    time: FloatArray
    position: FloatArray
    angle: FloatArray
    velocity: FloatArray
    energy: FloatArray
    momentum: FloatArray
    parameters: dict[str, Any] = field(default_factory=dict)

    def save(self, path: str | Path) -> None:
        """Write to `path` as npz."""
        arrays = {k: v for k, v in asdict(self).items() if k != "parameters"}
        with Path(path).open("wb") as file:
            np.savez_compressed(file, parameters=np.array(json.dumps(self.parameters)), **arrays)

    @staticmethod
    def load(path: str | Path) -> Recording:
        """Read what `save` wrote."""
        with np.load(path) as data:
            arrays = {k: data[k] for k in data.files if k != "parameters"}
            return Recording(**arrays, parameters=json.loads(str(data["parameters"])))


def step_count(duration: float, dt: float) -> int:
    """Steps of dt that fill the duration; ValueError unless both are positive and finite."""
    if check_dt(dt) == 0.0 or check_dt(duration) == 0.0:
        raise ValueError(f"duration = {duration}, dt = {dt}: give numbers > 0")
    return max(1, round(duration / dt))


def record(stepper: Stepper, duration: float, dt: float, every: int = 1, progress: bool = False) -> Recording:
    """Run `stepper` for round(duration / dt) steps and keep the start and every `every`-th step.

    Args:
        duration, dt: time, > 0.
        every: keep one of so many steps, >= 1.
        progress: show a progress bar.
    """
    if every < 1:
        raise ValueError(f"every = {every}: give a whole number >= 1")
    count = step_count(duration, dt)
    space = stepper.space
    bodies = Bodies(space)
    rows = np.array([bodies.row[b] for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC], np.intp)
    moments = 1 + count // every
    position, velocity = np.empty((moments, len(rows), 2)), np.empty((moments, len(rows), 2))
    angle, energy, momentum = np.empty((moments, len(rows))), np.empty(moments), np.empty((moments, 2))

    def keep(i: int) -> None:
        state = bodies.gather()
        if state is None:
            raise ValueError("bodies were added or removed while recording; record each stretch by itself")
        now = invariants(bodies, state, space.gravity)
        position[i], angle[i], velocity[i] = state[rows, POSITION], state[rows, ANGLE], state[rows, VELOCITY]
        energy[i], momentum[i] = now.energy, now.linear_momentum

    keep(0)
    for k in tqdm(range(1, count + 1), desc=type(stepper).__name__, unit="step", disable=not progress):
        stepper.step(dt)
        if k % every == 0:
            keep(k // every)
    parameters = {"stepper": type(stepper).__name__, "dt": dt, "duration": count * dt, "every": every, **versions()}
    time: FloatArray = (dt * every) * np.arange(moments, dtype=float)
    return Recording(time, position, angle, velocity, energy, momentum, parameters)

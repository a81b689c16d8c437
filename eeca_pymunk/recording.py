"""Recording: run a stepper and keep the trajectory."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from .arrays import FloatArray, IntArray
from .files import whole_file
from .space.bodies import ANGLE, POSITION, VELOCITY, Bodies, moving
from .space.measure import invariants
from .space.outlines import Outlines
from .stepper import Stepper, check_dt

if TYPE_CHECKING:
    import pymunk

_PER_BODY = 5 * 8  # bytes kept of a body and moment: position, angle, velocity
MEMORY = 2.0**30  # bytes


def versions() -> dict[str, str]:
    """Versions of what a result depends on."""
    from importlib.metadata import version

    return {
        "python": sys.version.split()[0],
        **{name: version(name) for name in ("eeca-pymunk", "pymunk", "numpy")},
    }


@dataclass
class Recording:
    """T moments of N bodies: those of `space.bodies` that are not static, in that order.

    A body that is removed on the way is NaN from then on. In a notebook a recording shows itself as a small film.

    Attributes:
        time: (T,).  position: (T, N, 2) length.  angle: (T, N) rad.  velocity: (T, N, 2) length/time.
        energy: (T,) kinetic plus gravity.  momentum: (T, 2).
        mass: (N,) infinite for kinematic bodies.  outlines: the shapes, as they were at the start.
        parameters: what the run was made with, and the versions.
    """

    time: FloatArray
    position: FloatArray
    angle: FloatArray
    velocity: FloatArray
    energy: FloatArray
    momentum: FloatArray
    mass: FloatArray = field(default_factory=lambda: np.zeros(0))
    outlines: Outlines = field(default_factory=Outlines)
    parameters: dict[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.time)

    def save(self, path: str | Path) -> None:
        """Write to `path` as npz, whole or not at all."""
        arrays = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("outlines", "parameters")}
        shapes = {f"outlines.{f.name}": getattr(self.outlines, f.name) for f in fields(self.outlines)}
        with whole_file(path) as partial, partial.open("wb") as file:
            np.savez_compressed(file, parameters=np.array(json.dumps(self.parameters)), **arrays, **shapes)

    @staticmethod
    def load(path: str | Path) -> Recording:
        """Read what `save` wrote; ValueError if it is something else."""
        try:
            with np.load(path) as data:
                found = {name: data[name] for name in data.files}
            parameters = json.loads(str(found.pop("parameters")))
            names = [name for name in found if name.startswith("outlines.")]
            outlines = Outlines(**{name.removeprefix("outlines."): found.pop(name) for name in names})
            return Recording(**found, outlines=outlines, parameters=parameters)
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise ValueError(f"{path} is not a recording that Recording.save wrote ({error})") from error

    def _repr_html_(self) -> str:
        from .render import player

        return player(self)


def step_count(duration: float, dt: float) -> int:
    """Steps of dt that fill the duration; ValueError unless both are positive and finite."""
    if check_dt(dt) == 0.0 or check_dt(duration) == 0.0:
        raise ValueError(f"duration = {duration}, dt = {dt}: give numbers > 0")
    return max(1, round(duration / dt))


def record(
    stepper: Stepper, duration: float, dt: float, every: int = 1, progress: bool = False, memory: float = MEMORY
) -> Recording:
    """Run `stepper` for round(duration / dt) steps and keep the start and every `every`-th step.

    Args:
        duration, dt: time, > 0.
        every: keep one of so many steps, >= 1.
        progress: show a progress bar.
        memory: bytes the recording may take. ValueError, before anything moves, if it would take more.
    """
    if every < 1:
        raise ValueError(f"every = {every}: give a whole number >= 1")
    count = step_count(duration, dt)
    kept = moving(stepper.space)
    moments = 1 + count // every
    needed = moments * (len(kept) * _PER_BODY + 32)
    if needed > memory:
        raise ValueError(
            f"{moments} moments of {len(kept)} bodies take {needed:.2g} bytes, more than memory = {memory:.2g}: "
            f"give every >= {int(np.ceil(every * needed / memory))}, or more memory"
        )
    film = _Moments(stepper.space, kept, moments)
    film.keep(0)
    for k in tqdm(range(1, count + 1), desc=type(stepper).__name__, unit="step", disable=not progress):
        stepper.step(dt)
        if k % every == 0:
            film.keep(k // every)
    film.recording.time[:] = (dt * every) * np.arange(moments)
    film.recording.parameters.update(
        stepper=type(stepper).__name__, dt=dt, duration=count * dt, every=every, **versions()
    )
    return film.recording


class _Moments:
    """A recording that is being filled."""

    def __init__(self, space: pymunk.Space, kept: list[pymunk.Body], moments: int) -> None:
        self.space, self.kept = space, kept
        T, N = moments, len(kept)
        self._read()
        self.recording = Recording(
            np.zeros(T), np.empty((T, N, 2)), np.empty((T, N)), np.empty((T, N, 2)), np.empty(T), np.empty((T, 2)),
            self.bodies.mass[self.rows], Outlines.of(space, kept),
        )  # fmt: skip

    def _read(self) -> None:
        """The rows of the kept bodies among those the space has now."""
        self.bodies = Bodies(self.space)
        self.present: IntArray = np.array([i for i, b in enumerate(self.kept) if b in self.bodies.row], np.intp)
        self.rows: IntArray = np.array([self.bodies.row[self.kept[i]] for i in self.present], np.intp)

    def keep(self, i: int) -> None:
        state = self.bodies.gather()
        if state is None:
            self._read()
            state = self.bodies.gather()
            assert state is not None  # read from these very bodies
            if set(self.bodies.row) - set(self.kept) - {b for b in self.bodies.row if b.body_type == b.STATIC}:
                raise ValueError("a body was added while recording: record the stretch that begins there by itself")
        now, to = invariants(self.bodies, state, self.space.gravity), self.recording
        for array, column in ((to.position, POSITION), (to.angle, ANGLE), (to.velocity, VELOCITY)):
            array[i] = np.nan
            array[i, self.present] = state[self.rows, column]
        to.energy[i], to.momentum[i] = now.energy, now.linear_momentum

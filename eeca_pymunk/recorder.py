"""record: run a stepper and store the trajectory."""

from __future__ import annotations

import functools
import math
import sys
from typing import TYPE_CHECKING

import numpy as np
from tqdm import tqdm

from .arguments import check_count, check_finite
from .arrays import FloatArray, IntArray
from .energy.invariants import traces
from .energy.ledger import LedgerTrace, as_array
from .events import Events
from .recording import Recording
from .report import StepReport
from .runs import RunningStepper
from .space.bodies import ANGLE, ANGULAR_VELOCITY, POSITION, VELOCITY, Bodies, moving
from .space.edits import clock
from .space.outlines import Outlines
from .stepper import Stepper

if TYPE_CHECKING:
    import pymunk

_MOST_STEPS = 1e15  # of which every one counts in floating point
_PER_BODY = 6 * 8  # bytes for a body and moment: position, angle, velocity, spin
_PER_MOMENT = 11 * 8  # further bytes for a moment: time, energies (2), momentum (2), ledger (6)
MEMORY = 2.0**30  # bytes that a recording may take by default


@functools.cache
def versions() -> dict[str, str]:
    """Versions of the software on which a result depends; to be copied, not changed."""
    from importlib.metadata import version

    return {"python": sys.version.split()[0], **{name: version(name) for name in ("eeca-pymunk", "pymunk", "numpy")}}


def step_count(duration: float, dt: float) -> int:
    """Number of steps of dt whose sum is nearest to the duration, at least 1; ValueError unless both are positive and
    finite, and for more than `_MOST_STEPS`."""
    duration, dt = check_finite("duration", duration), check_finite("dt", dt)
    if duration / dt > _MOST_STEPS:
        raise ValueError(f"duration = {duration}, dt = {dt}: {duration / dt:.3g} steps, give {_MOST_STEPS:.0g} at most")
    return max(1, round(duration / dt))


def record(
    stepper: Stepper, duration: float, dt: float, every: int = 1, progress: bool = False, memory: float = MEMORY
) -> Recording:
    """Run `stepper` for round(duration / dt) steps, at least one, and store the start, every `every`-th step, and all
    impacts.

    For EECA this is one compiled call if `stepper.run` is one.

    Args:
        duration, dt: time, > 0.
        every: number of steps between two stored moments, >= 1.
        progress: show a progress bar.
        memory: largest number of bytes for the moments. ValueError, before the first step, if they would take more.

    Raises:
        ValueError: also if a body that is not static is added during the run; for all others see `Stepper.step`.
    """
    every, count, dt = check_count("every", every, 1), step_count(duration, dt), float(dt)
    if not memory > 0:
        raise ValueError(f"memory = {memory}: give a number of bytes > 0")
    kept = moving(stepper.space)
    moments = 1 + count // every
    needed = moments * (len(kept) * _PER_BODY + _PER_MOMENT)
    if needed > memory:
        least = every * needed / memory
        remedy = f"give every >= {math.ceil(least)}, or more memory" if least < count else "give more"
        raise ValueError(
            f"{moments} moments of {len(kept)} bodies take {needed:.2g} bytes, and memory = {memory:.2g}: {remedy}"
        )
    if isinstance(stepper, RunningStepper) and stepper.compiles():
        recording = _record_compiled(stepper, kept, count, dt, every, progress)
    else:
        filled = _Moments(stepper.space, kept, moments)
        filled.store(0)
        for k in tqdm(range(1, count + 1), desc=type(stepper).__name__, unit="step", disable=not progress):
            filled.add_step(stepper.step(dt), (k - 1) * dt)
            if k % every == 0:
                filled.store(k // every)
        recording = filled.recording
        recording.parameters["steps_unmet"] = filled.unmet
        recording.events = Events.joined(filled.events).in_order()
    recording.time[:] = (dt * every) * np.arange(moments)
    recording.parameters.update(stepper=type(stepper).__name__, dt=dt, duration=count * dt, every=every, **versions())
    return recording


def _record_compiled(
    stepper: RunningStepper, kept: list[pymunk.Body], count: int, dt: float, every: int, progress: bool
) -> Recording:  # fmt: skip
    """The recording of a run in compiled code, whose times are 0."""
    space = stepper.space
    outlines = Outlines.of(space, kept)
    world = stepper.current()
    rows: IntArray = np.array([world.bodies.row[body] for body in kept], np.intp)
    mass, moment, dynamic = world.bodies.mass[rows], world.bodies.moment[rows], world.bodies.dynamic[rows]
    place = np.full(len(world.bodies), -1, np.intp)
    place[rows] = np.arange(len(kept))
    owner = place[world.owner]
    buffers = stepper.buffered_run(count, dt, kept, every, events=True, progress=progress)
    frames = buffers.frames
    position, angle, velocity, spin = frames[:, :, :2], frames[:, :, 2], frames[:, :, 3:5], frames[:, :, 5]
    d = np.argsort(rows)  # sums in the order of `measure`, so that they are equal to it bit by bit
    d = d[dynamic[d]]
    kinetic, potential, momentum, _ = traces(
        mass[d], moment[d], position[:, d], velocity[:, d], spin[:, d], space.gravity
    )  # fmt: skip
    return Recording(
        np.zeros(len(frames)), position.copy(), angle.copy(), velocity.copy(), kinetic + potential, momentum, mass,
        outlines, kinetic=kinetic, ledger=LedgerTrace(*buffers.arrays.SUMS.T.copy()), spin=spin.copy(),
        events=Events.of(buffers.events, owner).in_order(), parameters={"steps_unmet": int(buffers.progress.unmet)},
    )  # fmt: skip


class _Moments:
    """A recording that is filled step by step; its times are 0."""

    def __init__(self, space: pymunk.Space, kept: list[pymunk.Body], moments: int) -> None:
        self.space, self.kept = space, kept
        T, N = moments, len(kept)
        self.place = {body: i for i, body in enumerate(kept)}
        self.events: list[Events] = []
        self._read()
        self.recording = Recording(
            np.zeros(T), np.empty((T, N, 2)), np.empty((T, N)), np.empty((T, N, 2)), np.empty(T), np.empty((T, 2)),
            self.bodies.mass[self.rows], Outlines.of(space, kept), kinetic=np.empty(T), ledger=LedgerTrace.unknown(T),
            spin=np.empty((T, N)),
        )  # fmt: skip
        self.total: FloatArray = np.zeros(6)  # of the ledgers so far
        self.unmet = 0  # steps that did not meet a budget or tolerance

    def _read(self) -> None:
        """Find the rows of the recorded bodies in the present space."""
        self.bodies, self._clock = Bodies(self.space), clock()
        self.present: IntArray = np.array([i for i, b in enumerate(self.kept) if b in self.bodies.row], np.intp)
        self.rows: IntArray = np.array([self.bodies.row[self.kept[i]] for i in self.present], np.intp)

    def add_step(self, report: StepReport, start: float) -> None:
        """Add the ledger and the impacts of a step that began at the time `start`."""
        self.total += as_array(report.ledger)
        self.unmet += not report.converged
        self.events.append(Events.of_report(report, start, self.place))

    def store(self, i: int) -> None:
        """Write the present state of the space as moment i."""
        state = self.bodies.gather()
        if state is None or clock() != self._clock:  # other bodies, or other masses
            self._read()
            state = self.bodies.gather()
            assert state is not None  # read from these very bodies
            if set(self.bodies.row) - set(self.kept) - {b for b in self.bodies.row if b.body_type == b.STATIC}:
                raise ValueError("a body was added while recording: record the stretch that begins there by itself")
        now, to = self.bodies.invariants(state, self.space.gravity), self.recording
        for array, column in (
            (to.position, POSITION), (to.angle, ANGLE), (to.velocity, VELOCITY), (to.spin, ANGULAR_VELOCITY)
        ):  # fmt: skip
            array[i] = np.nan
            array[i, self.present] = state[self.rows, column]
        to.energy[i], to.kinetic[i], to.momentum[i] = now.energy, now.kinetic, now.linear_momentum
        to.ledger.put(i, self.total)

"""Rolling: copies of a scene, one for each thread of a rollout, kept from call to call."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .arrays import FloatArray, IntArray
from .compiled import table_of
from .energy.ledger import as_array
from .errors import NotFiniteError
from .events import Events
from .impacts.run import RunBuffers
from .impacts.scene import EventLoop
from .layout import BODY_ROW
from .model.values import reading_of
from .packed_space import TOO_FAR
from .runs import RunningStepper
from .space.bodies import moving
from .space.world import World


@dataclass(frozen=True)
class Job:
    """Inputs and outputs of K rollouts of b bodies with T frames; all of them as in `rollout` and `Rollouts`.

    Attributes:
        states: (K, b, 6).  push: (K, T, b, 3) controls, or None.  every, dt: see `rollout`.
        steps: number of steps of a rollout, T * every.  full: whether impacts are stored.
        frames: (K, T, b, 6), output.  ledger: (K, T, 6), output.  unmet: (K,), output.
    """

    states: FloatArray
    push: FloatArray | None
    steps: int
    every: int
    dt: float
    frames: FloatArray
    ledger: FloatArray
    unmet: IntArray
    full: bool


class Copy:
    """A copy of the arrays of a scene, for one thread."""

    def __init__(self, world: World, loop: EventLoop, rows: IntArray) -> None:
        """`loop`: that of `world`, which has taken no step.  `rows` (b,): rows of the moving bodies in STATES."""
        self.world, self.rows = world, rows
        self.loop = copy.deepcopy(loop)
        self._reading = table_of(
            reading_of(world.reading)._replace(
                STATES=world.STATES.copy(), IDS=world.IDS.copy(), EXTRA=world.EXTRA.copy(),
                ENDS=np.zeros_like(world.ENDS),
            )
        )  # fmt: skip
        self._place = np.full(len(world.bodies), -1, np.intp)
        self._place[rows] = np.arange(len(rows))
        self._at = world.IDS[BODY_ROW, rows]
        self.loop.keep_fresh()

    def roll(self, job: Job, first: int, last: int) -> list[Events]:
        """Compute rollouts [first, last); returns the impacts of each, an empty list unless `job.full`."""
        if not self.loop.listed:  # near lists are the same for all states: the kernel begins each rollout itself
            return self._take_rollouts(job, first, last)
        events = []
        for k in range(first, last):
            self.loop.reset_to(self._at, job.states[k])
            events += self._take_rollouts(job, k, k + 1)
        return events

    def _take_rollouts(self, job: Job, first: int, last: int) -> list[Events]:
        """Compute rollouts [first, last) in one call of the kernel; returns as `roll`."""
        T, world = job.frames.shape[1], self.world
        buffers = RunBuffers(
            job.dt, world.gravity, world.half_damping(job.dt), 0.0, self.rows, (last - first) * T, job.every,
            job.full, job.states[first:last], None if job.push is None else job.push[first:last],
            job.frames[first:last],
        )  # fmt: skip
        buffers.arrays = buffers.arrays._replace(OWN=self.loop.own, FRESH=self.loop.fresh)
        RUN = buffers.progress
        RUN.until, RUN.rollouts = job.steps, last - first
        status = self.loop.follow(buffers, self._reading)
        if status < 0:
            raise NotFiniteError(f"rollout {first + int(RUN.rollout)}, after {int(RUN.done)} steps: {TOO_FAR}")
        job.ledger[first:last] = buffers.arrays.SUMS.reshape(last - first, T, 6)
        job.unmet[first:last] = buffers.arrays.COUNTS[:, 0]
        if not job.full:
            return []
        events = Events.of(buffers.events, self._place[world.owner])
        ends = [0, *buffers.arrays.COUNTS[:, 1].tolist()]
        return [events.part(a, b).in_order() for a, b in pairwise(ends)]


class Rolling:
    """The copies of the scene of a stepper.

    Args:
        twin: another stepper of the same space. It takes no steps, so that its event loop is one before the first step.
    """

    def __init__(self, twin: RunningStepper) -> None:
        self.twin = twin
        self._made: list[Copy] = []
        self._version: tuple[object, ...] = ()  # of the scene from which they were made

    @staticmethod
    def of(stepper: RunningStepper, dt: float) -> Rolling:
        """The copies of a stepper, for the present space."""
        rolling = stepper.rolling
        if rolling is None:
            rolling = stepper.rolling = Rolling(copy.copy(stepper))
        rolling._refresh(dt)
        return rolling

    def _refresh(self, dt: float) -> None:
        """Forget the copies if the space has changed since they were made."""
        world = self.world = self.twin.adjusted(dt)
        loop = self.twin.event_loop
        assert loop is not None
        rules = loop.scene.RULE.tobytes()
        joints = (loop.joint.tobytes(), loop.pinned.tobytes()) if loop.jointed else ()
        version = id(world), world.patches, id(loop), rules, *joints
        if version != self._version:
            self._made, self._version = [], version

    def copies(self, count: int) -> list[Copy]:
        """The first `count` copies, made if necessary."""
        loop, world = self.twin.event_loop, self.world
        assert loop is not None
        if len(self._made) < count:
            rows: IntArray = np.array([world.bodies.row[body] for body in moving(self.twin.space)], np.intp)
            self._made += [Copy(world, loop, rows) for _ in range(count - len(self._made))]
        return self._made[:count]


def roll_in_python(twin: RunningStepper, job: Job, done: Callable[[int], object]) -> list[Events]:
    """The rollouts step by step on the space of `twin`, whose state is not restored; returns the impacts of each.
    `done`: called with 1 after each rollout."""
    bodies, found = moving(twin.space), []
    place = {body: i for i, body in enumerate(bodies)}
    for k, state in enumerate(job.states):
        twin.set_state(state)
        total, parts = np.zeros(6), []
        for step in range(job.steps):
            t = step // job.every
            if job.push is not None:
                for body, (fx, fy, torque) in zip(bodies, job.push[k, t].tolist(), strict=True):
                    body.force, body.torque = (fx, fy), torque
            report = twin.step(job.dt)
            total += as_array(report.ledger)
            job.unmet[k] += not report.converged
            if job.full:
                parts.append(Events.of_report(report, step * job.dt, place))
            if (step + 1) % job.every == 0:
                job.ledger[k, t] = total
                for i, body in enumerate(bodies):
                    job.frames[k, t, i] = *body.position, body.angle, *body.velocity, body.angular_velocity
        found.append(Events.joined(parts).in_order())
        done(1)
    return found

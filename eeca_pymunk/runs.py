"""RunningStepper: many steps in one compiled call, if no Python function has to be called in between."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from tqdm import tqdm

from .arguments import check_count
from .arrays import FloatArray, IntArray
from .impacts.edits import FILTER, Changes, Edits, write_edits
from .impacts.run import RunBuffers
from .impacts.taking_over import kept_in_place
from .layout import BODY_ROW, READ, WRITTEN
from .model.run import BETWEEN
from .model.step import FORCES
from .packed_stepper import PackedStepper
from .reentry import Entered, refuse_within
from .report import RunReport
from .space.world import World
from .states import get_state, set_state
from .stepper import check_dt

if TYPE_CHECKING:
    import pymunk

    from .rolling import Rolling

_FIRST = 256  # steps in the first call of the compiled loop
# Seconds of a call below which the next one has twice as many steps, and above which half as many: Python updates the
# progress bar and handles interrupts in between.
_SHORT, _LONG = 0.05, 0.2


class RunningStepper(PackedStepper):
    """A stepper that can take many steps in one call; arguments as of `PackedStepper`.

    Attributes:
        rolling: copies of the scene for rollouts.
    """

    rolling: Rolling | None = None

    def __getstate__(self) -> dict[str, object]:
        return {**super().__getstate__(), "rolling": None}

    def adjusted(self, dt: float) -> World:
        """The result of `current`, with joints and rules of the method updated for a step of length dt."""
        world = self.current()
        self.adjust(world, dt)
        return world

    def current(self) -> World:
        """The arrays of the present space, with the states of its bodies."""
        world = self._present()
        world.gather()
        if not world.is_current():
            world = self._update_world(anew=True)
            world.gather()
        return world

    def catch_up(self) -> None:
        """Take over all changes of the space since the last step, as the next one does.

        Raises:
            ValueError: as that step would.
        """
        world = self.current()
        joints = world.joints
        if joints is not None:
            joints.catch_up(world.state, world.bodies.row)
            self._rejoin(world, joints)

    def compiles(self) -> bool:
        """Whether a run of the present space is one compiled call.

        It is not if functions are called within steps (collision handlers, functions of bodies, joints and springs,
        waiting post-step callbacks), if bodies may sleep, if a centre of gravity is not at its body's origin, or if
        joints hold bodies outside the space. Then a run is a Python loop.
        """
        if self.calls() or self.event_loop is None or self._sleep is not None:
            return False
        world = self._world
        assert world is not None  # set by `calls`
        return not (world.eccentric or (world.joints is not None and world.joints.partners.outside))

    def calls(self) -> bool:
        """Whether functions have to be called within the next step."""
        world = self._present()
        functions = world.joints is not None and world.joints.calls_any()
        return world.hooked_steps or functions or (self.sync and self._sync.waits())

    def get_state(self) -> IntArray:
        """Everything that determines the further path of the space, as a 1-D array of integers: poses, velocities and
        forces of its bodies, and results of earlier steps that the stepper keeps. `set_state` restores it, in this
        process or in another one with an equal space.

        If some bodies sleep, the results of earlier steps are left out: paths then agree up to round-off.

        Raises:
            RuntimeError: called by a function within a step, or while another thread steps the space.
        """
        refuse_within(self.space)
        with Entered(self.space):
            return get_state(self)

    def set_state(self, state: npt.ArrayLike) -> None:
        """Return to a state.

        Args:
            state: the result of `get_state`: the space then follows the same path, bit by bit. Or (b, 6) position,
                angle, velocity and spin of the b bodies that are not static, in the order of `space.bodies`; length,
                rad, per time. This also clears forces and results of earlier steps, so that equal states give equal
                paths, whatever was run before: ratchets stand on the last notch that their bodies have passed there.
                Sleeping bodies wake.

        Raises:
            RuntimeError: called by a function within a step, or while another thread steps the space.
            ValueError: it is neither, belongs to another space, or is not finite; nothing is changed.
        """
        refuse_within(self.space)
        with Entered(self.space):
            set_state(self, np.asarray(state))

    def reset_to(self, world: World, state: FloatArray) -> None:
        """Forget results of earlier steps, after the bodies of the space have been set to `state` (N, 9)."""
        loop = self.event_loop
        if loop is None or world.joints is not None or self._sleep is not None:
            self.refresh()
        elif len(loop.fresh) == 0:
            # Keep the memory of a new scene, so that later calls only copy it.
            self.refresh()
            self.current()
            if (loop := self.event_loop) is not None:
                loop.keep_fresh()
        else:
            rows = world.IDS[BODY_ROW]
            self.decisions.forget(self.space)
            loop.reset_to(rows[rows >= 0], state[rows >= 0, :6])
            world.STATES[WRITTEN, rows >= 0] = np.nan

    def patch(self, world: World, moved: bool) -> bool:
        loop = self.event_loop
        if loop is None:
            return False
        found = world.patch(not moved, self._sleep is not None)
        if found is None:
            return False
        changes: Changes
        if isinstance(found, Edits):
            write_edits(loop.table, found)
            changes = [(FILTER, row) for row in found.filters]
            renewed = not changes or loop.go_on(changes, loop.measured)
        else:
            changes = found
            renewed = world.joints is None and loop.go_on(changes, world.packed.measured())
        if not renewed:
            self.choose_method(world, world, kept_in_place(len(world.BODY), len(world.shapes), changes))
        return True

    def run(self, steps: int, dt: float, progress: bool = False) -> RunReport:
        refuse_within(self.space)
        steps, dt = check_count("steps", steps), check_dt(dt)
        if steps == 0 or dt == 0.0 or not self.compiles():
            return super().run(steps, dt, progress)
        buffers = self.buffered_run(steps, dt, progress=progress)
        RUN = buffers.progress
        counted = int(RUN.impacts), int(RUN.unmet), int(RUN.iterations)
        return RunReport(self.time, int(RUN.done), buffers.ledger, *counted, float(RUN.lock))

    def buffered_run(
        self, steps: int, dt: float, kept: Sequence[pymunk.Body] = (), every: int = 0, events: bool = False,
        progress: bool = False,
    ) -> RunBuffers:  # fmt: skip
        """Take steps > 0 of dt > 0 in compiled code, for a space that `compiles`, and store frames of some bodies.

        Args:
            kept: bodies that are not static.  every: steps from frame to frame, 0 for none; the start is the first one.
            events: whether impacts are stored.  progress: whether to show a progress bar.

        Raises:
            as `step` does; the space is then at the end of the step before.  RuntimeError: another thread steps it.
        """
        with Entered(self.space):
            return self._buffered(steps, dt, kept, every, events, progress)

    def _buffered(
        self, steps: int, dt: float, kept: Sequence[pymunk.Body], every: int, events: bool, progress: bool
    ) -> RunBuffers:
        """`buffered_run`, in the one thread that may step the space."""
        world = self.adjusted(dt)
        rows = np.array([world.bodies.row[body] for body in kept], np.int64)
        moments = 1 + steps // every if every else 0
        buffers = RunBuffers(dt, world.gravity, world.half_damping(dt), self.time, rows, moments, every, events)
        if every:
            buffers.frames[0] = world.STATES[READ, rows, :6]
            buffers.progress.frame = 1
        status = 0
        try:
            status = self._take_steps(world, buffers, steps, progress)
            if status < 0:
                self._raise_failure(world, dt, status)
        finally:
            self._write_run_end(world, buffers, dt, status)
        return buffers

    def _take_steps(self, world: World, buffers: RunBuffers, steps: int, progress: bool) -> int:
        """Take the steps, in several calls of the kernel; returns status bits or a negative code."""
        RUN, loop, count, status = buffers.progress, self.event_loop, _FIRST, 0
        assert loop is not None
        with tqdm(total=steps, desc=type(self).__name__, unit="step", disable=not progress) as bar:
            while status >= 0 and RUN.done < steps:
                RUN.until = min(steps, int(RUN.done) + count)
                began, before = perf_counter(), int(RUN.done)
                status = loop.follow(buffers, world.reading)
                took = perf_counter() - began
                count = 2 * count if took < _SHORT else max(count // 2, 1) if took > _LONG else count
                bar.update(int(RUN.done) - before)
        return status

    def _write_run_end(self, world: World, buffers: RunBuffers, dt: float, status: int) -> None:
        """Write the end of the last complete step to the space, also after an exception or interrupt."""
        RUN = buffers.progress
        if status < 0 or RUN.stage != BETWEEN:  # the last step is not complete: READ has its start
            self._world = None
            moves = world.IDS[BODY_ROW] >= 0
            world.STATES[WRITTEN, moves, :6] = world.STATES[READ, moves, :6]
        if RUN.done == 0:
            return
        bits = int(RUN.bits)
        world.write_ends(bits)
        self.time = float(RUN.time)
        if bits & FORCES:
            world.reset_forces()
        self.write_end(world, dt, bits)
        if world.joints is not None:
            world.show_joints(world.joints)

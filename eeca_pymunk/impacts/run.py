"""Many steps in one call, each from the end of the one before; stores frames, ledgers and impacts.

Rollouts are such runs from many states; each begins as the first step of a new stepper does.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel, nonallocating, table_of
from ..compiled.records import Rows, row, rows
from ..energy.ledger import Ledger
from ..layout import BODY_ROW, READ, WRITTEN
from ..model.contacts import Impulse
from ..model.joints import joints_of
from ..model.run import AFTER, BETWEEN, WITHIN, Run, RunArrays, run_arrays_of
from ..model.scene import Scene, scene_of
from ..model.step import ENERGY, IMPACTS_FULL
from ..model.values import Reading, reading_of
from .memory import lengthened
from .step import resume, start

_NO_ROWS: IntArray = np.zeros(0, np.int64)
_IMPACTS = 256  # rows of EVENTS at first


@nonallocating
def carry_on(R: Reading) -> None:
    """Let the next step begin with the poses and velocities at the end of the last one, without forces."""
    now, after = R.STATES[READ], R.STATES[WRITTEN]
    for i in range(R.IDS.shape[1]):
        if R.IDS[BODY_ROW, i] >= 0:
            for c in range(6):
                now[i, c] = after[i, c]
            for c in range(6, 9):
                now[i, c] = 0.0


@nonallocating
def set_back(A: Scene, F: RunArrays, R: Reading) -> None:
    """Begin a rollout: clear the results of earlier steps, and set bodies to INITIAL."""
    now, after = R.STATES[READ], R.STATES[WRITTEN]
    if A.COUNT.remembered > 0:
        for q in range(A.KEYS.shape[0]):
            A.KEYS[q] = -1
    for q in range(F.OWN.shape[0]):
        F.OWN[q] = F.FRESH[q]
    # With the end of the last step unknown (NaN), `read_states` regards all bodies as edited.
    for i in range(R.IDS.shape[1]):
        if R.IDS[BODY_ROW, i] >= 0:
            for c in range(6):
                after[i, c] = math.nan
            for c in range(6, 9):
                now[i, c] = 0.0
    b = F.KEPT.shape[0]
    for q in range(b):
        for c in range(6):
            now[F.KEPT[q], c] = F.INITIAL[F.RUN.rollout * b + q, c]
    for c in range(6):
        F.TOTAL[c] = 0.0
    F.COUNTS[F.RUN.rollout, 0] = 0


@nonallocating
def before_step(A: Scene, F: RunArrays, R: Reading) -> None:
    """Set the states from which the next step starts."""
    RUN, now = F.RUN, R.STATES[READ]
    if RUN.done > 0:
        carry_on(R)
    elif RUN.rollouts > 0:
        set_back(A, F, R)
    if F.PUSH.shape[0] > 0:
        # `frame` counts those of earlier rollouts too.
        b = F.KEPT.shape[0]
        for q in range(b):
            for c in range(3):
                now[F.KEPT[q], 6 + c] = F.PUSH[RUN.frame * b + q, c]


@nonallocating
def after_step(A: Scene, F: RunArrays, R: Reading) -> int:
    """Store the results of a step. Returns 0, or ENERGY or IMPACTS_FULL with nothing done."""
    RUN, PAR, COUNT, LOG, T = F.RUN, A.PAR, A.COUNT, A.LOG, F.TOTAL
    if not math.isfinite(PAR.after):
        return ENERGY
    room = F.EVENTS.shape[0]
    if room > 0 and RUN.kept + COUNT.logged > room:
        return IMPACTS_FULL
    for k in range(COUNT.logged):
        if LOG[k].duration == 0.0 and LOG[k].normal != 0.0:
            RUN.impacts += 1
            if room > 0:
                F.EVENTS[RUN.kept] = LOG[k]
                F.EVENTS[RUN.kept].when = RUN.done * RUN.dt + LOG[k].when
                RUN.kept += 1
    RUN.done += 1
    RUN.time += RUN.dt
    if COUNT.unmet > 0:
        RUN.unmet += 1
        if RUN.rollouts > 0:
            F.COUNTS[RUN.rollout, 0] += 1
    if COUNT.logged > 0 or COUNT.unmet > 0:
        RUN.iterations += COUNT.solves + COUNT.blocks
        if abs(PAR.lock - 1.0) > abs(RUN.lock - 1.0):
            RUN.lock = PAR.lock
    change = PAR.after - PAR.before
    T[0] += change
    T[1] += PAR.external
    T[2] += PAR.restitution
    T[3] += PAR.frictional
    T[4] += PAR.damped
    T[5] += change - (PAR.external - PAR.restitution - PAR.frictional - PAR.damped)
    if RUN.every > 0 and RUN.done % RUN.every == 0:
        after, b = R.STATES[WRITTEN], F.KEPT.shape[0]
        for q in range(b):
            for c in range(6):
                F.FRAMES[RUN.frame * b + q, c] = after[F.KEPT[q], c]
        for c in range(6):
            F.SUMS[RUN.frame, c] = T[c]
        RUN.frame += 1
    RUN.bits |= A.COUNT.bits
    RUN.stage = BETWEEN
    return 0


@nonallocating
def next_rollout(F: RunArrays) -> bool:
    """Proceed to the next rollout; False if there is none."""
    RUN = F.RUN
    if RUN.rollouts == 0:
        return False
    F.COUNTS[RUN.rollout, 1] = RUN.kept
    RUN.rollout, RUN.done = RUN.rollout + 1, 0
    return bool(RUN.rollout < RUN.rollouts)


@kernel
def run(TABLE: Table, JOINTS: Table, ARRAYS: Table, READING: Table) -> int:
    """Take steps until RUN.until of them are done, of each rollout if there are any.

    Args:
        TABLE, JOINTS, READING: see `step.step`.  ARRAYS: `table_of` a RunArrays.

    Returns:
        the bits of all steps; a negative code of a step, or ENERGY, with the state at its start in STATES; or a code
            for more memory: provide it, and call again.
    """
    A, J, F, R = scene_of(TABLE), joints_of(JOINTS), run_arrays_of(ARRAYS), reading_of(READING)
    RUN = F.RUN
    while True:
        while RUN.done < RUN.until:
            if RUN.stage == BETWEEN:
                before_step(A, F, R)
                status = start(A, J, R, RUN.dt, RUN.gravity_x, RUN.gravity_y, RUN.half_damping)
                if status < 0:
                    return status
                RUN.stage = WITHIN
            if RUN.stage == WITHIN:
                status = resume(A, J, R)
                if status < 0:
                    return status
                RUN.stage = AFTER
            status = after_step(A, F, R)
            if status < 0:
                return status
        if not next_rollout(F):
            return RUN.bits


def _flat(table: FloatArray | None, columns: int) -> FloatArray:
    """Rows of a table with so many columns; none for None."""
    return np.zeros((0, columns)) if table is None else np.ascontiguousarray(table, float).reshape(-1, columns)


class RunBuffers:
    """Arguments and results of a run.

    Args:
        dt: time.  gravity: length/time².  half_damping: factor by which half a step's damping multiplies velocities.
        time: simulated time at its start.
        kept: (b,) rows in STATES of the bodies whose frames are stored.  frames: largest number of frames.
        every: steps from frame to frame, 0 for none.  events: whether impacts are stored.
        initial: (K, b, 6) states at which rollouts begin; None: the run continues from the present states.
        push: (K T, b, 3) forces and torques in each stretch of `every` steps, or None.
        into: (T, b, 6) memory for the frames, else new memory.
    """

    def __init__(
        self, dt: float, gravity: tuple[float, ...], half_damping: float, time: float = 0.0, kept: IntArray = _NO_ROWS,
        frames: int = 0, every: int = 0, events: bool = False, initial: FloatArray | None = None,
        push: FloatArray | None = None, into: FloatArray | None = None,
    ) -> None:  # fmt: skip
        b, RUN = len(kept), row(Run)
        rollouts = 0 if initial is None else len(initial)
        RUN.dt, RUN.gravity_x, RUN.gravity_y, RUN.half_damping = dt, *gravity, half_damping
        RUN.time, RUN.lock, RUN.every = time, 1.0, every
        self.arrays = RunArrays(
            RUN, np.ascontiguousarray(kept, np.int64), np.zeros((frames * b, 6)) if into is None else _flat(into, 6),
            np.zeros((frames, 6)),
            rows(Impulse, _IMPACTS if events else 0), np.zeros(6), _flat(initial, 6), _flat(push, 3),
            np.zeros((rollouts, 2), np.int64), _NO_ROWS, _NO_ROWS,
        )  # fmt: skip

    @property
    def frames(self) -> FloatArray:
        """(T, b, 6) poses and velocities."""
        frames: FloatArray = self._arrays.FRAMES.reshape(len(self._arrays.SUMS), len(self._arrays.KEPT), 6)
        return frames

    @property
    def arrays(self) -> RunArrays:
        """All arrays; replaced by setting others."""
        return self._arrays

    @arrays.setter
    def arrays(self, arrays: RunArrays) -> None:
        self._arrays, self.table = arrays, table_of(arrays)
        self.call: Callable[..., int] | None = None  # the loop bound to these arrays

    @property
    def progress(self) -> Run:
        """The progress of the run."""
        return self._arrays.RUN

    def more_events(self) -> None:
        """Double the memory for impacts."""
        arrays = self._arrays
        self.arrays = arrays._replace(EVENTS=lengthened(arrays.EVENTS, int(arrays.RUN.kept)))

    @property
    def events(self) -> Rows[Impulse]:
        """(m,) the impacts so far, `when` from the start of the run."""
        return self._arrays.EVENTS[: self._arrays.RUN.kept]

    @property
    def ledger(self) -> Ledger:
        """The sum of the ledgers of all steps so far."""
        return Ledger(*self._arrays.TOTAL.tolist())

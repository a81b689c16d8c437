"""The buffers of a run of an event loop: its arguments, and its results, with memory that grows as needed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import table_of
from ..compiled.records import Rows, row, rows
from ..energy.ledger import Ledger
from ..model.contacts import Impulse
from ..model.run import Run, RunArrays

_NOBODY: IntArray = np.zeros(0, np.int64)
_IMPACTS = 256  # rows of EVENTS at first


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
        self, dt: float, gravity: tuple[float, ...], half_damping: float, time: float = 0.0, kept: IntArray = _NOBODY,
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
            np.zeros((rollouts, 2), np.int64), _NOBODY, _NOBODY,
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
        longer = rows(Impulse, 2 * len(arrays.EVENTS))
        longer[: arrays.RUN.kept] = arrays.EVENTS[: arrays.RUN.kept]
        self.arrays = arrays._replace(EVENTS=longer)

    @property
    def events(self) -> Rows[Impulse]:
        """(m,) the impacts so far, `when` from the start of the run."""
        return self._arrays.EVENTS[: self._arrays.RUN.kept]

    @property
    def ledger(self) -> Ledger:
        """The sum of the ledgers of all steps so far."""
        return Ledger(*self._arrays.TOTAL.tolist())

"""BodyStates: reads and writes the states of a space's bodies, in one batch call each per step."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import pymunk
from pymunk import batch

from .. import layout
from ..arrays import FloatArray, IntArray, Memory
from ..compiled import Table
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.step import FORCES, TURNS
from ..rehearsing import accept_rounding, alter_end, copy_start, record_changes
from ..transfer import accept_static, read_states, write_ends
from .bodies import STATE_FIELDS, Bodies
from .private import batch as private_batch

_F = batch.BodyFields
# The tables of ENDS: where each begins (in N), and its fields. The key is that place, plus TURNS if the table has
# angles and spins.
_TABLES = {
    layout.END: (layout.END, _F.POSITION | _F.VELOCITY),
    layout.END + TURNS: (layout.END, _F.POSITION | _F.ANGLE | _F.VELOCITY | _F.ANGULAR_VELOCITY),
    layout.RESET_FORCES: (layout.RESET_FORCES, _F.FORCE | _F.TORQUE),
}
# Where IDS, EXTRA, HOOKED and ENDS begin in the memory, whose first array is STATES: in words of 8 bytes, over N.
_IDS = 2 * layout.STATE_COLUMNS
_EXTRA = _IDS + 4
_HOOKED = _EXTRA + layout.EXTRA_COLUMNS
_ENDS = _HOOKED + layout.HOOKED_TABLES * layout.STATE_COLUMNS
_KERNELS = copy_start, write_ends, alter_end, record_changes, accept_rounding, accept_static


class _Writers(dict[int, Callable[[], None]]):
    """Functions that write the tables of ENDS, by the keys of _TABLES; made at the first use from those of `past`,
    which can then no longer be used."""

    def __init__(self, states: BodyStates, past: _Writers | None) -> None:
        self._states = weakref.proxy(states)
        self._past: dict[int, Callable[[], None]] = {} if past is None else {**past._past, **past}

    def __missing__(self, place: int) -> Callable[[], None]:
        states, (start, fields) = self._states, _TABLES[place]
        ends = states.ENDS[start * len(states.bodies) :]
        write = private_batch.writer(states.space, fields, ends, states.bodies.reached, self._past.get(place))
        self[place] = write
        return write


class BodyStates:
    """The states of the bodies of a space, read and written.

    Attributes:
        bodies: in pymunk's order, N with the static ones.
        BODY: (n,).  STATES, IDS, EXTRA, ENDS, HOOKED: the arrays exchanged with pymunk, see `layout.py`.
        reading: their table.  bound: kernels bound to it, see `Layout`.
        copy_start, write_ends, accept_rounding, accept_static: functions, see `rehearsing.copy_start`,
            `transfer.write_ends`, `rehearsing.accept_rounding` and `transfer.accept_static`.
        gather: reads the state of all bodies into STATES[READ].
        eccentric: whether the centre of mass of any body is not its origin. pymunk places such a body by its present
            angle: its pose is written a second time, by the new angle.
        same_as_before: the bodies that were in the world before, see `Bodies.same_in`.
    """

    bodies: Bodies
    BODY: Rows[Body]
    eccentric: bool
    same_as_before: Sequence[tuple[int, int, bool]] = ()
    gather: Callable[[], None]
    copy_start: Callable[[], int]
    write_ends: Callable[[int], int]

    def __init__(self, space: pymunk.Space, past: BodyStates | None) -> None:
        """Make the arrays for the bodies of a space, and read their state into STATES[READ]. `past`: of the same space
        before. These arrays use its memory: it keeps copies of STATES and IDS, and can no longer read and write."""
        self.space = space
        N = len((*space.bodies, space.static_body))  # the latter is created at its first access
        memory = Memory() if past is None else past._memory
        if past is not None:
            past.STATES, past.IDS = past.STATES.copy(), past.IDS.copy()
        self._memory: Memory = memory
        ends, row = layout.END_COLUMNS * N + 1, 8 * N
        memory.provide(0, _ENDS * row + 8 * ends)
        # STATES and IDS have more rows than a call fills, so that there is room for one body more: pymunk replaces
        # memory that is too small by its own. After additions the ids differ at once, and other arrays are made.
        self.STATES: FloatArray = memory.array((2, N, layout.STATE_COLUMNS), float, 0)
        self.IDS: IntArray = memory.array((4, N), np.int64, _IDS * row)
        self.EXTRA: FloatArray = memory.array((N, layout.EXTRA_COLUMNS), float, _EXTRA * row)
        self.HOOKED: FloatArray = memory.array((layout.HOOKED_TABLES, N, layout.STATE_COLUMNS), float, _HOOKED * row)
        self.ENDS: FloatArray = memory.array((ends,), float, _ENDS * row)
        last = None if past is None else past.gather
        self.gather = private_batch.reader(space, STATE_FIELDS, self.STATES, self.IDS, last)
        self.gather()
        self.IDS[layout.KNOWN_ID] = self.IDS[layout.READ_ID]
        self._write: _Writers = _Writers(self, None if past is None else past._write)

    def bind(self, reading: Table, bound: Callable[..., list[Callable[..., Any]]]) -> None:
        """Set `reading` and `bound`, and make the functions that use kernels on these arrays."""
        self.reading, self.bound = reading, bound
        self.copy_start, self.write_ends, self._alter_end, self._record_changes, *accept = bound(*_KERNELS)
        self.accept_rounding, self.accept_static = accept

    def load(self) -> None:
        """Read the present states into BODY."""
        self.gather()
        self.read_states(0.0, 0.0, 1.0)

    @cached_property
    def read_states(self) -> Callable[[float, float, float], int]:
        """See `transfer.read_states`."""
        return read_states.bind(self.STATES, self.IDS, self.EXTRA, self.BODY)

    def gather_changes(self) -> bool:
        """Read the states again after functions before the motion: these may have pushed or moved any body. Static ones
        move at the end of the step (HOOKED[CHANGES_AFTER]); returns whether there are any."""
        still = self.bodies.static
        known = self.state[still]
        self.gather()
        moved = self.state[still] - known
        if not moved.any():
            return False
        self.HOOKED[layout.CHANGES_AFTER, still] += moved
        self.state[still] = known
        return True

    def before_call(self) -> None:
        """Read the states before a call of a function whose changes are recorded (`after_call`)."""
        self.gather()
        self.HOOKED[layout.BEFORE_CALL] = self.STATES[layout.READ]

    def after_call(self, late: bool) -> int:
        """Read the states, and record the changes since `before_call` (`rehearsing.record_changes`)."""
        self.gather()
        return int(self._record_changes(int(late)))

    def reset_forces(self) -> None:
        """Write the forces and torques at the end of the step (table RESET_FORCES), reset as pymunk does."""
        self._write[layout.RESET_FORCES]()

    @property
    def start(self) -> FloatArray:
        """(N, 9) the state at the start of a step that calls functions, copied by `copy_start`."""
        state: FloatArray = self.HOOKED[layout.START]
        return state

    def forget_changes(self) -> None:
        """Forget the changes by functions within a step, HOOKED[CHANGES_BEFORE] and HOOKED[CHANGES_AFTER]."""
        self.HOOKED[layout.CHANGES_BEFORE] = self.HOOKED[layout.CHANGES_AFTER] = 0.0

    def alter_end(self, stops: bool) -> tuple[int, float]:
        """See `rehearsing.alter_end`; returns its status, and the energy lost by damping 0."""
        return self._alter_end(int(stops)), float(self.ENDS[-1])

    def keep_unaltered(self) -> None:
        """Set STATES[WRITTEN] to the end of the step without HOOKED[CHANGES_AFTER], so that bodies that functions have
        changed in the step count as edited in the next one."""
        self.STATES[layout.WRITTEN] = self.HOOKED[layout.UNALTERED]

    def is_current(self) -> bool:
        """Whether `gather` has read these bodies, and no static one was moved since the rows were made."""
        now, then = (self.STATES[which, self.bodies.static, :3] for which in (layout.READ, layout.WRITTEN))
        return self.same_bodies() and np.array_equal(now, then)

    def same_bodies(self) -> bool:
        """Whether `gather` has read these bodies and no others."""
        now, known = self.IDS[layout.READ_ID].tobytes(), self.IDS[layout.KNOWN_ID].tobytes()
        return bool(now == known)  # numpy takes five times as long to compare few numbers

    def static_moved_since(self) -> bool:
        """Whether a static body was moved since the rows were made, by the present poses, also if other bodies have
        come, or pymunk's order has changed. Not of bodies that slept: pymunk wakes those that a program moves."""
        still: list[int] = (self.bodies.static & ~self.bodies.asleep).nonzero()[0].tolist()
        known = [(self.bodies.items[i], self.STATES[layout.WRITTEN, i, :3].tolist()) for i in still]
        return any(body.space is self.space and [*body.position, body.angle] != pose for body, pose in known)

    @property
    def state(self) -> FloatArray:
        """(N, 9) position, angle, velocity, spin, force and torque of `bodies`, as `gather` has read them."""
        now: FloatArray = self.STATES[layout.READ]
        return now

    def set_accelerations(self, change: Sequence[tuple[float, float, float]], dt: float) -> None:
        """Set the accelerations of the bodies with velocity functions in EXTRA. `change`: of each of them, in the order
        of `bodies.velocity_hooks`, the change of velocity (2) and spin within dt."""
        # One by one: for few bodies numpy's indices take several times as long.
        memory = self._extra
        for at, (x, y, spin) in zip(self._pushed, change, strict=True):
            memory[at], memory[at + 1], memory[at + 2] = x / dt, y / dt, spin / dt

    @cached_property
    def _extra(self) -> memoryview[float]:
        return self.EXTRA.data.cast("B").cast("d")

    @cached_property
    def _pushed(self) -> list[int]:
        """Where the accelerations of the bodies with velocity functions begin in `_extra`."""
        return [row * layout.EXTRA_COLUMNS + layout.ACCELERATION_X for row in self.bodies.velocity_hooks.tolist()]

    def write_whole(self) -> int:
        """Write the end of the step to ENDS, always with forces and angles; returns the status bits."""
        return self.write_ends(FORCES | TURNS)

    def ended(self) -> FloatArray:
        """(N, 9) the end of the step, by STATES[WRITTEN]; forces of moving bodies are 0, as after a step of pymunk."""
        state = self.state.copy()
        moving = ~self.bodies.static
        state[moving, :6], state[moving, 6:] = self.STATES[layout.WRITTEN, moving, :6], 0.0
        return state

    def recall(self, before: BodyStates) -> None:
        """Copy STATES[WRITTEN] from the world before, of bodies whose kind and centre of gravity are the same: the next
        step counts them as unedited unless their state differs from it. Of those with another mass or moment, or that
        have woken, only poses are copied, so that their velocities count as edited."""
        self.same_as_before = self.bodies.same_in(before.bodies)
        # Row by row: numpy's indices take longer for few bodies, and as long for a hundred.
        row, number = self.STATES.strides[1:]
        to, of = (states.STATES[layout.WRITTEN].data.cast("B") for states in (self, before))
        for i, j, unedited in self.same_as_before:
            size = row if unedited else 3 * number
            to[i * row : i * row + size] = of[j * row : j * row + size]

    def void_predictions(self) -> None:
        """Void all predictions: in the next step all bodies count as placed by the program (PLACED in `layout.py`)."""
        due = self.BODY["due"]
        np.minimum(due, layout.PLACED, out=due)

    def scatter(self, status: int) -> None:
        """Write poses and velocities at the end of the step to the space, angles and spins if the bit TURNS is set."""
        self._write[layout.END + (status & TURNS)]()
        if self.eccentric:
            self._write[layout.END + (status & TURNS)]()

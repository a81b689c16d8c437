"""World: a pymunk space as packed arrays, read once; its moving state crosses in one batch call each way and step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
import pymunk
from pymunk import batch

from ..arrays import FloatArray, IntArray
from ..layout import (
    BODY_ROW,
    COG_X,
    COG_Y,
    ECCENTRIC,
    END,
    END_COLUMNS,
    EXTRA_COLUMNS,
    FOUND,
    FRICTION,
    GRIP,
    GROUP,
    KNOWN,
    LEFT,
    MASK,
    NOW,
    PULL,
    PUSH_TWIST,
    PUSH_X,
    SPECIAL,
    SPEED,
    STATE_COLUMNS,
    STEERED,
    STILL,
)  # fmt: skip
from ..report import nothing
from ..transfer import FORCES, TURNS, lay, lay_rest, take
from . import private
from .bodies import ANGULAR_VELOCITY, VELOCITY, Bodies
from .checks import check_shape, check_space, rough_pair
from .noticed import edits
from .packing import Record, pack, read
from .shapes import Rules

_F = batch.BodyFields
_MOTION = _F.POSITION | _F.ANGLE | _F.VELOCITY | _F.ANGULAR_VELOCITY
_STATE = _MOTION | _F.FORCE | _F.TORQUE
_COLLIDES_WITH_ALL = tuple(pymunk.ShapeFilter())

Records: TypeAlias = dict[pymunk.Shape, Record | None]


class World:
    """The bodies and solid shapes of one space; ValueError or UnsupportedFeature for what cannot be stepped.

    Masses, shapes and functions of bodies are read once. `current()` tells, in half a microsecond, whether settings and
    contents of the space are still those, and whether shapes and bodies were edited in place (`noticed.py`); moved
    static bodies and exchanged bodies show in what `gather` reads, which `transfer.take` tells.

    Args:
        space: any pymunk space.  ignore: what to step on without, see `check_ignored`.
        before: the world of the same space before shapes came or went, whose shapes are not read again.

    Attributes:
        records: what the shapes of the space say of themselves, None for sensors.
        bodies: in pymunk's order, N with the static ones.  shapes: by row of SHAPE.
        owner: (k,) place in `bodies.items` of the body of every shape.
        BODY, SHAPE, LINK, VERTEX: see `layout.py`.  disks, dynamic: rows of BODY below which there are lone disks, and
            dynamic bodies; the rows from there to the last one, the ground, are kinematic.
        STATES, WALK, EXTRA, ENDS: what crosses the edge, see `layout.py`.
        gravity: length/time².  damping: pymunk's, 1 is none.
        ignores: whether there is friction that is ignored.  filtered: whether any shape has a filter.
        collisions: whether the space has collision handlers.  hooked: whether it or its bodies have functions, or
            velocities are gone after each step.
        rules: what collision handlers decided about pairs of rows of SHAPE for this step.
        empty: the arrays of a report without contacts.
    """

    def __init__(self, space: pymunk.Space, ignore: Sequence[str] = (), before: World | None = None) -> None:
        check_space(space)
        self.space = space
        self._edits = edits(space)
        self._known = self._edits[0]
        self.bodies = bodies = Bodies(space)
        state = bodies.gather()
        assert state is not None  # read from these very bodies
        bodies.check_finite(state)
        self.records: Records = self._records({} if before is None else before.records)
        solid = [s for s, record in self.records.items() if record is not None]
        self.ignores = "friction" in ignore and rough_pair(solid) is not None
        packed = pack(bodies, state, solid, [r for r in self.records.values() if r is not None])
        self.shapes, self.owner = packed.shapes, packed.owner
        self.BODY, self.SHAPE, self.LINK, self.VERTEX = packed.BODY, packed.SHAPE, packed.LINK, packed.VERTEX
        if "friction" in ignore:
            self.SHAPE[:, FRICTION] = 0.0
            self.BODY[:, GRIP] = 0.0
        self.disks, self.dynamic = packed.disks, packed.dynamic
        self.filtered = bool((self.LINK[:, GROUP : MASK + 1] != _COLLIDES_WITH_ALL).any())
        self.empty = nothing(bodies.items)
        self._allocate(packed.row, state)
        self.read_settings()

    def _records(self, known: Records) -> Records:
        """What every shape says, None for sensors; those that are known are not asked again."""
        records: Records = {}
        for shape in self.space.shapes:
            if shape in known:
                records[shape] = known[shape]
                if shape.body not in self.bodies.row:
                    check_shape(shape, self.bodies)
            elif shape.sensor:
                records[shape] = None
            else:
                check_shape(shape, self.bodies)
                records[shape] = read(shape)
        return records

    def _allocate(self, row: IntArray, state: FloatArray) -> None:
        bodies, space, N = self.bodies, self.space, len(self.bodies)
        # One body more than there are: pymunk must never find this memory too small.
        floats, ids = np.zeros(max(2 * N, N + 1) * STATE_COLUMNS), np.zeros(max(4 * N, N + 1), np.int64)
        self.STATES: FloatArray = floats[: 2 * N * STATE_COLUMNS].reshape(2, N, STATE_COLUMNS)
        self.WALK: IntArray = ids[: 4 * N].reshape(4, N)
        self.EXTRA: FloatArray = np.zeros((N, EXTRA_COLUMNS))
        self.ENDS: FloatArray = np.zeros(END_COLUMNS * N)
        self.WALK[KNOWN] = bodies.ids
        self.WALK[BODY_ROW] = row
        self.WALK[SPECIAL] = STEERED * bodies.steered + ECCENTRIC * bodies.center_of_gravity.any(axis=1)
        self.EXTRA[:, COG_X : COG_Y + 1] = bodies.center_of_gravity
        self.STATES[LEFT] = np.where(bodies.static[:, None], state, np.nan)
        self.gather = private.reader(space, _F.BODY_ID | _STATE, floats, ids)
        self._restore = private.writer(space, _STATE, floats)
        self.reset_forces = private.writer(space, _F.FORCE | _F.TORQUE, self.ENDS[PULL * N :])
        # By whether angles and spins are to be written.
        self._scatter = self._writers(_F.POSITION | _F.VELOCITY, END)
        self._scatter_still = self._writers(_F.POSITION | _F.VELOCITY, STILL)
        self._scatter_speed = self._writers(_F.VELOCITY, SPEED)
        # pymunk places a body whose centre of mass is elsewhere by the angle it has: the second time by the new one.
        self._twice = bool(bodies.center_of_gravity.any())

    def _writers(self, fields: batch.BodyFields, start: int) -> dict[int, Callable[[], None]]:
        """What writes the fields from the table that begins at `start` in ENDS, by the bit TURNS of a step's answer."""
        N, turning = len(self.bodies), fields
        for straight, turned in ((_F.POSITION, _F.ANGLE), (_F.VELOCITY, _F.ANGULAR_VELOCITY)):
            if straight in fields:
                turning |= turned
        table = self.ENDS[start * N :]
        return {0: private.writer(self.space, fields, table), TURNS: private.writer(self.space, turning, table)}

    def read_settings(self) -> None:
        """Read the settings of the space, checked, and watch them from now on."""
        check_space(self.space)
        self.gravity = tuple(self.space.gravity)
        self.damping = self.space.damping
        self.collisions = bool(private.handlers(self.space))
        self.rules = Rules()
        bodies = self.bodies
        functions = len(bodies.velocity_hooks) > 0 or len(bodies.position_hooks) > 0
        self.hooked = self.collisions or functions or self.damping == 0.0
        self._contents = self._count()
        self.current = private.watch(self.space, self._edits)

    def _count(self) -> tuple[int, int, int]:
        return private.shapes_ever(self.space), len(self.space.shapes), len(self.space.bodies)

    def same_contents(self) -> bool:
        """Whether shapes have neither come nor gone nor changed, so that new settings are all there is to read."""
        return self._contents == self._count() and not self.edited()

    def edited(self) -> bool:
        """Whether a shape or body was edited in place."""
        return self._edits[0] != self._known

    def is_current(self) -> bool:
        """Whether what `gather` read is of these very bodies, and no static one was moved."""
        if not np.array_equal(self.WALK[FOUND], self.WALK[KNOWN]):
            return False
        still = self.bodies.static
        return np.array_equal(self.STATES[NOW, still, :3], self.STATES[LEFT, still, :3])

    def load(self) -> None:
        """Put what pymunk has now into BODY."""
        self.gather()
        take(self.STATES, self.WALK, self.EXTRA, self.BODY, 0.0, 0.0, 1.0)

    @property
    def state(self) -> FloatArray:
        """(N, 9) what `gather` read: position, angle, velocity, spin, force and torque of `bodies`."""
        now: FloatArray = self.STATES[NOW]
        return now

    def left(self, dt: float) -> float:
        """What half a step's damping leaves of velocities; all where nothing is left at the end, see `stop`."""
        return self.damping ** (0.5 * dt) if self.damping > 0.0 else 1.0

    def stop(self, end: FloatArray) -> float:
        """Take all velocities from the (N, 9) `end`, as damping 0 does; the energy that is lost.

        Within the step bodies keep them, else nothing would ever move: pymunk moves bodies before it damps them.
        """
        bodies = self.bodies
        stops = bodies.dynamic & ~bodies.steered
        speed, spin = end[stops, VELOCITY], end[stops, ANGULAR_VELOCITY]
        moment = bodies.moment[stops]
        turning = np.where(np.isfinite(moment), moment, 0.0)
        lost = 0.5 * float(np.sum(bodies.mass[stops] * (speed * speed).sum(axis=1)) + np.sum(turning * spin * spin))
        end[stops, VELOCITY], end[stops, ANGULAR_VELOCITY] = 0.0, 0.0
        return lost

    def push(self, change: FloatArray, dt: float) -> None:
        """Let the bodies with velocity functions accelerate: velocities change by (k, 3) within dt."""
        self.EXTRA[self.bodies.velocity_hooks, PUSH_X : PUSH_TWIST + 1] = change / dt

    def put(self, end: FloatArray) -> int:
        """Take (N, 9) as the end of the step in the place of what the step gave, whatever pymunk has now; its bits."""
        self.STATES[LEFT] = end
        return lay(self.STATES, self.WALK, self.ENDS, FORCES | TURNS)

    def ended(self) -> FloatArray:
        """(N, 9) the end of the step; forces are reset as pymunk does."""
        state = self.state.copy()
        moving = ~self.bodies.static
        state[moving, :6], state[moving, 6:] = self.STATES[LEFT, moving, :6], 0.0
        return state

    def forget(self) -> None:
        """Whatever the bodies have next is new: what the last step left in pymunk is not what it gave."""
        self.STATES[LEFT][~self.bodies.static] = np.nan

    def scatter(self, status: int) -> None:
        """Write poses and velocities at the end of the step to the space, angles and spins if the bit TURNS is set."""
        self._scatter[status & TURNS]()
        if self._twice:
            self._scatter[status & TURNS]()

    def scatter_still(self, status: int) -> None:
        """Write the poses, and velocity 0; `scatter_speed` must follow."""
        lay_rest(self.STATES, self.ENDS, status)
        self._scatter_still[status & TURNS]()
        if self._twice:
            self._scatter_still[status & TURNS]()

    def scatter_speed(self, status: int) -> None:
        """Write the velocities."""
        self._scatter_speed[status & TURNS]()

    def restore(self) -> None:
        """Write back what `gather` read: the space as it was."""
        self._restore()
        if self._twice:
            self._restore()

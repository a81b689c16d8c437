"""Partners: bodies of joints that have no row in BODY, since no step moves them.

They are static and sleeping bodies, `space.static_body`, and bodies of any type outside the space. Joints act on the
other body only, by the partner's pose. A kinematic body outside the space also acts with the velocity that the program
has set, as under pymunk, though its pose does not change.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import pymunk
from pymunk import batch

from ..arrays import FloatArray, IntArray
from ..compiled.records import over, selected
from ..errors import NotFiniteError
from ..model.bodies import Body
from .edits import clock
from .private import batch as private_batch
from .private import joints as private_joints

_FIELDS = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
_FIELDS |= batch.BodyFields.ANGULAR_VELOCITY
_MOTION = struct.Struct("6d")  # the first fields of `Body`: pose and velocity


class Partners:
    """The rows of the partners of a space; NotFiniteError if a pose or velocity is not finite.

    Attributes:
        items: the bodies, by row.  PARTNER: (x,) records `Body` with poses and, of kinematic bodies, velocities.
        still: (x,) 1 for static bodies, else 0.
        outside: rows of the bodies outside the space, which the program may have moved.
        changed: rows of the bodies that differ from those of `past`, or are new.
    """

    def __init__(self, items: Sequence[pymunk.Body], space: pymunk.Space, past: Partners | None = None) -> None:
        self.items = tuple(items)
        before = {} if past is None else {body: i for i, body in enumerate(past.items)}
        past_rows = [before.get(body, -1) for body in self.items]
        # Rows of new bodies are written by `_read` below.
        self._memory: bytearray = selected(Body, bytearray() if past is None else past._memory, past_rows)
        self.PARTNER = over(Body, self._memory)
        known = [] if past is None else past._known
        self._known: list[tuple[float, ...] | None] = [known[i] if i >= 0 else None for i in past_rows]
        self.still: IntArray = np.array([body.body_type == pymunk.Body.STATIC for body in self.items], np.int64)
        # Moved static bodies of the space are found where the states of all its bodies are read.
        self.outside = [i for i, body in enumerate(self.items) if body.space is not space]
        self.changed = self._read(range(len(self.items)))
        self._last: tuple[bytes, int] = b"", -1  # motions of the bodies outside in the last step, and `edits.clock`

    def read(self) -> list[int]:
        """Read the bodies outside the space; returns the rows of those whose pose or velocity has changed."""
        motions, gather = self._motions
        gather()
        now = motions.tobytes(), clock()
        if now == self._last:
            return []
        moved = self._read(self.outside)
        self._last = now
        return moved

    @cached_property
    def _motions(self) -> tuple[FloatArray, Callable[[], None]]:
        """An array for the poses and velocities of the bodies outside, with room for one body more (see
        `private_batch.reader`), and the function that fills it."""
        motions = np.zeros(6 * (len(self.outside) + 1))
        return motions, private_batch.reader_of([self.items[i] for i in self.outside], _FIELDS, motions)

    def _read(self, rows: Sequence[int]) -> list[int]:
        """Read the bodies of these rows and write their records; returns the rows that have changed."""
        changed = []
        for i in rows:
            body = self.items[i]
            state = private_joints.pose_and_motion(body)
            if state == self._known[i]:
                continue
            x, y, angle, vx, vy, spin = state[:6]
            if not (math.isfinite(sum(state)) or all(map(math.isfinite, state))):
                raise NotFiniteError(
                    f"{body}, which a constraint holds, has position {body.position}, angle {angle}, velocity "
                    f"{body.velocity} and angular velocity {spin}: set finite values before stepping"
                )
            changed.append(i)
            self._known[i] = state
            c, s, kx, ky = math.cos(angle), math.sin(angle), *state[6:]
            place = i * Body.TYPE.itemsize
            _MOTION.pack_into(self._memory, place, x + c * kx - s * ky, y + s * kx + c * ky, angle, vx, vy, spin)
        return changed

    def motion(self, i: int) -> tuple[float, float, float, float, float, float]:
        """Position of the origin (2), angle, velocity (2) and spin of the body in row i, as last read."""
        known = self._known[i]
        assert known is not None  # read when these rows were made
        return known[:6]  # type: ignore[return-value]

    def motions(self) -> list[Any]:
        """The velocities of the bodies outside the space, for `private_joints.restore_motions` after a step of pymunk.
        There constraints change them, though pymunk does not move these bodies; to nan if both bodies of a constraint
        have infinite mass."""
        return private_joints.motions([self.items[i] for i in self.outside])

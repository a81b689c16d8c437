"""Partners: bodies at the other end of joints that have no row among the bodies that a step moves.

They are static bodies, `space.static_body`, and bodies of any type outside the space. Joints act from their poses and
do not move them. A kinematic body outside the space acts with the velocity that the program sets, as under pymunk, but
is not moved by it.
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
from ..compiled.records import moved, over
from ..errors import NotFiniteError
from ..model.bodies import Body
from .edits import clock
from .private import batch as private_batch
from .private import joints as private_joints

_FIELDS = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
_FIELDS |= batch.BodyFields.ANGULAR_VELOCITY
_MOTION = struct.Struct("6d")  # the first fields of `Body`: pose and velocity


class Partners:
    """The rows of some bodies; NotFiniteError if a pose or velocity is not finite.

    Attributes:
        items: the bodies, by row.  PARTNER: (x,) their poses and, of kinematic ones, velocities.
        still: (x,) 1 for static bodies, else 0: those never move but where the program puts them elsewhere.
        outside: rows of the bodies outside the space, which may have moved.
    """

    def __init__(self, items: Sequence[pymunk.Body], space: pymunk.Space, past: Partners | None = None) -> None:
        self.items = tuple(items)
        before = {} if past is None else {body: i for i, body in enumerate(past.items)}
        there = [before.get(body, -1) for body in self.items]
        # Those that are new are written below.
        self._memory: bytearray = moved(Body, bytearray() if past is None else past._memory, there)
        self.PARTNER = over(Body, self._memory)
        known = [] if past is None else past._known
        self._known: list[tuple[float, ...] | None] = [known[i] if i >= 0 else None for i in there]
        self.still: IntArray = np.array([body.body_type == pymunk.Body.STATIC for body in self.items], np.int64)
        # Moved static bodies of the space are found where the states of all its bodies are read.
        self.outside = [i for i, body in enumerate(self.items) if body.space is not space]
        self.changed = self._read(range(len(self.items)))
        self._last: tuple[bytes, int] = b"", -1  # motions of the bodies outside in the last step, and `edits.clock`

    def read(self) -> list[int]:
        """Read the bodies that may have moved; returns the rows of those that have."""
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
        """Room for the motions of the bodies outside, and of one more, and the function that reads them."""
        motions = np.zeros(6 * (len(self.outside) + 1))
        return motions, private_batch.reader_of([self.items[i] for i in self.outside], _FIELDS, motions)

    def _read(self, rows: Sequence[int]) -> list[int]:
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
        """Position of the origin, angle, velocity and spin of body i, as last read."""
        known = self._known[i]
        assert known is not None  # read when these rows were made
        return known[:6]  # type: ignore[return-value]

    def motions(self) -> list[Any]:
        """The velocities of the bodies outside the space, for `private_joints.restore_motions` after a step of pymunk:
        constraints change them there though pymunk does not move these bodies, to nan if neither body of a constraint
        has mobility."""
        return private_joints.motions([self.items[i] for i in self.outside])

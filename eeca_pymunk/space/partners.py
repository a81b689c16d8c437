"""Partners: bodies at the other end of joints that have no row among the bodies that a step moves.

They are static bodies, `space.static_body`, and bodies of any type outside the space. Joints act from their poses and
do not move them. A kinematic body outside the space acts with the velocity that the program sets, as under pymunk, but
is not moved by it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import pymunk

from ..arrays import IntArray
from ..compiled.records import rows
from ..errors import NotFiniteError
from ..model.bodies import POSE, VELOCITY, Body
from . import private_joints

_MOTION = *POSE, *VELOCITY
_NONE: IntArray = np.zeros(0, np.int64)


class Partners:
    """The rows of some bodies.

    Attributes:
        items: the bodies, by row.  PARTNER: (x,) their poses and, of kinematic ones, velocities.
        still: (x,) 1 for static bodies, else 0: those never move but where the program puts them elsewhere.
        outside: rows of the bodies outside the space, which may have moved.
    """

    def __init__(self, items: Sequence[pymunk.Body], space: pymunk.Space, past: Partners | None = None) -> None:
        self.items = tuple(items)
        self.PARTNER = rows(Body, len(self.items))
        self._known: list[tuple[float, ...] | None] = [None] * len(self.items)
        if past is not None:
            before = {body: i for i, body in enumerate(past.items)}
            for i, body in enumerate(self.items):
                if body in before:
                    self._known[i] = past._known[before[body]]
                    self.PARTNER[i] = past.PARTNER[before[body]]
        self.still: IntArray = np.array([body.body_type == pymunk.Body.STATIC for body in self.items], np.int64)
        # Moved static bodies of the space are found where the states of all its bodies are read.
        self.outside = [i for i, body in enumerate(self.items) if body.space is not space]
        self.changed: IntArray = self._read(range(len(self.items)))

    def read(self) -> IntArray:
        """Read the bodies that may have moved; returns the rows of those that have."""
        return self._read(self.outside)

    def _read(self, rows: Sequence[int]) -> IntArray:
        changed = []
        for i in rows:
            body = self.items[i]
            state = private_joints.pose_and_motion(body)
            if state == self._known[i]:
                continue
            x, y, angle, vx, vy, spin = state[:6]
            if not all(math.isfinite(v) for v in state):
                raise NotFiniteError(
                    f"{body}, which a constraint holds, has position {body.position}, angle {angle}, velocity "
                    f"{body.velocity} and angular velocity {spin}: set finite values before stepping"
                )
            changed.append(i)
            self._known[i] = state
            c, s, kx, ky = math.cos(angle), math.sin(angle), *state[6:]
            place = x + c * kx - s * ky, y + s * kx + c * ky
            for name, number in zip(_MOTION, (*place, angle, vx, vy, spin), strict=True):
                self.PARTNER[name][i] = number
        return np.array(changed, np.int64) if changed else _NONE

    def motion(self, i: int) -> tuple[float, float, float, float, float, float]:
        """Position, angle, velocity and spin of body i, as last read."""
        known = self._known[i]
        assert known is not None  # read when these rows were made
        return known[:6]  # type: ignore[return-value]

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Within this block steps of pymunk do not change bodies outside the space: pymunk's constraints change their
        velocities though it does not move them, to nan if neither body of a constraint has mobility."""
        with private_joints.moving_on([self.items[i] for i in self.outside]):
            yield

"""Partners: bodies of joints that have no row in BODY, since no step moves them.

They are static and sleeping bodies, `space.static_body`, and bodies of any type outside the space. Joints act on the
other body only, by the partner's pose. A kinematic body outside the space also acts with the velocity that the program
has set, as under pymunk, though its pose does not change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk import batch

from ..arrays import IntArray
from ..compiled.records import Rows, over, selected
from ..errors import NotFiniteError
from ..joints.partners import PARTNER_NOT_FINITE, read_partners
from ..model.bodies import Body
from ..model.joints import Joint
from .edits import clock
from .private import batch as private_batch
from .private import joints as private_joints

_FIELDS = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
_FIELDS |= batch.BodyFields.ANGULAR_VELOCITY


class _Reader(NamedTuple):
    """Some bodies, their rows, and functions that read their motions, and write what has changed into the rows."""

    items: Sequence[pymunk.Body]
    rows: Sequence[int]
    gather: Callable[[], None]
    write: Callable[[int], int]


class Partners:
    """The rows of the partners of a space; NotFiniteError if a pose or velocity is not finite.

    Attributes:
        items: the bodies, by row.  PARTNER: (x,) records `Body` with poses and, of kinematic bodies, velocities.
        still: (x,) 1 for static bodies, else 0.
        outside: rows of the bodies outside the space, which the program may have moved.
    """

    def __init__(
        self, items: Sequence[pymunk.Body], space: pymunk.Space, joint: Rows[Joint], n: int,
        past: Partners | None = None,
    ) -> None:  # fmt: skip
        """`joint`: the joints of these bodies, n + row; those of bodies that are new or differ from `past` are marked
        as EDITED."""
        self.items, self._joint = tuple(items), joint
        before = {} if past is None else {body: i for i, body in enumerate(past.items)}
        past_rows = [before.get(body, -1) for body in self.items]
        # Rows of new bodies are written by `read_partners` below.
        self._memory: bytearray = selected(Body, bytearray() if past is None else past._memory, past_rows)
        self.PARTNER = over(Body, self._memory)
        # See `read_partners`.
        self._fixed, self._known = np.full((len(items), 3), np.nan), np.full((len(items), 6), np.nan)
        for i, row in enumerate(past_rows):
            if past is not None and row >= 0:
                self._fixed[i], self._known[i] = past._fixed[row], past._known[row]
        self.renumber(space, n, True)

    def renumber(self, space: pymunk.Space, n: int, anew: bool) -> None:
        """Read all bodies, whose numbers begin with n from now on. `anew`: centres of gravity and kinds, too."""
        # Moved static bodies of the space are found where the states of all its bodies are read.
        self._n, self.outside = n, [i for i, body in enumerate(self.items) if body.space is not space]
        self.__dict__.pop("_outside", None)
        self._clock = clock()
        if anew:
            self._find_fixed(range(len(self.items)))
            self.still: IntArray = (self._fixed[:, 2] < 0.0).astype(np.int64)
        if self.items:
            self._read(self._all)

    def read(self) -> int:
        """Read the bodies outside the space, and mark the joints of those that have moved as EDITED; returns how
        many of them are static."""
        if self._clock != (now := clock()):
            self._find_fixed(self.outside)
            self._clock = now
        return self._read(self._outside)

    @cached_property
    def _all(self) -> _Reader:
        return self._reader(range(len(self.items)))

    @cached_property
    def _outside(self) -> _Reader:
        return self._reader(self.outside)

    def _find_fixed(self, rows: Sequence[int]) -> None:
        """Read the centres of gravity and the kinds of the bodies of these rows, which only setters change."""
        at: IntArray = np.array(rows, np.int64)
        now = np.array([private_joints.centre_and_kind(self.items[i]) for i in rows]).reshape(-1, 3)
        self._known[at[(now != self._fixed[at]).any(axis=1)]] = np.nan
        self._fixed[at] = now

    def _reader(self, rows: Sequence[int]) -> _Reader:
        """What `_read` takes, for the bodies of these rows."""
        items = [self.items[i] for i in rows]
        motion = np.zeros(6 * (len(rows) + 1))  # room for one body more, see `private_batch.reader`
        gather = private_batch.reader_of(items, _FIELDS, motion)
        write = read_partners.bind(
            motion, np.array(rows, np.int64), self._fixed, self._known, self.PARTNER, self._joint
        )  # fmt: skip
        return _Reader(items, rows, gather, write)

    def _read(self, reader: _Reader) -> int:
        """Read bodies; returns how many static ones have moved."""
        reader.gather()
        status = reader.write(self._n)
        if status == PARTNER_NOT_FINITE:
            body = reader.items[np.isnan(self._known[reader.rows, 0]).argmax()]
            raise NotFiniteError(
                f"{body}, which a constraint holds, has position {body.position}, angle {body.angle}, velocity "
                f"{body.velocity} and angular velocity {body.angular_velocity}: set finite values before stepping"
            )
        return status

    def motion(self, i: int) -> tuple[float, float, float, float, float, float]:
        """Position of the origin (2), angle, velocity (2) and spin of the body in row i, as last read."""
        return tuple(self._known[i].tolist())

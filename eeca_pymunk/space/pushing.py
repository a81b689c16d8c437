"""Pushing: which constraints exert forces in a rest step of pymunk (`sync.py`), and which have a sleeping body."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk

from ..compiled.records import Rows
from ..model.joints import Joint


class Pushing:
    """Lists of the constraints of a space, made again only when they change.

    Args:
        items: the constraints, by row of `joint` (j,).  always: those that push in any case.
        asleep: those that have a sleeping body.
    """

    def __init__(
        self, items: Sequence[pymunk.Constraint], joint: Rows[Joint], always: Sequence[pymunk.Constraint],
        asleep: set[pymunk.Constraint],
    ) -> None:  # fmt: skip
        self._items, self._joint, self._always, self._asleep = items, joint, always, asleep
        self._touched = b""
        self._now: list[pymunk.Constraint] = []
        self._last: Sequence[pymunk.Constraint] = ()
        self._awake: list[pymunk.Constraint] = []

    def now(self) -> list[pymunk.Constraint]:
        """The constraints that push: those that always do, and joints that are or may be apart."""
        touched = self._joint["touched"].tobytes()
        if touched != self._touched:
            apart = np.flatnonzero(self._joint["touched"]).tolist()
            self._touched = touched
            self._now = list(dict.fromkeys((*self._always, *(self._items[j] for j in apart))))
        return self._now

    def awake(self, items: Sequence[pymunk.Constraint]) -> list[pymunk.Constraint]:
        """Those of constraints that have no sleeping body; `items` must stay as it is."""
        if items is not self._last:
            self._last, self._awake = items, [item for item in items if item not in self._asleep]
        return self._awake

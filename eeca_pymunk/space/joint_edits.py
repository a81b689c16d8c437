"""Edits of constraints are recorded when they are made.

pymunk records none: its setters write into Chipmunk at once. But all attributes of constraints are set in Python. So
`pymunk.Constraint.__setattr__` is replaced when the first `Edits` is made; for constraints without one it acts as
before.
"""

from __future__ import annotations

from typing import Any
from weakref import ref

import pymunk

# All `Edits` by their numbers. To iterate over a `WeakSet` takes ten times as long, in every edit of any constraint.
_watching: dict[int, ref[Edits]] = {}
_native_setattr = pymunk.Constraint.__setattr__


class Edits:
    """The edits of the constraints of one listing.

    Attributes:
        rows: those of the constraints of which an attribute was set since the last `take`.
    """

    def __init__(self, row: dict[pymunk.Constraint, int]) -> None:
        """`row`: the row of each constraint."""
        self._row = row
        self.rows: set[int] = set()
        number = id(self)
        _watching[number] = ref(self, lambda _: _watching.pop(number))
        if pymunk.Constraint.__setattr__ is not _set:
            pymunk.Constraint.__setattr__ = _set  # type: ignore[method-assign, assignment]

    def take(self) -> set[int]:
        """Return the rows, and clear them."""
        edited, self.rows = self.rows, set()
        return edited

    def forget(self, row: int) -> None:
        """Remove a row, of which this package has just set an attribute itself."""
        self.rows.discard(int(row))

    def record(self, constraint: pymunk.Constraint) -> None:
        """Record that an attribute of a constraint was set."""
        row = self._row.get(constraint)
        if row is not None:
            self.rows.add(row)


def _set(self: pymunk.Constraint, name: str, value: Any) -> None:
    _native_setattr(self, name, value)
    for watching in list(_watching.values()):
        edits = watching()
        if edits is not None:
            edits.record(self)

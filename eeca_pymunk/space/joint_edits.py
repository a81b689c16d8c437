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


# Attributes that do not change what functions a constraint has, or whether its bodies collide.
_NUMBERS = frozenset((
    "anchor_a", "anchor_b", "angle", "damping", "distance", "error_bias", "groove_a", "groove_b", "max", "max_bias",
    "max_force", "min", "phase", "ratchet", "rate", "ratio", "rest_angle", "rest_length", "stiffness",
))  # fmt: skip


class Edits:
    """The edits of the constraints of one listing.

    Attributes:
        rows: those of the constraints of which an attribute was set since the last `take`, and whether one was set
            beside _NUMBERS.
    """

    def __init__(self, row: dict[pymunk.Constraint, int]) -> None:
        """`row`: the row of each constraint."""
        self._row = row
        self.rows: dict[int, bool] = {}
        number = id(self)
        _watching[number] = ref(self, lambda _: _watching.pop(number))
        if pymunk.Constraint.__setattr__ is not _set:
            pymunk.Constraint.__setattr__ = _set  # type: ignore[method-assign, assignment]

    def take(self) -> dict[int, bool]:
        """Return the rows, and clear them."""
        edited, self.rows = self.rows, {}
        return edited

    def forget(self, row: int) -> None:
        """Remove a row, of which this package has just set an attribute itself."""
        self.rows.pop(int(row), None)

    def record(self, constraint: pymunk.Constraint, name: str) -> None:
        """Record that this attribute of a constraint was set."""
        row = self._row.get(constraint)
        if row is not None:
            self.rows[row] = self.rows.get(row, False) or name not in _NUMBERS


def _set(self: pymunk.Constraint, name: str, value: Any) -> None:
    _native_setattr(self, name, value)
    for watching in list(_watching.values()):
        edits = watching()
        if edits is not None:
            edits.record(self, name)

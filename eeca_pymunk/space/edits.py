"""Edits of constraints are recorded when they are made, and `constraint.impulse` returns impulses of EECA steps.

pymunk offers neither: setters write into Chipmunk at once, and `impulse` has no setter. But all attributes of
constraints are set through Python. So `pymunk.Constraint.__setattr__` and the property `impulse` are replaced when the
first constraint is watched; for other constraints they act as before, after one access to a dictionary of weak
references.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any
from weakref import WeakKeyDictionary, WeakSet

import pymunk

_watching: WeakSet[Edits] = WeakSet()
Reading = Callable[[int], "float | None"]
_readings: WeakKeyDictionary[pymunk.Constraint, tuple[Reading | None, int]] = WeakKeyDictionary()
_showings = 0
_native_impulse: Any = pymunk.Constraint.impulse
_native_setattr = pymunk.Constraint.__setattr__


class Edits:
    """`some`: rows of the constraints of which an attribute was set since the last `take`."""

    def __init__(self, row: dict[pymunk.Constraint, int]) -> None:
        self._row = row
        self.some: set[int] = set()
        _watching.add(self)
        if pymunk.Constraint.__setattr__ is not _set:
            pymunk.Constraint.__setattr__ = _set  # type: ignore[method-assign, assignment]

    def take(self) -> set[int]:
        """Return the rows, and clear them."""
        edited, self.some = self.some, set()
        return edited

    def add(self, rows: Iterable[int]) -> None:
        """Record these rows as edited."""
        self.some.update(rows)

    def forget(self, row: int) -> None:
        """Remove a row: the last setting was not an edit by the program."""
        self.some.discard(int(row))

    def hear(self, constraint: pymunk.Constraint) -> None:
        """Record that an attribute of a constraint was set."""
        row = self._row.get(constraint)
        if row is not None:
            self.some.add(row)


def _set(self: pymunk.Constraint, name: str, value: Any) -> None:
    _native_setattr(self, name, value)
    for edits in _watching:
        edits.hear(self)


def showings() -> int:
    """Number of calls of `show_impulses`."""
    return _showings


def shown(item: pymunk.Constraint) -> Reading | None:
    """The function that `show_impulses` has set for a constraint, None if its `impulse` is pymunk's."""
    return _readings.get(item, (None, 0))[0]


def show_impulses(items: Sequence[pymunk.Constraint], read: Reading) -> None:
    """Let `impulse` of these constraints return `read(row)`, unless that is None.

    `read` exists as long as any of them: it must not refer to them or to their space.
    """
    global _showings
    _showings += 1
    for j, item in enumerate(items):
        _readings[item] = read, j
    if pymunk.Constraint.impulse is not _OWN:
        pymunk.Constraint.impulse = _OWN  # type: ignore[method-assign]


def _impulse(self: pymunk.Constraint) -> float:
    read, row = _readings.get(self, (None, 0))
    value = None if read is None else read(row)
    return float(_native_impulse.fget(self)) if value is None else value


_OWN: Any = property(_impulse, doc=_native_impulse.__doc__)

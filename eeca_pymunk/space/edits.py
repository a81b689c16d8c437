"""What the user changes of constraints, found without looking, and `constraint.impulse` that tells of our steps.

pymunk has neither: all setters write into Chipmunk at once, and `impulse` has no setter. All attributes of pymunk's
constraints are set through Python, though, so one hook on the class `pymunk.Constraint` hears of each; and its property
`impulse` asks us first. Both are put in place when the first constraint is watched, and change nothing for
constraints that nobody watches: one look into a dictionary of weak references.
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
    """Which of some constraints had an attribute set since last asked: `some`, their rows."""

    def __init__(self, row: dict[pymunk.Constraint, int]) -> None:
        self._row = row
        self.some: set[int] = set()
        _watching.add(self)
        pymunk.Constraint.__setattr__ = _set  # type: ignore[method-assign, assignment]

    def take(self) -> set[int]:
        """Their rows; then none."""
        edited, self.some = self.some, set()
        return edited

    def add(self, rows: Iterable[int]) -> None:
        """As if these had been set."""
        self.some.update(rows)

    def forget(self, row: int) -> None:
        """Take no notice of what was set just now."""
        self.some.discard(int(row))

    def hear(self, constraint: pymunk.Constraint) -> None:
        """An attribute of a constraint was set."""
        row = self._row.get(constraint)
        if row is not None:
            self.some.add(row)


def _set(self: pymunk.Constraint, name: str, value: Any) -> None:
    _native_setattr(self, name, value)
    for edits in _watching:
        edits.hear(self)


def showings() -> int:
    """How often `show_impulses` was called."""
    return _showings


def shown(item: pymunk.Constraint) -> Reading | None:
    """What `show_impulses` was last told for a constraint, None if its `impulse` is native's."""
    return _readings.get(item, (None, 0))[0]


def show_impulses(items: Sequence[pymunk.Constraint], read: Reading) -> None:
    """Let `impulse` of these constraints be `read(row)`, as long as it knows one.

    `read` lives as long as any of them: it must not hold them, nor their space.
    """
    global _showings
    _showings += 1
    for j, item in enumerate(items):
        _readings[item] = read, j
    pymunk.Constraint.impulse = property(_impulse, doc=_native_impulse.__doc__)  # type: ignore[method-assign, assignment]


def _impulse(self: pymunk.Constraint) -> float:
    read, row = _readings.get(self, (None, 0))
    value = None if read is None else read(row)
    return float(_native_impulse.fget(self)) if value is None else value

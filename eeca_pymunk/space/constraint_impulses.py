"""`constraint.impulse` returns the impulses of EECA steps.

pymunk's property has no setter. It is replaced when impulses are shown for the first time; for other constraints it
acts as before, after one access to a dictionary of weak references.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from typing import Any
from weakref import WeakKeyDictionary

import pymunk

from ..compiled.records import Rows
from ..model.joints import ROTARY_SPRING, SPRING, Joint
from . import private

Reading = Callable[[int], "float | None"]
_readings: WeakKeyDictionary[pymunk.Constraint, tuple[Reading | None, int]] = WeakKeyDictionary()
_showings = 0
_native_impulse: Any = pymunk.Constraint.impulse


class Impulses:
    """Values of `constraint.impulse` by row. It outlives the stepper, and does not refer to constraints.

    Attributes:
        joint: the rows.  ours: pymunk's count of its own steps when they were written.
    """

    def __init__(self, space: pymunk.Space, joint: Rows[Joint]) -> None:
        self._space = weakref.ref(space)
        self.joint = joint
        self.ours = -1

    def read(self, j: int) -> float | None:
        """The impulse: of springs signed (positive pushes), else >= 0; None if pymunk has taken a step since."""
        space = self._space()
        if space is not None and private.timestamp(space)() != self.ours:
            return None
        first, second = self.joint[j].impulse
        if self.joint[j].kind in (SPRING, ROTARY_SPRING):
            return float(first)
        return math.hypot(first, second)


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

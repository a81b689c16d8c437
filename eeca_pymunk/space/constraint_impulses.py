"""`constraint.impulse` returns the impulses of EECA steps.

pymunk's property has no setter. It is replaced when impulses are shown for the first time; for other constraints it
acts as before, after one access to a dictionary of weak references.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from typing import Any, ClassVar
from weakref import WeakKeyDictionary

import pymunk

from ..compiled.records import Rows
from ..model.joints import ROTARY_SPRING, SPRING, Joint
from .private import spaces as private


class ConstraintImpulses:
    """The impulses in `joint` (j,), which `constraint.impulse` returns. The constraints refer to this object through
    `_shown`; it refers neither to them nor to the space, so that both can be freed.

    Attributes:
        shows: number of times that `_shown` was changed, by any space. While it is the same as at the last `show`, the
            constraints still refer to the same object, and `show` need not test that.
    """

    shows: ClassVar[int] = 0

    def __init__(self, space: pymunk.Space, joint: Rows[Joint]) -> None:
        self._space, self._joint = weakref.ref(space), joint
        self._stamp = self._checked = -1

    def show(self, items: Sequence[pymunk.Constraint], stamp: int) -> None:
        """Let `impulse` of these constraints return their impulses in the rows of `joint`, as long as the number of
        pymunk's own steps (`private.timestamp`) is `stamp`."""
        self._stamp = stamp
        if self._checked != ConstraintImpulses.shows:
            if _shown.get(items[0], _NATIVE)[0] is not self:
                ConstraintImpulses.shows += 1
                for j, item in enumerate(items):
                    _shown[item] = self, j
                if pymunk.Constraint.impulse is not _OWN:
                    pymunk.Constraint.impulse = _OWN  # type: ignore[method-assign]
            self._checked = ConstraintImpulses.shows

    def go_on(self, items: Sequence[pymunk.Constraint], stamp: int, dt: float) -> None:
        """After a step dt in which all bodies sleep, let `impulse` return the impulses of the last forces, not those of
        pymunk's solver. If pymunk has taken no step since, nothing has changed (`Sleep.step`)."""
        if self._stamp == stamp:
            return
        last, impulse = self._joint["last_step"], self._joint["impulse"]
        held = last > 0.0
        impulse[held] *= (dt / last[held])[:, None]
        last[held] = dt
        self._joint["struck"] = 0.0
        self.show(items, stamp)

    def read(self, item: pymunk.Constraint, j: int) -> float | None:
        """The impulse of a constraint, in row j, mass length/time; of rotary joints mass length²/time. That of springs
        has a sign (positive pushes the bodies apart), others are >= 0. None if pymunk has taken a step since, or the
        bodies are in another space by now."""
        space = self._space()
        if any(_space_of(body) not in (None, space) for body in (item.a, item.b)):
            return None
        if space is not None and private.timestamp(space)() != self._stamp:
            return None
        (first, second), (x, y) = self._joint[j].impulse, self._joint[j].struck
        if self._joint[j].kind in (SPRING, ROTARY_SPRING):
            return float(first)
        return math.hypot(first + x, second + y)


def _space_of(body: pymunk.Body) -> pymunk.Space | None:
    """`body.space`, and None also for the static body of a space that is gone, where pymunk 6 raises an error."""
    try:
        return body.space
    except ReferenceError:
        return None


# The impulses of each constraint, and its row there; _NATIVE for constraints that no EECA step has moved.
_shown: WeakKeyDictionary[pymunk.Constraint, tuple[ConstraintImpulses | None, int]] = WeakKeyDictionary()
_NATIVE = None, 0
_native_impulse: Any = pymunk.Constraint.impulse


def _impulse(self: pymunk.Constraint) -> float:
    impulses, row = _shown.get(self, _NATIVE)
    value = None if impulses is None else impulses.read(self, row)
    return float(_native_impulse.fget(self)) if value is None else value


_OWN: Any = property(_impulse, doc=_native_impulse.__doc__)

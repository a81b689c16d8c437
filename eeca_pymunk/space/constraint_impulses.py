"""Values that `constraint.impulse` returns after steps; `edits.py` lets the property read them."""

from __future__ import annotations

import math
import weakref

import pymunk

from ..compiled.records import Rows
from ..model.joints import ROTARY_SPRING, SPRING, Joint
from . import private


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

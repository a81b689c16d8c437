"""The two ends of a step: what was read from the space becomes the bodies' paths, and the other way round.

Bitwise comparison with what was written last finds what the user has changed: only that is forecast anew.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..layout import ANGLE, AX, AY, DUE, II, IM, SINCE, SPIN, TWIST, VX, VY, X, Y
from .layout import (
    CHANGED, DAMPED, DAMPING, DONE, DT, EVENTS, EXTERNAL, GAP, GRAVITY_X, GRAVITY_Y, HEAP, IMPACTS, BLOCKS, BY, KINKS, LEDGER, LOCK,
    LOGGED, NOT_FINITE, NOW, ON, OTHER, LEAVE, STALE, UNMET, FORECASTS, PAR_LENGTH, Scene,
)  # fmt: skip
from .loop import forecast

# Columns of what pymunk's batch reads of a body.
_X, _Y, _ANGLE, _VX, _VY, _SPIN, _FX, _FY, _TORQUE = range(9)

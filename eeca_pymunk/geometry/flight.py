"""The path of a body: q(t) = q + v s + a s² / 2 with s = t - SINCE, for x, y and the angle alike."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import uncounted
from ..layout import ANGLE, AX, AY, SINCE, SPIN, TWIST, VX, VY, X, Y


@uncounted
def norm(x: float, y: float) -> float:
    """Length of a vector; math.hypot, which cannot overflow, takes ten times as long."""
    return math.sqrt(x * x + y * y)


@uncounted
def pose(BODY: FloatArray, i: int, t: float) -> tuple[float, float, float]:
    """Position (length) and angle (rad) of body i at instant t; at t = SINCE the stored ones exactly."""
    s = t - BODY[i, SINCE]
    half = 0.5 * s
    return (
        BODY[i, X] + (BODY[i, VX] + half * BODY[i, AX]) * s,
        BODY[i, Y] + (BODY[i, VY] + half * BODY[i, AY]) * s,
        BODY[i, ANGLE] + (BODY[i, SPIN] + half * BODY[i, TWIST]) * s,
    )


@uncounted
def rate(BODY: FloatArray, i: int, t: float) -> tuple[float, float, float]:
    """Velocity (length/time) and spin (rad/time) of body i at instant t; at t = SINCE the stored ones exactly."""
    s = t - BODY[i, SINCE]
    return BODY[i, VX] + s * BODY[i, AX], BODY[i, VY] + s * BODY[i, AY], BODY[i, SPIN] + s * BODY[i, TWIST]

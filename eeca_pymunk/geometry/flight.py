"""The path of a body: q(t) = q + v s + a s² / 2 with s = t - SINCE, for x, y and the angle alike."""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body


@nonallocating
def norm(x: float, y: float) -> float:
    """Length of a vector; math.hypot, which cannot overflow, takes ten times as long."""
    return math.sqrt(x * x + y * y)


@nonallocating
def has_velocity(body: Body) -> bool:
    """Whether a body has a velocity at SINCE."""
    return bool(body.vx != 0.0 or body.vy != 0.0 or body.spin != 0.0)


@nonallocating
def pose(BODY: Rows[Body], i: int, t: float) -> tuple[float, float, float]:
    """Position (length) and angle (rad) of body i at instant t; at t = SINCE the stored ones exactly."""
    s = t - BODY[i].since
    half = 0.5 * s
    return (
        BODY[i].x + (BODY[i].vx + half * BODY[i].ax) * s,
        BODY[i].y + (BODY[i].vy + half * BODY[i].ay) * s,
        BODY[i].angle + (BODY[i].spin + half * BODY[i].angular) * s,
    )


@nonallocating
def rate(BODY: Rows[Body], i: int, t: float) -> tuple[float, float, float]:
    """Velocity (length/time) and spin (rad/time) of body i at instant t; at t = SINCE the stored ones exactly."""
    s = t - BODY[i].since
    return BODY[i].vx + s * BODY[i].ax, BODY[i].vy + s * BODY[i].ay, BODY[i].spin + s * BODY[i].angular


@nonallocating
def speed_along(velocity: tuple[float, float, float], nx: float, ny: float, x: float, y: float) -> float:
    """Velocity along n of the point at (x, y) from a body with this velocity and spin."""
    vx, vy, spin = velocity
    return float(nx * vx + ny * vy + (x * ny - y * nx) * spin)

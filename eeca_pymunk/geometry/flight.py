"""The path of a body: q(t) = q + v s + a s² / 2 with s = t - SINCE, for x, y and the angle alike."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
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
def moves(body: Body) -> bool:
    """Whether a body has a velocity at SINCE or an acceleration."""
    return bool(has_velocity(body) or body.ax != 0.0 or body.ay != 0.0 or body.angular != 0.0)


@nonallocating
def fastest(body: Body) -> float:
    """Bound of the speed of a body's points at SINCE: that of its centre, and the one that its spin adds at most."""
    return norm(body.vx, body.vy) + abs(body.spin) * body.extent


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
def move_to(BODY: Rows[Body], i: int, t: float) -> None:
    """Let the path of body i begin at instant t, with its pose and velocity there."""
    body = BODY[i]
    if t != body.since:
        body.x, body.y, body.angle = pose(BODY, i, t)
        body.vx, body.vy, body.spin = rate(BODY, i, t)
        body.since = t


@inlined
def rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector rotated by an angle; exact for angle 0 and for a vector of length 0."""
    if angle == 0.0 or (x == 0.0 and y == 0.0):
        return x, y
    c, z = math.cos(angle), math.sin(angle)
    return c * x - z * y, z * x + c * y


@inlined
def opening_rate(
    nx: float, ny: float, arm_a: float, arm_b: float, a: tuple[float, float, float], b: tuple[float, float, float]
) -> float:
    """Velocity along n with which a point of body b leaves one of body a: n.(v_b - v_a) + arm_b w_b - arm_a w_a, by
    their velocities and spins, with arm = r x n, r from the centre of the body to the point."""
    return nx * (b[0] - a[0]) + ny * (b[1] - a[1]) + (arm_b * b[2] - arm_a * a[2])


@nonallocating
def opening_rate_at(
    POSE: FloatArray, V: FloatArray, a: int, b: int, nx: float, ny: float, px: float, py: float
) -> float:
    """`opening_rate` of bodies a and b, with poses POSE and velocities V (k, 3), at the point (px, py) of both, without
    their arms: the same but for round-off."""
    x = V[b, 0] - V[b, 2] * (py - POSE[b, 1]) - V[a, 0] + V[a, 2] * (py - POSE[a, 1])
    y = V[b, 1] + V[b, 2] * (px - POSE[b, 0]) - V[a, 1] - V[a, 2] * (px - POSE[a, 0])
    return nx * x + ny * y


@nonallocating
def point_speed(vx: float, vy: float, spin: float, extent: float) -> float:
    """Bound of the speed (length/time) of the points of a body, which are within `extent` of its centre of mass."""
    return abs(vx) + abs(vy) + extent * abs(spin)


@nonallocating
def fastest_point(V: FloatArray, EXTENT: FloatArray, n: int) -> float:
    """Bound of the speed of all points of n bodies with velocities V (k, 3); inf if one is not finite."""
    found = 0.0
    for i in range(n):
        one = point_speed(V[i, 0], V[i, 1], V[i, 2], EXTENT[i])
        if not one < math.inf:
            return math.inf
        found = max(found, one)
    return found

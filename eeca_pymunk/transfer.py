"""Transfer: from the states that pymunk holds to the rows of BODY and back (columns: `layout.py`).

A step takes the state, moves the rows of BODY, and gives the state at its end. Damping d acts as a factor d^(dt/2) on
velocities before and after the motion, which is second order. Centre of mass c and position x of a body at angle phi:

    c = x + R(phi) k,     k its centre of gravity in its own coordinates, 0 for most bodies.
"""

from __future__ import annotations

import math

from .arrays import FloatArray, IntArray
from .compiled import kernel
from .layout import (
    ANGLE,
    AX,
    AY,
    BODY_ROW,
    COG_X,
    COG_Y,
    DUE,
    END,
    FOUND,
    II,
    IM,
    KNOWN,
    LEFT,
    NOW,
    PULL,
    PUSH_TWIST,
    PUSH_X,
    PUSH_Y,
    SINCE,
    SPEED,
    SPIN,
    STEERED,
    STILL,
    TWIST,
    VX,
    VY,
    X,
    Y,
)  # fmt: skip

# What `take`, `give` and a step answer: bits of what is to be done, or a negative code.
EVENTS, FORCES, TURNS = 1, 2, 4
OTHER_BODIES, MOVED_STATIC, NOT_FINITE, OVERFLOW = -1, -2, -3, -4


@kernel
def finite(a: float, b: float, c: float, d: float, e: float, f: float) -> bool:
    """Whether all six are."""
    # Comparing is what numba does fastest; NaN is not less than anything.
    least, most = -math.inf, math.inf
    return (
        least < a < most
        and least < b < most
        and least < c < most
        and least < d < most
        and least < e < most
        and least < f < most
    )


@kernel
def take(
    STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, BODY: FloatArray, gx: float, gy: float, left: float
) -> int:
    """Put the states read from pymunk into BODY: all rows at the start of the step, SINCE = 0.

    `DUE` of a body that was edited or is accelerated otherwise than before becomes -inf: its forecast is void.

    Args:
        STATES (2, N, 9), WALK (4, N), EXTRA (N, 5), BODY (n, 16): see `layout.py`.
        gx, gy: gravity, length/time².  left: d^(dt/2), what half a step's damping leaves of velocities.

    Returns:
        FORCES if any body has a force or torque, else 0; negative, with BODY in no order, if these are not the bodies,
        if a static one was moved, or if a number is not finite.
    """
    now, before = STATES[NOW], STATES[LEFT]
    status = 0
    for i in range(WALK.shape[1]):
        if WALK[FOUND, i] != WALK[KNOWN, i]:
            return OTHER_BODIES
        x, y, angle, vx, vy, spin = now[i, 0], now[i, 1], now[i, 2], now[i, 3], now[i, 4], now[i, 5]
        fx, fy, torque = now[i, 6], now[i, 7], now[i, 8]
        # NaN, the mark of what nobody knows, differs from everything.
        moved = x != before[i, 0] or y != before[i, 1] or angle != before[i, 2]
        edited = moved or vx != before[i, 3] or vy != before[i, 4] or spin != before[i, 5]
        # What the step before has left was finite.
        if edited and not finite(x, y, angle, vx, vy, spin):
            return NOT_FINITE
        if fx != 0.0 or fy != 0.0 or torque != 0.0:
            status |= FORCES
            if not finite(fx, fy, torque, 0.0, 0.0, 0.0):
                return NOT_FINITE
        row = WALK[BODY_ROW, i]
        if row < 0:
            if moved:
                return MOVED_STATIC
            continue
        ax, ay, twist, damped = 0.0, 0.0, 0.0, 1.0
        im = BODY[row, IM]
        if WALK[STEERED, i] != 0:
            ax, ay, twist = EXTRA[i, PUSH_X], EXTRA[i, PUSH_Y], EXTRA[i, PUSH_TWIST]
        elif im > 0.0:
            ax, ay, twist, damped = fx * im + gx, fy * im + gy, torque * BODY[row, II], left
        kx, ky = EXTRA[i, COG_X], EXTRA[i, COG_Y]
        if kx != 0.0 or ky != 0.0:
            c, s = math.cos(angle), math.sin(angle)
            x += c * kx - s * ky
            y += s * kx + c * ky
        if edited or damped != 1.0 or ax != BODY[row, AX] or ay != BODY[row, AY] or twist != BODY[row, TWIST]:
            BODY[row, DUE] = -math.inf
        BODY[row, X], BODY[row, Y], BODY[row, ANGLE] = x, y, angle
        BODY[row, VX], BODY[row, VY], BODY[row, SPIN] = damped * vx, damped * vy, damped * spin
        BODY[row, AX], BODY[row, AY], BODY[row, TWIST] = ax, ay, twist
        BODY[row, SINCE] = 0.0
    return status


@kernel
def give(
    STATES: FloatArray,
    WALK: IntArray,
    EXTRA: FloatArray,
    BODY: FloatArray,
    ENDS: FloatArray,
    dt: float,
    left: float,
    status: int,
) -> int:
    """Write where BODY's paths are at the end of the step to what the step leaves in STATES, and lay it out in ENDS.

    Args:
        dt: time.  left: see `take`.  status: the bits of the step so far.

    Returns:
        `status` with what `lay` adds; OVERFLOW, with STATES written all the same, if a number is not finite.
    """
    after = STATES[LEFT]
    for i in range(WALK.shape[1]):
        row = WALK[BODY_ROW, i]
        if row < 0:
            continue
        s = dt - BODY[row, SINCE]
        damped = left if BODY[row, IM] > 0.0 and WALK[STEERED, i] == 0 else 1.0
        for k in range(3):
            v, a = BODY[row, VX + k], BODY[row, AX + k]
            after[i, k] = BODY[row, X + k] + s * (v + 0.5 * s * a)
            after[i, 3 + k] = damped * (v + s * a)
        kx, ky = EXTRA[i, COG_X], EXTRA[i, COG_Y]
        if kx != 0.0 or ky != 0.0:
            c, s = math.cos(after[i, 2]), math.sin(after[i, 2])
            after[i, 0] -= c * kx - s * ky
            after[i, 1] -= s * kx + c * ky
        if not finite(after[i, 0], after[i, 1], after[i, 2], after[i, 3], after[i, 4], after[i, 5]):
            status = OVERFLOW
    if status == OVERFLOW:
        return OVERFLOW
    return lay(STATES, WALK, ENDS, status)


@kernel
def lay(STATES: FloatArray, WALK: IntArray, ENDS: FloatArray, status: int) -> int:
    """Lay out in ENDS what the step leaves in STATES.

    Returns:
        `status`, with TURNS if the angle or spin of any body is no longer what pymunk has. Otherwise the tables of ENDS
        have no columns for them, which pymunk takes as long to write as all others together.
    """
    N = WALK.shape[1]
    now, after = STATES[NOW], STATES[LEFT]
    end, still, speed, pull = ENDS[END * N :], ENDS[STILL * N :], ENDS[SPEED * N :], ENDS[PULL * N :]
    w = 2
    for i in range(N):
        if WALK[BODY_ROW, i] < 0:
            for k in range(3, 6):
                after[i, k] = now[i, k]
        elif after[i, 2] != now[i, 2] or after[i, 5] != now[i, 5]:
            w = 3
    for i in range(N):
        for k in range(w):
            x, v = after[i, k], after[i, 3 + k]
            end[2 * w * i + k] = still[2 * w * i + k] = x
            end[2 * w * i + w + k] = speed[w * i + k] = v
            still[2 * w * i + w + k] = 0.0
    if status & FORCES:
        for i in range(N):
            for k in range(3):
                pull[3 * i + k] = 0.0 if WALK[BODY_ROW, i] >= 0 else now[i, 6 + k]
    return status | TURNS if w == 3 else status


@kernel
def fly(
    STATES: FloatArray,
    WALK: IntArray,
    EXTRA: FloatArray,
    BODY: FloatArray,
    ENDS: FloatArray,
    dt: float,
    gx: float,
    gy: float,
    left: float,
) -> int:
    """A step of bodies that meet nothing: exact parabolas, constant spin or torque. Arguments and answer as above."""
    status = take(STATES, WALK, EXTRA, BODY, gx, gy, left)
    if status < 0:
        return status
    return give(STATES, WALK, EXTRA, BODY, ENDS, dt, left, status)

"""Transfer: from the states that pymunk holds to the rows of BODY and back (`layout.py`, `model.bodies`).

`read_states` writes the states that were read into the rows of BODY, a step moves them, `write_states` writes the
states at its end. Damping d acts as a factor d^(dt/2) on velocities before and after the motion, which is second order.
Centre of mass c and position x of a body at angle phi:

    c = x + R(phi) k,     k its centre of gravity in its own coordinates, 0 for most bodies.
"""

from __future__ import annotations

import math

from . import layout
from .arrays import FloatArray, IntArray
from .compiled import Table, kernel, nonallocating
from .compiled.records import Rows
from .model.bodies import Body
from .model.step import FORCES, MOVED_STATIC, NOT_FINITE, OTHER_BODIES, OVERFLOW, TURNS
from .model.values import reading_of


@kernel
def finite(a: float, b: float, c: float, d: float, e: float, f: float) -> bool:
    """Whether all six numbers are finite."""
    # Comparisons are fastest in machine code; those with NaN are false.
    least, most = -math.inf, math.inf
    place = least < a < most and least < b < most and least < c < most
    return place and least < d < most and least < e < most and least < f < most


@nonallocating
def to_centre(EXTRA: FloatArray, i: int, angle: float) -> tuple[float, float]:
    """R(angle) k (length): from the position of body i, whose centre of mass is not its origin, to its centre of
    mass."""
    kx, ky = EXTRA[i, layout.COG_X], EXTRA[i, layout.COG_Y]
    c, s = math.cos(angle), math.sin(angle)
    return c * kx - s * ky, s * kx + c * ky


@nonallocating
def acceleration(
    now: FloatArray, i: int, body: Body, special: int, EXTRA: FloatArray, gx: float, gy: float, half_damping: float
) -> tuple[float, float, float, float]:
    """Acceleration (2) and angular acceleration of body i without contacts, by its force and torque in `now` (N, 9) and
    gravity, or those that its velocity function has set; and the factor of half a step's damping on its velocities."""
    if special & layout.STEERED:
        twist = EXTRA[i, layout.ANGULAR_ACCELERATION]
        return EXTRA[i, layout.ACCELERATION_X], EXTRA[i, layout.ACCELERATION_Y], twist, 1.0
    im = body.inv_mass
    if im > 0.0:
        return now[i, 6] * im + gx, now[i, 7] * im + gy, now[i, 8] * body.inv_inertia, half_damping
    return 0.0, 0.0, 0.0, 1.0


@kernel
def read_states(
    STATES: FloatArray, IDS: IntArray, EXTRA: FloatArray, BODY: Rows[Body], gx: float, gy: float, half_damping: float
) -> int:
    """Write the states read from pymunk into BODY: all paths begin at the start of the step, `since` = 0.

    `Body.due` becomes negative if the prediction of the last step is void: -1 if the velocity was edited or damped, or
    the acceleration has changed; SHIFTED - (way of its points over the body's extent) if the pose was edited, and -inf
    if that way is not known. With damping all predictions are void.

    Args:
        STATES (2, N, 9), IDS (4, N), EXTRA (N, 5), BODY (n,): see `layout.py`.
        gx, gy: gravity, length/time².  half_damping: d^(dt/2), the factor of half a step's damping.

    Returns:
        FORCES if any body has a force or torque, else 0. A negative code, with BODY invalid, if the bodies are others,
        a static one was moved, or a number is not finite.
    """
    now, before = STATES[layout.READ], STATES[layout.WRITTEN]
    status = 0
    for i in range(IDS.shape[1]):
        if IDS[layout.READ_ID, i] != IDS[layout.KNOWN_ID, i]:
            return OTHER_BODIES
        x, y, angle, vx, vy, spin = now[i, 0], now[i, 1], now[i, 2], now[i, 3], now[i, 4], now[i, 5]
        fx, fy, torque = now[i, 6], now[i, 7], now[i, 8]
        # NaN, for unknown, differs from everything.
        moved = x != before[i, 0] or y != before[i, 1] or angle != before[i, 2]
        edited = moved or vx != before[i, 3] or vy != before[i, 4] or spin != before[i, 5]
        # The end of the last step was finite.
        if edited and not finite(x, y, angle, vx, vy, spin):
            return NOT_FINITE
        if fx != 0.0 or fy != 0.0 or torque != 0.0:
            status |= FORCES
            if not finite(fx, fy, torque, 0.0, 0.0, 0.0):
                return NOT_FINITE
        row = IDS[layout.BODY_ROW, i]
        if row < 0:
            if moved:
                return MOVED_STATIC
            continue
        special = IDS[layout.FLAGS, i]
        ax, ay, twist, damped = acceleration(now, i, BODY[row], special, EXTRA, gx, gy, half_damping)
        if special & layout.ECCENTRIC:
            dx, dy = to_centre(EXTRA, i, angle)
            x, y = x + dx, y + dy
        if moved:
            way = (abs(now[i, 0] - before[i, 0]) + abs(now[i, 1] - before[i, 1])) / max(BODY[row].extent, 1e-300)
            way += abs(angle - before[i, 2])
            BODY[row].due = min(BODY[row].due, layout.SHIFTED - way) if way >= 0.0 else -math.inf
        elif edited or damped != 1.0 or ax != BODY[row].ax or ay != BODY[row].ay or twist != BODY[row].angular:
            BODY[row].due = min(BODY[row].due, -1.0)
        BODY[row].x, BODY[row].y, BODY[row].angle = x, y, angle
        BODY[row].vx, BODY[row].vy, BODY[row].spin = damped * vx, damped * vy, damped * spin
        BODY[row].ax, BODY[row].ay, BODY[row].angular = ax, ay, twist
        BODY[row].since = 0.0
    return status


@kernel
def accept_static(table: Table) -> None:
    """Let static bodies count as not moved: STATES[WRITTEN] is what was read of them. IDS[FLAGS] of those that had
    moved is MOVED."""
    R = reading_of(table)
    for i in range(R.IDS.shape[1]):
        if R.IDS[layout.BODY_ROW, i] < 0:
            R.IDS[layout.FLAGS, i] = 0
            for c in range(layout.STATE_COLUMNS):
                if c < 3 and R.STATES[layout.WRITTEN, i, c] != R.STATES[layout.READ, i, c]:
                    R.IDS[layout.FLAGS, i] = layout.MOVED
                R.STATES[layout.WRITTEN, i, c] = R.STATES[layout.READ, i, c]


@kernel
def write_states(
    STATES: FloatArray, IDS: IntArray, EXTRA: FloatArray, BODY: Rows[Body], ENDS: FloatArray, half_damping: float,
    status: int,
) -> int:  # fmt: skip
    """Write BODY, at the end of the step, to STATES[WRITTEN], and to ENDS for pymunk.

    Args:
        half_damping: see `read_states`.  status: the bits of the step so far.

    Returns:
        `status` with the bits of `put_ends`; OVERFLOW, with STATES written, if a number is not finite.
    """
    after = STATES[layout.WRITTEN]
    for i in range(IDS.shape[1]):
        row = IDS[layout.BODY_ROW, i]
        if row < 0:
            continue
        special = IDS[layout.FLAGS, i]
        damped = half_damping if BODY[row].inv_mass > 0.0 and not special & layout.STEERED else 1.0
        x, y, angle = BODY[row].x, BODY[row].y, BODY[row].angle
        vx, vy, spin = damped * BODY[row].vx, damped * BODY[row].vy, damped * BODY[row].spin
        if special & layout.ECCENTRIC:
            dx, dy = to_centre(EXTRA, i, angle)
            x, y = x - dx, y - dy
        if not finite(x, y, angle, vx, vy, spin):
            status = OVERFLOW
        after[i, 0], after[i, 1], after[i, 2] = x, y, angle
        after[i, 3], after[i, 4], after[i, 5] = vx, vy, spin
    if status == OVERFLOW:
        return OVERFLOW
    return put_ends(STATES, IDS, ENDS, status)


@kernel
def put_ends(STATES: FloatArray, IDS: IntArray, ENDS: FloatArray, status: int) -> int:
    """Write STATES[WRITTEN] to ENDS, to the tables END and RESET_FORCES.

    Returns:
        `status`, with TURNS if the angle or spin of any body differs from pymunk's, or any body spins (contacts in a
        step of pymunk would change its spin). Otherwise END has no columns for angles and spins, which take pymunk as
        long to write as all others.
    """
    N = IDS.shape[1]
    now, after = STATES[layout.READ], STATES[layout.WRITTEN]
    end, forces = ENDS[layout.END * N :], ENDS[layout.RESET_FORCES * N :]
    for i in range(N):
        if IDS[layout.BODY_ROW, i] < 0:
            after[i, 3], after[i, 4], after[i, 5] = now[i, 3], now[i, 4], now[i, 5]
        elif after[i, 2] != now[i, 2] or after[i, 5] != now[i, 5] or after[i, 5] != 0.0:
            status |= TURNS
            break
        end[4 * i], end[4 * i + 1] = after[i, 0], after[i, 1]
        end[4 * i + 2], end[4 * i + 3] = after[i, 3], after[i, 4]
    if status & TURNS:
        for i in range(N):
            if IDS[layout.BODY_ROW, i] < 0:
                after[i, 3], after[i, 4], after[i, 5] = now[i, 3], now[i, 4], now[i, 5]
            for k in range(6):
                end[6 * i + k] = after[i, k]
    if status & FORCES:
        for i in range(N):
            for k in range(3):
                forces[3 * i + k] = 0.0 if IDS[layout.BODY_ROW, i] >= 0 else now[i, 6 + k]
    return status


@kernel
def write_ends(table: Table, status: int) -> int:
    """See `put_ends`."""
    R = reading_of(table)
    return put_ends(R.STATES, R.IDS, R.ENDS, status)

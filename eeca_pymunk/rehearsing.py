"""Kernels of steps in which functions of the program are called: the state before, changes by the functions, and the
start of pymunk's own step, which calls collision handlers (the rehearsal)."""

from __future__ import annotations

import math

from . import layout, transfer
from .arrays import FloatArray, IntArray
from .compiled import Table, kernel, nonallocating
from .compiled.records import Rows
from .model.parameters.detection import REHEARSAL_NEAR, REHEARSAL_SHIFT
from .model.shapes import HandledShape
from .model.step import FORCES, MOVED_STATIC, NOT_FINITE, OTHER_BODIES, OVERFLOW, TURNS
from .model.values import Reading, reading_of


@nonallocating
def copy_read(R: Reading, copy: FloatArray) -> int:
    """Copy the state that was read to `copy` (N, 9), and void all predictions: functions may change anything, so all
    bodies count as placed by the program. Also if no function is called then: paths must not depend on that.

    Returns:
        0, or OTHER_BODIES, MOVED_STATIC or NOT_FINITE if the bodies are others, a static one was moved, or a number is
        not finite.
    """
    IDS, BODY, now, before = R.IDS, R.BODY, R.STATES[layout.READ], R.STATES[layout.WRITTEN]
    status = 0
    for i in range(BODY.shape[0]):
        BODY[i].due = min(BODY[i].due, layout.PLACED)
    for i in range(IDS.shape[1]):
        if IDS[layout.READ_ID, i] != IDS[layout.KNOWN_ID, i]:
            return OTHER_BODIES
        if not transfer.finite(now[i, 0], now[i, 1], now[i, 2], now[i, 3], now[i, 4], now[i, 5]):
            status = NOT_FINITE
        if not transfer.finite(now[i, 6], now[i, 7], now[i, 8], 0.0, 0.0, 0.0):
            status = NOT_FINITE
        if IDS[layout.BODY_ROW, i] < 0:
            if now[i, 0] != before[i, 0] or now[i, 1] != before[i, 1] or now[i, 2] != before[i, 2]:
                return MOVED_STATIC
        for c in range(layout.STATE_COLUMNS):
            copy[i, c] = now[i, c]
    return status


@kernel
def copy_start(table: Table) -> int:
    """`copy_read` to HOOKED[START]."""
    R = reading_of(table)
    return copy_read(R, R.HOOKED[layout.START])


@kernel
def alter_end(table: Table, stops: int) -> int:
    """At the end of a step: set all velocities to 0 if `stops` (damping 0); copy the result to HOOKED[UNALTERED]; add
    HOOKED[CHANGES_AFTER], the changes by functions, and clear it; write all to ENDS.

    Within the step bodies keep their velocities, as under pymunk, which moves bodies before it damps them. The
    energy lost by damping 0 is the last number of ENDS. Forces are reset.

    Returns:
        the bits of `put_ends`, or OVERFLOW if a number is not finite.
    """
    R = reading_of(table)
    IDS, BODY, changes, unaltered = R.IDS, R.BODY, R.HOOKED[layout.CHANGES_AFTER], R.HOOKED[layout.UNALTERED]
    now, end = R.STATES[layout.READ], R.STATES[layout.WRITTEN]
    status, straight, turning = FORCES | TURNS, 0.0, 0.0
    for i in range(IDS.shape[1]):
        row = IDS[layout.BODY_ROW, i]
        for c in range(layout.STATE_COLUMNS):
            unaltered[i, c] = end[i, c]
        if row < 0:
            for c in range(layout.STATE_COLUMNS):
                end[i, c] = now[i, c]
            if stops:
                unaltered[i, 3], unaltered[i, 4], unaltered[i, 5] = now[i, 3], now[i, 4], now[i, 5]
        else:
            end[i, 6], end[i, 7], end[i, 8] = 0.0, 0.0, 0.0
            if stops and BODY[row].inv_mass > 0.0 and not IDS[layout.FLAGS, i] & layout.STEERED:
                straight += (end[i, 3] * end[i, 3] + end[i, 4] * end[i, 4]) / BODY[row].inv_mass
                if BODY[row].inv_inertia > 0.0:
                    turning += end[i, 5] * end[i, 5] / BODY[row].inv_inertia
                for c in range(3, 6):
                    end[i, c], unaltered[i, c] = 0.0, 0.0
        for c in range(layout.STATE_COLUMNS):
            end[i, c] += changes[i, c]
            changes[i, c] = 0.0
        if row >= 0 and not transfer.finite(end[i, 0], end[i, 1], end[i, 2], end[i, 3], end[i, 4], end[i, 5]):
            status = OVERFLOW
    R.ENDS[layout.END_COLUMNS * IDS.shape[1]] = 0.5 * (straight + turning)
    if status == OVERFLOW:
        return OVERFLOW
    return transfer.put_ends(R.STATES, IDS, R.ENDS, status)


@kernel
def accept_rounding(table: Table) -> None:
    """Accept positions that differ from STATES[WRITTEN] by round-off as unedited: pymunk rounds the positions of bodies
    whose centre of mass is not their origin."""
    R = reading_of(table)
    now, end, EXTRA = R.STATES[layout.READ], R.STATES[layout.WRITTEN], R.EXTRA
    for i in range(now.shape[0]):
        size = max(abs(now[i, 0]), abs(now[i, 1])) + max(abs(EXTRA[i, layout.COG_X]), abs(EXTRA[i, layout.COG_Y]))
        if max(abs(now[i, 0] - end[i, 0]), abs(now[i, 1] - end[i, 1])) <= 1e-14 * size:
            end[i, 0], end[i, 1] = now[i, 0], now[i, 1]


@nonallocating
def put_handled(R: Reading, HANDLED: Rows[HandledShape], dt: float) -> None:
    """Put the boxes of shapes that move to the end of free flight after dt, which begins at the poses in ENDS."""
    now, N = R.STATES[layout.READ], R.STATES.shape[1]
    end = R.ENDS[layout.END * N :]
    for k in range(HANDLED.shape[0]):
        box = HANDLED[k]
        if box.body >= 0:
            i = box.body
            before, after = end[6 * i + 2], end[6 * i + 2] + dt * now[i, 5]
            # The centre of mass moves by dt v, and about it the box turns.
            x, y = now[i, 0], now[i, 1]
            way_x, way_y = end[6 * i] + dt * now[i, 3] - x, end[6 * i + 1] + dt * now[i, 4] - y
            if R.IDS[layout.FLAGS, i] & layout.ECCENTRIC:
                from_x, from_y = transfer.to_centre(R.EXTRA, i, now[i, 2])
                to_x, to_y = transfer.to_centre(R.EXTRA, i, before)
                x, y, way_x, way_y = x + from_x, y + from_y, way_x + to_x - from_x, way_y + to_y - from_y
            box.cos, box.sin = math.cos(after + box.angle), math.sin(after + box.angle)
            box.at_x = x + way_x + box.cos * box.x - box.sin * box.y
            box.at_y = y + way_y + box.sin * box.x + box.cos * box.y
            turn = abs(after - now[i, 2])
            box.reach = box.rounding + REHEARSAL_NEAR * (math.hypot(way_x, way_y) + box.extent * turn)


@nonallocating
def box_distance(a: HandledShape, b: HandledShape) -> float:
    """Distance of a box, without rounding, from the box with parallel sides that contains the other one; a bound of
    their distance from below. Two boxes are apart if and only if this is > 0 in one of the two orders."""
    dx, dy = b.at_x - a.at_x, b.at_y - a.at_y
    c, s = abs(a.cos * b.cos + a.sin * b.sin), abs(a.cos * b.sin - a.sin * b.cos)
    x = abs(a.cos * dx + a.sin * dy) - a.half_x - b.half_x * c - b.half_y * s
    y = abs(a.cos * dy - a.sin * dx) - a.half_y - b.half_x * s - b.half_y * c
    return math.hypot(max(x, 0.0), max(y, 0.0))


@kernel
def any_near(HANDLED: Rows[HandledShape], PAIRS: IntArray) -> int:
    """Whether the boxes of any of the PAIRS (p, 2) of rows of HANDLED are within each other's reach."""
    for p in range(PAIRS.shape[0]):
        a, b = HANDLED[PAIRS[p, 0]], HANDLED[PAIRS[p, 1]]
        if max(box_distance(a, b), box_distance(b, a)) <= a.reach + b.reach:
            return 1
    return 0


@kernel
def place_for_rehearsal(
    table: Table, HANDLED: Rows[HandledShape], PAIRS: IntArray, dt: float, gx: float, gy: float, half_damping: float
) -> int:
    """`copy_read` to HOOKED[REHEARSAL_START]. Write to ENDS, to the table END with angles and spins, the poses from
    which a step of pymunk leads to the end of free flight. pymunk moves bodies before it accelerates them, so that they
    start at

        q_free - dt v,   q_free = q + dt (d v + dt a / 2),   d = `half_damping`, the factor of half a step's damping.

    a is that of forces and gravity, v the velocity.

    Bodies at rest on each other have a gap of 0 up to round-off; pymunk, in whose steps they overlap, would begin and
    end such contacts at random. Therefore each body is moved along gravity by REHEARSAL_SHIFT times its height above
    the lowest one.

    Returns:
        1 if one of PAIRS is near at the end of free flight (`any_near`), else 0; a negative code of `copy_read`, or
        OVERFLOW if a number at the end is not finite.
    """
    R = reading_of(table)
    status = copy_read(R, R.HOOKED[layout.REHEARSAL_START])
    if status < 0:
        return status
    IDS, EXTRA, BODY, now = R.IDS, R.EXTRA, R.BODY, R.STATES[layout.READ]
    N = IDS.shape[1]
    pull = math.sqrt(gx * gx + gy * gy)
    down_x, down_y, deepest = 0.0, 0.0, -math.inf
    if pull > 0.0:
        down_x, down_y = gx / pull, gy / pull
    for i in range(N):
        row = IDS[layout.BODY_ROW, i]
        if row >= 0 and BODY[row].inv_mass > 0.0:
            deepest = max(deepest, now[i, 0] * down_x + now[i, 1] * down_y)
    end = R.ENDS[layout.END * N :]
    for i in range(N):
        x, y, angle, vx, vy, spin = now[i, 0], now[i, 1], now[i, 2], now[i, 3], now[i, 4], now[i, 5]
        row = IDS[layout.BODY_ROW, i]
        if row >= 0:
            special, moves = IDS[layout.FLAGS, i], BODY[row].inv_mass > 0.0
            ax, ay, twist, damped = transfer.acceleration(now, i, BODY[row], special, EXTRA, gx, gy, half_damping)
            px, py = x, y
            if special & layout.ECCENTRIC:
                dx, dy = transfer.to_centre(EXTRA, i, angle)
                px, py = px + dx, py + dy
            px += dt * (damped * vx + 0.5 * dt * ax)
            py += dt * (damped * vy + 0.5 * dt * ay)
            turned = angle + dt * (damped * spin + 0.5 * dt * twist)
            if not transfer.finite(px, py, turned, 0.0, 0.0, 0.0):
                return OVERFLOW
            way = REHEARSAL_SHIFT * (deepest - (x * down_x + y * down_y)) if moves and pull > 0.0 else 0.0
            x, y, angle = px - dt * vx + way * down_x, py - dt * vy + way * down_y, turned - dt * spin
            if special & layout.ECCENTRIC:
                dx, dy = transfer.to_centre(EXTRA, i, angle)
                x, y = x - dx, y - dy
        end[6 * i], end[6 * i + 1], end[6 * i + 2] = x, y, angle
        end[6 * i + 3], end[6 * i + 4], end[6 * i + 5] = vx, vy, spin
    put_handled(R, HANDLED, dt)
    return any_near(HANDLED, PAIRS)


@kernel
def record_changes(table: Table, late: int) -> int:
    """Add the differences of STATES[READ] from HOOKED[BEFORE_CALL], which is updated, to HOOKED[CHANGES_BEFORE], or if
    `late`, and of static bodies always, to HOOKED[CHANGES_AFTER].

    pymunk sets spins of bodies of infinite moment that gears hold to nan: nan counts as unchanged.

    Returns:
        the sum of 1 if there are any in HOOKED[CHANGES_BEFORE], and 2 if in HOOKED[CHANGES_AFTER].
    """
    R = reading_of(table)
    now, last, found = R.STATES[layout.READ], R.HOOKED[layout.BEFORE_CALL], 0
    for i in range(now.shape[0]):
        after = late > 0 or R.IDS[layout.BODY_ROW, i] < 0
        changes = R.HOOKED[layout.CHANGES_AFTER if after else layout.CHANGES_BEFORE]
        for c in range(layout.STATE_COLUMNS):
            before = last[i, c]
            if now[i, c] != before:
                if before == before:
                    changes[i, c] += now[i, c] - before
                    found |= 2 if after else 1
                last[i, c] = now[i, c]
    return found

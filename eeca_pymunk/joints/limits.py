"""Limits of slides, grooves, rotary limits and ratchets: met at their instant without bounce, held while they push.

A limit is a row that is either held (SIDE = -1 on the lower, 1 on the upper bound), g = bound, lam SIDE <= 0, or free.
When a step would end beyond a bound, it is taken anew to the instant at which the bound is reached (secant on the end
of the implicit step); there velocities into the bound vanish, and what that costs in kinetic energy is booked. A held
row that would pull is let go from the start of the part. The number of parts of a step is bounded; past it, rows land:
they are held from where they are, g reaches its bound at the end of the part, and their work is booked.
"""

from __future__ import annotations

from ..compiled import kernel
from .correct import project_velocities, stand_still
from .layout import GROOVE, LIMITED, LOWER, RATCHET, ROTARY_LIMIT, SLIDE, TOOTH, UPPER
from .ledger import book
from .motion import advance
from .rows import joint_rows
from .scratch import (
    AFTER,
    BEFORE,
    L_A,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LAM,
    ROWS,
    SIZE,
    VALUE,
    FloatArray,
    IntArray,
)  # fmt: skip
from .solve import newton_step

TOUCH = 1e-12  # a gap below this, over the size of the island, is closed
MOST_EVENTS = 12
MOST_SECANTS = 12


@kernel
def bounded(joint: FloatArray, link: IntArray, k: int, side: int) -> bool:
    """Whether joint k has a bound at this side."""
    kind, j = link[k, L_KIND], link[k, L_JOINT]
    if kind == RATCHET:
        return side * joint[j, TOOTH] < 0.0
    if kind == SLIDE and side < 0:
        return joint[j, LOWER] > 0.0
    if kind in (SLIDE, ROTARY_LIMIT, GROOVE):
        return abs(joint[j, UPPER if side > 0 else LOWER]) < 1e300
    return False


@kernel
def gap(
    joint: FloatArray, hinge: FloatArray, link: IntArray, k: int, side: int, local: FloatArray, h: float,
    one: FloatArray,
) -> float:  # fmt: skip
    """How far joint k is from its bound at this side at the end of the present iterate, negative beyond it."""
    was, soft = link[k, L_SIDE], link[k, L_SOFT]
    link[k, L_SIDE], link[k, L_SOFT] = side, 0
    joint_rows(joint, hinge, link, k, local, h, one)
    link[k, L_SIDE], link[k, L_SOFT] = was, soft
    return -side * one[VALUE, link[k, L_ROWS] - 1]


@kernel
def approach(link: IntArray, k: int, side: int, local: FloatArray, column: int, one: FloatArray) -> float:
    """Rate of the gap whose row was just computed, with the velocities at `column`."""
    rate, row = 0.0, ROWS + link[k, L_ROWS] - 1
    for end in range(2):
        for c in range(3):
            rate += one[row, 3 * end + c] * local[link[k, L_A + end], column + c]
    return -side * rate


@kernel
def standing(link: IntArray, joints: int) -> bool:
    """Whether a joint stands on a limit."""
    count = 0
    for k in range(joints):
        count += abs(link[k, L_SIDE])
    return count > 0


@kernel
def release(link: IntArray, hinge: FloatArray, joints: int) -> bool:
    """Let go of the held limit that pulls most, if one does."""
    worst, which = 0.0, -1
    for k in range(joints):
        if link[k, L_SIDE] != 0 and link[k, L_SOFT] == 0:
            pull = hinge[k, LAM + link[k, L_ROWS] - 1] * link[k, L_SIDE]
            if pull > worst:
                worst, which = pull, k
    if which < 0:
        return False
    link[which, L_SIDE] = 0
    hinge[which, LAM + link[which, L_ROWS] - 1] = 0.0
    return True


@kernel
def first_bound(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float, one: FloatArray,
    found: FloatArray,
) -> int:  # fmt: skip
    """The free limit that a step h passes first, by the parabola through its gaps and their rate at the start; or -1.

    found[0] is its side, found[1] the estimate of the instant. Gaps at the start are those of no way.
    """
    which, found[1] = -1, h
    for k in range(joints):
        if link[k, L_SIDE] != 0 or link[k, L_SOFT] != 0:
            continue
        for side in (-1, 1):
            if not bounded(joint, link, k, side):
                continue
            end = gap(joint, hinge, link, k, side, local, h, one)
            if end >= -TOUCH * hinge[k, SIZE]:
                continue
            mean = 0.5 * (approach(link, k, side, local, BEFORE, one) + approach(link, k, side, local, AFTER, one))
            start = max(end - h * mean, 0.0)
            when = h * start / (start - end)
            if which < 0 or when < found[1]:
                which, found[0], found[1] = k, float(side), when
    return which


@kernel
def touch(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int, one: FloatArray
) -> bool:
    """Hold all free limits whose gap is closed and closing at the start; whether there were any."""
    stand_still(joint, hinge, link, joints, local, bodies)
    any_found = False
    for k in range(joints):
        if link[k, L_SIDE] != 0 or link[k, L_SOFT] != 0:
            continue
        for side in (-1, 1):
            if (
                bounded(joint, link, k, side)
                and gap(joint, hinge, link, k, side, local, 1.0, one) <= TOUCH * hinge[k, SIZE]
                and approach(link, k, side, local, BEFORE, one) < 0.0
            ):
                link[k, L_SIDE] = side
                any_found = True
                break
    return any_found


@kernel
def step_with_limits(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, length: float, loops: bool, give: float, band: int, size: int, matrix: FloatArray, right: FloatArray,
    one: FloatArray, found: FloatArray, ledger: FloatArray,
) -> float:  # fmt: skip
    """Take the step h in parts between instants at which limits are met; the time that is left if Newton fails."""
    left, events, solves = h, 0, 0
    while True:
        if (
            newton_step(
                joint,
                hinge,
                link,
                joints,
                local,
                node,
                bodies,
                left,
                length,
                loops or standing(link, joints),
                give,
                band,
                size,
                matrix,
                right,
                one,
            )
            < 0
        ):
            return left
        solves += 1
        if solves < 2 * joints + 8 * MOST_EVENTS and release(link, hinge, joints):
            continue
        k = first_bound(joint, hinge, link, joints, local, left, one, found)
        if k < 0 or solves > 4 * joints + 8 * MOST_EVENTS:
            book(joint, hinge, link, joints, local, bodies, left, one, ledger)
            advance(local, bodies)
            return 0.0
        side, events = int(found[0]), events + 1
        if events > MOST_EVENTS:  # land
            link[k, L_SIDE] = side
            continue
        when, low, high = found[1], 0.0, left
        for _ in range(MOST_SECANTS):
            if when <= 1e-13 * h:
                break
            if (
                newton_step(
                    joint,
                    hinge,
                    link,
                    joints,
                    local,
                    node,
                    bodies,
                    when,
                    length,
                    loops or standing(link, joints),
                    give,
                    band,
                    size,
                    matrix,
                    right,
                    one,
                )
                < 0
            ):
                return left
            solves += 1
            distance = gap(joint, hinge, link, k, side, local, when, one)
            if abs(distance) <= 0.1 * TOUCH * hinge[k, SIZE]:
                break
            if distance > 0.0:
                low = when
            else:
                high = when
            rate = approach(link, k, side, local, AFTER, one)
            step = when - distance / rate if rate < 0.0 else 0.5 * (low + high)
            when = step if low < step < high else 0.5 * (low + high)
        if when > 1e-13 * h:
            book(joint, hinge, link, joints, local, bodies, when, one, ledger)
            advance(local, bodies)
            left -= when
        link[k, L_SIDE] = side
        touch(joint, hinge, link, joints, local, bodies, one)
        ledger[LIMITED] += project_velocities(
            joint, hinge, link, joints, local, node, bodies, band, size, matrix, right, one
        )
        for i in range(joints):
            hinge[i, LAM] = hinge[i, LAM + 1] = 0.0
        if left <= 1e-13 * h:
            return 0.0

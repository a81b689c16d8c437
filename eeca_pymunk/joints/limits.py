"""Limits of slides, grooves, rotary limits and ratchets: met at their instant without bounce, held while they push.

A limit is a row that is either held (SIDE = -1 on the lower, 1 on the upper bound), g = bound, lam SIDE <= 0, or free.
When a step would end beyond a bound, it is taken anew to the instant at which the bound is reached (secant on the end
of the implicit step); there velocities into the bound vanish, and what that costs in kinetic energy is booked. A held
row that would pull is let go from the start of the part. The number of parts of a step is bounded; past it, rows land:
they are held from where they are, g reaches its bound at the end of the part, and their work is booked.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .bounds import TOUCH, approach, first_bound, gap, hold, release, standing
from .correct import book_fit
from .layout import LIMITED
from .ledger import book
from .motion import advance
from .scratch import AFTER, EFFORT, HURRY, L_SIDE, L_SOFT, LAM, LINEAR_STEP, SIZE, SPEEDS
from .solve import solve

MOST_EVENTS = 12
MOST_SECANTS = 12
_FEW_SECANTS = 2  # in a hurry
_FEW_SOLVES = 8  # of linear rows, that let limits go which pull


@uncounted
def step_with_limits(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, length: float, loops: bool, give: float, whole: bool, span: IntArray, matrix: FloatArray,
    right: FloatArray, more: FloatArray, pivots: IntArray, stiff: FloatArray, found: FloatArray, ledger: FloatArray,
) -> bool:  # fmt: skip
    """Take the step h in parts between instants at which limits are met; False if Newton fails.

    A `whole` step does not meet any: False if it would. `what` is STEP or LINEAR_STEP.
    """
    left, when, low, high = h, h, 0.0, h
    events, solves, secants, meeting, side = 0, 0, 0, -1, 0
    last, before = 0.0, 0.0
    while True:
        redundant = loops or standing(link, joints)
        if when > 1e-13 * abs(h) or h < 0.0:
            if solve(
                what, joint, hinge, link, joints, local, node, bodies, when, length, redundant, give, span, matrix,
                right, more, pivots, stiff, found,
            ) < 0:  # fmt: skip
                return False
            solves += 1
            if meeting < 0:  # a step to the end
                if solves < (_FEW_SOLVES if what == LINEAR_STEP else 2 * joints + 100) and release(link, hinge, joints):
                    continue
                k = first_bound(joint, hinge, link, joints, local, when, found)
                if k < 0 or solves > 4 * joints + 200 or what == LINEAR_STEP:
                    book(joint, hinge, link, joints, local, when, ledger)
                    advance(local, bodies, when)
                    return True
                if whole:
                    return False
                side, events = int(found[0]), events + 1
                if events > MOST_EVENTS or found[EFFORT] > found[HURRY]:  # land
                    link[k, L_SIDE] = side
                    continue
                meeting, when, low, high, secants = k, found[1], 0.0, left, 0
                continue
            distance = gap(joint, hinge, link, meeting, side)
            secants += 1
            most = MOST_SECANTS if found[EFFORT] <= found[HURRY] else _FEW_SECANTS
            if abs(distance) > 0.1 * TOUCH * hinge[meeting, SIZE] and secants < most:
                if distance > 0.0:
                    low = when
                else:
                    high = when
                rate = approach(hinge, link, meeting, side, local, AFTER)
                if secants > 1 and when != last:
                    rate = (distance - before) / (when - last)
                last, before = when, distance
                step = when - distance / rate if rate < 0.0 else 0.5 * (low + high)
                when = step if low < step < high else 0.5 * (low + high)
                continue
            k = first_bound(joint, hinge, link, joints, local, when, found)
            if (
                k >= 0 and k != meeting and events < MOST_EVENTS and found[EFFORT] <= found[HURRY]
            ):  # another one is passed before
                meeting, side, low, high, secants, events = k, int(found[0]), 0.0, when, 0, events + 1
                when = found[1]
                continue
            book(joint, hinge, link, joints, local, when, ledger)
            advance(local, bodies, when)
            left -= when
        link[meeting, L_SIDE] = side
        solve(
            int(SPEEDS), joint, hinge, link, joints, local, node, bodies, 2.0, length, loops, 0.0, span, matrix, right,
            more, pivots, stiff, found,
        )  # fmt: skip
        book_fit(local, bodies, ledger, int(LIMITED))
        for k in range(joints):
            hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
            if link[k, L_SIDE] != 0 and link[k, L_SOFT] == 0:
                hold(joint, hinge, link, k)
        if left <= 1e-13 * h:
            return True
        meeting, when = -1, left

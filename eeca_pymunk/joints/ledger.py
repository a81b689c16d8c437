"""What a part of a step did with energy: every impulse times the way of its rows, so that the ledger closes."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .entries import held
from .layout import (
    CLAMPED,
    CLOSED,
    DAMPED,
    LIMITED,
    MAX_FORCE,
    MOTOR,
    MOTORS,
    PROJECTED,
    PUSH,
    REST,
    ROTARY_SPRING,
    SPRING,
    STIFFNESS,
    STORED,
    SUPPORTS,
    WORK,
)
from .scratch import (
    BEFORE,
    BEGAN,
    ENDED,
    FORCE,
    FREE,
    L_A,
    L_JOINT,
    L_KIND,
    L_SIDE,
    L_SOFT,
    LAM,
    MEASURE,
    MOBILITY,
    SAVED,
    SHIFT,
    TOTAL,
    TRAVEL,
    WAY,
)
from .springs import held_energy


@uncounted
def book(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float, ledger: FloatArray
) -> None:
    """Add the works of a solved part of the step to `ledger` (see `layout`), and its impulses to TOTAL.

    A joint's work on its bodies is F . x / h. Of that, F . x / h of a body that it cannot move is taken from a support.
    """
    per = 1.0 / h
    for k in range(joints):
        kind, j = link[k, L_KIND], link[k, L_JOINT]
        spring = kind in (SPRING, ROTARY_SPRING)
        if not spring and not held(link, k, 0):
            continue
        total, moved = 0.0, 0.0
        for end in range(2):
            i = link[k, L_A + end]
            for c in range(3):
                work = hinge[k, FORCE + 3 * end + c] * local[i, WAY + c] * per
                total += work
                if local[i, MOBILITY + c] > 0.0:
                    moved += work
        ledger[SUPPORTS] += moved - total
        joint[j, WORK] += moved
        hinge[k, TOTAL] += hinge[k, LAM]
        hinge[k, TOTAL + 1] += hinge[k, LAM + 1]
        if spring:
            began, ended = hinge[k, BEGAN], hinge[k, ENDED]
            stretch = ended - began if kind == SPRING else began - ended
            lost = (hinge[k, MEASURE] - hinge[k, LAM] / h) * stretch
            ledger[STORED] -= hinge[k, MEASURE] * stretch
            ledger[DAMPED] += lost
            ledger[CLOSED] += total - hinge[k, MEASURE] * stretch + lost
        elif kind == MOTOR or link[k, L_SOFT] != 0:
            if kind == MOTOR or total > 0.0:
                ledger[MOTORS] += total
            else:
                ledger[CLAMPED] -= total
        elif link[k, L_SIDE] != 0 and total < 0.0:
            ledger[LIMITED] -= total
        else:
            ledger[CLOSED] += total


@uncounted
def springs_hold(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int) -> float:
    """The energy that springs hold at the start."""
    total = 0.0
    for k in range(joints):
        j, kind = link[k, L_JOINT], link[k, L_KIND]
        if kind in (SPRING, ROTARY_SPRING):
            sign = 1.0 if kind == SPRING else -1.0
            at = sign * (hinge[k, BEGAN] - joint[j, REST])
            total += held_energy(joint[j, PUSH], -joint[j, STIFFNESS], joint[j, MAX_FORCE], at)
    return total


@uncounted
def close_ledger(local: FloatArray, bodies: int, ledger: FloatArray) -> None:
    """Let the ledger of a step from SAVED to the present close, whose joints did not hold: works of supports are CLOSED
    too. Rows that contradict each other push without bound there, and their works cancel but for round-off."""
    gained = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                before, after = local[i, SAVED + 3 + c], local[i, BEFORE + c]
                way = local[i, TRAVEL + c] - local[i, SHIFT + c]
                gained += (0.5 * (after * after - before * before) - local[i, FREE + c] * way) / local[i, MOBILITY + c]
    lost = ledger[DAMPED] + ledger[LIMITED] + ledger[CLAMPED] + ledger[PROJECTED]
    ledger[SUPPORTS] = 0.0
    ledger[CLOSED] = gained + ledger[STORED] + lost - ledger[MOTORS]

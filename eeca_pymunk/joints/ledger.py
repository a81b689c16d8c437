"""What a part of a step did with energy: every impulse times the way of its rows, so that the ledger closes."""

from __future__ import annotations

from ..compiled import kernel
from .layout import (
    CLAMPED,
    CLOSED,
    DAMPED,
    LIMITED,
    MOTOR,
    MOTORS,
    PUSH,
    REST,
    ROTARY_SPRING,
    SPRING,
    STIFFNESS,
    STORED,
    SUPPORTS,
    WORK,
)  # fmt: skip
from .newton import held
from .rows import joint_rows
from .scratch import (
    BEGAN,
    DRAG,
    ENDED,
    FORCE,
    L_A,
    L_JOINT,
    L_KIND,
    L_SIDE,
    L_SOFT,
    LAM,
    MOBILITY,
    TOTAL,
    WAY,
    FloatArray,
    IntArray,
)  # fmt: skip


@kernel
def book(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int, h: float,
    one: FloatArray, ledger: FloatArray,
) -> None:  # fmt: skip
    """Add the works of a solved part of the step to `ledger` (see `layout`), and its impulses to TOTAL.

    A joint's work on its bodies is F . x / h. Of that, F . x / h of a body that it cannot move is taken from a support.
    """
    for k in range(joints):
        kind, j = link[k, L_KIND], link[k, L_JOINT]
        spring = kind in (SPRING, ROTARY_SPRING)
        if not spring and not held(link, k, 0):
            continue
        joint_rows(joint, hinge, link, k, local, h, one)
        total, moved = 0.0, 0.0
        for end in range(2):
            i = link[k, L_A + end]
            for c in range(3):
                work = one[FORCE, 3 * end + c] * local[i, WAY + c] / h
                total += work
                if local[i, MOBILITY + c] > 0.0:
                    moved += work
        ledger[SUPPORTS] += moved - total
        joint[j, WORK] += moved
        hinge[k, TOTAL] += hinge[k, LAM]
        hinge[k, TOTAL + 1] += hinge[k, LAM + 1]
        if spring:
            began, ended = hinge[k, BEGAN], hinge[k, ENDED]
            sign = -1.0 if kind == SPRING else 1.0
            pull = joint[j, STIFFNESS] * (0.5 * (began + ended) - joint[j, REST]) + sign * joint[j, PUSH]
            lost = hinge[k, DRAG] * (ended - began) ** 2 / h
            ledger[STORED] += pull * (ended - began)
            ledger[DAMPED] += lost
            ledger[CLOSED] += total + pull * (ended - began) + lost
        elif kind == MOTOR or link[k, L_SOFT] != 0:
            if kind == MOTOR or total > 0.0:
                ledger[MOTORS] += total
            else:
                ledger[CLAMPED] -= total
        elif link[k, L_SIDE] != 0 and total < 0.0:
            ledger[LIMITED] -= total
        else:
            ledger[CLOSED] += total

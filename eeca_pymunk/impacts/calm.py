"""Which islands come to a stand.

An island stands still once, over a whole step that nobody disturbed, every body of it was slower than STANDS |a| dt at
both ends, so that its contacts bear its weight to that accuracy, and no contact slipped or was driven; or once it has
hardly moved for some steps and `..sustained.statics` finds the forces that hold it.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..layout import AX, AY, EXTENT, SPIN, TWIST, VX, VY
from ..sustained.statics import STANDS, bound
from .layout import (
    AFTER_ME,
    BETA,
    BUSY,
    CALM_FOR,
    DT,
    HITS,
    ISLAND,
    JOINTED,
    LAM,
    LIFT,
    OPEN,
    PULLED,
    PUSHES,
    ROOT,
    SPAN_FROM,
    STILL,
    TOGETHER,
    UN_AFTER,
    UN_BEFORE,
    UNTIL,
    UT_AFTER,
    UT_BEFORE,
    WORK_OF,
    Scene,
)  # fmt: skip

LIKELY = 3  # of MEMBER[STILL]
_SURE = 2  # steps that an island hardly moves, before it is asked whether it stands
_AGAIN, _LATEST = 4, 32  # and until it is asked again, one more for every fourth body


@uncounted
def speed(BODY: FloatArray, i: int, s: float) -> float:
    """A bound on the speed of the points of body i in s."""
    vx, vy = BODY[i, VX] + s * BODY[i, AX], BODY[i, VY] + s * BODY[i, AY]
    return bound(vx, vy, BODY[i, SPIN] + s * BODY[i, TWIST], BODY[i, EXTENT])


@uncounted
def calm(A: Scene, root: int, MINE: IntArray, n: int, t: float) -> bool:
    """Whether the island of the n bodies MINE may come to a stand at instant t; if so, it is asked again much later."""
    if t > 0.0 or A.COUNT[TOGETHER] > 0 or A.RULE.shape[0] > 0 or A.MEMBER[root, HITS] > 0:
        return False
    for q in range(n):
        if A.RESTING[MINE[q], CALM_FOR] < _SURE or A.MEMBER[MINE[q], BUSY] > 0:
            return False
    for q in range(n):
        A.RESTING[MINE[q], CALM_FOR] = -min(_AGAIN + n // 4, _LATEST)
    return True


@uncounted
def slow(A: Scene, root: int) -> bool:
    """Whether all bodies of an island were as good as at rest at both ends of this step, undisturbed."""
    BODY, MEMBER = A.BODY, A.MEMBER
    dt = A.PAR[DT]
    if MEMBER[root, OPEN] == 0 or MEMBER[root, JOINTED] > 0 or MEMBER[root, HITS] > 0:
        return False
    if A.RESTING[root, UNTIL] < math.inf:
        return False
    limit = STANDS * A.PAR[PULLED] * dt
    i = root
    while i >= 0:
        if MEMBER[i, BUSY] > 0:
            return False
        if max(speed(BODY, i, 0.0), speed(BODY, i, dt)) > limit:
            return False
        for c in range(6):
            if A.RESTING[i, LIFT + c] != 0.0:
                return False
        i = MEMBER[i, AFTER_ME]
    return True


@uncounted
def find_still(A: Scene) -> None:
    """At the end of a step, before its contacts are booked: which islands come to a stand."""
    if A.PAR[PULLED] == 0.0 or A.COUNT[TOGETHER] > 0 or A.RULE.shape[0] > 0:
        return
    some = False
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i, ISLAND] == i and A.MEMBER[i, STILL] == 0 and slow(A, i):
            A.MEMBER[i, STILL] = LIKELY
            some = True
    if not some:
        return
    limit = STANDS * A.PAR[PULLED] * A.PAR[DT]
    for c in range(A.COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root < 0 or A.MEMBER[root, STILL] != LIKELY:
            continue
        R = A.PUSHED[c]
        slips = max(max(abs(R[UN_BEFORE]), abs(R[UN_AFTER])), max(abs(R[UT_BEFORE]), abs(R[UT_AFTER])))
        driven = abs(R[WORK_OF]) > limit * (abs(R[LAM]) + abs(R[BETA]))
        if R[SPAN_FROM] != 0.0 or slips > 4.0 * limit or driven:
            A.MEMBER[root, STILL] = 0

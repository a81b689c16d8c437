"""Contacts that a motor below its max_force presses shut: which impulse it takes to overcome it."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..impacts.spans import Local
from ..model.contacts import Row
from ..model.scene import Scene
from ..rows.build import normal_rate
from .advance import AS_IF_SLIPPING, AS_IT_IS, NOT_AT_ALL, Motion, advance
from .columns import Columns, weigh
from .groups import Groups
from .layout import Joints
from .motors import may_slip

_TRIES, _MORE = 12, 4.0  # impulses against a motor, each so many times the last


@uncounted
def driven(J: Joints, groups: Groups, C: Columns, P: IntArray, Q: IntArray, m: int, HELD: IntArray) -> bool:
    """HELD (m,): 1 for contacts that are left out, though joints with bounds hold against them; if there are any."""
    some = False
    for i in range(m):
        HELD[i] = 0
        for q in (P[i], Q[i]):
            g = groups.GROUP[q]
            if C.OUT[i] != 0 and g >= 0 and groups.COMPONENT[g] >= 0 and may_slip(J, groups.COMPONENT[g]):
                HELD[i] = 1
                some = True
    return some


@kernel
def overcome(
    A: Scene, J: Joints, isle: Local, groups: Groups, P: IntArray, Q: IntArray, ROWS: Rows[Row], L: FloatArray, m: int,
    t: float, h: float, small: float, motion: Motion, C: Columns,
) -> None:  # fmt: skip
    """Where a motor below its max_force pushes a body into another one, no small impulse changes the body's velocity:
    the motor makes up for it. Find one that does, so that the answers C are those of a motor at its max_force.
    """
    HELD = np.empty(m, np.int64)
    if not driven(J, groups, C, P, Q, m, HELD):
        return
    START, UNKNOWN = np.zeros(m), np.empty((0, 3))
    waiting = 0
    for i in range(m):
        START[i] = normal_rate(P, Q, ROWS, motion.V, i)
        if not ROWS[i].target - START[i] > small:
            HELD[i] = 0
        waiting += HELD[i]
    if waiting == 0:
        return
    advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, AS_IF_SLIPPING, UNKNOWN)
    weigh(groups, C, P, Q, ROWS, m)
    for i in range(m):
        if C.OUT[i] != 0:
            HELD[i] = 0
        if HELD[i] != 0:
            L[i, 0] += ROWS[i].k_n * (ROWS[i].target - START[i])
    for tries in range(_TRIES):
        advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, NOT_AT_ALL, UNKNOWN)
        waiting = 0
        for i in range(m):
            if HELD[i] == 0:
                continue
            if normal_rate(P, Q, ROWS, motion.V, i) > START[i] + 0.1 * (ROWS[i].target - START[i]):
                HELD[i] = 0
                continue
            L[i, 0] *= _MORE if tries + 1 < _TRIES else 0.0
            waiting += 1
        if waiting == 0:
            break
    advance(A, J, isle, groups, P, Q, ROWS, L, m, t, h, motion, C, AS_IT_IS, UNKNOWN)
    weigh(groups, C, P, Q, ROWS, m)

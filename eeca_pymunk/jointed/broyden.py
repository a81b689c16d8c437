"""Columns updated by the last two motions of the components: Broyden's method.

Columns are linear responses about one motion, without the rotation of joints that press hard. With d the change of all
impulses between two motions, and e the change of velocities that the columns do not explain,

    Y <- Y + e (W d)^T / (d.W d)

for each component with the impulses on it: the smallest change of the columns that explains e, where W d.d, with W the
mobilities along the impulses, is an energy, as impulses and angular impulses have no common unit. Iterations converge
superlinearly without new columns. The update fails if a contact would no longer be moved by its own impulse.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded
from ..model.parameters.joints import UPDATE_ROUND_OFF
from ..rows.bounded import push_row
from ..rows.columns import push_columns
from .advance import Interval
from .columns import column_rate, is_movable


@nonallocating
def clear_round_off(interval: Interval, ERROR: FloatArray) -> None:
    """Set to 0 what may be round-off of places of bodies, over the interval, in changes of velocities ERROR (k, 3):
    small changes of impulses would otherwise seem to cause it."""
    for q in range(len(ERROR)):
        extent = interval.isle.EXTENT[q]
        least = UPDATE_ROUND_OFF * extent / interval.h
        for c in range(3):
            if abs(ERROR[q, c]) * (extent if c == 2 else 1.0) <= least:
                ERROR[q, c] = 0.0


@kernel
def update_columns(
    interval: Interval, B: Bounded, L: FloatArray, BEFORE: FloatArray, NOW: FloatArray, V: FloatArray
) -> bool:
    """Update the columns of contacts and of bounded rows by the last two motions. BEFORE (m, 2), NOW (rows,) and V (k,
    3) are impulses of contacts, of bounded rows, and velocities of the one before; L (m, 2) the present impulses. False
    if a contact that its own impulse moved no longer is: the columns are then invalid."""
    groups, ROWS, motion, C, m = interval.groups, interval.ROWS, interval.motion, interval.C, interval.m
    ERROR, D, n = motion.EVEN - V, L[:m] - BEFORE[:m], B.NUMBER[0]
    push_columns(C, D, m, -1.0, ERROR)
    SQUARE = np.zeros(len(groups.COMPONENT) + 1)  # d.d of each group; one more, for GROUP -1
    for i in range(m):
        a, b = groups.GROUP[ROWS[i].a] + 1, groups.GROUP[ROWS[i].b] + 1
        square = (D[i, 0] ** 2 + D[i, 1] ** 2) * ROWS[i].a_nn
        SQUARE[a] += square
        SQUARE[b] += square if b != a else 0.0
    for i in range(n):
        change = B.ROWS[i].now - NOW[i]
        push_row(B, i, -change, ERROR)
        SQUARE[groups.GROUP[B.BODY[B.AT[i]]] + 1] += change**2 * B.ROWS[i].a_own
    clear_round_off(interval, ERROR)
    for i in range(m):
        for w in range(C.AT[i], C.AT[i + 1]):
            q = C.BODY[w]
            square = SQUARE[groups.GROUP[q] + 1]
            if groups.COMPONENT[groups.GROUP[q]] < 0 or not square > 0.0:
                continue
            for c in range(3):
                C.N[w, c] += ERROR[q, c] * D[i, 0] * ROWS[i].a_nn / square
                C.T[w, c] += ERROR[q, c] * D[i, 1] * ROWS[i].a_nn / square
    for i in range(n):
        for w in range(B.AT[i], B.AT[i + 1]):
            square = SQUARE[groups.GROUP[B.BODY[w]] + 1]
            for c in range(3 if square > 0.0 else 0):
                B.N[w, c] += ERROR[B.BODY[w], c] * (B.ROWS[i].now - NOW[i]) * B.ROWS[i].a_own / square
    for i in range(m):
        if C.LEFT_OUT[i] == 0 and not is_movable(groups, ROWS[i], column_rate(C, ROWS, i, C.N, False)):
            return False
    return True

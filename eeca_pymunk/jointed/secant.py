"""Columns made to fit the last two motions of the components: Broyden's update.

Columns are linear answers about one motion, without what turns with it where joints press hard. With the change d of
all impulses between two motions, and e what the velocities have changed by beyond the columns,

    Y <- Y + e d^T / (d.d),

for each component with the impulses on it: the least change of the columns with which they answer d as the component
does. Iterations converge superlinearly with it, without new columns; unless a contact would no longer be moved by its
own impulse, as no component answers.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded
from ..model.parameters.joints import FIT_ROUND_OFF
from ..rows.bounded import push_row
from ..rows.columns import push_columns
from .advance import Interval
from .columns import column_rate, is_movable


@nonallocating
def clear_round_off(interval: Interval, ERROR: FloatArray) -> None:
    """Set to 0 what may be round-off of the places of bodies (k, 3), over the interval, in changes of velocities: small
    changes of impulses would seem to cause it all."""
    for q in range(len(ERROR)):
        extent = interval.isle.EXTENT[q]
        least = FIT_ROUND_OFF * extent / interval.h
        for c in range(3):
            if abs(ERROR[q, c]) * (extent if c == 2 else 1.0) <= least:
                ERROR[q, c] = 0.0


@kernel
def fit_columns(
    interval: Interval, B: Bounded, L: FloatArray, BEFORE: FloatArray, NOW: FloatArray, V: FloatArray
) -> bool:
    """Update the columns of contacts and of bounded rows; V (k, 3), NOW (rows,), BEFORE (m, 2): velocities at the end
    of the motion before, impulses of bounded rows and of contacts in it; L (m, 2): those of the present motion. Whether
    all contacts that gave way still do: else these are no columns."""
    groups, ROWS, motion, C, m = interval.groups, interval.ROWS, interval.motion, interval.C, interval.m
    ERROR, D, n = motion.MEAN - V, L[:m] - BEFORE[:m], B.USED[0]
    push_columns(C, D, m, -1.0, ERROR)
    SQUARE = np.zeros(len(groups.COMPONENT) + 1)  # d.d of each group; one more, for GROUP -1
    for i in range(m):
        a, b = groups.GROUP[ROWS[i].a] + 1, groups.GROUP[ROWS[i].b] + 1
        SQUARE[a] += D[i, 0] ** 2 + D[i, 1] ** 2
        SQUARE[b] += D[i, 0] ** 2 + D[i, 1] ** 2 if b != a else 0.0
    for i in range(n):
        change = B.ROWS[i].now - NOW[i]
        push_row(B, i, -change, ERROR)
        if B.AT[i + 1] > B.AT[i]:
            SQUARE[groups.GROUP[B.BODY[B.AT[i]]] + 1] += change**2
    clear_round_off(interval, ERROR)
    for i in range(m):
        for w in range(C.AT[i], C.AT[i + 1]):
            q = C.BODY[w]
            square = SQUARE[groups.GROUP[q] + 1]
            if groups.COMPONENT[groups.GROUP[q]] < 0 or not square > 0.0:
                continue
            for c in range(3):
                C.N[w, c] += ERROR[q, c] * D[i, 0] / square
                C.T[w, c] += ERROR[q, c] * D[i, 1] / square
    for i in range(n):
        for w in range(B.AT[i], B.AT[i + 1]):
            square = SQUARE[groups.GROUP[B.BODY[w]] + 1]
            for c in range(3 if square > 0.0 else 0):
                B.N[w, c] += ERROR[B.BODY[w], c] * (B.ROWS[i].now - NOW[i]) / square
    for i in range(m):
        if C.OUT[i] == 0 and not is_movable(groups, ROWS[i], column_rate(C, ROWS, i, C.N, False)):
            return False
    return True

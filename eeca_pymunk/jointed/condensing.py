"""Contacts and bounded rows of joints, those inside of their bounds condensed: contacts feel motors that hold.

With the rows S inside and their velocities at their targets, an impulse along a column c of a contact moves

    c - D_S (J_S D_S)^-1 J_S c,

D the columns of the rows, J the rows. The contacts are solved with these, the impulses of S follow, and the row that
violates its bound, or its law at it, the most changes sides: an active-set method, which ends where none does.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, empty
from ..model.contacts import ROW, Bounded, Columns, JointedProblem, Row
from ..model.parameters.joints import (
    COLUMN_CONTACTS,
    CONDENSED_BOUNDED,
    CONDENSED_CHANGES,
    CONDENSED_PROXIMAL,
)
from ..rows.bounded import SINGLE, bounded_rate, per_impulse, push_row, room_for_rows
from ..rows.build import normal_rate
from ..rows.dense import back, decompose
from ..rows.inplace import copy
from .columns import leave_out, weigh
from .groups import Groups
from .newton import solve_columns


@nonallocating
def copy_weights(ROWS: Rows[Row], m: int, KEPT: Rows[Row]) -> None:
    """Copy to KEPT (m,) those fields that `weigh` changes."""
    for i in range(m):
        R, K = ROWS[i], KEPT[i]
        K.k_n, K.a_nn, K.k_t, K.a_tt, K.a_nt = R.k_n, R.a_nn, R.k_t, R.a_tt, R.a_nt
        K.friction, K.w_nn, K.w_nt, K.w_tt = R.friction, R.w_nn, R.w_nt, R.w_tt


@nonallocating
def along_row(D: Bounded, i: int, C: Columns, contact: int, tangent: bool) -> float:
    """Velocity along bounded row i per normal, or tangential, impulse of a contact."""
    total = 0.0
    for w in range(C.AT[contact], C.AT[contact + 1]):
        for end in range(2):
            if C.BODY[w] == D.END[i, end]:
                for c in range(3):
                    total += D.ROW[i, 3 * end + c] * (C.T[w, c] if tangent else C.N[w, c])
    return total


@nonallocating
def add_column(D: Bounded, i: int, factor: float, C: Columns, contact: int, tangent: bool) -> None:
    """Add the column of bounded row i, times a factor, to a column of a contact."""
    if factor == 0.0:
        return
    for w in range(C.AT[contact], C.AT[contact + 1]):
        for e in range(D.AT[i], D.AT[i + 1]):
            if D.BODY[e] == C.BODY[w]:
                for c in range(3):
                    if tangent:
                        C.T[w, c] += factor * D.N[e, c]
                    else:
                        C.N[w, c] += factor * D.N[e, c]


@nonallocating
def violation(D: Bounded, i: int, side: int, x: float, per: float, V: FloatArray) -> float:
    """By how much row i violates its bound, or at a bound its law: a velocity."""
    if side == 0:
        return max(x - D.ROWS[i].high, D.ROWS[i].low - x) * per
    return side * (D.ROWS[i].speed + bounded_rate(D, i, V))


@nonallocating
def follow(S: IntArray, k: int, Y: FloatArray, L: FloatArray, LC: FloatArray, m: int) -> None:
    """Take LC (m, 2) for the impulses of the contacts in L; those of the k rows S answer by Y (k, 2 m)."""
    for i in range(m):
        for c in range(2):
            change = LC[i, c] - L[i, c]
            for p in range(k):
                L[m + S[p], 0] += Y[p, 2 * i + c] * change
            L[i, c] = LC[i, c]


@nonallocating
def first_to_yield(D: Bounded, S: IntArray, k: int, Y: FloatArray, L: FloatArray, m: int, j: int) -> int:
    """Which of the k rows S comes to its bound first while impulse j of the contacts grows; -1 for none."""
    first, least = -1, np.inf
    for p in range(k):
        i, rate = S[p], Y[p, j]
        if rate == 0.0:
            continue
        way = (D.ROWS[i].high - L[m + i, 0]) / rate if rate > 0.0 else (D.ROWS[i].low - L[m + i, 0]) / rate
        if way < least:
            first, least = p, way
    return first


@kernel
def solve_condensed(
    problem: JointedProblem, groups: Groups, K: Columns, L: FloatArray, V: FloatArray, tolerance: float, most: int
) -> float:
    """Impulses L (m contacts, then the bounded rows D) and velocities V.

    Args:
        K: room for the condensed columns.  tolerance, most: see `solve_columns`.

    Returns:
        the last sweep's largest change of a contact's velocity; -1 with nothing changed if rows go on changing sides,
        if that is above the tolerance, or if there are some of discs.
    """
    A, B, ROWS, C, D, m = problem
    n = D.USED[0]
    if n == 0 or n > CONDENSED_BOUNDED or m > COLUMN_CONTACTS:
        return -1.0
    L0, V0, KEPT = L.copy(), V.copy(), empty(m, ROW)
    side, R, S = np.zeros(n, np.int64), np.empty((n, n)), np.empty(n, np.int64)
    Y, LC = np.empty((n, 2 * m)), np.empty((m, 2))
    W, order, r, x = np.empty((n, n)), np.empty(n, np.int64), np.empty(n), np.empty(n)
    for i in range(n):
        if D.ROWS[i].part != SINGLE:
            return -1.0
        for j in range(n):
            R[i, j] = per_impulse(D, i, j)
        side[i] = 1 if L[m + i, 0] >= D.ROWS[i].high else -1 if L[m + i, 0] <= D.ROWS[i].low else 0
    copy_weights(ROWS, m, KEPT)
    for _ in range(CONDENSED_CHANGES * n):
        k = 0
        for i in range(n):
            if not R[i, i] > 0.0:
                continue  # joints hold what it acts between: its impulse stays
            if side[i] == 0:
                S[k] = i
                k += 1
            else:
                bound = D.ROWS[i].high if side[i] > 0 else D.ROWS[i].low
                push_row(D, i, bound - L[m + i, 0], V)
                L[m + i, 0] = bound
        for p in range(k):
            for q in range(k):
                W[p, q] = R[S[p], S[q]]
            W[p, p] += abs(W[p, p]) / CONDENSED_PROXIMAL
            r[p] = -D.ROWS[S[p]].speed - bounded_rate(D, S[p], V)
        decompose(W, k, order)
        back(W, k, order, r, x)
        for p in range(k):
            L[m + S[p], 0] += x[p]
            push_row(D, S[p], x[p], V)
        for w in range(C.AT[m]):
            for c in range(3):
                K.N[w, c], K.T[w, c] = C.N[w, c], C.T[w, c]
        for j in range(2 * m):
            tangent = j % 2 == 1
            for p in range(k):
                r[p] = -along_row(D, S[p], C, j // 2, tangent)
            back(W, k, order, r, x)
            for p in range(k):
                Y[p, j] = x[p]
                add_column(D, S[p], x[p], K, j // 2, tangent)
        weigh(groups, K, A, B, ROWS, m)
        for i in range(m):
            LC[i, 0], LC[i, 1] = L[i, 0], L[i, 1]
        leave_out(K, LC, m, V)
        blocked = -1
        for i in range(m):
            if K.OUT[i] != 0 and C.OUT[i] == 0 and normal_rate(A, B, ROWS, V, i) < ROWS[i].target - 10.0 * tolerance:
                blocked = i
        if blocked >= 0:
            # Rows inside hold what the contact would have to move: one of them comes to its bound.
            copy_weights(KEPT, m, ROWS)
            follow(S, k, Y, L, LC, m)
            p = first_to_yield(D, S, k, Y, L, m, 2 * blocked)
            if p < 0:
                break
            side[S[p]] = 1 if Y[p, 2 * blocked] > 0.0 else -1
            continue
        worst = solve_columns(JointedProblem(A, B, ROWS, K, room_for_rows(0, 0), m), LC, V, tolerance, most)
        follow(S, k, Y, L, LC, m)
        copy_weights(KEPT, m, ROWS)
        farthest, by = -1, 10.0 * tolerance
        for i in range(n):
            off = violation(D, i, side[i], L[m + i, 0], R[i, i], V)
            if off > by and R[i, i] > 0.0:
                farthest, by = i, off
        if farthest < 0:
            if worst > 10.0 * tolerance:
                break
            return worst
        if side[farthest] != 0:
            side[farthest] = 0
        else:
            side[farthest] = 1 if L[m + farthest, 0] > D.ROWS[farthest].high else -1
    copy(L, L0)
    copy(V, V0)
    return -1.0

"""Contact laws of few contacts, and bounded rows of joints, by Lemke's pivots: where sweeps go round in circles.

Impulses of a contact answer along its tangent, too: with much friction sweeps go from one mode to another and back, or
creep from one end of a face to the other. The laws of all are one linear complementarity problem (Stewart and Trinkle
1996; Anitescu and Potra 1997), lam, beta = beta+ - beta-, and gamma the speed of slip:

    0 <= lam    _|_  u_n - b >= 0,             0 <= beta+-  _|_  gamma +- u_t >= 0,
    0 <= gamma  _|_  mu lam - beta+ - beta- >= 0,

and for a row of speed u whose impulse is low + z:  0 <= z _|_ u + y >= 0,  0 <= y _|_ high - low - z >= 0. Lemke's
method finds a solution of it, whatever the friction, as a kinetic energy is behind u.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..model.contacts import Bounded, JointedProblem, Row
from ..model.parameters.joints import PIVOT_CONTACTS, PIVOT_ROUND_OFF, PIVOT_WAKES, PIVOTS
from ..rows.bounded import SINGLE, bounded_rate, push_row
from ..rows.build import normal_rate, tangent_rate
from ..rows.columns import push_columns
from ..rows.dense import matrix
from ..rows.inplace import copy
from ..rows.sweeps import sweep

_NORMAL, _TANGENT, _BOUNDED = 0, 1, 2  # directions of impulses, as in `matrix`


@uncounted
def exchange(T: FloatArray, n: int, row: int, column: int) -> None:
    """Let the variable of a column of the tableau T (n, w) take the place of that of a row."""
    width = T.shape[1]
    over = 1.0 / T[row, column]
    for c in range(width):
        T[row, c] *= over
    for i in range(n):
        factor = T[i, column]
        if i == row or factor == 0.0:
            continue
        for c in range(width):
            T[i, c] -= factor * T[row, c]
        T[i, column] = 0.0


@uncounted
def leaving_row(T: FloatArray, n: int, column: int, BASIS: IntArray) -> int:
    """The row whose variable comes to 0 first while that of the column grows: the artificial one's of several, else
    that with the largest pivot; -1 if none does."""
    last, least, row, largest = T.shape[1] - 1, math.inf, -1, 0.0
    for i in range(n):
        if T[i, column] > PIVOT_ROUND_OFF:
            least = min(least, max(T[i, last], 0.0) / T[i, column])
    for i in range(n):
        pivot = T[i, column]
        if pivot <= PIVOT_ROUND_OFF or max(T[i, last], 0.0) > (least + PIVOT_ROUND_OFF) * pivot:
            continue
        if BASIS[i] == 2 * n:
            return i
        if pivot > largest:
            row, largest = i, pivot
    return row


@kernel
def lemke(M: FloatArray, Q: FloatArray, n: int, Z: FloatArray) -> bool:
    """Z (n,) >= 0 with w = M Z + Q >= 0 and Z.w = 0, by at most PIVOTS pivots for each; False if they find none."""
    for i in range(n):
        Z[i] = 0.0
    row, scale = -1, 0.0
    for i in range(n):
        scale = max(scale, abs(Q[i]))
    if scale == 0.0:
        return True
    T, BASIS = np.zeros((n, 2 * n + 2)), np.empty(n, np.int64)
    least = 0.0
    for i in range(n):
        # Covers of different sizes: few rows come to 0 together.
        cover = 1.0 + 0.5 * ((0.618034 * (i + 1)) % 1.0)
        T[i, i], T[i, 2 * n], T[i, 2 * n + 1] = 1.0, -cover, Q[i] / scale
        for j in range(n):
            T[i, n + j] = -M[i, j]
        BASIS[i] = i
        if Q[i] / scale < least * cover:
            row, least = i, Q[i] / scale / cover
    if row < 0:
        return True
    enters = 2 * n
    for _ in range(PIVOTS * n):
        leaves = BASIS[row]
        exchange(T, n, row, enters)
        BASIS[row] = enters
        if leaves == 2 * n:
            for i in range(n):
                if BASIS[i] >= n:
                    Z[BASIS[i] - n] = max(T[i, 2 * n + 1], 0.0) * scale
            return True
        enters = leaves + n if leaves < n else leaves - n
        row = leaving_row(T, n, enters, BASIS)
        if row < 0:
            return False
    return False


@kernel
def pose_problem(
    ROWS: Rows[Row], D: Bounded, W: FloatArray, U: FloatArray, at: IntArray, kind: IntArray, N: int, M: FloatArray,
    Q: FloatArray, OF: IntArray,
) -> int:  # fmt: skip
    """Fill in M and Q of `lemke` from the N directions, their rates U (N,) and answers W (N, N), in units of the square
    root of a mass; how many unknowns there are. OF (., 2): the direction of each, and its sign, 0 for what is none."""
    n = 0
    for k in range(N):
        count = 2 if kind[k] == _BOUNDED or kind[k] == _TANGENT else 1
        for sign in range(count):
            OF[n, 0], OF[n, 1] = k, 0 if kind[k] == _BOUNDED and sign == 1 else 1 - 2 * sign
            n += 1
        if kind[k] == _TANGENT:
            OF[n, 0], OF[n, 1] = k, 0
            n += 1
    for i in range(n):
        k, sign = OF[i, 0], OF[i, 1]
        d = 1.0 / math.sqrt(W[k, k])
        Q[i] = d * sign * U[k]
        if sign == 0 and kind[k] == _BOUNDED:
            Q[i] = (D.ROWS[at[k]].high - D.ROWS[at[k]].low) / d
        for j in range(n):
            o, other = OF[j, 0], OF[j, 1]
            M[i, j] = d * sign * W[k, o] * other / math.sqrt(W[o, o]) if sign != 0 and other != 0 else 0.0
            if o == k and sign != other and sign * other == 0:
                # gamma beside both ways of slip; y beside z.
                M[i, j] = 1.0 if other == 0 else -1.0
            if kind[k] == _TANGENT and sign == 0 and kind[o] == _NORMAL and at[o] == at[k]:
                M[i, j] = ROWS[at[k]].friction / math.sqrt(W[o, o]) / d
    return n


@kernel
def pivot_columns(problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float, worst: float) -> float:
    """Impulses L (m contacts, then the bounded rows D), after which a sweep still changes a velocity by `worst`, by
    pivots; what a sweep does then, 0 if these laws are met to round-off. Nothing is changed where there are too many
    contacts, discs, or no solution is found."""
    A, B, ROWS, C, D, m = problem
    s = D.USED[0]
    if m > PIVOT_CONTACTS or s > PIVOT_CONTACTS:
        return worst
    for i in range(s):
        if D.ROWS[i].part != SINGLE:
            return worst
    size = 2 * m + s
    at, kind, U = np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size)
    slip, W = np.zeros(m), np.empty((size, size))
    room = 4 * m + 2 * s
    M, Q, Z, OF = np.empty((room, room)), np.empty(room), np.empty(room), np.empty((room, 2), np.int64)
    L0, V0 = L.copy(), V.copy()
    for _ in range(PIVOT_WAKES):
        push_columns(C, L, m, -1.0, V)
        for i in range(s):
            push_row(D, i, D.ROWS[i].low - L[m + i, 0], V)
            L[m + i, 0] = D.ROWS[i].low
        N = 0
        for i in range(m):
            L[i, 0] = L[i, 1] = 0.0
            if C.OUT[i] == 0 and ROWS[i].wake == np.inf:
                at[N], kind[N], U[N] = i, _NORMAL, normal_rate(A, B, ROWS, V, i) - ROWS[i].target
                N += 1
                if ROWS[i].friction > 0.0:
                    at[N], kind[N], U[N] = i, _TANGENT, tangent_rate(A, B, ROWS, V, i)
                    N += 1
        for i in range(s):
            at[N], kind[N], U[N] = i, _BOUNDED, D.ROWS[i].speed + bounded_rate(D, i, V)
            N += 1
        matrix(problem, slip, at, kind, N, W)
        sound = True
        for k in range(N):
            sound = sound and W[k, k] > 0.0
        n = pose_problem(ROWS, D, W, U, at, kind, N, M, Q, OF) if sound else 0
        if not sound or not lemke(M, Q, n, Z):
            copy(L, L0)
            copy(V, V0)
            return worst
        for j in range(n):
            k = OF[j, 0]
            impulse = OF[j, 1] * Z[j] / math.sqrt(W[k, k])
            if kind[k] == _BOUNDED:
                L[m + at[k], 0] += impulse
                push_row(D, at[k], impulse, V)
            else:
                L[at[k], kind[k]] += impulse
        for i in range(m):
            most = ROWS[i].friction * L[i, 0]
            L[i, 1] = min(max(L[i, 1], -most), most)
        push_columns(C, L, m, 1.0, V)
        FOUND, MOTION, asleep, left = L.copy(), V.copy(), 0, 0
        for i in range(m):
            asleep += 1 if ROWS[i].wake < np.inf else 0
        left_over = sweep(problem, L, V)
        for i in range(m):
            left += 1 if ROWS[i].wake < np.inf else 0
        if left_over <= 10.0 * tolerance:
            return left_over
        if left == asleep:
            # Coulomb's law is met; sweeps cut friction where a contact alone would give energy.
            copy(L, FOUND)
            copy(V, MOTION)
            return 0.0
    copy(L, L0)
    copy(V, V0)
    return worst

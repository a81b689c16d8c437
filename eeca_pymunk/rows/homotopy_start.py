"""The start of a homotopy: its tableau, at given impulses and the states that they are in, or without any.

`homotopy.py` has the equations.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..model.contacts import JointedProblem
from ..model.parameters.impulses import HOMOTOPY_CHANGES, HOMOTOPY_CHANGES_ANEW, ON_CONE_SWEPT, RESTORED_FIRST
from ..model.parameters.joints import CHANGE_ENTRY_WORK, CHANGE_WORK, HOMOTOPY_WORK
from .bounded import SINGLE, bounded_rate
from .build import normal_rate, tangent_rate
from .coulomb import OPEN, SLIP, STICK, limited_slip, mode_of
from .dense import matrix_jointed
from .pivots import BOUND, INSIDE, Tableau, bound_of, make_tableau, own_rate, pivot, slip, stick, unknown_of


@inlined
def work_of_change(size: int) -> float:
    """Operations of a change of state among so many unknowns: the search for it, and the pivot."""
    return size * (CHANGE_WORK + CHANGE_ENTRY_WORK * size)


@kernel
def start_homotopy(problem: JointedProblem, L: FloatArray, V: FloatArray, anew: bool, discs: bool) -> Tableau:
    """The homotopy's start at impulses L (m + n, 2) of m contacts and n bounded rows with velocities V (k, 3); or, if
    `anew`, without impulses of contacts, and with rows at a bound. Contacts that are inactive (`Row.activation`) or
    left out (`Columns.LEFT_OUT`), and rows that joints hold take no part: their impulses stay, and so do those of
    discs, unless these are replaced by squares (`discs`)."""
    ROWS, C, B, m = problem
    n = B.NUMBER[0]
    size = 2 * m + n
    changes = HOMOTOPY_CHANGES_ANEW if anew else HOMOTOPY_CHANGES
    tableau = make_tableau(m, n, size + changes * (m + n))
    NUMBERS, SIZES = np.zeros(2 * size + m, np.int64), np.zeros(2 * size + m)
    AT, KIND, BEGAN = NUMBERS[:size], NUMBERS[size : 2 * size], NUMBERS[2 * size :]  # BEGAN: states of L
    T, X, OWN, SIGN = tableau.T, SIZES[:size], SIZES[size : 2 * size], SIZES[2 * size :]  # SIGN: of friction
    for k in range(size):
        AT[k], KIND[k] = (k // 2, k % 2) if k < 2 * m else (k - 2 * m, 2)
    matrix_jointed(problem, X, AT, KIND, size, T)  # without slips
    for k in range(size):
        T[size, k] = T[size + 1, k] = 0.0
        OWN[k] = T[k, k]
        for r in range(k):
            T[k, r], T[r, k] = T[r, k], T[k, r]
    C.WORK[0] += HOMOTOPY_WORK
    for i in range(m):
        if C.LEFT_OUT[i] == 0 and not ROWS[i].activation < np.inf:
            tableau.MODE[i] = OPEN
            T[size, 2 * i] = normal_rate(ROWS[i], V) - ROWS[i].target
            tableau.TARGET_T[i] = limited_slip(ROWS[i], L[i, 0], L[i, 1])
            T[size, 2 * i + 1] = tangent_rate(ROWS[i], V) - tableau.TARGET_T[i]
            BEGAN[i], SIGN[i] = mode_of(ROWS[i], V, L[i, 0], L[i, 1], ON_CONE_SWEPT)
            tableau.MU[i] = max(ROWS[i].friction, 0.0) if BEGAN[i] != SLIP or SIGN[i] != 0.0 else 0.0
            X[2 * i], X[2 * i + 1] = L[i, 0], L[i, 1]
            C.WORK[0] += work_of_change(size) if L[i, 0] > 0.0 else 0.0
    for i in range(n):
        row, k = B.ROWS[i], 2 * m + i
        tableau.LOW[i], tableau.HIGH[i] = row.low, row.high
        if (discs or row.part == SINGLE) and T[k, k] > 0.0:
            upper = L[m + i, 0] >= row.high or row.low == -np.inf
            tableau.MODE[m + i], tableau.SIGN[m + i] = BOUND, 1.0 if upper else -1.0
            T[size, k] = row.speed + bounded_rate(B, i, V)
            X[k] = L[m + i, 0]
    if not anew:
        set_direction_of_residuals(tableau, m, X, BEGAN, SIGN)
    remove_impulses(tableau, m, X)
    if anew:
        set_opening_direction(tableau, m)
    else:
        restore_states(tableau, m, X, BEGAN, SIGN, OWN)
    return tableau


@nonallocating
def set_direction_of_residuals(tableau: Tableau, m: int, X: FloatArray, BEGAN: IntArray, SIGN: FloatArray) -> None:
    """Set p, the velocities per theta T[size + 1, :]: minus the residuals of the laws at impulses X (size,), at which
    the velocities are T[size, :] and contacts in the states BEGAN (m,) with friction of SIGN (m,)."""
    T, size = tableau.T, tableau.T.shape[1]
    for c in range(len(tableau.MODE)):
        k, state = unknown_of(m, c), tableau.MODE[c]
        u, x = T[size, k], X[k]
        if state == BOUND:
            inside = tableau.LOW[c - m] < x < tableau.HIGH[c - m]
            T[size + 1, k] = -u if inside or tableau.SIGN[c] * u > 0.0 else 0.0
        elif state == OPEN:
            T[size + 1, k] = -u if x > 0.0 else max(-u, 0.0)
            if BEGAN[c] == STICK or SIGN[c] * T[size, k + 1] > 0.0:
                T[size + 1, k + 1] = -T[size, k + 1]


@nonallocating
def set_opening_direction(tableau: Tableau, m: int) -> None:
    """Set p, the velocities per theta, so that all contacts open and rows stay at their bounds; by different amounts,
    so that states change one by one."""
    T, size = tableau.T, tableau.T.shape[1]
    most = 0.0
    for k in range(size):
        most = max(most, abs(T[size, k]))
    for c in range(len(tableau.MODE)):
        k = unknown_of(m, c)
        if tableau.MODE[c] == OPEN or tableau.MODE[c] == BOUND:
            amount = (1.0 + (0.618034 * c) % 1.0) * most
            T[size + 1, k] = -tableau.SIGN[c] * amount if tableau.MODE[c] == BOUND else amount


@nonallocating
def remove_impulses(tableau: Tableau, m: int, X: FloatArray) -> None:
    """Change T[size, :] from the velocities at impulses X (size,) to those without impulses of contacts, and with rows
    at their bounds."""
    T, size = tableau.T, tableau.T.shape[1]
    for k in range(size):
        at_bound = k >= 2 * m and tableau.MODE[k - m] == BOUND
        change = (bound_of(tableau, m, k - m) if at_bound else 0.0) - X[k]
        if change != 0.0:
            for r in range(size):
                T[size, r] += T[k, r] * change


@nonallocating
def restore_states(tableau: Tableau, m: int, X: FloatArray, BEGAN: IntArray, SIGN: FloatArray, OWN: FloatArray) -> None:
    """Pivot from open contacts and rows at bounds to the states of the impulses X (size,), of contacts BEGAN and
    SIGN (m,).

    A pivot far below OWN (size,), what the unknown feels of itself, waits for the others. Redundant impulses leave
    such a pivot whatever comes first. Friction that slips may leave one that another impulse makes as large as any:
    taken before that, it fills the tableau with entries of 1 / pivot, whose round-off exceeds the pivots of redundant
    impulses.
    """
    least, taken = RESTORED_FIRST, 1
    while taken > 0:
        waiting = taken = 0
        for c in range(len(tableau.MODE)):
            k, state = unknown_of(m, c), tableau.MODE[c]
            if state == BOUND and tableau.LOW[c - m] < X[k] < tableau.HIGH[c - m]:
                if abs(own_rate(tableau, k, 0.0)) < least * OWN[k]:
                    waiting += 1
                    continue
                bound = bound_of(tableau, m, c)
                pivot(tableau, k, 0.0, 0.0)
                tableau.T[len(X), k] += bound
                tableau.MODE[c], tableau.SIGN[c] = INSIDE, 0.0
                taken += 1
            elif state == OPEN and BEGAN[c] != OPEN:
                if abs(own_rate(tableau, k, SIGN[c] * tableau.MU[c])) < least * OWN[k]:
                    waiting += 1
                    continue
                slip(tableau, c, SIGN[c])
                taken += 1
            if tableau.MODE[c] == SLIP and BEGAN[c] == STICK:
                if abs(own_rate(tableau, k + 1, 0.0)) < least * OWN[k + 1]:
                    waiting += 1
                    continue
                stick(tableau, c)
                taken += 1
        if taken == 0 and waiting > 0 and least > 0.0:
            least, taken = 0.0, 1

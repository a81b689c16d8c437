"""Coulomb's law and bounded impulses along a homotopy of solved problems, from any impulses to the solution.

In the plane both are piecewise linear: contacts are open (lam = 0, u_n >= b), stick (u = (b, 0)) or slip (beta =
s mu lam, s u_t <= 0); a bounded row has its target velocity, or its impulse is at a bound. Impulses that sweeps leave
miss the law by a residual in each row. They solve it exactly if the free velocities are not q but q + p, with p such
that each row's residual is 0. So they are the solution for q + theta p at theta = 1; that for q is at theta = 0. On the
way there the solution is linear in theta until a state changes; then it goes on, with growing or falling theta, as the
new state allows (Lemke 1965; of contacts Stewart and Trinkle 1996). A change is one pivot, also where contacts jam
with redundant impulses, among which sweeps cycle. A homotopy that begins without impulses ends if no target is positive
and no surface conveys (Anitescu and Potra 1997); others may run to infinity.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..model.contacts import JointedProblem
from ..model.parameters.impulses import HOMOTOPY_CHANGES, HOMOTOPY_CHANGES_ANEW, HOMOTOPY_REFINEMENTS, ON_CONE_SWEPT
from ..model.parameters.joints import CHANGE_ENTRY_WORK, CHANGE_WORK, HOMOTOPY_WORK
from .bounded import SINGLE, bounded_rate
from .build import normal_rate, tangent_rate
from .coulomb import OPEN, SLIP, STICK, limited_slip, mode_of
from .dense import matrix_jointed
from .pivots import (
    ABSENT,
    BOUND,
    INSIDE,
    Tableau,
    bound_of,
    change,
    margin,
    pivot,
    slip,
    slope_of,
    stick,
    unknown_of,
)  # fmt: skip
from .sweeps import velocities


@inlined
def work_of_change(size: int) -> float:
    """Operations of a change of state among so many unknowns: the search for it, and the pivot."""
    return size * (CHANGE_WORK + CHANGE_ENTRY_WORK * size)


@kernel
def start_homotopy(problem: JointedProblem, L: FloatArray, V: FloatArray, anew: bool) -> Tableau:
    """The homotopy's start at impulses L (m + n, 2) of m contacts and n bounded rows with velocities V (k, 3); or, if
    `anew`, without impulses of contacts, and with rows at a bound. Contacts that are inactive (`Row.wake`) or left out
    (`Columns.LEFT_OUT`), discs, and rows that joints hold take no part: their impulses stay."""
    ROWS, C, D, m = problem
    n = D.USED[0]
    size = 2 * m + n
    tableau = Tableau(
        np.zeros(m + n, np.int64), np.zeros(m + n), np.zeros(m), np.zeros(n), np.zeros(n), np.zeros(m),
        np.zeros((size, size + 2)), np.empty(size + 2),
    )  # fmt: skip
    T, X, BEGAN, SIGN = tableau.T, np.zeros(size), np.zeros(m, np.int64), np.zeros(m)  # states of L, signs of friction
    AT, KIND = np.empty(size, np.int64), np.empty(size, np.int64)
    for k in range(size):
        AT[k], KIND[k] = (k // 2, k % 2) if k < 2 * m else (k - 2 * m, 2)
    matrix_jointed(problem, np.zeros(m), AT, KIND, size, T)
    C.WORK[0] += HOMOTOPY_WORK
    for i in range(m):
        if C.LEFT_OUT[i] == 0 and not ROWS[i].wake < np.inf:
            tableau.MODE[i] = OPEN
            T[2 * i, size] = normal_rate(ROWS[i], V) - ROWS[i].target
            tableau.REST[i] = limited_slip(ROWS[i], L[i, 0], L[i, 1])
            T[2 * i + 1, size] = tangent_rate(ROWS[i], V) - tableau.REST[i]
            BEGAN[i], SIGN[i] = mode_of(ROWS[i], V, L[i, 0], L[i, 1], ON_CONE_SWEPT)
            tableau.MU[i] = max(ROWS[i].friction, 0.0) if BEGAN[i] != SLIP or SIGN[i] != 0.0 else 0.0
            X[2 * i], X[2 * i + 1] = L[i, 0], L[i, 1]
            C.WORK[0] += work_of_change(size) if L[i, 0] > 0.0 else 0.0
    for i in range(n):
        row, k = D.ROWS[i], 2 * m + i
        tableau.LOW[i], tableau.HIGH[i] = row.low, row.high
        if row.part == SINGLE and T[k, k] > 0.0:
            upper = L[m + i, 0] >= row.high or row.low == -np.inf
            tableau.MODE[m + i], tableau.SIGN[m + i] = BOUND, 1.0 if upper else -1.0
            T[k, size] = row.speed + bounded_rate(D, i, V)
            X[k] = L[m + i, 0]
    if not anew:
        set_direction_of_residuals(tableau, m, X, BEGAN, SIGN)
    remove_impulses(tableau, m, X)
    if anew:
        set_opening_direction(tableau, m)
    else:
        restore_states(tableau, m, X, BEGAN, SIGN)
    return tableau


@nonallocating
def set_direction_of_residuals(tableau: Tableau, m: int, X: FloatArray, BEGAN: IntArray, SIGN: FloatArray) -> None:
    """Set p, the velocities per theta T[:, size + 1]: minus the residuals of the laws at impulses X (size,), at which
    the velocities are T[:, size] and contacts in the states BEGAN (m,) with friction of SIGN (m,)."""
    T, size = tableau.T, len(tableau.T)
    for c in range(len(tableau.MODE)):
        k, state = unknown_of(m, c), tableau.MODE[c]
        u, x = T[k, size], X[k]
        if state == BOUND:
            inside = tableau.LOW[c - m] < x < tableau.HIGH[c - m]
            T[k, size + 1] = -u if inside or tableau.SIGN[c] * u > 0.0 else 0.0
        elif state == OPEN:
            T[k, size + 1] = -u if x > 0.0 else max(-u, 0.0)
            if BEGAN[c] == STICK or SIGN[c] * T[k + 1, size] > 0.0:
                T[k + 1, size + 1] = -T[k + 1, size]


@nonallocating
def set_opening_direction(tableau: Tableau, m: int) -> None:
    """Set p, the velocities per theta, so that all contacts open and rows stay at their bounds; by different amounts,
    so that states change one by one."""
    T, size = tableau.T, len(tableau.T)
    most = 0.0
    for k in range(size):
        most = max(most, abs(T[k, size]))
    for c in range(len(tableau.MODE)):
        k = unknown_of(m, c)
        if tableau.MODE[c] == OPEN or tableau.MODE[c] == BOUND:
            amount = (1.0 + (0.618034 * c) % 1.0) * most
            T[k, size + 1] = -tableau.SIGN[c] * amount if tableau.MODE[c] == BOUND else amount


@nonallocating
def remove_impulses(tableau: Tableau, m: int, X: FloatArray) -> None:
    """Change T[:, size] from the velocities at impulses X (size,) to those without impulses of contacts, and with rows
    at their bounds."""
    T, size = tableau.T, len(tableau.T)
    for k in range(size):
        at_bound = k >= 2 * m and tableau.MODE[k - m] == BOUND
        change = (bound_of(tableau, m, k - m) if at_bound else 0.0) - X[k]
        if change != 0.0:
            for r in range(size):
                T[r, size] += T[r, k] * change


@nonallocating
def restore_states(tableau: Tableau, m: int, X: FloatArray, BEGAN: IntArray, SIGN: FloatArray) -> None:
    """Pivot from open contacts and rows at bounds to the states of the impulses X (size,), of contacts BEGAN and
    SIGN (m,)."""
    T, MODE, size = tableau.T, tableau.MODE, len(tableau.T)
    for c in range(len(MODE)):
        k = unknown_of(m, c)
        if MODE[c] == BOUND and tableau.LOW[c - m] < X[k] < tableau.HIGH[c - m]:
            bound = bound_of(tableau, m, c)
            pivot(tableau, k)
            T[k, size] += bound
            MODE[c], tableau.SIGN[c] = INSIDE, 0.0
        elif MODE[c] == OPEN and BEGAN[c] != OPEN:
            slip(tableau, c, SIGN[c])
            if BEGAN[c] == STICK:
                stick(tableau, c)


@nonallocating
def set_impulses(tableau: Tableau, m: int, X: FloatArray, L: FloatArray) -> None:
    """Set the impulses L of the present states, by the unknowns X (size,) that these leave free."""
    for c in range(len(tableau.MODE)):
        k, state = unknown_of(m, c), tableau.MODE[c]
        if state == BOUND:
            L[c, 0] = bound_of(tableau, m, c)
        elif state != ABSENT:
            L[c, 0] = X[k] if state != OPEN else 0.0
            if c < m:
                L[c, 1] = X[k + 1] if state == STICK else slope_of(tableau, c) * L[c, 0]


@nonallocating
def correct_residual(problem: JointedProblem, tableau: Tableau, V: FloatArray, X: FloatArray) -> None:
    """Correct the unknowns X (size,) by what the proximal term and the round-off of pivots leave of the velocities that
    the present states fix; V (k, 3) are those of the bodies."""
    ROWS, _, D, m = problem
    for c in range(len(tableau.MODE)):
        k, state = unknown_of(m, c), tableau.MODE[c]
        for z in range(2 if state == STICK else 1 if state in (SLIP, INSIDE) else 0):
            if c >= m:
                off = D.ROWS[c - m].speed + bounded_rate(D, c - m, V)
            elif z == 1:
                off = tangent_rate(ROWS[c], V) - tableau.REST[c]
            else:
                off = normal_rate(ROWS[c], V) - ROWS[c].target
            for i in range(len(X)):
                X[i] -= tableau.T[i, k + z] * off


@kernel
def follow_homotopy(problem: JointedProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, anew: bool) -> bool:
    """Impulses L (m + n, 2) and velocities V (k, 3) at the end of the homotopy from these; False, with nothing changed,
    if its end is not reached.

    Args:
        FREE: (k, 3) velocities without any impulses of the problem.  anew: whether it begins without impulses, and may
            be longer.
    """
    m = problem.m
    tableau = start_homotopy(problem, L, V, anew)
    T, count, size = tableau.T, len(tableau.MODE), len(tableau.T)
    X = np.empty(size)
    # way: direction of theta, +-1.  nearest: way of theta to the next change of state, change `number` of `changed`.
    theta, way, changed, number = 1.0, -1.0, -1, 0
    for _ in range((HOMOTOPY_CHANGES_ANEW if anew else HOMOTOPY_CHANGES) * count):
        nearest = np.inf
        if changed >= 0:
            way = 1.0 if margin(tableau, m, changed, number, 1) > 0.0 else -1.0
        changed = -1
        for c in range(count):
            for which in range(2):
                rate = way * margin(tableau, m, c, which, 1)
                if rate < 0.0:
                    left = max(margin(tableau, m, c, which, 0) + theta * way * rate, 0.0) / -rate
                    if left < nearest:
                        nearest, changed, number = left, c, which
        if way < 0.0 and theta <= nearest:
            finite = True
            for k in range(size):
                X[k] = T[k, size]
                finite = finite and abs(X[k]) < np.inf
            if not finite:
                return False  # a pivot was 0
            set_impulses(tableau, m, X, L)
            velocities(problem, L, FREE, V)
            for _ in range(HOMOTOPY_REFINEMENTS):
                correct_residual(problem, tableau, V, X)
                set_impulses(tableau, m, X, L)
                velocities(problem, L, FREE, V)
            return True
        if changed < 0:
            return False
        theta += way * nearest
        problem.C.WORK[0] += work_of_change(size)
        number = change(tableau, m, changed, number, theta)
    return False

"""Coulomb's law and bounded impulses along a homotopy of solved problems, from any impulses to the solution.

In the plane both are piecewise linear: contacts are open (lam = 0, u_n >= b), stick (u = (b, 0)) or slip (beta = s mu
lam, s u_t <= 0); a bounded row has its target velocity, or its impulse is at a bound. Impulses that sweeps leave miss
the law by a residual in each row. They solve it exactly if the velocities without impulses are not q but q + p, with p
such that each row's residual is 0. So they are the solution for q + theta p at theta = 1; that for q is at theta = 0.
On the way there the solution is linear in theta until a state changes; then it goes on, with growing or falling theta,
as the new state allows (Lemke 1965; of contacts Stewart and Trinkle 1996). A change is one pivot, also where contacts
jam with redundant impulses, among which sweeps cycle. A homotopy that begins without impulses ends if no target is
positive and no surface conveys (Anitescu and Potra 1997); others may run to infinity.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import JointedProblem
from ..model.parameters.impulses import HOMOTOPY_CHANGES, HOMOTOPY_CHANGES_ANEW, HOMOTOPY_REFINEMENTS
from .bounded import bounded_rate
from .build import normal_rate, tangent_rate
from .coulomb import OPEN, SLIP, STICK
from .homotopy_start import start_homotopy, work_of_change
from .pivots import ABSENT, BOUND, INSIDE, Tableau, bound_of, change, margin, slope_of, take_pivot, unknown_of
from .sweeps import velocities


@nonallocating
def set_impulses(tableau: Tableau, m: int, X: FloatArray, L: FloatArray) -> None:
    """Set the impulses L of the present states, by the basic unknowns X (size,)."""
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
    ROWS, _, B, m = problem
    T, size = tableau.T, len(X)
    for k in range(size):
        T[size + 2, k] = 0.0
    for c in range(len(tableau.MODE)):
        k, state = unknown_of(m, c), tableau.MODE[c]
        for z in range(2 if state == STICK else 1 if state in (SLIP, INSIDE) else 0):
            if c >= m:
                off = B.ROWS[c - m].speed + bounded_rate(B, c - m, V)
            elif z == 1:
                off = tangent_rate(ROWS[c], V) - tableau.TARGET_T[c]
            else:
                off = normal_rate(ROWS[c], V) - ROWS[c].target
            T[size + 2, k + z] = off
    # Their effect on the unknowns, by all pivots.
    for p in range(tableau.MADE[0]):
        take_pivot(tableau, p, size + 2)
    for k in range(size):
        X[k] += T[size + 2, k]


@kernel
def follow_homotopy(
    problem: JointedProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, anew: bool, discs: bool
) -> bool:
    """Impulses L (m + n, 2) and velocities V (k, 3) at the end of the homotopy from these; False, with nothing changed,
    if its end is not reached.

    Args:
        FREE: (k, 3) velocities without any impulses of the problem.  anew: whether it begins without impulses, and may
            be longer.
        discs: whether impulses of discs take part, in squares around these; else they stay.
    """
    m = problem.m
    tableau = start_homotopy(problem, L, V, anew, discs)
    T, count, size = tableau.T, len(tableau.MODE), tableau.T.shape[1]
    X = np.empty(size)
    # sense: of theta, +-1.  nearest: change of theta up to the next change of state, change `number` of `changed`.
    theta, sense, changed, number = 1.0, -1.0, -1, 0
    for _ in range((HOMOTOPY_CHANGES_ANEW if anew else HOMOTOPY_CHANGES) * count):
        nearest = np.inf
        if changed >= 0:
            sense = 1.0 if margin(tableau, m, changed, number, 1) > 0.0 else -1.0
        changed = -1
        for c in range(count):
            for which in range(2):
                rate = sense * margin(tableau, m, c, which, 1)
                if rate < 0.0:
                    left = max(margin(tableau, m, c, which, 0) + theta * sense * rate, 0.0) / -rate
                    if left < nearest:
                        nearest, changed, number = left, c, which
        if sense < 0.0 and theta <= nearest:
            finite = True
            for k in range(size):
                X[k] = T[size, k]
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
        theta += sense * nearest
        problem.C.WORK[0] += work_of_change(size)
        number = change(tableau, m, changed, number, theta)
    return False

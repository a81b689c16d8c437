"""Contact laws of few contacts to round-off: sweeps find which act, a direct solution on these does the rest."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import JointedProblem
from ..model.parameters.joints import COLUMN_CONTACTS, COLUMN_ROUNDS, COLUMN_SWEEPS, COLUMN_SWEEPS_AFTER
from ..rows.conjugate import iterate
from ..rows.dense import newton
from ..rows.inplace import copy
from ..rows.sweeps import push, sweep


@kernel
def solve_columns(problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float, most: int) -> float:
    """Impulses L (m contacts, then the bounded rows) and velocities V by sweeps, at most `most`, and for few contacts
    by direct solutions between them.

    Where direct solutions stop to help, or come back to where they were, sweeps go on from the best of them.
    Returns the last sweep's largest change of a contact's velocity.
    """
    if problem.m > COLUMN_CONTACTS:
        return iterate(problem, L, V, tolerance, most)[1]
    worst = iterate(problem, L, V, tolerance, COLUMN_SWEEPS)[1]
    best, L0, V0 = worst, L.copy(), V.copy()
    last, before_last = np.inf, np.inf
    for turn in range(COLUMN_ROUNDS):
        if worst <= tolerance:
            return worst
        FREE = V.copy()
        push(problem, L, -1.0, FREE)
        newton(problem, L, V, FREE, 2, 0.1 * tolerance, turn % 2 == 1)
        worst, done = np.inf, 0
        while done < COLUMN_SWEEPS_AFTER and worst > tolerance:
            worst = sweep(problem, L, V)
            done += 1
        if worst < best:
            best = worst
            copy(L0, L)
            copy(V0, V)
        elif not worst < 100.0 * best:
            break
        if abs(worst - before_last) <= 0.5 * worst:
            break
        last, before_last = worst, last
    if worst > tolerance:
        copy(L, L0)
        copy(V, V0)
        worst = iterate(problem, L, V, tolerance, most)[1]
    return worst

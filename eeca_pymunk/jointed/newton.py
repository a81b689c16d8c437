"""Contact laws of few contacts to round-off: sweeps find which act, a direct solution on these does the rest."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import JointedProblem
from ..model.parameters.impulses import PATH_CHANGES, PATH_CHANGES_ANEW
from ..model.parameters.joints import (
    COLUMN_CONTACTS,
    COLUMN_ROUNDS,
    COLUMN_SWEEPS_AFTER,
)
from ..rows.conjugate import iterate
from ..rows.inplace import copy
from ..rows.path import follow_path
from ..rows.sweeps import push, sweep, velocities


@kernel
def solve_columns(
    problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float, sweeps: int, most: int
) -> float:
    """Impulses L (m contacts, then the bounded rows) and velocities V by sweeps, at most `most`, and for few contacts
    by direct solutions between them.

    Where direct solutions stop to help, or come back to where they were, sweeps go on from the best of them.
    Returns the last sweep's largest change of a contact's velocity.
    """
    if problem.m > COLUMN_CONTACTS:
        return iterate(problem, L, V, tolerance, most)[1]
    worst = iterate(problem, L, V, tolerance, sweeps)[1]
    best, L0, V0, before = worst, L.copy(), V.copy(), np.inf
    for _ in range(COLUMN_ROUNDS):
        if worst <= tolerance:
            return worst
        FREE = V.copy()
        push(problem, L, -1.0, FREE)
        if not follow_path(problem, L, V, FREE, PATH_CHANGES * len(L)):
            for i in range(len(L)):
                L[i, 0] = L[i, 1] = 0.0
            velocities(problem, L, FREE, V)
            if not follow_path(problem, L, V, FREE, PATH_CHANGES_ANEW * len(L)):
                break
        worst, done = np.inf, 0
        while done < COLUMN_SWEEPS_AFTER and worst > tolerance:
            worst = sweep(problem, L, V)
            done += 1
        if worst < best:
            best = worst
            copy(L0, L)
            copy(V0, V)
        if not worst <= 0.5 * before:
            break
        before = worst
    if worst > tolerance:
        copy(L, L0)
        copy(V, V0)
        worst = iterate(problem, L, V, tolerance, most)[1]
    return worst

"""Contact laws of few contacts to round-off: sweeps find which act, a direct solution on these does the rest."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import JointedProblem
from ..model.parameters.joints import (
    ACTIVATIONS,
    COLUMN_CONTACTS,
    COLUMN_ROUNDS,
    COLUMN_SWEEPS,
    COLUMN_SWEEPS_AFTER,
    SOME_CONTACTS,
)
from ..rows.columns import lawful
from ..rows.conjugate import iterate
from ..rows.dense import newton
from ..rows.inplace import copy
from ..rows.sweeps import push, sweep, velocities


@kernel
def activate(problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float) -> float:
    """Impulses L (m, 2) and velocities V from no impulses on: the contact farthest from its law takes what that asks
    for, which says whether it is open, sticks or slips; a direct solution on all that act follows, and the next one.
    Ends where none is off by more than the tolerance; returns by how much the farthest one is."""
    ROWS, C, m = problem.ROWS, problem.C, problem.m
    FREE = V.copy()
    push(problem, L, -1.0, FREE)
    for i in range(m):
        L[i, 0] = L[i, 1] = 0.0
    velocities(problem, L, FREE, V)
    farthest = np.inf
    for _ in range(ACTIVATIONS * m):
        farthest, at, normal, tangential = 0.0, -1, 0.0, 0.0
        for i in range(m):
            if C.OUT[i] != 0:
                continue
            lam, beta = lawful(problem, L, V, i)
            off = max(abs(lam - L[i, 0]) * ROWS[i].a_nn, abs(beta - L[i, 1]) * ROWS[i].a_tt)
            if not off <= farthest:
                farthest, at, normal, tangential = off, i, lam, beta
        if farthest <= tolerance:
            break
        L[at, 0], L[at, 1] = normal, tangential
        newton(problem, L, V, FREE, 2, 0.1 * tolerance, False)
    return farthest


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
    if worst > tolerance and problem.m <= SOME_CONTACTS and problem.D.USED[0] == 0:
        worst = activate(problem, L, V, tolerance)
    if worst > tolerance:
        copy(L, L0)
        copy(V, V0)
        worst = iterate(problem, L, V, tolerance, most)[1]
    return worst

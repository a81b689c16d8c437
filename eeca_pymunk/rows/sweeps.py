"""Projected Gauss-Seidel sweeps over contact rows: each contact in turn solves its law (`coulomb.py`) with the impulses
of the others fixed; with inverse masses, or the response of jointed components (`columns.py`)."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import Choice, nonallocating
from ..model.contacts import AnyProblem, Problem
from .build import push_contact
from .columns import push_jointed, sweep_jointed
from .coulomb import activate, lawful
from .inplace import copy


@nonallocating
def sweep_unjointed(problem: Problem, L: FloatArray, V: FloatArray) -> float:
    """One sweep over the contacts; updates L and V, and returns the largest change of a contact's velocity."""
    ROWS, IM, II, _, _, m = problem
    worst = 0.0
    for i in range(m):
        if ROWS[i].activation < np.inf:
            activate(ROWS, m, i, V, L)
        lam, beta, _ = lawful(ROWS[i], V, L[i, 0], L[i, 1], False)
        dn, dt = lam - L[i, 0], beta - L[i, 1]
        if dn == 0.0 and dt == 0.0:
            continue
        L[i, 0], L[i, 1] = lam, beta
        push_contact(ROWS[i], IM, II, dn, dt, V)
        worst = max(worst, abs(dn) * ROWS[i].a_nn, abs(dt) * ROWS[i].a_tt)
    return worst


@nonallocating
def push_unjointed(problem: Problem, L: FloatArray, factor: float, V: FloatArray) -> None:
    """Add factor M^-1 (G^T lam + T^T beta) to V (k, 3)."""
    ROWS, IM, II, _, _, m = problem
    for i in range(m):
        lam = factor * L[i, 0]
        beta = factor * L[i, 1]
        if lam != 0.0 or beta != 0.0:
            push_contact(ROWS[i], IM, II, lam, beta, V)


sweep = Choice(sweep_unjointed, sweep_jointed)
push = Choice(push_unjointed, push_jointed)


@nonallocating
def velocities(problem: AnyProblem, L: FloatArray, FREE: FloatArray, V: FloatArray) -> None:
    """Set V (k, 3) = FREE + W (G^T lam + T^T beta), with the response W of the problem: inverse masses, or columns."""
    copy(V, FREE)
    push(problem, L, 1.0, V)


@nonallocating
def restore_impulses(L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray) -> None:
    """Set impulses L and velocities V to L0 and V0."""
    copy(L, L0)
    copy(V, V0)

"""Redundant contacts: impulses that go from one contact to others and change no velocity.

Where rows of contacts depend on each other, sweeps may come to change the impulses by the same D each time, and the
velocities not at all: every sweep leaves the same residual, until an impulse has come to 0 or to its limit of friction,
after s = |L| / |D| sweeps. These are taken at once, and a direct solve with the contacts that are left is exact.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import AnyProblem
from ..model.parameters.impulses import DRIFT_SLIPS, DRIFT_STEADY
from .sweeps import restore_impulses, sweep, velocities


@nonallocating
def sweeps_left(problem: AnyProblem, L: FloatArray, L0: FloatArray) -> float:
    """How many times D = L - L0 can be added to L (m, 2) until a contact opens, or one that sticks begins to slip;
    infinite if none does."""
    ROWS, left = problem.ROWS, math.inf
    for i in range(problem.m):
        lam, more, mu = L[i, 0], L[i, 0] - L0[i, 0], ROWS[i].friction
        if more < 0.0:
            left = min(left, -lam / more)
        for side in range(2 if mu > 0.0 else 0):
            sign = 1.0 - 2.0 * side
            room, change = mu * lam - sign * L[i, 1], mu * more - sign * (L[i, 1] - L0[i, 1])
            if change < 0.0 and room > DRIFT_SLIPS * mu * lam:
                left = min(left, -room / change)
    return left


@kernel
def skip_drift(problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, worst: float) -> float:
    """One sweep; if its residual is about that of the sweep before, `worst`, then s (`sweeps_left`) times its change D
    and another sweep, undone if that has a larger residual: D then was no drift. Returns the change of velocity in the
    last sweep."""
    L0 = L.copy()
    now = sweep(problem, L, V)
    if abs(now - worst) > DRIFT_STEADY * worst:
        return now
    left = sweeps_left(problem, L, L0)
    if not 1.0 < left < math.inf:
        return now
    L1, V1 = L.copy(), V.copy()
    for i in range(problem.m):
        L[i, 0] = max(L[i, 0] + left * (L[i, 0] - L0[i, 0]), 0.0)
        L[i, 1] += left * (L[i, 1] - L0[i, 1])
    velocities(problem, L, FREE, V)
    after = sweep(problem, L, V)
    if after > now:
        restore_impulses(L, V, L1, V1)
        return now
    return after

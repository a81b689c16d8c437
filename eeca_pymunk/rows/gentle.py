"""Impulses of contacts whose problem has no solution, or only one of excessive impulses: those without friction, else
a few sweeps from none.

Where rows contradict one another (a body jammed between walls), or friction alone holds (a body wedged in a corner),
impulses grow without bound, and with them the work of moving walls and its round-off. Sweeps from no impulses decrease
(1/2) lam.A lam + lam.(u - b): a few of them give bounded impulses, between none and a solution.
"""

from __future__ import annotations

from math import inf

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import AnyProblem, Problem, Solved
from ..model.parameters.joints import COLUMN_SWEEPS_AFTER, EXCESSIVE_IMPULSE, GENTLE_SWEEPS
from .columns import as_columns
from .inplace import copy
from .laws import solve_wedged
from .sweeps import sweep, velocities


@nonallocating
def excessive(L: FloatArray, m: int, IM: FloatArray, n: int, speed: float) -> bool:
    """Whether an impulse of L of m contacts is not finite, or exceeds EXCESSIVE_IMPULSE times the mass of the n bodies
    times `speed`, the largest of theirs. IM (n,): inverse masses."""
    mass = 0.0
    for q in range(n):
        mass += 1.0 / IM[q]
    for i in range(m):
        if not abs(L[i, 0]) + abs(L[i, 1]) <= EXCESSIVE_IMPULSE * mass * speed:
            return True
    return False


@nonallocating
def sweep_gently(problem: AnyProblem, L: FloatArray, V: FloatArray) -> float:
    """GENTLE_SWEEPS sweeps from impulses L, which are 0 for contacts, with velocities V (k, 3) under them.
    Returns the largest change of a contact's velocity in the last sweep."""
    worst = 0.0
    for _ in range(GENTLE_SWEEPS):
        worst = sweep(problem, L, V)
    return worst


@kernel
def unwedge(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, tolerance: float, speed: float, out: Solved
) -> float:
    """Set impulses L (m, 2) and velocities V (k, 3) of wedged contacts: those without friction, which their rows lose;
    or of `sweep_gently`, if these are `excessive` too. FREE (k, 3): velocities without impulses. Returns the residual,
    a velocity."""
    L[:] = 0.0
    copy(V, FREE)
    columns = as_columns(problem)
    worst = solve_wedged(columns, L, V, tolerance, COLUMN_SWEEPS_AFTER, inf)
    out.operations += columns.C.WORK[0]
    if excessive(L, problem.m, problem.IM, problem.n, speed):
        L[:] = 0.0
        copy(V, FREE)
        worst = sweep_gently(problem, L, V)
    velocities(problem, L, FREE, V)
    return worst

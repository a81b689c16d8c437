"""Impulses where there is no solution, or one that makes no sense: they gain nothing however far they are from solved.

Rows that contradict one another (what is jammed between walls), or that friction alone holds (what is wedged in a
corner), let impulses grow without bound; the work of what they lean on, and its round-off, are then without bound too.
Sweeps from no impulses are descents of (1/2) lam.A lam + lam.(u - b), so that what is left of them is between nothing
and the solution.
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
    """Whether the impulses L of m contacts are beyond all that n bodies of such a speed need: larger by
    EXCESSIVE_IMPULSE than their momenta; not finite ones are, too. IM (n,): inverse masses."""
    mass = 0.0
    for q in range(n):
        mass += 1.0 / IM[q]
    for i in range(m):
        if not abs(L[i, 0]) + abs(L[i, 1]) <= EXCESSIVE_IMPULSE * mass * speed:
            return True
    return False


@nonallocating
def sweep_gently(problem: AnyProblem, L: FloatArray, V: FloatArray) -> float:
    """Impulses L by GENTLE_SWEEPS sweeps from those given, which are none of contacts; V (k, 3) are the velocities
    under them. Returns the largest change of a contact's velocity in the last sweep."""
    worst = 0.0
    for _ in range(GENTLE_SWEEPS):
        worst = sweep(problem, L, V)
    return worst


@kernel
def unwedge(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, tolerance: float, speed: float, out: Solved
) -> float:
    """Impulses L (m, 2) and velocities V (k, 3) of contacts that are wedged: without friction, which their rows lose;
    or gentle ones, if these are excessive for such a speed, too. FREE (k, 3): velocities without impulses. Returns how
    far from solved they are (velocity)."""
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

"""Displacements along normals that lift bodies out of each other: D = W G^T mu with 0 <= mu _|_ g + G D >= 0.

What they cost, and which part of them a budget pays, is that of the correction (`..contacts.correction`,
`..jointed.correction`).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import Choice, inlined, kernel, nonallocating
from ..model.contacts import AnyProblem, JointedProblem, Problem
from ..model.parameters.intervals import WALL_SWEEPS
from .build import normal_rate, push_contact
from .columns import push_column


@inlined
def push_normal_unjointed(problem: Problem, i: int, d: float, D: FloatArray) -> None:
    """Add M^-1 G^T of a change d of mu of contact i to D (k, 3)."""
    push_contact(problem.ROWS[i], problem.IM, problem.II, d, 0.0, D)


@inlined
def push_normal_jointed(problem: JointedProblem, i: int, d: float, D: FloatArray) -> None:
    """Add the normal column of contact i times a change d of its mu to D (k, 3)."""
    push_column(problem.C, i, d, 0.0, D)


push_normal = Choice(push_normal_unjointed, push_normal_jointed)


@inlined
def meet_gap(problem: AnyProblem, GAP: float, MU: FloatArray, D: FloatArray, i: int) -> float:
    """Solve 0 <= mu _|_ g + G D >= 0 of contact i, with g = GAP, for its mu, with the others fixed; updates D. Returns
    the change of its gap."""
    g = GAP + normal_rate(problem.ROWS[i], D)
    if g >= 0.0 and MU[i] == 0.0:
        return 0.0
    k = problem.ROWS[i].k_n
    mu = max(MU[i] - k * g, 0.0)
    d = mu - MU[i]
    MU[i] = mu
    push_normal(problem, i, d, D)
    return float(abs(d) / k)


@kernel
def keep_walls(problem: AnyProblem, n: int, GAPS: FloatArray, LEAST: FloatArray, MU: FloatArray, D: FloatArray) -> None:
    """After a solve that has not converged: raise gaps of contacts with bodies without mobility, those from n on, to at
    least LEAST (m,). GAPS (m,) are those without displacements; infinite ones are left out. In sweeps, as what lifts
    one end of a face may lower the other."""
    for _ in range(WALL_SWEEPS):
        met = True
        for i in range(problem.m):
            if max(problem.ROWS[i].a, problem.ROWS[i].b) >= n:
                if GAPS[i] + normal_rate(problem.ROWS[i], D) < LEAST[i]:
                    met = meet_gap(problem, GAPS[i] - LEAST[i], MU, D, i) == 0.0 and met
        if met:
            break


@kernel
def lift_above_walls(
    problem: AnyProblem, n: int, GAPS: FloatArray, D: FloatArray, tolerance: float, most: int
) -> FloatArray:
    """`lift` from mu = 0 (m,), which is returned; if that does not converge, no overlap with bodies without mobility
    becomes deeper (`keep_walls`)."""
    MU = np.zeros(problem.m)
    if lift(problem, GAPS, MU, D, tolerance, most) > tolerance:
        keep_walls(problem, n, GAPS, np.minimum(GAPS, 0.0), MU, D)
    return MU


@nonallocating
def lift(problem: AnyProblem, GAPS: FloatArray, MU: FloatArray, D: FloatArray, tolerance: float, most: int) -> float:
    """Solve for the displacements D, by at most `most` sweeps; returns the largest change of a gap in the last one.

    Args:
        GAPS: (m,) length.  MU: (m,) in and out, mass times length.  D: (k, 3) in and out, length and rad.
        tolerance: change of a gap in a sweep at which the solve ends: length.
    """
    worst = 0.0
    for _ in range(most):
        worst = 0.0
        for i in range(problem.m):
            worst = max(worst, meet_gap(problem, GAPS[i], MU, D, i))
        if worst <= tolerance:
            break
    return worst

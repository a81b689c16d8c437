"""Midstep: psi2 = 0, every impulse at the middle of the step (design section 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..energy import balance
from ..energy.complementarity import solve
from .locked import TOLERANCE, locked_motion, restitution
from .simultaneous import Problem, Simultaneous, Solution

_DRAFT = 1e-2  # relative tolerance that suffices to see which contacts close


@dataclass(frozen=True)
class Midstep(Simultaneous):
    """The rigid limit K, xi -> infinity: psi2 = 0, impulses at the middle of the step (design sections 2, 4).

    Solves 0 <= lam _|_ A lam + (e u_n + u*) >= 0 on all active contacts at once, Newton's restitution. Second order
    in free flight, first order at impacts. psi1 is reported as infinite, its limit.

    Args:
        tolerance: of the complementarity problem, relative to the largest approach speed. The energy lock makes
            energy exact whatever it is.
        max_iterations: of the complementarity problem.
    """

    tolerance: float = TOLERANCE
    max_iterations: int = 2000

    def solve(self, problem: Problem) -> Solution:
        zero = np.zeros_like(problem.gap)
        geometry = problem.geometry_at(0.5 * problem.dt)
        A = problem.operator(geometry)
        q = restitution(A, problem)
        tolerance = max(self.tolerance, _DRAFT) if problem.draft else self.tolerance
        impulses = solve(A, q, start=problem.guess, tolerance=tolerance, max_iterations=self.max_iterations)
        weights = balance.Weights(np.full_like(zero, math.inf), zero, zero)
        draft = problem.draft and not impulses.exact
        return locked_motion(
            A, geometry, problem, impulses.lam, weights, impulses.iterations, impulses.converged, q, draft
        )

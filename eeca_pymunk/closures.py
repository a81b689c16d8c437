"""The simultaneous closures Midstep and Dashpot: psi2 from a limit or from a law of the contact (design section 4).

Each solves the contacts of a step for the impulses and the motion; what it returns is exactly conservative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from . import balance
from .bodies import FloatArray
from .complementarity import solve
from .delassus import Delassus
from .geometry import Geometry
from .graph import islands
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

    tolerance: float = 1e-6
    max_iterations: int = 2000

    def solve(self, problem: Problem) -> Solution:
        zero = np.zeros_like(problem.gap)
        geometry = problem.geometry_at(0.5 * problem.dt)
        A = problem.operator(geometry)
        q = _restitution(A, problem)
        tolerance = max(self.tolerance, _DRAFT) if problem.draft else self.tolerance
        impulses = solve(A, q, start=problem.guess, tolerance=tolerance, max_iterations=self.max_iterations)
        weights = balance.Weights(np.full_like(zero, math.inf), zero, zero)
        draft = problem.draft and not impulses.exact
        return _locked_motion(
            A, geometry, problem, impulses.lam, weights, impulses.iterations, impulses.converged, q, draft
        )


@dataclass(frozen=True)
class Dashpot(Simultaneous):
    """The paper's closure: psi1 + psi2 = 4 xi / Omega (Eqs. 28-30), an enhanced penalty of spring and dashpot.

    A fixed point over complementarity problems (design section 4): impulses give psi2, Delta g and the normals at the
    kinks, these give the next problem. Islands in which no positive lock exists fall back to the rigid limit.

    Args:
        stiffness: K > 0, mass/time².
        damping_ratio: xi >= 0.
        tolerance: of the change of the impulses between iterations, relative to the largest, and of psi2.
        max_iterations: of the fixed point; `StepReport.converged` tells whether they sufficed.
    """

    stiffness: float
    damping_ratio: float
    tolerance: float = 1e-8
    max_iterations: int = 25

    def __post_init__(self) -> None:
        check_stiffness(self.stiffness)
        if not (self.damping_ratio >= 0 and math.isfinite(self.damping_ratio)):
            raise ValueError(f"damping_ratio = {self.damping_ratio}: give a finite number >= 0")

    def solve(self, problem: Problem) -> Solution:
        dt, K = problem.dt, self.stiffness
        S = balance.dashpot_sum(self.damping_ratio, balance.reduced_frequency(K, problem.larger_mass, dt))
        psi2, increment, lam = np.zeros_like(S), np.zeros_like(S), problem.guess
        geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
        A = problem.operator(geometry)
        converged, iteration = False, 0
        while not converged and iteration < self.max_iterations:
            iteration += 1
            p_c = balance.extra_momentum(A, psi2, problem.external + A.impulse(lam))
            q = _restitution(A, problem) + 2.0 * (A.relative(p_c * A.inverse_mass[:, None]) - increment / dt)
            impulses = solve(A, q, start=lam, tolerance=0.1 * self.tolerance, max_iterations=300)
            delta_p = problem.external + A.impulse(impulses.lam)
            w = balance.projected_product(A, delta_p, delta_p)
            new = balance.weights(impulses.lam, problem.gap, w, S, K, dt)
            change = np.max(np.abs(impulses.lam - lam))
            converged = bool(
                impulses.converged
                and change <= self.tolerance * np.max(impulses.lam)
                and np.max(np.abs(new.psi2 - psi2)) <= self.tolerance
            )
            lam, psi2, increment = impulses.lam, new.psi2, new.gap_increment
            # The motion takes these psi2 too: the kink it makes in a path lies where its normal was taken.
            geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
            A = problem.operator(geometry)
        weights = balance.Weights(S - psi2, psi2, increment)
        return _locked_motion(A, geometry, problem, lam, weights, iteration, converged)


def check_stiffness(stiffness: float) -> None:
    """Raise ValueError unless the penalty stiffness K is positive and finite."""
    if not (stiffness > 0 and math.isfinite(stiffness)):
        raise ValueError(f"stiffness = {stiffness}: give a finite number > 0, in mass/time²")


def _restitution(A: Delassus, problem: Problem) -> FloatArray:
    """(m,) e u_n + u*, u* with the external forces alone."""
    u_n = A.relative(problem.velocity)
    u_free = u_n + problem.dt * A.relative(problem.acceleration)
    return balance.restitution_target(u_n, problem.elasticity) + u_free


def _locked_motion(
    A: Delassus,
    geometry: Geometry,
    problem: Problem,
    lam: FloatArray,
    weights: balance.Weights,
    iterations: int,
    converged: bool,
    q: FloatArray | None = None,
    draft: bool = False,
) -> Solution:
    """Scale the impulses by the energy lock, and move: Eq. 10 with v_np1 and p_c of the scaled impulses.

    `q` (m,) is e u_n + u* of the rigid limit, computed if None.
    """
    dt, psi1, psi2, increment = problem.dt, weights.psi1, weights.psi2, weights.gap_increment
    q = _restitution(A, problem) if q is None else q
    # Impulses that meet their tolerance need no lock of their own for each island: it would be 1 in all of them.
    island = None if converged else islands(problem.row_a, problem.row_b, problem.inverse_mass)
    lock = balance.energy_lock(A, island, lam, q, psi2, problem.external)
    failed = ~lock.valid & (lam > 0)
    if failed.any() and psi2.any():
        psi1, psi2 = np.where(failed, math.inf, psi1), np.where(failed, 0.0, psi2)
        increment, converged = np.where(failed, 0.0, increment), False
        geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
        A = problem.operator(geometry)
        q = _restitution(A, problem)
        lam = np.where(failed, solve(A, q, tolerance=Midstep.tolerance).lam, lam)
        lock = balance.energy_lock(A, island, lam, q, psi2, problem.external)
    # In the rigid limit no impulse at all conserves energy too.
    scale = np.where(lam > 0, np.where(lock.valid, lock.scale, 0.0), 1.0)
    worst = float(scale[np.argmax(np.abs(scale - 1.0))])
    lam = scale * lam
    m_inv = A.inverse_mass[:, None]
    delta_p = problem.external + A.impulse(lam)
    velocity = problem.velocity + delta_p * m_inv
    displacement = (0.5 * dt) * (problem.velocity + velocity)
    displacement += dt * balance.extra_momentum(A, psi2, delta_p) * m_inv
    return Solution(
        velocity, displacement, lam, psi1, psi2, increment, balance.impulse_time(psi2, dt), geometry,
        iterations, worst, converged, draft,
    )  # fmt: skip

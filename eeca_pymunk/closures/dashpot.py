"""Dashpot: psi2 from a spring with a dashpot, the paper's closure; the energy lock makes its energy exact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import check_count, check_finite
from ..arrays import FloatArray
from ..energy import balance
from ..energy.complementarity import solve
from ..energy.delassus import Delassus, islands
from .motion import Disks, Geometry
from .simultaneous import ActiveContacts, Solution, move_disks

if TYPE_CHECKING:
    from ..space.world import World

RIGID_TOLERANCE = 1e-6  # of the rigid limit's complementarity problem, relative to the largest approach speed


@dataclass(frozen=True)
class Dashpot:
    """The paper's closure: psi1 + psi2 = 4 xi / Omega (Eqs. 28-30), an enhanced penalty of spring and dashpot.

    A fixed-point iteration over complementarity problems: impulses give psi2, Delta g and the normals at the instants
    of the impulses; these give the next problem. Islands without a positive lock use the rigid limit.

    Args:
        stiffness: K > 0, mass/time².
        damping_ratio: xi >= 0.
        tolerance: of the change of the impulses between iterations, relative to the largest, and of psi2; > 0.
        max_iterations: of the fixed point, >= 1; `StepReport.converged` is False if they do not suffice.
    """

    stiffness: float
    damping_ratio: float
    tolerance: float = 1e-8
    max_iterations: int = 25

    def __post_init__(self) -> None:
        check_stiffness(self.stiffness)
        check_finite("damping_ratio", self.damping_ratio, zero=True)
        check_finite("tolerance", self.tolerance)
        check_count("max_iterations", self.max_iterations, 1)

    def prepare(self, world: World) -> Disks:
        """The disks of a world of single disks and static shapes, which was just read."""
        return Disks(world, type(self).__name__, partial(move_disks, self.solve))

    def solve(self, problem: ActiveContacts) -> Solution:
        """The impulses of the fixed point, scaled by the energy lock, and the motion of the bodies."""
        dt, K = problem.dt, self.stiffness
        S = balance.dashpot_sum(self.damping_ratio, balance.reduced_frequency(K, problem.larger_mass, dt))
        psi2, increment, lam = np.zeros_like(S), np.zeros_like(S), problem.guess
        geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
        A = problem.operator(geometry)
        converged, iteration = False, 0
        while not converged and iteration < self.max_iterations:
            iteration += 1
            p_c = balance.extra_momentum(A, psi2, problem.external + A.impulse(lam))
            q = constant_term(A, problem) + 2.0 * (A.relative(p_c * A.inverse_mass[:, None]) - increment / dt)
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
            # The normals are those at the instants of the final psi2, at which the motion changes its paths.
            geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
            A = problem.operator(geometry)
        weights = balance.Weights(S - psi2, psi2, increment)
        return locked_motion(A, geometry, problem, lam, weights, iteration, converged)


def constant_term(A: Delassus, problem: ActiveContacts) -> FloatArray:
    """(m,) q = -b + u*, the constant term of the rigid limit: u* = u_n + dt a_n, with external forces only; -b of
    docs/method.md, section 3, is e u_n where the contact approaches, u_n where it opens: no impulse adds energy."""
    u_n = A.relative(problem.velocity)
    u_free = u_n + problem.dt * A.relative(problem.acceleration)
    return np.where(u_n < 0, problem.elasticity, 1.0) * u_n + u_free


def locked_motion(
    A: Delassus, geometry: Geometry, problem: ActiveContacts, lam: FloatArray, weights: balance.Weights,
    iterations: int, converged: bool,
) -> Solution:  # fmt: skip
    """Scale the impulses by the energy lock, and move: Eq. 10 with v_np1 and p_c of the scaled impulses."""
    dt, psi1, psi2, increment = problem.dt, weights.psi1, weights.psi2, weights.gap_increment
    q = constant_term(A, problem)
    # Converged impulses get one common scale, which is 1 up to the tolerance.
    island = None if converged else islands(problem.row_a, problem.row_b, problem.inverse_mass)
    lock = balance.energy_lock(A, island, lam, q, psi2, problem.external)
    failed = ~lock.valid & (lam > 0)
    if failed.any() and psi2.any():
        # The rigid limit: psi1 infinite, psi2 = 0.
        psi1, psi2 = np.where(failed, math.inf, psi1), np.where(failed, 0.0, psi2)
        increment, converged = np.where(failed, 0.0, increment), False
        geometry = problem.geometry_at(balance.impulse_time(psi2, dt))
        A = problem.operator(geometry)
        q = constant_term(A, problem)
        lam = np.where(failed, solve(A, q, tolerance=RIGID_TOLERANCE).lam, lam)
        lock = balance.energy_lock(A, island, lam, q, psi2, problem.external)
    # In the rigid limit the scale 0, no impulse, conserves energy as well; it is used where there is no positive one.
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
        iterations, worst, converged,
    )  # fmt: skip


def check_stiffness(stiffness: float) -> None:
    """Raise ValueError unless the penalty stiffness K is positive and finite."""
    check_finite("stiffness", stiffness, unit="mass/time²")

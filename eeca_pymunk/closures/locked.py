"""Newton's restitution, and the motion with impulses scaled by the energy lock: exact energy for any impulses."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..energy import balance
from ..energy.complementarity import solve
from ..energy.delassus import Delassus
from ..energy.graph import islands
from .motion import Geometry
from .simultaneous import ActiveContacts, Solution

TOLERANCE = 1e-6  # of the rigid limit's complementarity problem, relative to the largest approach speed


def restitution(A: Delassus, problem: ActiveContacts) -> FloatArray:
    """(m,) q = -b + u*, the constant term of the rigid limit: u* = u_n + dt a_n, with external forces only; -b of
    docs/method.md, section 3, is e u_n where the contact approaches, u_n where it opens: no impulse adds energy."""
    u_n = A.relative(problem.velocity)
    u_free = u_n + problem.dt * A.relative(problem.acceleration)
    return np.where(u_n < 0, problem.elasticity, 1.0) * u_n + u_free


def locked_motion(
    A: Delassus,
    geometry: Geometry,
    problem: ActiveContacts,
    lam: FloatArray,
    weights: balance.Weights,
    iterations: int,
    converged: bool,
) -> Solution:
    """Scale the impulses by the energy lock, and move: Eq. 10 with v_np1 and p_c of the scaled impulses."""
    dt, psi1, psi2, increment = problem.dt, weights.psi1, weights.psi2, weights.gap_increment
    q = restitution(A, problem)
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
        q = restitution(A, problem)
        lam = np.where(failed, solve(A, q, tolerance=TOLERANCE).lam, lam)
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

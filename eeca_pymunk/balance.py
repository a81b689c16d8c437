"""The EECA equations as pure array kernels (paper Eqs. 10-12, 20, 28-32; design sections 2, 4, 5).

Per contact, with n from a to b, impulse lam >= 0 on b, and Delta the increment over the step:

    Delta q / dt = M^-1 (p_1/2 + p_c),  p_c = sum_c 1/2 psi2 n n^T Delta p        Eqs. 10, 11
    lam / dt     = -1/2 K (g_np1 + g_n) - 1/2 psi1 K (g_np1 - g_n)                Eqs. 11, 12
    psi1 + psi2  = S = 4 xi / Omega,  Omega = dt sqrt(K / M)                      Eqs. 28, 29
    lam Delta g / dt = 1/2 psi2 w,  w = sum over a, b of (n . Delta p)^2 / m      Eq. 20
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bodies import FloatArray, IntArray
from .complementarity import Delassus


def reduced_frequency(stiffness: float, mass: FloatArray, dt: float) -> FloatArray:
    """Omega = dt sqrt(K / M) (m,), M the larger of the two contacting masses (Eq. 29)."""
    result: FloatArray = dt * np.sqrt(stiffness / mass)
    return result


def dashpot_sum(damping_ratio: float, reduced_frequency: FloatArray) -> FloatArray:
    """S = psi1 + psi2 = 4 xi / Omega (m,) (Eq. 28)."""
    return 4.0 * damping_ratio / reduced_frequency


def projected_increment(A: Delassus, delta_p: FloatArray) -> FloatArray:
    """w (m,) = (n . Delta p_a)^2 / m_a + (n . Delta p_b)^2 / m_b of Eq. 20, energy; bodies at rest add nothing."""
    along_a = np.einsum("ij,ij->i", A.normal, delta_p[A.row_a])
    along_b = np.einsum("ij,ij->i", A.normal, delta_p[A.row_b])
    result: FloatArray = along_a**2 * A.inverse_mass[A.row_a] + along_b**2 * A.inverse_mass[A.row_b]
    return result


@dataclass(frozen=True)
class Weights:
    """psi1, psi2 and the gap increment Delta g (length) of m contacts; each array is (m,)."""

    psi1: FloatArray
    psi2: FloatArray
    gap_increment: FloatArray


def weights(
    lam: FloatArray, gap: FloatArray, w: FloatArray, S: FloatArray, stiffness: float, dt: float
) -> Weights:
    """Delta g, psi2 and psi1 from the impulse: the balance (Eq. 20) and the dashpot (Eq. 28) solved together.

    Inserting psi2 = kappa Delta g with kappa = 2 lam / (dt w), and psi1 = S - psi2, into the contact force gives

        kappa Delta g^2 - (1 + S) Delta g - h = 0,     h = 2 (lam / (dt K) + min(g_n, 0)),

    whose small root is -2 h / ((1 + S) + sqrt((1 + S)^2 + 4 kappa h)). Limits: K, xi -> infinity gives Delta g = 0
    and psi2 = 0. An open contact (lam = 0) has neither force nor momentum: Delta g = psi2 = 0, psi1 = S.
    psi2 outside [-1, 1] would put the impulse outside the step (design section 3): it is clamped there.
    """
    closed = (lam > 0) & (w > 0)
    kappa = np.divide(2.0 * lam, dt * w, out=np.zeros_like(lam), where=closed)
    h = 2.0 * (lam / (dt * stiffness) + np.minimum(gap, 0.0))
    root = np.sqrt(np.maximum((1.0 + S) ** 2 + 4.0 * kappa * h, 0.0))
    increment = np.where(closed, -2.0 * h / ((1.0 + S) + root), 0.0)
    psi2 = np.clip(kappa * increment, -1.0, 1.0)
    return Weights(S - psi2, psi2, increment)


def extra_momentum(A: Delassus, psi2: FloatArray, delta_p: FloatArray) -> FloatArray:
    """p_c (R, 2) = sum over a body's contacts of 1/2 psi2 n n^T Delta p (Eq. 11)."""
    total = np.zeros_like(delta_p)
    for rows in (A.row_a, A.row_b):
        along = 0.5 * psi2 * np.einsum("ij,ij->i", A.normal, delta_p[rows])
        for axis in (0, 1):
            total[:, axis] += np.bincount(rows, along * A.normal[:, axis], len(delta_p))
    return total


def impulse_time(psi2: FloatArray, dt: float) -> FloatArray:
    """tau (m,) = dt (1 - psi2) / 2, the instant inside the step at which the impulse acts (design section 3)."""
    return 0.5 * dt * (1.0 - psi2)


def restitution_target(relative: FloatArray, elasticity: FloatArray) -> FloatArray:
    """e u_n where the contact approaches, u_n where it opens, so that no impulse can add energy (design section 2)."""
    return np.where(relative < 0, elasticity, 1.0) * relative


@dataclass(frozen=True)
class Lock:
    """The energy lock: `scale` (m,) for each contact's impulse, and `valid` (m,) where a positive scale exists."""

    scale: FloatArray
    valid: FloatArray


def energy_lock(
    A: Delassus,
    island: IntArray,
    lam: FloatArray,
    psi2: FloatArray,
    velocity: FloatArray,
    external: FloatArray,
    loss: FloatArray,
) -> Lock:
    """One scale s per island that makes the step exactly conservative whatever lam is (design section 5).

    With J = G^T lam, F = dt f_ext, P x = sum_c 1/2 psi2 n n^T x and v_np1 = v_n + M^-1 (F + s J), the work balance
    of the island, Delta E = s J . v_1/2 - F . M^-1 P (F + s J) - s `loss`, is the quadratic a s^2 + b s + c = 0 with

        a = 1/2 J . M^-1 J,   b = J . (v_n + 1/2 M^-1 F) - F . M^-1 P J - loss,   c = -F . M^-1 P F.

    Without psi2 this is s = -lam^T (e u_n + u*) / (lam^T A lam). The root nearer to 1 is taken.

    Args:
        velocity: (R, 2) v_n.  external: (R, 2) F, momentum.
        loss: (m,) energy 1/2 lam (1 - e) u_n that restitution prescribes for each contact, <= 0.
    """
    m_inv = A.inverse_mass[:, None]
    J = A.impulse(lam)
    PJ = extra_momentum(A, psi2, J)
    PF = extra_momentum(A, psi2, external)
    of_row = np.zeros(len(A.inverse_mass), np.intp)
    count = int(island.max(initial=-1)) + 1
    for rows in (A.row_a, A.row_b):
        moves = A.inverse_mass[rows] > 0
        of_row[rows[moves]] = island[moves]

    def per_island(x: FloatArray, y: FloatArray) -> FloatArray:
        terms = np.einsum("ij,ij->i", x, y)
        return np.bincount(of_row, terms, count)[:count]

    a = 0.5 * per_island(J, J * m_inv)
    b = per_island(J, (velocity + 0.5 * external * m_inv) * (m_inv > 0)) - per_island(external * m_inv, PJ)
    b -= np.bincount(island, loss, count)
    c = -per_island(external * m_inv, PF)
    scale, valid = np.ones(count), np.zeros(count, bool)
    real = (a > 0) & (b * b >= 4.0 * a * c)
    a_, b_, c_ = a[real], b[real], c[real]
    # Vieta's second root avoids the cancellation of the first.
    larger = -0.5 * (b_ + np.copysign(np.sqrt(b_ * b_ - 4.0 * a_ * c_), b_))
    r1 = larger / a_
    r2 = np.divide(c_, larger, out=np.zeros_like(c_), where=larger != 0)
    s = np.where(np.abs(r1 - 1.0) <= np.abs(r2 - 1.0), r1, r2)
    scale[real], valid[real] = s, s > 0
    return Lock(scale[island], valid[island])

"""The EECA equations as pure array functions (paper Eqs. 10-12, 20, 28-32; docs/method.md, section 1).

Per contact, with n from a to b, impulse lam >= 0 on b, Delta the increment over the step, p_1/2 the mean of the momenta
at its start and end, K the stiffness of the penalty spring and xi its damping ratio:

    Delta q / dt = M^-1 (p_1/2 + p_c),  p_c = sum_c 1/2 psi2 n n^T Delta p        Eqs. 10, 11
    lam / dt     = -1/2 K (g_np1 + g_n) - 1/2 psi1 K (g_np1 - g_n)                Eqs. 11, 12
    psi1 + psi2  = S = 4 xi / Omega,  Omega = dt sqrt(K / M)                      Eqs. 28, 29
    lam Delta g / dt = 1/2 psi2 w,  w = sum over a, b of (n . Delta p)^2 / m      Eq. 20
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .delassus import Delassus


def reduced_frequency(stiffness: float, mass: FloatArray, dt: float) -> FloatArray:
    """Omega = dt sqrt(K / M) (m,), M the larger of the two contacting masses (Eq. 29)."""
    result: FloatArray = dt * np.sqrt(stiffness / mass)
    return result


def dashpot_sum(damping_ratio: float, reduced_frequency: FloatArray) -> FloatArray:
    """S = psi1 + psi2 = 4 xi / Omega (m,) (Eq. 28)."""
    return 4.0 * damping_ratio / reduced_frequency


def projected_product(A: Delassus, x: FloatArray, y: FloatArray) -> FloatArray:
    """(m,) (n . x_a)(n . y_a) / m_a + (n . x_b)(n . y_b) / m_b of momenta x, y (R, 2); bodies at rest add nothing.

    With x = y = Delta p this is w of Eq. 20, an energy.
    """
    total = np.zeros(A.size)
    for rows in (A.row_a, A.row_b):
        along_x = np.einsum("ij,ij->i", A.normal, x[rows])
        along_y = along_x if y is x else np.einsum("ij,ij->i", A.normal, y[rows])
        total += along_x * along_y * A.inverse_mass[rows]
    return total


@dataclass(frozen=True)
class Weights:
    """psi1, psi2 and the gap increment Delta g (length) of m contacts; each array is (m,)."""

    psi1: FloatArray
    psi2: FloatArray
    gap_increment: FloatArray


def weights(lam: FloatArray, gap: FloatArray, w: FloatArray, S: FloatArray, stiffness: float, dt: float) -> Weights:
    """Delta g, psi2 and psi1 from the impulse: the balance (Eq. 20) and the dashpot (Eq. 28) solved together.

    Inserting psi2 = kappa Delta g with kappa = 2 lam / (dt w), and psi1 = S - psi2, into the contact force gives

        kappa Delta g^2 - (1 + S) Delta g - h = 0,     h = 2 (lam / (dt K) + min(g_n, 0)),

    whose small root is -2 h / ((1 + S) + sqrt((1 + S)^2 + 4 kappa h)). Limits: K, xi -> infinity gives Delta g = 0
    and psi2 = 0. An open contact (lam = 0) has neither force nor momentum: Delta g = psi2 = 0, psi1 = S.
    psi2 outside [-1, 1] would put the impulse outside the step: it is clamped. A gap g_n > 0 counts as 0, since the
    impulse acts from the contact on.

    Args:
        lam: (m,) impulses >= 0.  gap: (m,) g_n, length.  w: (m,) energy, Eq. 20.  S: (m,) psi1 + psi2.
        stiffness: K, mass/time².  dt: time.
    """
    closed = (lam > 0) & (w > 0)
    kappa = np.divide(2.0 * lam, dt * w, out=np.zeros_like(lam), where=closed)
    h = 2.0 * (lam / (dt * stiffness) + np.minimum(gap, 0.0))
    root = np.sqrt(np.maximum((1.0 + S) ** 2 + 4.0 * kappa * h, 0.0))
    free = -2.0 * h / ((1.0 + S) + root)
    psi2 = np.clip(kappa * free, -1.0, 1.0)
    # Where psi2 is clamped, Delta g follows from the energy balance and not from the dashpot.
    increment = np.where(closed, np.divide(psi2, kappa, out=free, where=np.abs(psi2) == 1.0), 0.0)
    return Weights(S - psi2, psi2, increment)


def extra_momentum(A: Delassus, psi2: FloatArray, delta_p: FloatArray) -> FloatArray:
    """p_c (R, 2) = sum over a body's contacts of 1/2 psi2 n n^T Delta p (Eq. 11)."""
    total = np.zeros_like(delta_p)
    if not psi2.any():
        return total
    for rows in (A.row_a, A.row_b):
        along = 0.5 * psi2 * np.einsum("ij,ij->i", A.normal, delta_p[rows])
        for axis in (0, 1):
            total[:, axis] += np.bincount(rows, along * A.normal[:, axis], len(delta_p))
    return total


def impulse_time(psi2: FloatArray, dt: float) -> FloatArray:
    """tau (m,) = dt (1 - psi2) / 2, the instant inside the step at which the impulse acts."""
    return 0.5 * dt * (1.0 - psi2)


@dataclass(frozen=True)
class Lock:
    """The energy lock: `scale` (m,) for each contact's impulse; `valid` (m,), whether a positive scale exists. Without
    one the caller has to use other impulses (`..closures.dashpot`)."""

    scale: FloatArray
    valid: BoolArray


def energy_lock(
    A: Delassus, island: IntArray | None, lam: FloatArray, q: FloatArray, psi2: FloatArray, external: FloatArray
) -> Lock:
    """One scale s per island that makes the energy balance exact for any lam, loss by restitution included.

    With J = G^T lam, F = dt f_ext and P x = sum_c 1/2 psi2 n n^T x, the bodies' energy changes over a step with the
    impulses s J by s J . v_1/2 - F . M^-1 P (F + s J), where v_1/2 = v_n + 1/2 M^-1 (F + s J). Setting that equal to
    the loss s 1/2 lam (1 - e) u_n of restitution gives a s^2 + b s + c = 0, a sum over the island's contacts, with

        a = 1/2 lam^T A lam,   b = 1/2 lam^T q - F . M^-1 P J,   c = -F . M^-1 P F.

    Without psi2 or without external forces this is s = -lam^T q / (lam^T A lam). Of two roots the one nearer to 1 is
    taken.

    Args:
        A: the contacts.  island: (m,) label of each contact's island, None if all are one.  lam: (m,) impulses.
        q: (m,) e u_n + u* of the rigid limit, velocity; u* = u_n + dt a_n without impulses.  psi2: (m,).
        external: (R, 2) F, momentum.
    """
    if island is None:
        island = np.zeros(len(lam), np.intp)
        a, b = np.array([0.5 * np.dot(lam, A @ lam)]), np.array([0.5 * np.dot(lam, q)])
        count = 1
    else:
        count = int(island.max(initial=-1)) + 1
        a = 0.5 * np.bincount(island, lam * (A @ lam), count)
        b = 0.5 * np.bincount(island, lam * q, count)
    scale, valid = np.ones(count), np.zeros(count, bool)
    if psi2.any() and external.any():
        b -= np.bincount(island, 0.5 * psi2 * projected_product(A, external, A.impulse(lam)), count)
        c = -np.bincount(island, 0.5 * psi2 * projected_product(A, external, external), count)
        real = (a > 0) & (b * b >= 4.0 * a * c)
        a, b, c = a[real], b[real], c[real]
        # Vieta's second root avoids the cancellation of the first.
        larger = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        r1, r2 = larger / a, np.divide(c, larger, out=np.zeros_like(c), where=larger != 0)
        scale[real] = np.where(np.abs(r1 - 1.0) <= np.abs(r2 - 1.0), r1, r2)
    else:
        real = a > 0
        scale[real] = -b[real] / a[real]
    valid[real] = scale[real] > 0
    return Lock(scale[island], valid[island])

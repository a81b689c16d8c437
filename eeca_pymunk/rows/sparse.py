"""Direct solve on the active contacts, as an augmented Lagrangian in the space of bodies, with sparse factors.

Active normals (lam > 0) are to reach u_n = b, sticking tangents u_t = 0; slipping ones follow beta = +-mu lam. With the
residual r = target - u, one pass solves (M + sum R j j^T / A_jj) dv = sum R j r / A_jj and adds R (r - j.dv) / A_jj to
the impulses: the error decreases by about R times the smallest eigenvalue of A scaled to diagonal 1. Redundant contacts
make A singular but not this matrix.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import Problem
from .active_set import clamp, classify, divide_friction
from .build import normal_rate, push_contact, slip_rate, tangent_rate
from .cholesky import assemble_blocks, factor_blocks, make_factor, solve_blocks
from .coulomb import lossless_slip
from .sweeps import velocities


@kernel
def solve_sparse(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, R: float, passes: int, tolerance: float
) -> tuple[float, int]:
    """Solve on the active contacts of L; L and V = FREE + M^-1 (G^T lam + T^T beta), which are consistent on entry, are
    replaced.

    Args:
        FREE: (k, 3) velocities without impulses.  R: stiffness of the augmentation, dimensionless, 1e2 ... 1e8.
        passes: largest number of refinements.  tolerance: residual velocity at which they end.

    Returns:
        The residual velocity before the impulses were clamped, and how many were clamped.
    """
    ROWS, IM, _, _, n, m = problem
    divide_friction(ROWS, L, m)
    active, stuck, slope, target_t = classify(ROWS, L, V, m)
    factor = make_factor(problem, active)
    SCALE, place = factor.SCALE, factor.place
    ROOTS, SPINS = SCALE[:, 0], SCALE[:, 2]
    assemble_blocks(problem, active, stuck, R, factor)
    factor_blocks(factor)
    f, F, dv, r, worst = np.empty((n, 3)), np.empty((len(IM), 3)), np.zeros((len(IM), 3)), np.zeros((m, 2)), np.inf
    for done in range(passes + 1):
        last = worst
        worst = 0.0
        F[:] = 0.0
        for i in range(m):
            if active[i] == 0:
                continue
            r[i, 0] = ROWS[i].target - normal_rate(ROWS[i], V)
            worst = max(worst, abs(r[i, 0]))
            fn = R * ROWS[i].k_n * r[i, 0]
            ft = 0.0
            if stuck[i] != 0:
                r[i, 1] = target_t[i] - tangent_rate(ROWS[i], V)
                worst = max(worst, abs(r[i, 1]))
                ft = R * ROWS[i].k_t * r[i, 1]
            push_contact(ROWS[i], ROOTS, SPINS, fn, ft, F)
        if worst <= tolerance or done == passes or worst > 0.5 * last:
            break
        for i in range(n):
            for p in range(3):
                f[place[i], p] = F[i, p]
        solve_blocks(factor, f)
        for i in range(n):
            for p in range(3):
                dv[i, p] = SCALE[i, p] * f[place[i], p]
        for i in range(m):
            if active[i] == 0:
                continue
            L[i, 0] += R * ROWS[i].k_n * (r[i, 0] - normal_rate(ROWS[i], dv))
            if stuck[i] != 0:
                L[i, 1] += R * ROWS[i].k_t * (r[i, 1] - slip_rate(ROWS[i], dv))
                if stuck[i] == 2 and L[i, 1] != 0.0:
                    target_t[i] = lossless_slip(ROWS[i], L[i, 0], L[i, 1])
            else:
                L[i, 1] = slope[i] * L[i, 0]
        velocities(problem, L, FREE, V)
    divide_friction(ROWS, L, m)
    return worst, clamp(problem, L, FREE, V)

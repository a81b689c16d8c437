"""Direct solve on the active contacts, as an augmented Lagrangian in the space of bodies.

Active normals (lam > 0) are to reach u_n = b, sticking tangents u_t = 0; slipping ones follow beta = +-mu lam. With the
residual r = target - u, one pass solves (M + sum R j j^T / A_jj) dv = sum R j r / A_jj and adds R (r - j.dv) / A_jj to
the impulses: the error decreases by about R times the smallest eigenvalue of A scaled to diagonal 1. Redundant contacts
make A singular but not this matrix. Impulses are then clamped to their cones; `segment` selects the part of the step
that is taken.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.contacts import AnyProblem, Problem, Row
from ..model.parameters.impulses import FACE_LINE, ON_CONE
from .build import normal_rate, push_contact, slip_rate, tangent_rate
from .cholesky import assemble_blocks, factor_blocks, make_factor, solve_blocks
from .coulomb import OPEN, STICK, limits_slip, lossless_slip, mode_of
from .sweeps import velocities


@nonallocating
def divide_friction(ROWS: Rows[Row], L: FloatArray, m: int) -> None:
    """Divide the friction of a face between its two points in proportion to their normal impulses: beta_k = lam_k sum
    beta / sum lam.

    Both are on one tangent line, so that no velocity depends on the division; and if the sum is inside the cone of the
    sum, each is inside its own. If one point is taken as slipping while the other sticks, the active set has no
    solution.
    """
    for i in range(m - 1):
        j = i + 1
        mu = ROWS[i].friction
        lam = L[i, 0] + L[j, 0]
        if ROWS[i].a != ROWS[j].a or ROWS[i].b != ROWS[j].b or mu <= 0.0 or mu != ROWS[j].friction or lam <= 0.0:
            continue
        if ROWS[i].nx != ROWS[j].nx or ROWS[i].ny != ROWS[j].ny or ROWS[i].surface != ROWS[j].surface:
            continue
        line = FACE_LINE * abs(ROWS[i].arm_na - ROWS[j].arm_na)
        if abs(ROWS[i].arm_ta - ROWS[j].arm_ta) > line or abs(ROWS[i].arm_tb - ROWS[j].arm_tb) > line:
            continue
        beta = L[i, 1] + L[j, 1]
        if abs(beta) <= mu * lam and beta * ROWS[i].ut <= 0.0:
            L[i, 1] = beta * (L[i, 0] / lam)
            L[j, 1] = beta * (L[j, 0] / lam)


@kernel
def classify(
    ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """held, stuck, slip and rest (m,) of contacts, by their impulses: held[i] = 1 where lam > 0; of these stuck[i] = 1
    where u_t is to be 0, 2 where it is to be rest[i], length/time, as energy limits friction (`lossless_slip`); else 0,
    and beta = slip[i] lam.
    """
    held, stuck, slip, rest = np.zeros(m, np.int64), np.zeros(m, np.int64), np.zeros(m), np.zeros(m)
    for i in range(m):
        state, sign = mode_of(ROWS[i], V, L[i, 0], L[i, 1], ON_CONE)
        held[i], slip[i] = int(state != OPEN), sign * ROWS[i].friction
        if state == STICK:
            limited = limits_slip(ROWS[i], L[i, 0], L[i, 1])
            stuck[i] = 2 if limited else 1
            rest[i] = lossless_slip(ROWS[i], L[i, 0], L[i, 1]) if limited else 0.0
    return held, stuck, slip, rest


@nonallocating
def clamp(problem: AnyProblem, L: FloatArray, FREE: FloatArray, V: FloatArray) -> int:
    """Move impulses back into their cones, with V as `velocities` has it; returns how many were outside."""
    ROWS, clamped = problem.ROWS, 0
    for i in range(problem.m):
        most = ROWS[i].friction * L[i, 0]
        if L[i, 0] < 0.0:
            L[i, 0] = L[i, 1] = 0.0
            clamped += 1
        elif abs(L[i, 1]) > most:
            # Round-off of beta = mu lam is not outside.
            if abs(L[i, 1]) > most * (1.0 + 1e-14):
                clamped += 1
            L[i, 1] = most if L[i, 1] > 0.0 else -most
    if clamped > 0:
        velocities(problem, L, FREE, V)
    return clamped


@kernel
def polish_free(
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
    held, stuck, slip, rest = classify(ROWS, L, V, m)
    factor = make_factor(problem, held)
    SCALE, place = factor.SCALE, factor.place
    ROOTS, SPINS = SCALE[:, 0], SCALE[:, 2]
    assemble_blocks(problem, held, stuck, R, factor)
    factor_blocks(factor)
    f, F, dv, r, worst = np.empty((n, 3)), np.empty((len(IM), 3)), np.zeros((len(IM), 3)), np.zeros((m, 2)), np.inf
    for done in range(passes + 1):
        last = worst
        worst = 0.0
        F[:] = 0.0
        for i in range(m):
            if held[i] == 0:
                continue
            r[i, 0] = ROWS[i].target - normal_rate(ROWS[i], V)
            worst = max(worst, abs(r[i, 0]))
            fn = R * ROWS[i].k_n * r[i, 0]
            ft = 0.0
            if stuck[i] != 0:
                r[i, 1] = rest[i] - tangent_rate(ROWS[i], V)
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
            if held[i] == 0:
                continue
            L[i, 0] += R * ROWS[i].k_n * (r[i, 0] - normal_rate(ROWS[i], dv))
            if stuck[i] != 0:
                L[i, 1] += R * ROWS[i].k_t * (r[i, 1] - slip_rate(ROWS[i], dv))
                if stuck[i] == 2 and L[i, 1] != 0.0:
                    rest[i] = lossless_slip(ROWS[i], L[i, 0], L[i, 1])
            else:
                L[i, 1] = slip[i] * L[i, 0]
        velocities(problem, L, FREE, V)
    divide_friction(ROWS, L, m)
    return worst, clamp(problem, L, FREE, V)


@nonallocating
def segment(problem: AnyProblem, L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray) -> float:
    """Go back from (L, V) towards (L0, V0) to the minimum of lam.(u_n - b) + beta.u_t - (1/2) lam^T A lam between them,
    the energy that the frictionless contact problem minimises. Returns the part of the step that remains."""
    ROWS, m = problem.ROWS, problem.m
    slope, curvature = 0.0, 0.0
    for i in range(m):
        dn = L[i, 0] - L0[i, 0]
        dt = L[i, 1] - L0[i, 1]
        if dn == 0.0 and dt == 0.0:
            continue
        un = normal_rate(ROWS[i], V0)
        ut = tangent_rate(ROWS[i], V0)
        slope += dn * (un - ROWS[i].target) + dt * ut
        curvature += dn * (normal_rate(ROWS[i], V) - un) + dt * (tangent_rate(ROWS[i], V) - ut)
    part = 0.0
    if curvature > 0.0:
        part = max(-slope / curvature, 0.0)
    if part >= 1.0:
        return 1.0
    for i in range(m):
        for j in range(2):
            L[i, j] = L0[i, j] + part * (L[i, j] - L0[i, j])
    for i in range(len(V)):
        for j in range(3):
            V[i, j] = V0[i, j] + part * (V[i, j] - V0[i, j])
    return part

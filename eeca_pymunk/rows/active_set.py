"""The active set of a direct solve: which equations of the law hold for the impulses at hand (`classify`); impulses are
clamped to their cones afterwards, and `segment` selects the part of the step that is taken.

`sparse.py` solves the equations, or `dense.py` for few contacts and jointed bodies; `direct.py` has the whole round.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.contacts import AnyProblem, Row
from ..model.parameters.impulses import FACE_LINE, ON_CONE
from .build import normal_rate, tangent_rate
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
    """active, stuck, slope and target_t (m,) of contacts, by their impulses: active[i] = 1 where lam > 0; of these
    stuck[i] = 1 where u_t is to be 0, 2 where it is to be target_t[i], length/time, as energy limits friction
    (`lossless_slip`); else stuck[i] = 0, and beta = slope[i] lam.
    """
    active, stuck, slope, target_t = np.zeros(m, np.int64), np.zeros(m, np.int64), np.zeros(m), np.zeros(m)
    for i in range(m):
        state, sign = mode_of(ROWS[i], V, L[i, 0], L[i, 1], ON_CONE)
        active[i], slope[i] = int(state != OPEN), sign * ROWS[i].friction
        if state == STICK:
            limited = limits_slip(ROWS[i], L[i, 0], L[i, 1])
            stuck[i] = 2 if limited else 1
            target_t[i] = lossless_slip(ROWS[i], L[i, 0], L[i, 1]) if limited else 0.0
    return active, stuck, slope, target_t


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

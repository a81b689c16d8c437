"""A contact row from a point, a normal and the motion of the two bodies."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .layout import (
    A_NN,
    A_NT,
    A_TT,
    ARM_NA,
    ARM_NB,
    ARM_TA,
    ARM_TB,
    ELASTICITY,
    FRICTION,
    GAP,
    K_N,
    K_T,
    NX,
    NY,
    SURFACE,
    TARGET,
    UN,
    UT,
    W_NN,
    W_NT,
    W_TT,
    WAKE,
)

SINGULAR = 1e-12  # determinant of A relative to the product of its diagonal


@uncounted
def place_row(
    A: IntArray, B: IntArray, ROWS: FloatArray, i: int, a: int, b: int, nx: float, ny: float, px: float, py: float,
    gap: float, POSE: FloatArray, IM: FloatArray, II: FloatArray, elasticity: float, friction: float, surface: float,
) -> None:  # fmt: skip
    """Write row i: contact at (px, py) with unit normal (nx, ny) from local body a to b; target 0, awake.

    Arms that are round-off of the point's coordinates (a circle about its centre of mass) become 0, so that
    frictionless impulses on disks turn nothing.
    """
    A[i] = a
    B[i] = b
    ROWS[i, NX] = nx
    ROWS[i, NY] = ny
    xa = px - POSE[a, 0]
    ya = py - POSE[a, 1]
    xb = px - POSE[b, 0]
    yb = py - POSE[b, 1]
    noise = 1e-15 * (abs(px) + abs(py))
    arm = xa * ny - ya * nx
    if abs(arm) <= 1e-15 * (abs(xa) + abs(ya)) + noise:
        arm = 0.0
    ROWS[i, ARM_NA] = arm
    arm = xb * ny - yb * nx
    if abs(arm) <= 1e-15 * (abs(xb) + abs(yb)) + noise:
        arm = 0.0
    ROWS[i, ARM_NB] = arm
    ROWS[i, ARM_TA] = xa * nx + ya * ny
    ROWS[i, ARM_TB] = xb * nx + yb * ny
    ROWS[i, GAP] = gap
    mass = IM[a] + IM[b]
    nn = mass + II[a] * ROWS[i, ARM_NA] ** 2 + II[b] * ROWS[i, ARM_NB] ** 2
    tt = mass + II[a] * ROWS[i, ARM_TA] ** 2 + II[b] * ROWS[i, ARM_TB] ** 2
    nt = II[a] * ROWS[i, ARM_NA] * ROWS[i, ARM_TA] + II[b] * ROWS[i, ARM_NB] * ROWS[i, ARM_TB]
    ROWS[i, A_NN], ROWS[i, A_NT], ROWS[i, A_TT] = nn, nt, tt
    ROWS[i, K_N] = 1.0 / nn
    ROWS[i, K_T] = 1.0 / tt
    if friction > 0.0:
        det = nn * tt - nt * nt
        regular = det > SINGULAR * nn * tt
        ROWS[i, W_NN] = tt / det if regular else np.nan
        ROWS[i, W_NT] = -nt / det if regular else 0.0
        ROWS[i, W_TT] = nn / det if regular else 0.0
    ROWS[i, ELASTICITY] = elasticity
    ROWS[i, FRICTION] = friction
    ROWS[i, SURFACE] = surface
    ROWS[i, TARGET] = 0.0
    ROWS[i, WAKE] = np.inf


@uncounted
def normal_rate(A: IntArray, B: IntArray, ROWS: FloatArray, V: FloatArray, i: int) -> float:
    """u_n of contact i at velocities V."""
    a = A[i]
    b = B[i]
    rate: float = (
        ROWS[i, NX] * (V[b, 0] - V[a, 0])
        + ROWS[i, NY] * (V[b, 1] - V[a, 1])
        + (ROWS[i, ARM_NB] * V[b, 2] - ROWS[i, ARM_NA] * V[a, 2])
    )
    return rate


@uncounted
def tangent_rate(A: IntArray, B: IntArray, ROWS: FloatArray, V: FloatArray, i: int) -> float:
    """u_t of contact i at velocities V, relative to moving surfaces."""
    a = A[i]
    b = B[i]
    rate: float = (
        ROWS[i, NX] * (V[b, 1] - V[a, 1])
        - ROWS[i, NY] * (V[b, 0] - V[a, 0])
        + (ROWS[i, ARM_TB] * V[b, 2] - ROWS[i, ARM_TA] * V[a, 2])
        + ROWS[i, SURFACE]
    )
    return rate


@uncounted
def rates(A: IntArray, B: IntArray, ROWS: FloatArray, V: FloatArray, m: int) -> None:
    """Set u_n and u_t before the impulses of all contacts from V."""
    for i in range(m):
        ROWS[i, UN] = normal_rate(A, B, ROWS, V, i)
        ROWS[i, UT] = tangent_rate(A, B, ROWS, V, i)


@uncounted
def aim(ROWS: FloatArray, m: int) -> float:
    """Targets of impacts at one instant: b = -e u_n where the contact approaches, -u_n where it opens.

    Then no impulse can add energy: lam (u_n + b) <= 0. Returns the largest b - u_n, a velocity: <= 0 if nothing hits.
    """
    worst = 0.0
    for i in range(m):
        u = ROWS[i, UN]
        ROWS[i, TARGET] = -ROWS[i, ELASTICITY] * u if u < 0.0 else -u
        worst = max(worst, ROWS[i, TARGET] - u)
    return worst


@uncounted
def conserves(ROWS: FloatArray, m: int) -> bool:
    """Whether all contacts are elastic and without friction."""
    lossy = 0
    for i in range(m):
        if ROWS[i, ELASTICITY] < 1.0 or ROWS[i, FRICTION] > 0.0:
            lossy += 1
    return lossy == 0


@uncounted
def rubs(ROWS: FloatArray, m: int) -> bool:
    """Whether any contact has friction."""
    rough = 0
    for i in range(m):
        if ROWS[i, FRICTION] > 0.0:
            rough += 1
    return rough > 0

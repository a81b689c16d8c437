"""A contact row from a point, a normal and the motion of the two bodies."""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .layout import (
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
    WAKE,
    FloatArray,
    IntArray,
)


@kernel
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
    ROWS[i, K_N] = 1.0 / (mass + II[a] * ROWS[i, ARM_NA] ** 2 + II[b] * ROWS[i, ARM_NB] ** 2)
    ROWS[i, K_T] = 1.0 / (mass + II[a] * ROWS[i, ARM_TA] ** 2 + II[b] * ROWS[i, ARM_TB] ** 2)
    ROWS[i, ELASTICITY] = elasticity
    ROWS[i, FRICTION] = friction
    ROWS[i, SURFACE] = surface
    ROWS[i, TARGET] = 0.0
    ROWS[i, WAKE] = np.inf


@kernel
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


@kernel
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


@kernel
def rates(A: IntArray, B: IntArray, ROWS: FloatArray, V: FloatArray, m: int) -> None:
    """Set u_n and u_t before the impulses of all contacts from V."""
    for i in range(m):
        ROWS[i, UN] = normal_rate(A, B, ROWS, V, i)
        ROWS[i, UT] = tangent_rate(A, B, ROWS, V, i)


@kernel
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

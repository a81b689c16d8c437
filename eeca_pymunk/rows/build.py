"""A contact row from a point, a normal and the motion of the two bodies."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.impulses import SINGULAR


@nonallocating
def place_row(
    A: IntArray, B: IntArray, ROWS: Rows[Row], i: int, px: float, py: float, POSE: FloatArray, IM: FloatArray,
    II: FloatArray,
) -> None:  # fmt: skip
    """Complete row i, whose bodies, unit normal, gap, elasticity, friction and surface velocity are set, for a contact
    at the point (px, py), with target 0, active.

    Arms that are round-off of the point's coordinates (a circle about its centre of mass) become 0, so that
    frictionless impulses exert no torque on disks.
    """
    a, b, nx, ny, friction = A[i], B[i], ROWS[i].nx, ROWS[i].ny, ROWS[i].friction
    xa = px - POSE[a, 0]
    ya = py - POSE[a, 1]
    xb = px - POSE[b, 0]
    yb = py - POSE[b, 1]
    noise = 1e-15 * (abs(px) + abs(py))
    arm = xa * ny - ya * nx
    if abs(arm) <= 1e-15 * (abs(xa) + abs(ya)) + noise:
        arm = 0.0
    ROWS[i].arm_na = arm
    arm = xb * ny - yb * nx
    if abs(arm) <= 1e-15 * (abs(xb) + abs(yb)) + noise:
        arm = 0.0
    ROWS[i].arm_nb = arm
    ROWS[i].arm_ta = xa * nx + ya * ny
    ROWS[i].arm_tb = xb * nx + yb * ny
    mass = IM[a] + IM[b]
    nn = mass + II[a] * ROWS[i].arm_na ** 2 + II[b] * ROWS[i].arm_nb ** 2
    tt = mass + II[a] * ROWS[i].arm_ta ** 2 + II[b] * ROWS[i].arm_tb ** 2
    nt = II[a] * ROWS[i].arm_na * ROWS[i].arm_ta + II[b] * ROWS[i].arm_nb * ROWS[i].arm_tb
    ROWS[i].a_nn, ROWS[i].a_nt, ROWS[i].a_tt = nn, nt, tt
    ROWS[i].k_n = 1.0 / nn
    ROWS[i].k_t = 1.0 / tt
    if friction > 0.0:
        invert(ROWS[i], nn, nt, tt)
    ROWS[i].target = 0.0
    ROWS[i].wake = np.inf


@nonallocating
def invert(row: Row, nn: float, nt: float, tt: float) -> None:
    """Set the inverse w_nn, w_nt, w_tt of the matrix of a contact, a_nn, a_nt, a_tt = nn, nt, tt; where that is
    singular w_nn is nan."""
    det = nn * tt - nt * nt
    regular = det > SINGULAR * nn * tt
    row.w_nn = tt / det if regular else np.nan
    row.w_nt = -nt / det if regular else 0.0
    row.w_tt = nn / det if regular else 0.0


@nonallocating
def normal_rate(A: IntArray, B: IntArray, ROWS: Rows[Row], V: FloatArray, i: int) -> float:
    """u_n of contact i at velocities V (k, 3)."""
    a, b = A[i], B[i]
    rate: float = (
        ROWS[i].nx * (V[b, 0] - V[a, 0])
        + ROWS[i].ny * (V[b, 1] - V[a, 1])
        + (ROWS[i].arm_nb * V[b, 2] - ROWS[i].arm_na * V[a, 2])
    )
    return rate


@nonallocating
def slip_rate(A: IntArray, B: IntArray, ROWS: Rows[Row], V: FloatArray, i: int) -> float:
    """The part of `tangent_rate` that is of the bodies."""
    a, b = A[i], B[i]
    rate: float = (
        ROWS[i].nx * (V[b, 1] - V[a, 1])
        - ROWS[i].ny * (V[b, 0] - V[a, 0])
        + (ROWS[i].arm_tb * V[b, 2] - ROWS[i].arm_ta * V[a, 2])
    )
    return rate


@nonallocating
def tangent_rate(A: IntArray, B: IntArray, ROWS: Rows[Row], V: FloatArray, i: int) -> float:
    """u_t of contact i at velocities V (k, 3), surface velocities included."""
    rate: float = slip_rate(A, B, ROWS, V, i) + ROWS[i].surface
    return rate


@inlined
def push_contact(
    A: IntArray, B: IntArray, ROWS: Rows[Row], IM: FloatArray, II: FloatArray, i: int, lam: float, beta: float,
    V: FloatArray,
) -> None:  # fmt: skip
    """Add M^-1 (G^T lam + T^T beta) of contact i to V (k, 3)."""
    a, b = A[i], B[i]
    fx = lam * ROWS[i].nx - beta * ROWS[i].ny
    fy = lam * ROWS[i].ny + beta * ROWS[i].nx
    V[a, 0] -= IM[a] * fx
    V[a, 1] -= IM[a] * fy
    V[a, 2] -= II[a] * (lam * ROWS[i].arm_na + beta * ROWS[i].arm_ta)
    V[b, 0] += IM[b] * fx
    V[b, 1] += IM[b] * fy
    V[b, 2] += II[b] * (lam * ROWS[i].arm_nb + beta * ROWS[i].arm_tb)


@nonallocating
def rates(A: IntArray, B: IntArray, ROWS: Rows[Row], V: FloatArray, m: int) -> None:
    """Set u_n and u_t before the impulses of m contacts from velocities V (k, 3)."""
    for i in range(m):
        ROWS[i].un = normal_rate(A, B, ROWS, V, i)
        ROWS[i].ut = tangent_rate(A, B, ROWS, V, i)


@nonallocating
def largest_terms(A: IntArray, B: IntArray, ROWS: Rows[Row], V: FloatArray, m: int) -> float:
    """The largest sum of magnitudes of the terms of u_n, and with friction of u_t, of m contacts at velocities V (k,
    3). Times the unit round-off it is the error of these rates, however small they are."""
    most = 0.0
    for i in range(m):
        a, b, nx, ny = A[i], B[i], abs(ROWS[i].nx), abs(ROWS[i].ny)
        x, y = abs(V[a, 0]) + abs(V[b, 0]), abs(V[a, 1]) + abs(V[b, 1])
        one, two = abs(V[a, 2]), abs(V[b, 2])
        most = max(most, nx * x + ny * y + abs(ROWS[i].arm_na) * one + abs(ROWS[i].arm_nb) * two)
        if ROWS[i].friction > 0.0:
            turned = abs(ROWS[i].arm_ta) * one + abs(ROWS[i].arm_tb) * two
            most = max(most, nx * y + ny * x + turned + abs(ROWS[i].surface))
    return most


@nonallocating
def aim(ROWS: Rows[Row], m: int) -> float:
    """Set the targets of m contacts of an impact: b = -e u_n where the contact approaches, -u_n where it opens.

    Then no impulse can add energy: lam (u_n + b) <= 0. Returns the largest b - u_n, a velocity: <= 0 if no contact
    approaches.
    """
    worst = 0.0
    for i in range(m):
        u = ROWS[i].un
        ROWS[i].target = -ROWS[i].elasticity * u if u < 0.0 else -u
        worst = max(worst, ROWS[i].target - u)
    return worst


@nonallocating
def conserves(ROWS: Rows[Row], m: int) -> bool:
    """Whether all m contacts are elastic and without friction."""
    for i in range(m):
        if ROWS[i].elasticity < 1.0 or ROWS[i].friction > 0.0:
            return False
    return True


@nonallocating
def rubs(ROWS: Rows[Row], m: int) -> bool:
    """Whether any of m contacts has friction."""
    for i in range(m):
        if ROWS[i].friction > 0.0:
            return True
    return False

"""A contact row from a point, a normal and the motion of the two bodies."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..geometry.flight import opening_rate
from ..model.contacts import Row
from ..model.parameters.impulses import ARM_ROUND_OFF, SINGULAR


@nonallocating
def place_row(row: Row, px: float, py: float, POSE: FloatArray, IM: FloatArray, II: FloatArray) -> None:
    """Complete a row, whose bodies, unit normal, gap, elasticity, friction and surface velocity are set, for a contact
    at the point (px, py), with target 0, active, where nothing turns.

    Arms that are round-off of the point's coordinates (a circle about its centre of mass) become 0, so that
    frictionless impulses exert no torque on disks.
    """
    a, b = row.a, row.b
    nx, ny, noise = row.nx, row.ny, ARM_ROUND_OFF * (abs(px) + abs(py))
    xa, ya, xb, yb = px - POSE[a, 0], py - POSE[a, 1], px - POSE[b, 0], py - POSE[b, 1]
    na, nb, ta, tb = xa * ny - ya * nx, xb * ny - yb * nx, xa * nx + ya * ny, xb * nx + yb * ny
    na = 0.0 if abs(na) <= ARM_ROUND_OFF * (abs(xa) + abs(ya)) + noise else na
    nb = 0.0 if abs(nb) <= ARM_ROUND_OFF * (abs(xb) + abs(yb)) + noise else nb
    row.arm_na, row.arm_nb, row.arm_ta, row.arm_tb = na, nb, ta, tb
    mass = IM[a] + IM[b]
    nn, tt = mass + II[a] * na**2 + II[b] * nb**2, mass + II[a] * ta**2 + II[b] * tb**2
    nt = II[a] * na * ta + II[b] * nb * tb
    row.a_nn, row.a_nt, row.a_tt = nn, nt, tt
    row.k_n, row.k_t = 1.0 / nn, 1.0 / tt
    if row.friction > 0.0:
        invert(row, nn, nt, tt)
    row.target, row.activation, row.turned, row.swung, row.unsure = 0.0, np.inf, 0.0, 0.0, 0.0


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
def normal_rate(row: Row, V: FloatArray) -> float:
    """u_n of a contact at velocities V (k, 3)."""
    a, b = (V[row.a, 0], V[row.a, 1], V[row.a, 2]), (V[row.b, 0], V[row.b, 1], V[row.b, 2])
    return float(opening_rate(row.nx, row.ny, row.arm_na, row.arm_nb, a, b))


@nonallocating
def slip_rate(row: Row, V: FloatArray) -> float:
    """The part of `tangent_rate` that is of the bodies."""
    a, b = (V[row.a, 0], V[row.a, 1], V[row.a, 2]), (V[row.b, 0], V[row.b, 1], V[row.b, 2])
    return float(opening_rate(-row.ny, row.nx, row.arm_ta, row.arm_tb, a, b))


@nonallocating
def tangent_rate(row: Row, V: FloatArray) -> float:
    """u_t of a contact at velocities V (k, 3) at the end of its interval, surface velocities included."""
    return slip_rate(row, V) + row.surface


@inlined
def push_contact(row: Row, IM: FloatArray, II: FloatArray, lam: float, beta: float, V: FloatArray) -> None:
    """Add M^-1 (G^T lam + T^T beta) of a contact to V (k, 3)."""
    a, b = row.a, row.b
    fx = lam * row.nx - beta * row.ny
    fy = lam * row.ny + beta * row.nx
    V[a, 0] -= IM[a] * fx
    V[a, 1] -= IM[a] * fy
    V[a, 2] -= II[a] * (lam * row.arm_na + beta * row.arm_ta)
    V[b, 0] += IM[b] * fx
    V[b, 1] += IM[b] * fy
    V[b, 2] += II[b] * (lam * row.arm_nb + beta * row.arm_tb)


@nonallocating
def rates(ROWS: Rows[Row], V: FloatArray, m: int) -> None:
    """Set u_n and u_t before the impulses of m contacts from velocities V (k, 3)."""
    for i in range(m):
        ROWS[i].un = normal_rate(ROWS[i], V)
        ROWS[i].ut = tangent_rate(ROWS[i], V) + 2.0 * ROWS[i].swung


@nonallocating
def largest_terms(ROWS: Rows[Row], V: FloatArray, m: int) -> float:
    """The largest sum of magnitudes of the terms of u_n, and with friction of u_t, of m contacts at velocities V (k,
    3). Times the unit round-off it is the error of these rates, however small they are."""
    most = 0.0
    for i in range(m):
        a, b, nx, ny = ROWS[i].a, ROWS[i].b, abs(ROWS[i].nx), abs(ROWS[i].ny)
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

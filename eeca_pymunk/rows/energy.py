"""Losses of contacts, the energy lock, and lifting bodies out of each other.

For any impulses the kinetic energy of an island changes, apart from forces and moving surfaces, by -sum (D_n + D_t),

    D_n = -lam (u_n- + u_n+) / 2,   D_t = -beta (u_t- + u_t+) / 2.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.contacts import Row
from .build import normal_rate, tangent_rate
from .sweeps import velocities


@uncounted
def works(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int, LOSS: FloatArray
) -> tuple[float, float]:
    """LOSS (m, 2) = D_n and D_t of each contact, energy, V being the velocities after; returns their sums.

    Where slip reverses, friction gives back a part of what restitution takes, D_n + D_t >= 0: a negative loss counts
    against the same contact's other one. Likewise for the sums, where the solve was cut short.
    """
    normal = 0.0
    tangential = 0.0
    for i in range(m):
        LOSS[i, 0] = 0.0
        LOSS[i, 1] = 0.0
        if L[i, 0] == 0.0 and L[i, 1] == 0.0:
            continue
        LOSS[i, 0] = -0.5 * L[i, 0] * (ROWS[i].un + normal_rate(A, B, ROWS, V, i))
        LOSS[i, 1] = -0.5 * L[i, 1] * (ROWS[i].ut + tangent_rate(A, B, ROWS, V, i))
        both = LOSS[i, 0] + LOSS[i, 1]
        if LOSS[i, 0] < 0.0:
            LOSS[i, 0] = min(both, 0.0)
            LOSS[i, 1] = max(both, 0.0)
        elif LOSS[i, 1] < 0.0:
            LOSS[i, 0] = both
            LOSS[i, 1] = 0.0
        normal += LOSS[i, 0]
        tangential += LOSS[i, 1]
    if normal < 0.0:
        tangential += normal
        normal = 0.0
    elif tangential < 0.0:
        normal += tangential
        tangential = 0.0
    return normal, tangential


@uncounted
def scale_of(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, FREE: FloatArray, m: int, owed: float,
    exact: bool,
) -> tuple[float, float]:  # fmt: skip
    """One scale s for all impulses, so that the island loses `owed` at least; exactly that if `exact`.

    With u* the velocities of FREE, s L loses D(s) = -s lam.(u- + u*)/2 - s^2 lam.A.lam/2 (tangents likewise). Of the
    two roots of D(s) = owed the one nearer to 1 is taken; s = 1 if nothing has to change. Without a root s loses the
    most that these impulses can.

    Returns:
        s, and the energy still owed (0 where there is a root).
    """
    p = 0.0
    q = 0.0
    for i in range(m):
        lam = L[i, 0]
        beta = L[i, 1]
        if lam == 0.0 and beta == 0.0:
            continue
        n0 = normal_rate(A, B, ROWS, FREE, i)
        t0 = tangent_rate(A, B, ROWS, FREE, i)
        p -= 0.5 * (lam * (ROWS[i].un + n0) + beta * (ROWS[i].ut + t0))
        q += 0.5 * (lam * (normal_rate(A, B, ROWS, V, i) - n0) + beta * (tangent_rate(A, B, ROWS, V, i) - t0))
    if not q > 0.0:
        return 1.0, max(owed, 0.0)
    if not exact and p - q >= owed:
        return 1.0, 0.0
    left = 0.0
    square = p * p - 4.0 * q * owed
    if square < 0.0 or p <= 0.0:
        s = max(0.5 * p / q, 0.0)
        left = max(owed - s * (p - s * q), 0.0)
    else:
        large = 0.5 * (p + math.sqrt(square))
        s = large / q
        other = owed / large if large > 0.0 else 0.0
        if abs(other - 1.0) < abs(s - 1.0):
            s = other
    return s, left


@uncounted
def lock(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, FREE: FloatArray, IM: FloatArray,
    II: FloatArray, m: int, owed: float, exact: bool,
) -> tuple[float, float]:  # fmt: skip
    """Scale all impulses by `scale_of`, and V with them; its results."""
    s, left = scale_of(A, B, ROWS, L, V, FREE, m, owed, exact)
    if s != 1.0:
        for i in range(m):
            L[i, 0] *= s
            L[i, 1] *= s
        velocities(A, B, ROWS, L, FREE, IM, II, m, V)
    return s, left


@uncounted
def lift(
    A: IntArray, B: IntArray, ROWS: Rows[Row], GAPS: FloatArray, MU: FloatArray, D: FloatArray, IM: FloatArray,
    II: FloatArray, m: int, tolerance: float, most: int,
) -> tuple[int, float]:  # fmt: skip
    """Displacements D = M^-1 G^T mu with 0 <= mu _|_ g + A mu >= 0, by at most `most` sweeps.

    Args:
        GAPS: (m,) length.  MU: (m,) in and out, mass times length.  D: (k, 3) in and out, length and rad.
        tolerance: length that a sweep may still move a gap.
    Returns:
        Sweeps taken and the last one's largest change of a gap.
    """
    worst = 0.0
    done = 0
    while done < most:
        worst = 0.0
        for i in range(m):
            g = GAPS[i] + normal_rate(A, B, ROWS, D, i)
            if g >= 0.0 and MU[i] == 0.0:
                continue
            k = ROWS[i].k_n
            mu = max(MU[i] - k * g, 0.0)
            d = mu - MU[i]
            MU[i] = mu
            a = A[i]
            b = B[i]
            nx = ROWS[i].nx
            ny = ROWS[i].ny
            D[a, 0] -= IM[a] * d * nx
            D[a, 1] -= IM[a] * d * ny
            D[a, 2] -= II[a] * (d * ROWS[i].arm_na)
            D[b, 0] += IM[b] * d * nx
            D[b, 1] += IM[b] * d * ny
            D[b, 2] += II[b] * (d * ROWS[i].arm_nb)
            worst = max(worst, abs(d) / k)
        done += 1
        if worst <= tolerance:
            break
    return done, worst

"""Losses of contacts, and the energy lock.

For any impulses the kinetic energy of an island changes, apart from forces and moving surfaces, by -sum (D_n + D_t),

    D_n = -lam (u_n- + u_n+) / 2,   D_t = -beta (u_t- + u_t+) / 2.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.contacts import AnyProblem, Row
from .build import normal_rate, tangent_rate
from .sweeps import velocities


@inlined
def offset_gain(normal: float, tangential: float) -> tuple[float, float]:
    """Losses by a normal impulse and by friction, energies: a gain, a negative loss, is deducted from the other one."""
    both = normal + tangential
    if normal < 0.0:
        return min(both, 0.0), max(both, 0.0)
    return (both, 0.0) if tangential < 0.0 else (normal, tangential)


@inlined
def losses_of(problem: AnyProblem, L: FloatArray, V: FloatArray, i: int) -> tuple[float, float]:
    """D_n and D_t of contact i, energies, with V the velocities after.

    Where slip reverses, friction returns a part of what restitution takes, D_n + D_t >= 0: see `offset_gain`.
    """
    ROWS = problem.ROWS
    normal = -0.5 * L[i, 0] * (ROWS[i].un + normal_rate(ROWS[i], V))
    tangential = -0.5 * L[i, 1] * (ROWS[i].ut + tangent_rate(ROWS[i], V))
    return offset_gain(normal, tangential)


@nonallocating
def losses(problem: AnyProblem, L: FloatArray, V: FloatArray) -> tuple[float, float]:
    """Sums of D_n and D_t; `offset_gain` of these too, as the solve may be truncated."""
    normal, tangential = 0.0, 0.0
    for i in range(problem.m):
        if L[i, 0] != 0.0 or L[i, 1] != 0.0:
            one, two = losses_of(problem, L, V, i)
            normal += one
            tangential += two
    return offset_gain(normal, tangential)


@nonallocating
def scale_to_lose(p: float, q: float, owed: float, exact: bool) -> float:
    """The scale s of impulses that lose D(s) = s p - s^2 q: see `lock`."""
    if not q > 0.0:
        return 1.0
    if not exact and p - q >= owed:
        return 1.0
    square = p * p - 4.0 * q * owed
    if square < 0.0 or p <= 0.0:
        return max(0.5 * p / q, 0.0)
    large = 0.5 * (p + math.sqrt(square))
    s = large / q
    other = owed / large if large > 0.0 else 0.0
    return other if abs(other - 1.0) < abs(s - 1.0) else s


@nonallocating
def loss_of_scaled(ROWS: Rows[Row], L: FloatArray, V: FloatArray, FREE: FloatArray, m: int) -> tuple[float, float]:
    """p and q of the loss D(s) = s p - s^2 q of s times the impulses L (m, 2): with u* the velocities of FREE (k, 3),
    without these impulses, and u+ those of V (k, 3), p = -lam.(u- + u*)/2, q = lam.(u+ - u*)/2; tangents likewise."""
    p, q = 0.0, 0.0
    for i in range(m):
        lam, beta = L[i, 0], L[i, 1]
        if lam != 0.0 or beta != 0.0:
            n0, t0 = normal_rate(ROWS[i], FREE), tangent_rate(ROWS[i], FREE)
            p -= 0.5 * (lam * (ROWS[i].un + n0) + beta * (ROWS[i].ut + t0))
            q += 0.5 * (lam * (normal_rate(ROWS[i], V) - n0) + beta * (tangent_rate(ROWS[i], V) - t0))
    return p, q


@nonallocating
def lock(problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, owed: float, exact: bool) -> float:
    """Energy lock: one scale s for all impulses, so that the island loses at least `owed`; exactly that if `exact`.
    Updates L and V.

    Of the two roots of D(s) = owed (`loss_of_scaled`) the one nearer to 1 is taken; s = 1 if no change is needed.
    Without a root, s gives the largest loss of these impulses. Returns s.
    """
    p, q = loss_of_scaled(problem.ROWS, L, V, FREE, problem.m)
    s = scale_to_lose(p, q, owed, exact)
    if s != 1.0:
        for i in range(problem.m):
            L[i, 0] *= s
            L[i, 1] *= s
        velocities(problem, L, FREE, V)
    return s

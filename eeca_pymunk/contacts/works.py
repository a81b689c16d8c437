"""Works of contacts and forces over an interval, and kinetic energy. The losses of contacts are in `..rows.energy`."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.contacts import Row


@nonallocating
def external_work(
    ROWS: Rows[Row], L: FloatArray, V: FloatArray, VN: FloatArray, IM: FloatArray, II: FloatArray, m: int
) -> float:
    """External work of m contacts with impulses L (m, 2): of bodies that impulses do not move or do not turn, at the
    means of their velocities V and VN (k, 3) before and after, and of moving surfaces."""
    work = 0.0
    for i in range(m):
        lam, beta = L[i, 0], L[i, 1]
        if lam == 0.0 and beta == 0.0:
            continue
        work -= beta * (ROWS[i].surface + ROWS[i].swung)
        fx = lam * ROWS[i].nx - beta * ROWS[i].ny
        fy = lam * ROWS[i].ny + beta * ROWS[i].nx
        a, b = ROWS[i].a, ROWS[i].b
        if IM[b] == 0.0:
            work -= 0.5 * (fx * (V[b, 0] + VN[b, 0]) + fy * (V[b, 1] + VN[b, 1]))
        if II[b] == 0.0:
            work -= 0.5 * (lam * ROWS[i].arm_nb + beta * ROWS[i].arm_tb) * (V[b, 2] + VN[b, 2])
        if IM[a] == 0.0:
            work += 0.5 * (fx * (V[a, 0] + VN[a, 0]) + fy * (V[a, 1] + VN[a, 1]))
        if II[a] == 0.0:
            work += 0.5 * (lam * ROWS[i].arm_na + beta * ROWS[i].arm_ta) * (V[a, 2] + VN[a, 2])
    return work


@nonallocating
def work_of_forces(ACC: FloatArray, IM: FloatArray, II: FloatArray, n: int, D: FloatArray) -> float:
    """Work of the forces that cause accelerations ACC (k, 3) over displacements D (k, 3), for the first n bodies."""
    work = 0.0
    for i in range(n):
        work += (ACC[i, 0] * D[i, 0] + ACC[i, 1] * D[i, 1]) / IM[i]
        if II[i] > 0.0:
            work += ACC[i, 2] * D[i, 2] / II[i]
    return work


@nonallocating
def kinetic_energy(V: FloatArray, IM: FloatArray, II: FloatArray, n: int) -> float:
    """Kinetic energy of the first n bodies, which impulses move, at velocities V (k, 3)."""
    total = 0.0
    for q in range(n):
        total += 0.5 * (V[q, 0] ** 2 + V[q, 1] ** 2) / IM[q]
        if II[q] > 0.0:
            total += 0.5 * V[q, 2] ** 2 / II[q]
    return total


@nonallocating
def gained_energy(V: FloatArray, BEFORE: FloatArray, IM: FloatArray, II: FloatArray, n: int) -> float:
    """`kinetic_energy` at velocities V less that at velocities BEFORE, from (V - BEFORE) (V + BEFORE): without the
    round-off of two large energies."""
    total = 0.0
    for q in range(n):
        for c in range(3):
            mobility = II[q] if c == 2 else IM[q]
            if mobility > 0.0:
                total += 0.5 * (V[q, c] - BEFORE[q, c]) * (V[q, c] + BEFORE[q, c]) / mobility
    return total


@nonallocating
def kinetic(BODY: Rows[Body], i: int) -> float:
    """Kinetic energy of body i; 0 for bodies that impulses do not move."""
    if BODY[i].inv_mass == 0.0:
        return 0.0
    vx, vy, spin = BODY[i].vx, BODY[i].vy, BODY[i].spin
    return 0.5 * (vx * vx + vy * vy) / BODY[i].inv_mass + (
        0.5 * spin * spin / BODY[i].inv_inertia if BODY[i].inv_inertia > 0.0 else 0.0
    )

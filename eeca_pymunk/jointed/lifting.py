"""Lifting the bodies of an island with joints out of each other, paid from what its contacts have just lost."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, uncounted
from ..contacts.works import against
from ..model.contacts import JointedProblem
from ..model.islands import Island
from ..model.joints import Joints
from ..model.parameters.intervals import CORRECTION_STEP
from ..model.parameters.joints import JOINTED_CORRECTION_SWEEPS, JOINTED_OVERLAP
from ..model.scene import Scene
from ..rows.bounded import room_for_rows
from ..rows.build import normal_rate
from ..rows.inplace import copy
from ..rows.lifting import lift
from .advance import Interval
from .columns import fill_group, weigh
from .component import close_joints, ready
from .gathered import find_places, gather_component
from .groups import hangs
from .motors import drives


@kernel
def raise_gaps(problem: JointedProblem, GAPS: FloatArray, D: FloatArray, tolerance: float) -> FloatArray:
    """Displacements D (k, 3) = Y mu, 0 <= mu _|_ g + G D >= 0, of contacts that are not left out; mu (m,)."""
    MU = np.zeros(problem.m)
    for i in range(problem.m):
        if problem.C.OUT[i] != 0:
            GAPS[i] = np.inf
    lift(problem, GAPS, MU, D, np.inf, tolerance, JOINTED_CORRECTION_SWEEPS, np.empty(problem.m, np.int64))
    return MU


@uncounted
def unturn(isle: Island, n: int, NEW: FloatArray, D: FloatArray, V: FloatArray) -> tuple[float, float, float, float]:
    """The common spin that takes back the angular momentum sum m D x v of displacements D to NEW, the centre of mass
    (x, y) about which it is, and the energy that it costs. No joint and no contact minds it."""
    mass = x = y = vx = vy = 0.0
    for q in range(n):
        if isle.II[q] == 0.0:
            return 0.0, 0.0, 0.0, 0.0
        m = 1.0 / isle.IM[q]
        mass, x, y, vx, vy = mass + m, x + m * NEW[q, 0], y + m * NEW[q, 1], vx + m * V[q, 0], vy + m * V[q, 1]
    x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
    gained = spin = inertia = 0.0
    for q in range(n):
        rx, ry, wx, wy = NEW[q, 0] - x, NEW[q, 1] - y, V[q, 0] - vx, V[q, 1] - vy
        gained += (D[q, 0] * V[q, 1] - D[q, 1] * V[q, 0]) / isle.IM[q]
        spin += (rx * wy - ry * wx) / isle.IM[q] + V[q, 2] / isle.II[q]
        inertia += (rx * rx + ry * ry) / isle.IM[q] + 1.0 / isle.II[q]
    turn = -gained / inertia
    return turn, x, y, turn * spin + 0.5 * inertia * turn * turn


@kernel
def correct(A: Scene, J: Joints, interval: Interval, end: float, budget: float) -> float:
    """Lift the poses at the end of an island's motion by at most what `budget` pays; the energy that it costs.

    The cost is -m a.D for displacements D, turns included, and what springs hold more. Joints hold: D goes along them,
    and what is left of second order is closed. Where nothing without mobility is in the island, its angular momentum
    stays: velocities at the end turn by what the displacements have changed of it.
    """
    isle, groups, P, Q, ROWS, motion, C, m, n, _, h = interval
    V, WAY, END = motion.V, motion.WAY, motion.END
    size = np.inf
    for q in range(n):
        size = min(size, isle.EXTENT[q])
    GAPS, deepest = np.empty(m), 0.0
    for i in range(m):
        GAPS[i] = ROWS[i].gap + normal_rate(P, Q, ROWS, WAY, i)
        deepest = min(deepest, GAPS[i])
    if deepest >= -JOINTED_OVERLAP * size or not budget > 0.0:
        return 0.0
    NOTHING, INDEX = np.zeros_like(V), np.full(len(isle.IM), -1, np.int64)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        # Where joints do nothing but hold, bodies answer as they did in the interval.
        if s >= 0 and drives(J, s):
            gather_component(A, J, s, END, V, NOTHING, isle.IM, isle.II, end, h)
            places = find_places(A, J, s, INDEX)
            if ready(J, s, 2.0, False):
                fill_group(J, groups, C, g, INDEX, False, P, Q, ROWS, m, np.empty((places, 3)))
    KEEP = ROWS[:m].copy()
    weigh(C, P, Q, KEEP, m)
    D = np.zeros_like(V)
    raise_gaps(JointedProblem(P, Q, KEEP, C, room_for_rows(0, 0), m), GAPS, D, 1e-3 * -deepest)
    far = 0.0
    for q in range(n):
        far = max(far, (math.sqrt(D[q, 0] ** 2 + D[q, 1] ** 2) + abs(D[q, 2]) * isle.EXTENT[q]) / isle.EXTENT[q])
    cost = -against(isle.ACC, isle.IM, isle.II, n, D)
    part = min(1.0, CORRECTION_STEP / far) if far > 0.0 else 0.0
    if cost * part > 0.5 * budget:
        part = 0.5 * budget / cost
    HELD = np.zeros(len(groups.COMPONENT))
    free = len(isle.IM) == n and not hangs(groups, J.COMPONENT, J.MEMBER)
    for _ in range(4):
        spent = 0.0
        NEW = END.copy()
        for q in range(n):
            for c in range(3):
                NEW[q, c] += part * D[q, c]
        for g in range(len(groups.COMPONENT)):
            s = groups.COMPONENT[g]
            moves = 0.0
            for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
                for c in range(3):
                    moves = max(moves, abs(D[groups.BODY[w], c]))
            if s >= 0 and moves > 0.0:
                HELD[g] = close_joints(A, J, s, END, NEW, V, isle.IM, isle.II, end, h)
                spent += HELD[g]
        spent -= against(isle.ACC, isle.IM, isle.II, n, NEW - END)
        turn, x, y, cost = unturn(isle, n, NEW, NEW - END, V) if free else (0.0, 0.0, 0.0, 0.0)
        spent += cost
        if spent <= budget:
            for q in range(n if turn != 0.0 else 0):
                V[q, 0] -= turn * (NEW[q, 1] - y)
                V[q, 1] += turn * (NEW[q, 0] - x)
                V[q, 2] += turn
            for g in range(len(groups.COMPONENT)):
                s = groups.COMPONENT[g]
                if s >= 0:
                    J.STEPPED[s].stored += HELD[g]
            copy(END, NEW)
            return spent
        part *= 0.25
    return 0.0

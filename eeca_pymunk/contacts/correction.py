"""Penetration correction: displacements of bodies at the end of an interval, whose cost in energy is deducted from the
losses of the same island and interval.

delta = M^-1 G^T mu with 0 <= mu _|_ g + A mu >= 0 for the gaps g at the end, scaled so that the potential energy it
costs is at most the losses, and no point of a body moves farther than CORRECTION_STEP of the size of the smallest one:
so the correction gives no energy, no body passes through a wall by it, and gaps stay about linear in the displacements.
Gaps above -OVERLAP_LEFT of the size are not corrected; within a step only those are that the correction at its end may
not reach (`..islands.depths.left_to_lift`).

Displacements change the orbital angular momentum by sum m delta x v. If an island is free (without bodies that impulses
do not move), a common rotation of the velocities of bodies that press on each other, about their centre of mass,
removes that change.
"""

from __future__ import annotations

import math
from math import inf

import numpy as np

from ..arrays import FlagArray, FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..geometry.widths import depth_limit
from ..model.contacts import AnyProblem, Problem
from ..model.parameters.intervals import (
    CORRECTION_ROUND_OFF,
    CORRECTION_SHARE,
    CORRECTION_STEP,
    CORRECTION_SWEEPS,
    CORRECTION_TRIES,
    CORRECTION_WORK,
    LIFT_RESIDUAL,
    OVERLAP_LEFT,
)
from ..model.scene import Scene
from ..rows.build import normal_rate
from ..rows.lifting import keep_walls, lift_above_walls
from .forces import shapes_of
from .works import work_of_forces


@kernel
def correct_penetration(
    problem: Problem, L: FloatArray, POSE: FloatArray, VN: FloatArray, ACC: FloatArray, h: float, EXTENT: FloatArray,
    budget: float, left: float, JUMP: FloatArray,
) -> None:  # fmt: skip
    """Compute the corrections JUMP (k, 6) of pose and velocity at the end of an interval of length h.

    Args:
        problem: its contacts, with gaps at the start.  L: (m, 2) their impulses.
        POSE: (k, 3) at the middle of the interval.
        VN: (k, 3) velocities at the end.  ACC: (k, 3) accelerations without contacts.
        EXTENT: (k,) lengths from the bodies' centres of mass to their farthest points.
        budget: energy that the correction may cost; below 0 nothing is corrected, with 0 what costs nothing.
        left: depth, in parts of the smallest body, up to which nothing is corrected.
    """
    ROWS, IM, II, _, n, m = problem
    size = least_of(EXTENT, n)
    JUMP[:] = 0.0
    GAPS = np.empty(m)
    deepest = 0.0
    for i in range(m):
        GAPS[i] = ROWS[i].gap + 0.5 * h * (ROWS[i].un + normal_rate(ROWS[i], VN))
        deepest = min(deepest, GAPS[i])
    if deepest >= -left * size or not budget >= 0.0:
        return
    D = np.zeros((len(IM), 3))
    MU = lift_above_walls(
        problem, n, GAPS, D, LIFT_RESIDUAL * OVERLAP_LEFT * size, CORRECTION_SWEEPS + CORRECTION_WORK // m
    )
    D = admissible(D, EXTENT, n, size) * D
    END = POSE + 0.5 * h * VN
    NEW = END + D
    GROUP, TURN, ONE = np.arange(n), np.zeros((n, 3)), np.empty(n, np.uint8)
    for i in range(m if len(IM) == n else 0):
        if L[i, 0] > 0.0 or MU[i] > 0.0:
            connect(GROUP, ROWS[i].a, ROWS[i].b)
    for tries in range(CORRECTION_TRIES):
        work, square = -work_of_forces(ACC, IM, II, n, D), 0.0
        if len(IM) == n:
            NEW = END + D
            spun, square = unturn_groups(NEW, D, VN, IM, II, GROUP, ONE, np.zeros(n), TURN)
            work += spun
        if not work + square > budget + CORRECTION_ROUND_OFF * work_of_forces(np.abs(ACC), IM, II, n, np.abs(D)):
            break
        part = part_for(CORRECTION_SHARE * budget, work, square)
        D = (part if tries + 2 < CORRECTION_TRIES else 0.0) * D
    for i in range(n):
        for c in range(3):
            JUMP[i, c] = D[i, c]
    turn_groups(NEW, GROUP, ONE, TURN, JUMP, 3)


@inlined
def part_for(budget: float, first: float, square: float) -> float:
    """The part p of displacements D that costs just `budget`, if D costs `first` + `square`: the work w of forces, and
    `unturn_groups`.

    A group of inertia I has the angular momentum s + p g, of which p D have given p g. Its turn -p g / I changes the
    energy by -p g (s + p g) / I + (p g)^2 / (2 I). For p = 1 the second term is `square`, the first w - g s / I -
    2 square. So p D cost

        p w - p g s / I - p^2 g^2 / (2 I) = p (first + 2 square) - p^2 square,

    and p is the smaller root. I is taken as constant, so that the cost of the part has to be computed again.
    """
    linear = first + 2.0 * square
    return 2.0 * budget / (linear + math.sqrt(max(linear * linear - 4.0 * square * budget, 0.0)))


@kernel
def without_turning(problem: Problem) -> Problem:
    """The problem of bodies that do not turn."""
    ROWS, IM, II, POSE, n, m = problem
    KEEP = ROWS[:m].copy()
    for i in range(m):
        KEEP[i].k_n = 1.0 / (IM[KEEP[i].a] + IM[KEEP[i].b])
    return Problem(KEEP, IM, np.zeros_like(II), POSE, n, m)


@nonallocating
def connect(GROUP: IntArray, one: int, other: int) -> None:
    """Unite the groups of two bodies; GROUP (n,) has the least body of each one's."""
    least, most = min(GROUP[one], GROUP[other]), max(GROUP[one], GROUP[other])
    for q in range(len(GROUP) if least < most else 0):
        if GROUP[q] == most:
            GROUP[q] = least


@nonallocating
def least_of(EXTENT: FloatArray, n: int) -> float:
    """The extent of the smallest of n bodies that have shapes."""
    size = math.inf
    for i in range(n):
        size = min(size, EXTENT[i] if EXTENT[i] > 0.0 else math.inf)
    return size


@nonallocating
def admissible(D: FloatArray, EXTENT: FloatArray, n: int, size: float) -> float:
    """The factor <= 1 on displacements D (k, 3) of n bodies, the smallest of extent `size`, with which no point moves
    too far: see CORRECTION_STEP."""
    far = 0.0
    for i in range(n):
        far = max(far, math.sqrt(D[i, 0] * D[i, 0] + D[i, 1] * D[i, 1]) + abs(D[i, 2]) * EXTENT[i])
    most = CORRECTION_STEP * size
    return most / far if far > most else 1.0


@nonallocating
def unturn(
    NEW: FloatArray, D: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray, touched: FlagArray, excess: float
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """The common spin of the touched bodies that removes the angular momentum sum m D x v which displacements D to the
    poses NEW give at velocities V, all (k, 3), and `excess`. It changes no velocity along contacts and joints.

    Returns the spin, the centre of mass (x, y), the angular momentum about it and the moment of inertia; zeros if a
    touched body cannot turn, or none is touched. touched (k,): 1 for bodies that turn. II: inf for spins that stay.
    """
    mass = x = y = vx = vy = 0.0
    for i in range(len(touched)):
        if touched[i] == 0:
            continue
        if II[i] == 0.0:
            return 0.0, 0.0, 0.0, 0.0, 0.0
        mass += 1.0 / IM[i]
        x, y = x + NEW[i, 0] / IM[i], y + NEW[i, 1] / IM[i]
        vx, vy = vx + V[i, 0] / IM[i], vy + V[i, 1] / IM[i]
    if mass == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
    gained, spin, inertia = excess, 0.0, 0.0
    for i in range(len(touched)):
        if touched[i] == 0:
            continue
        rx, ry, wx, wy = NEW[i, 0] - x, NEW[i, 1] - y, V[i, 0] - vx, V[i, 1] - vy
        gained += (D[i, 0] * wy - D[i, 1] * wx) / IM[i]
        spin += (rx * wy - ry * wx) / IM[i] + V[i, 2] / II[i]
        inertia += (rx * rx + ry * ry) / IM[i] + 1.0 / II[i]
    return -gained / inertia, x, y, spin, inertia


@nonallocating
def mark_group(GROUP: IntArray, g: int, ONE: FlagArray) -> bool:
    """Set the flags ONE (n,) of the bodies of group g; False if that is no group, or a single body."""
    size = 0
    for q in range(len(GROUP)):
        ONE[q] = 1 if GROUP[q] == g else 0
        size += ONE[q]
    return size > 1


@nonallocating
def unturn_groups(
    NEW: FloatArray, D: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray, GROUP: IntArray, ONE: FlagArray,
    EXCESS: FloatArray, TURN: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """`unturn` for each group of bodies, EXCESS (n,) being that of group g at g: sets TURN (n, 3), the spin and the
    centre of each. ONE (n,): scratch. Returns the changes of kinetic energy of first and second order in the spins."""
    first, second = 0.0, 0.0
    for g in range(len(GROUP)):
        TURN[g, 0] = 0.0
        if mark_group(GROUP, g, ONE):
            turn, x, y, spin, inertia = unturn(NEW, D, V, IM, II, ONE, EXCESS[g])
            TURN[g, 0], TURN[g, 1], TURN[g, 2] = turn, x, y
            first, second = first + turn * spin, second + 0.5 * inertia * turn * turn
    return first, second


@nonallocating
def turn_groups(NEW: FloatArray, GROUP: IntArray, ONE: FlagArray, TURN: FloatArray, V: FloatArray, at: int) -> None:
    """`turn_by` for each group of bodies, with TURN of `unturn_groups`."""
    for g in range(len(GROUP)):
        if TURN[g, 0] != 0.0:
            mark_group(GROUP, g, ONE)
            turn_by(NEW, ONE, TURN[g, 0], TURN[g, 1], TURN[g, 2], V, at)


@nonallocating
def turn_by(NEW: FloatArray, touched: FlagArray, turn: float, x: float, y: float, V: FloatArray, at: int) -> None:
    """Add a common spin `turn` about (x, y) to the velocities V[:, at :] of the touched bodies, which are at NEW."""
    for i in range(len(touched)):
        if touched[i] != 0:
            V[i, at] -= turn * (NEW[i, 1] - y)
            V[i, at + 1] += turn * (NEW[i, 0] - x)
            V[i, at + 2] += turn


@kernel
def stop_at_walls(A: Scene, problem: AnyProblem, n: int, LEFT_OUT: IntArray, L: FloatArray, V: FloatArray) -> None:
    """After a solve of many contacts, which may not have converged: its residuals let light bodies under heavy ones
    sink, by a part of the depth that each interval allows, and in the end through a floor. So further impulses of walls
    alone, which act on no other body, bring contacts with bodies without mobility, those from number n on, to u_n >= b
    at velocities V (k, 3), where they are deeper than an interval allows. Heavy bodies then go into light ones instead.
    Normal impulses L only grow, so that frictions remain within their limits. LEFT_OUT (m,): not 0 for contacts that no
    impulse moves."""
    LACK = np.full(problem.m, inf)
    for i in range(problem.m):
        row = problem.ROWS[i]
        if max(row.a, row.b) >= n and row.activation == inf and LEFT_OUT[i] == 0:
            a, b = shapes_of(A, row)
            LACK[i] = -row.target if row.gap < -depth_limit(A, a, b) else inf
    keep_walls(problem, n, LACK, np.zeros(problem.m), L[:, 0], V)

"""Contacts of jointed bodies, by response columns: the changes of the velocities of all bodies of a component by a
unit impulse along n, and along t, of a contact. Y is the matrix of all columns.

The same contact problem as that of bodies without joints, with the response of components in place of inverse masses.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, kernel, nonallocating
from ..model.contacts import Columns, JointedProblem, Problem, Row
from ..model.parameters.impulses import ON_CONE
from ..model.parameters.joints import DISC_WORK, SLIP_WORK, SWEEP_ENTRY_WORK, SWEEP_WORK
from .bounded import FIRST_OF_DISC, bounded_rate, inside_discs, push_row, room_for_rows, sweep_bounded
from .build import normal_rate, tangent_rate
from .coulomb import OPEN, STICK, activate, lawful, limited_slip, mode_of


@inlined
def put_unjointed(C: Columns, w: int, row: Row, on_b: bool, mobility: float, turning: float) -> None:
    """Write entry w of the columns of a contact, on its body a, or b if `on_b`, which no joint holds: `mobility` and
    `turning` are its inverse mass and moment."""
    sign = 1.0 if on_b else -1.0
    x, y = sign * mobility * row.nx, sign * mobility * row.ny
    C.N[w, 0], C.N[w, 1], C.T[w, 0], C.T[w, 1] = x, y, -y, x
    C.N[w, 2] = sign * turning * (row.arm_nb if on_b else row.arm_na)
    C.T[w, 2] = sign * turning * (row.arm_tb if on_b else row.arm_ta)


@kernel
def as_columns(problem: Problem) -> JointedProblem:
    """The contact problem of bodies without joints by columns, each on the two bodies of its contact."""
    ROWS, IM, II, _, _, m = problem
    C = Columns(
        np.empty(m + 1, np.int64), np.empty(2 * m, np.int64), np.empty((2 * m, 3)), np.empty((2 * m, 3)),
        np.zeros(m, np.int64), np.zeros(1),
    )  # fmt: skip
    for i in range(m):
        C.AT[i] = 2 * i
        for side in range(2):
            q = ROWS[i].b if side == 1 else ROWS[i].a
            C.BODY[2 * i + side] = q
            put_unjointed(C, 2 * i + side, ROWS[i], side == 1, IM[q], II[q])
    C.AT[m] = 2 * m
    return JointedProblem(ROWS, C, room_for_rows(0, 0), m)


@inlined
def push_column(C: Columns, i: int, lam: float, beta: float, V: FloatArray) -> None:
    """Add the columns of contact i times changes of its impulses to V (k, 3)."""
    for w in range(C.AT[i], C.AT[i + 1]):
        for c in range(3):
            V[C.BODY[w], c] += lam * C.N[w, c] + beta * C.T[w, c]


@nonallocating
def push_columns(C: Columns, L: FloatArray, m: int, factor: float, V: FloatArray) -> None:
    """Add factor Y L to V (k, 3): the columns Y of m contacts times their impulses L (m, 2)."""
    for i in range(m):
        lam, beta = factor * L[i, 0], factor * L[i, 1]
        if lam != 0.0 or beta != 0.0:
            push_column(C, i, lam, beta, V)


@nonallocating
def push_jointed(problem: JointedProblem, L: FloatArray, factor: float, V: FloatArray) -> None:
    """Add factor Y L to V (k, 3), bounded rows included."""
    push_columns(problem.C, L, problem.m, factor, V)
    for i in range(problem.B.NUMBER[0]):
        push_row(problem.B, i, factor * L[problem.m + i, 0], V)


@nonallocating
def breach(problem: JointedProblem, L: FloatArray, V: FloatArray) -> float:
    """The largest velocity by which impulses L and velocities V break the laws of contacts and bounded rows; inf if
    impulses are on the rim of a disc. Inactive contacts break theirs beyond the velocity that activates them. The
    change of velocity in a sweep is no such measure: where an impulse of friction could open its contact,
    a_nn < mu |a_nt|, a contact by itself has several solutions, among which a sweep may change."""
    ROWS, C, B, m = problem
    worst = 0.0 if inside_discs(B, L, m) else np.inf
    for i in range(m):
        if C.LEFT_OUT[i] != 0:
            continue
        if ROWS[i].activation < np.inf:
            worst = max(worst, ROWS[i].activation - normal_rate(ROWS[i], V))
            continue
        un = normal_rate(ROWS[i], V) - ROWS[i].target
        state, sign = mode_of(ROWS[i], V, L[i, 0], L[i, 1], ON_CONE)
        worst = max(worst, -un if state == OPEN else abs(un))
        if state == STICK or sign != 0.0:
            off = tangent_rate(ROWS[i], V) - limited_slip(ROWS[i], L[i, 0], L[i, 1])
            worst = max(worst, abs(off) if state == STICK else sign * off)
    for i in range(B.NUMBER[0]):
        row, x = B.ROWS[i], L[m + i, 0]
        if row.a_own > 0.0:
            u = row.speed + bounded_rate(B, i, V)
            worst = max(worst, abs(u) if row.low < x < row.high else u if x >= row.high else -u)
    return worst


@nonallocating
def sweep_jointed(problem: JointedProblem, L: FloatArray, V: FloatArray) -> float:
    """One sweep over the contacts as `sweeps.sweep_unjointed`, but that a contact which sticks stays closed where
    friction alone could open it; and over the bounded rows, whose impulses are L[m:, 0]. Returns the largest change of
    a velocity."""
    ROWS, C, B, m = problem
    work = SWEEP_WORK * (m + B.NUMBER[0]) + SWEEP_ENTRY_WORK * (C.AT[m] + B.AT[B.NUMBER[0]])
    for i in range(B.NUMBER[0]):
        work += DISC_WORK if B.ROWS[i].part == FIRST_OF_DISC else 0.0
    C.WORK[0] += work
    worst = 0.0
    for i in range(m):
        if C.LEFT_OUT[i] != 0:
            continue
        if ROWS[i].activation < np.inf:
            activate(ROWS, m, i, V, L)
        lam, beta, slips = lawful(ROWS[i], V, L[i, 0], L[i, 1], True)
        C.WORK[0] += SLIP_WORK if slips else 0.0
        dn, dt = lam - L[i, 0], beta - L[i, 1]
        if dn == 0.0 and dt == 0.0:
            continue
        L[i, 0], L[i, 1] = lam, beta
        push_column(C, i, dn, dt, V)
        worst = max(worst, abs(dn) * ROWS[i].a_nn, abs(dt) * ROWS[i].a_tt)
    return max(worst, sweep_bounded(B, L, m, V))

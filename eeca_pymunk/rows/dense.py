"""Direct solve on the active contacts of a small island: Newton's step of the law, in the space of contacts.

As `sparse.py`, but with slip in the matrix: a slipping contact acts along n +- mu t, so that the matrix is not
symmetric, and a few steps suffice if the active contacts are right. A + diag(A) / R with refinement (the proximal point
method) allows redundant contacts: each pass leaves the part 1 / (1 + R l) of the error, with l the smallest eigenvalue
of A scaled to diagonal 1. R is PROXIMAL_DENSE, or with the columns of components COLUMN_PROXIMAL, which is
larger: homotopies have that matrix too, and fewer passes (HOMOTOPY_REFINEMENTS).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import Choice, kernel, nonallocating
from ..model.contacts import AnyProblem, JointedProblem, Problem
from ..model.parameters.impulses import PROXIMAL_DENSE
from ..model.parameters.joints import COLUMN_PROXIMAL, MATRIX_WORK
from .active_set import clamp, classify
from .bounded import bounded_rate
from .build import normal_rate, slip_rate, tangent_rate
from .coulomb import lossless_slip
from .sweeps import velocities


@nonallocating
def decompose_dense(W: FloatArray, N: int, order: IntArray) -> None:
    """LU decomposition with partial pivoting of W[:N, :N] in place; order (N,): out, its rows."""
    for j in range(N):
        order[j] = j
    for j in range(N):
        p = j
        for i in range(j + 1, N):
            if abs(W[i, j]) > abs(W[p, j]):
                p = i
        if p != j:
            order[j], order[p] = order[p], order[j]
            for k in range(N):
                W[j, k], W[p, k] = W[p, k], W[j, k]
        if W[j, j] == 0.0:
            W[j, j] = 1e-300
        for i in range(j + 1, N):
            if W[i, j] != 0.0:
                W[i, j] /= W[j, j]
                factor = W[i, j]
                for k in range(j + 1, N):
                    W[i, k] -= factor * W[j, k]


@nonallocating
def solve_factors(W: FloatArray, N: int, order: IntArray, r: FloatArray, x: FloatArray) -> None:
    """Set x = W^-1 r, with W of `decompose_dense`."""
    for i in range(N):
        s = r[order[i]]
        for k in range(i):
            s -= W[i, k] * x[k]
        x[i] = s
    for i in range(N - 1, -1, -1):
        s = x[i]
        for k in range(i + 1, N):
            s -= W[i, k] * x[k]
        x[i] = s / W[i, i]


@kernel
def matrix_unjointed(problem: Problem, slope: FloatArray, at: IntArray, kind: IntArray, N: int, W: FloatArray) -> None:
    """W[i, j] = velocity along unknown i by a unit impulse of unknown j, for N unknowns of contacts `at`, of `kind` 0
    (normal, with its slip) or 1 (tangential). slope (m,): beta / lam of slipping contacts."""
    ROWS, IM, II, _, _, _ = problem
    ARMS = np.empty((N, 8))  # rows: n or t with arms a, b; then the columns' direction and arms
    for i in range(N):
        c = at[i]
        row, nx, ny = ROWS[c], ROWS[c].nx, ROWS[c].ny
        if kind[i] == 0:
            ARMS[i, 0], ARMS[i, 1], ARMS[i, 2], ARMS[i, 3] = nx, ny, row.arm_na, row.arm_nb
            ARMS[i, 4], ARMS[i, 6] = nx - slope[c] * ny, row.arm_na + slope[c] * row.arm_ta
            ARMS[i, 5], ARMS[i, 7] = ny + slope[c] * nx, row.arm_nb + slope[c] * row.arm_tb
        else:
            ARMS[i, 0], ARMS[i, 1], ARMS[i, 2], ARMS[i, 3] = -ny, nx, row.arm_ta, row.arm_tb
            for k in range(4):
                ARMS[i, 4 + k] = ARMS[i, k]
    for i in range(N):
        for j in range(N):
            a, b, w = ROWS[at[i]].a, ROWS[at[i]].b, 0.0
            along = ARMS[i, 0] * ARMS[j, 4] + ARMS[i, 1] * ARMS[j, 5]
            if a == ROWS[at[j]].a:
                w += IM[a] * along + II[a] * ARMS[i, 2] * ARMS[j, 6]
            elif a == ROWS[at[j]].b:
                w -= IM[a] * along + II[a] * ARMS[i, 2] * ARMS[j, 7]
            if b == ROWS[at[j]].b:
                w += IM[b] * along + II[b] * ARMS[i, 3] * ARMS[j, 7]
            elif b == ROWS[at[j]].a:
                w -= IM[b] * along + II[b] * ARMS[i, 3] * ARMS[j, 6]
            W[i, j] = w
        c = at[i]
        W[i, i] += 1.0 / (PROXIMAL_DENSE * (ROWS[c].k_n if kind[i] == 0 else ROWS[c].k_t))


@kernel
def matrix_jointed(
    problem: JointedProblem, slope: FloatArray, at: IntArray, kind: IntArray, N: int, W: FloatArray
) -> None:
    """As `matrix_unjointed`, with response columns; unknowns of kind 2 are bounded rows."""
    ROWS, C, B, _ = problem
    C.WORK[0] += MATRIX_WORK * N * N
    bodies = 0
    for i in range(N):
        if kind[i] == 2:
            bodies = max(bodies, B.END[at[i], 0] + 1, B.END[at[i], 1] + 1)
        else:
            bodies = max(bodies, ROWS[at[i]].a + 1, ROWS[at[i]].b + 1)
    for w in range(len(C.BODY)):
        bodies = max(bodies, C.BODY[w] + 1)
    for w in range(B.AT[B.NUMBER[0]]):
        bodies = max(bodies, B.BODY[w] + 1)
    V, MOVED = np.zeros((bodies, 3)), np.full(bodies, -1, np.int64)  # the last column that moves each body
    for j in range(N):
        c = at[j]
        BODY, first, last = (B.BODY, B.AT[c], B.AT[c + 1]) if kind[j] == 2 else (C.BODY, C.AT[c], C.AT[c + 1])
        for w in range(first, last):
            q = BODY[w]
            for k in range(3):
                if kind[j] == 2:
                    V[q, k] = B.N[w, k]
                else:
                    V[q, k] = C.T[w, k] if kind[j] == 1 else C.N[w, k] + slope[c] * C.T[w, k]
            if V[q, 0] != 0.0 or V[q, 1] != 0.0 or V[q, 2] != 0.0:
                MOVED[q] = j
        for i in range(N):
            z = at[i]
            if kind[i] == 2:
                W[i, j] = bounded_rate(B, z, V)
                continue
            row = ROWS[z]
            if MOVED[row.a] != j and MOVED[row.b] != j:
                W[i, j] = 0.0
            else:
                W[i, j] = normal_rate(row, V) if kind[i] == 0 else slip_rate(row, V)
        for w in range(first, last):
            for k in range(3):
                V[BODY[w], k] = 0.0
        W[j, j] += abs(W[j, j]) / COLUMN_PROXIMAL


matrix = Choice(matrix_unjointed, matrix_jointed)


@kernel
def solve_dense(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, passes: int, tolerance: float, shared: bool
) -> tuple[float, int]:
    """Solve on the active contacts of L; arguments and results as of `sparse.solve_sparse`.

    Where energy limits friction, beta (u_t- + u_t+) = -lam (u_n- + b): if `shared`, another contact of the same face
    has u_t+ = 0, and beta follows lam as in slip.
    """
    ROWS, m = problem.ROWS, problem.m
    active, stuck, slope, target_t = classify(ROWS, L, V, m)
    # Unknowns: of contact `at`, the normal impulse (`kind` 0) or the tangential one (1).
    at, kind, N = np.empty(2 * m, np.int64), np.empty(2 * m, np.int64), 0
    for i in range(m):
        if active[i] == 0:
            continue
        if shared and stuck[i] == 2:
            stuck[i] = 0
            slope[i] = -min(ROWS[i].un + ROWS[i].target, 0.0) / ROWS[i].ut
        at[N], kind[N] = i, 0
        N += 1
        if stuck[i] != 0:
            at[N], kind[N] = i, 1
            N += 1
        else:
            L[i, 1] = slope[i] * L[i, 0]
    W, order, r, x = np.empty((N, N)), np.empty(N, np.int64), np.empty(N), np.empty(N)
    matrix(problem, slope, at, kind, N, W)
    decompose_dense(W, N, order)
    velocities(problem, L, FREE, V)
    worst = np.inf
    for done in range(passes + 1):
        last = worst
        worst = 0.0
        for k in range(N):
            i = at[k]
            if kind[k] == 0:
                r[k] = ROWS[i].target - normal_rate(ROWS[i], V)
            else:
                if stuck[i] == 2 and L[i, 1] != 0.0:
                    target_t[i] = lossless_slip(ROWS[i], L[i, 0], L[i, 1])
                r[k] = target_t[i] - tangent_rate(ROWS[i], V)
            worst = max(worst, abs(r[k]))
        if worst <= tolerance or done == passes or worst > 0.5 * last:
            break
        solve_factors(W, N, order, r, x)
        for k in range(N):
            i = at[k]
            L[i, kind[k]] += x[k]
            if kind[k] == 0 and stuck[i] == 0:
                L[i, 1] = slope[i] * L[i, 0]
        velocities(problem, L, FREE, V)
    return worst, clamp(problem, L, FREE, V)

"""Sparse Cholesky factor of B = 1 + sum R j j^T / A_jj over active rows j, in blocks of one body.

Rows are scaled by the roots of the inverse masses: j = sqrt(M^-1) times the row of G or T. So B is 1 for bodies that
impulses do not move, dimensionless, and insensitive to mass ratios.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Problem
from ..model.parameters.impulses import FACTOR_LEAST
from .dissection import contact_neighbours, dissect, pattern


class Factor(NamedTuple):
    """A symmetric matrix in blocks of one body, and its factor in the same memory.

    SCALE (k, 3): roots of the inverse masses and moments. place (n,): position of a body in the order of elimination.
    rows: of the blocks below the diagonal, those of column j at columns[j] : columns[j + 1]. DIAGONAL (n, 3, 3), BELOW
    (len(rows), 3, 3): the blocks.
    """

    SCALE: FloatArray
    place: IntArray
    columns: IntArray
    rows: IntArray
    DIAGONAL: FloatArray
    BELOW: FloatArray


@kernel
def make_factor(problem: Problem, used: IntArray) -> Factor:
    """Room for the factor of the bodies of a problem with the contacts with used[i] != 0, its order, and its scale."""
    ROWS, IM, II, POSE, n, m = problem
    SCALE = np.empty((len(IM), 3))
    for i in range(len(IM)):
        SCALE[i, 0] = SCALE[i, 1] = math.sqrt(IM[i])
        SCALE[i, 2] = math.sqrt(II[i])
    start, other = contact_neighbours(ROWS, m, n, used)
    place = np.empty(n, np.int64)
    dissect(POSE, n, start, other, place)
    columns, rows = pattern(n, start, other, place)
    return Factor(SCALE, place, columns, rows, np.empty((n, 3, 3)), np.empty((len(rows), 3, 3)))


@kernel
def assemble_blocks(problem: Problem, active: IntArray, stuck: IntArray, R: float, factor: Factor) -> None:
    """Write the blocks of B to `factor`, for the normal rows of contacts with active[i] = 1, and the tangential ones
    with stuck[i] != 0."""
    ROWS, _, _, _, n, m = problem
    SCALE, place, columns, rows, DIAGONAL, BELOW = factor
    DIAGONAL[:] = 0.0
    BELOW[:] = 0.0
    for j in range(n):
        for p in range(3):
            DIAGONAL[j, p, p] = 1.0
    ja, jb = np.empty(3), np.empty(3)
    for i in range(m):
        a, b, nx, ny = ROWS[i].a, ROWS[i].b, ROWS[i].nx, ROWS[i].ny
        for kind in range(2):
            if kind == 0:
                if active[i] == 0:
                    continue
                weight = R * ROWS[i].k_n
                ja[0], ja[1], ja[2] = -nx, -ny, -ROWS[i].arm_na
                jb[0], jb[1], jb[2] = nx, ny, ROWS[i].arm_nb
            else:
                if stuck[i] == 0:
                    continue
                weight = R * ROWS[i].k_t
                ja[0], ja[1], ja[2] = ny, -nx, -ROWS[i].arm_ta
                jb[0], jb[1], jb[2] = -ny, nx, ROWS[i].arm_tb
            for p in range(3):
                ja[p] *= SCALE[a, p]
                jb[p] *= SCALE[b, p]
            if a < n:
                k = place[a]
                for p in range(3):
                    for q in range(3):
                        DIAGONAL[k, p, q] += weight * ja[p] * ja[q]
            if b < n:
                k = place[b]
                for p in range(3):
                    for q in range(3):
                        DIAGONAL[k, p, q] += weight * jb[p] * jb[q]
            if a < n and b < n:
                low, high = min(place[a], place[b]), max(place[a], place[b])
                s, e = columns[low], columns[low + 1]
                while s < e:
                    h = (s + e) // 2
                    if rows[h] < high:
                        s = h + 1
                    else:
                        e = h
                for p in range(3):
                    for q in range(3):
                        if high == place[b]:
                            BELOW[s, p, q] += weight * jb[p] * ja[q]
                        else:
                            BELOW[s, p, q] += weight * ja[p] * jb[q]


@kernel
def factor_blocks(factor: Factor) -> None:
    """Left-looking Cholesky factorisation in place: DIAGONAL gets lower triangles, BELOW the blocks under them.

    Column k acts next on column rows[first[k]], in whose chain (`head`, then `after`) it is until then.
    """
    columns, rows, D, X = factor.columns, factor.rows, factor.DIAGONAL, factor.BELOW
    n = len(D)
    head, after, where = np.full(n, -1, np.int64), np.full(n, -1, np.int64), np.full(n, -1, np.int64)
    first = np.zeros(n, np.int64)
    for j in range(n):
        for q in range(columns[j], columns[j + 1]):
            where[rows[q]] = q
        k = head[j]
        while k != -1:
            follower, f = after[k], first[k]
            x00, x01, x02 = X[f, 0, 0], X[f, 0, 1], X[f, 0, 2]
            x10, x11, x12 = X[f, 1, 0], X[f, 1, 1], X[f, 1, 2]
            x20, x21, x22 = X[f, 2, 0], X[f, 2, 1], X[f, 2, 2]
            D[j, 0, 0] -= x00 * x00 + x01 * x01 + x02 * x02
            D[j, 1, 0] -= x10 * x00 + x11 * x01 + x12 * x02
            D[j, 1, 1] -= x10 * x10 + x11 * x11 + x12 * x12
            D[j, 2, 0] -= x20 * x00 + x21 * x01 + x22 * x02
            D[j, 2, 1] -= x20 * x10 + x21 * x11 + x22 * x12
            D[j, 2, 2] -= x20 * x20 + x21 * x21 + x22 * x22
            for q in range(f + 1, columns[k + 1]):
                t = where[rows[q]]
                for p in range(3):
                    y0, y1, y2 = X[q, p, 0], X[q, p, 1], X[q, p, 2]
                    X[t, p, 0] -= y0 * x00 + y1 * x01 + y2 * x02
                    X[t, p, 1] -= y0 * x10 + y1 * x11 + y2 * x12
                    X[t, p, 2] -= y0 * x20 + y1 * x21 + y2 * x22
            if f + 1 < columns[k + 1]:
                first[k] = f + 1
                r = rows[f + 1]
                after[k] = head[r]
                head[r] = k
            k = follower
        # B >= 1 in exact arithmetic; for large R round-off may violate that.
        d00 = math.sqrt(max(D[j, 0, 0], FACTOR_LEAST))
        d10, d20 = D[j, 1, 0] / d00, D[j, 2, 0] / d00
        d11 = math.sqrt(max(D[j, 1, 1] - d10 * d10, FACTOR_LEAST))
        d21 = (D[j, 2, 1] - d20 * d10) / d11
        d22 = math.sqrt(max(D[j, 2, 2] - d20 * d20 - d21 * d21, FACTOR_LEAST))
        D[j, 0, 0], D[j, 1, 0], D[j, 2, 0] = d00, d10, d20
        D[j, 1, 1], D[j, 2, 1], D[j, 2, 2] = d11, d21, d22
        for q in range(columns[j], columns[j + 1]):
            for p in range(3):
                y0 = X[q, p, 0] / d00
                y1 = (X[q, p, 1] - y0 * d10) / d11
                X[q, p, 2] = (X[q, p, 2] - y0 * d20 - y1 * d21) / d22
                X[q, p, 0], X[q, p, 1] = y0, y1
        if columns[j] < columns[j + 1]:
            first[j] = columns[j]
            r = rows[columns[j]]
            after[j] = head[r]
            head[r] = j


@nonallocating
def solve_blocks(factor: Factor, f: FloatArray) -> None:
    """Replace f (n, 3), in the order of elimination, by B^-1 f."""
    columns, rows, D, X = factor.columns, factor.rows, factor.DIAGONAL, factor.BELOW
    n = len(D)
    for j in range(n):
        f[j, 0] /= D[j, 0, 0]
        f[j, 1] = (f[j, 1] - D[j, 1, 0] * f[j, 0]) / D[j, 1, 1]
        f[j, 2] = (f[j, 2] - D[j, 2, 0] * f[j, 0] - D[j, 2, 1] * f[j, 1]) / D[j, 2, 2]
        for q in range(columns[j], columns[j + 1]):
            i = rows[q]
            for p in range(3):
                f[i, p] -= X[q, p, 0] * f[j, 0] + X[q, p, 1] * f[j, 1] + X[q, p, 2] * f[j, 2]
    for j in range(n - 1, -1, -1):
        for q in range(columns[j], columns[j + 1]):
            i = rows[q]
            for p in range(3):
                f[j, p] -= X[q, 0, p] * f[i, 0] + X[q, 1, p] * f[i, 1] + X[q, 2, p] * f[i, 2]
        f[j, 2] /= D[j, 2, 2]
        f[j, 1] = (f[j, 1] - D[j, 2, 1] * f[j, 2]) / D[j, 1, 1]
        f[j, 0] = (f[j, 0] - D[j, 1, 0] * f[j, 1] - D[j, 2, 0] * f[j, 2]) / D[j, 0, 0]

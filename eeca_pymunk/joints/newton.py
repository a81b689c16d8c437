"""The linear systems of Newton's method for the implicit step of an island.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2:

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target.

The linear systems are banded, scaled by sqrt(M) and by the diagonal of G M^-1 G^T; `epsilon` on the impulses' block
takes redundant rows (it acts on increments alone, so the solution is that of the equations above). `give` > 0 makes
rows elastic: g - target + (give h / 2 SCALE^2) lam = 0.
Soft rows follow Alart and Curnier: with p = lam - u/A, A = 1/SCALE^2, either |p| <= bound and u = 0 or lam = bound p/|p|.
"""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .layout import GROOVE, RATCHET, ROTARY_LIMIT, SLIDE
from .rows import joint_rows
from .scratch import (
    BOUND,
    COLUMN,
    FORCE,
    FREEDOMS,
    FULL_BEND,
    GOT,
    L_A,
    L_B,
    L_KIND,
    L_ROW,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LAM,
    MOBILITY,
    NO_BEND,
    ROWS,
    SCALE,
    SIZE,
    SLOPES,
    STIFFNESS,
    TARGET,
    VALUE,
    FloatArray,
    IntArray,
)  # fmt: skip


@kernel
def held(link: IntArray, k: int, r: int) -> bool:
    """Whether row r of joint k acts: rows of limits do where the joint stands on one."""
    kind = link[k, L_KIND]
    if kind == GROOVE:
        return r == 0 or link[k, L_SIDE] != 0
    limited = kind in (SLIDE, ROTARY_LIMIT, RATCHET)
    return not limited or link[k, L_SIDE] != 0


@kernel
def scale_rows(link: IntArray, hinge: FloatArray, local: FloatArray, k: int, one: FloatArray) -> None:
    """SCALE of the rows of joint k, whose J is in `one`."""
    a, b = link[k, L_A], link[k, L_B]
    for r in range(link[k, L_ROWS]):
        total = 0.0
        for c in range(3):
            total += local[a, MOBILITY + c] * one[ROWS + r, c] ** 2 + local[b, MOBILITY + c] * one[ROWS + r, 3 + c] ** 2
        hinge[k, SCALE + r] = 1.0 / np.sqrt(total) if total > 0.0 else 1.0


@kernel
def put_bodies(local: FloatArray, node: IntArray, bodies: int, band: int, matrix: FloatArray) -> None:
    """Ones on the diagonal of all bodies' unknowns: their masses, scaled."""
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            matrix[node[i, COLUMN] + c, band] = 1.0


@kernel
def put_rows(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, one: FloatArray, slopes: int,
    band: int, matrix: FloatArray,
) -> None:  # fmt: skip
    """Scaled rows G (those of `one` at `slopes`) and columns -J^T of joint k."""
    row = link[k, L_ROW]
    for r in range(link[k, L_ROWS]):
        if not held(link, k, r):
            continue
        for end in range(2):
            i = link[k, L_A + end]
            column = node[i, COLUMN]
            for c in range(node[i, FREEDOMS]):
                scale = hinge[k, SCALE + r] * np.sqrt(local[i, MOBILITY + c])
                d = column + c - (row + r)
                matrix[row + r, d + band] += one[slopes + r, 3 * end + c] * scale
                matrix[column + c, band - d] -= one[ROWS + r, 3 * end + c] * scale


@kernel
def put_stiffness(
    link: IntArray, local: FloatArray, node: IntArray, k: int, one: FloatArray, bend: int, h: float, band: int,
    matrix: FloatArray,
) -> None:  # fmt: skip
    """-(h/2) dF/dx of joint k, scaled."""
    for end in range(2):
        i = link[k, L_A + end]
        for other in range(2):
            if bend != FULL_BEND and end != other:
                continue
            m = link[k, L_A + other]
            for c in range(0 if bend == FULL_BEND else 2, node[i, FREEDOMS]):
                factor = 0.5 * h * np.sqrt(local[i, MOBILITY + c])
                row = node[i, COLUMN] + c
                for d in range(0 if bend == FULL_BEND else 2, node[m, FREEDOMS]):
                    entry = one[STIFFNESS + 3 * end + c, 3 * other + d] * factor * np.sqrt(local[m, MOBILITY + d])
                    matrix[row, node[m, COLUMN] + d - row + band] -= entry


@kernel
def put_soft(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, one: FloatArray, h: float,
    band: int, matrix: FloatArray, right: FloatArray,
) -> float:  # fmt: skip
    """Rows of velocity of joint k with bounded impulses; the residual as a length."""
    row, rows, bound = link[k, L_ROW], link[k, L_ROWS], hinge[k, BOUND] * abs(h)
    if link[k, L_KIND] == GROOVE:
        rows = 1 if link[k, L_SIDE] == 0 else 2
        for r in range(rows, 2):
            matrix[row + r, band] = 1.0
            right[row + r] = -hinge[k, LAM + r] / hinge[k, SCALE + r]
    low, high = -bound, bound
    kind, side = link[k, L_KIND], link[k, L_SIDE]
    if kind in (SLIDE, ROTARY_LIMIT, RATCHET):
        low, high = (0.0, bound) if side < 0 else (-bound, 0.0)
    rho = hinge[k, SCALE] ** 2
    if rows == 2:
        rho = min(rho, hinge[k, SCALE + 1] ** 2)
    p0 = hinge[k, LAM] - rho * one[VALUE, 0] * 2.0 / h
    p1 = hinge[k, LAM + 1] - rho * one[VALUE, 1] * 2.0 / h if rows == 2 else 0.0
    size = np.sqrt(p0 * p0 + p1 * p1)
    sticks = low <= p0 <= high if rows == 1 else size <= bound
    worst = 0.0
    for r in range(rows):
        scale = hinge[k, SCALE + r]
        if sticks:
            right[row + r] = -one[VALUE, r] * scale * 2.0 / h
            worst = max(worst, abs(one[VALUE, r]))
        elif rows == 1:
            off = hinge[k, LAM] - min(max(p0, low), high)
            matrix[row, band] = 1.0
            right[row] = -off / scale
            worst = abs(off) * abs(h) / scale**2
        else:
            p_r = p0 if r == 0 else p1
            off = hinge[k, LAM + r] - bound * p_r / size
            right[row + r] = -off / scale
            worst = max(worst, abs(off) * abs(h) / scale**2)
    for r in range(rows):
        if rows == 1 and not sticks:
            break
        scale = hinge[k, SCALE + r]
        for q in range(rows):
            if sticks:
                if q != r:
                    continue
                weight = scale
            else:
                p_r, p_q = p0 if r == 0 else p1, p0 if q == 0 else p1
                turn = ((1.0 if q == r else 0.0) - p_r * p_q / size**2) * bound / size
                matrix[row + r, row + q - row - r + band] += (
                    ((1.0 if q == r else 0.0) - turn) * hinge[k, SCALE + q] / scale
                )
                weight = turn * rho / scale
            for end in range(2):
                i = link[k, L_A + end]
                for c in range(node[i, FREEDOMS]):
                    d = node[i, COLUMN] + c - (row + r)
                    matrix[row + r, d + band] += weight * one[SLOPES + q, 3 * end + c] * np.sqrt(local[i, MOBILITY + c])
    for r in range(rows):
        for end in range(2):
            i = link[k, L_A + end]
            for c in range(node[i, FREEDOMS]):
                d = node[i, COLUMN] + c - (row + r)
                scale = hinge[k, SCALE + r] * np.sqrt(local[i, MOBILITY + c])
                matrix[node[i, COLUMN] + c, band - d] -= one[ROWS + r, 3 * end + c] * scale
    return worst


@kernel
def assemble(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, give: float, first: bool, band: int, matrix: FloatArray, right: FloatArray, one: FloatArray,
) -> float:  # fmt: skip
    """The scaled linear system of a Newton step; how far g is from its targets, over the size of the island."""
    worst = 0.0
    for i in range(bodies):
        local[i, GOT] = local[i, GOT + 1] = local[i, GOT + 2] = 0.0
    put_bodies(local, node, bodies, band, matrix)
    for k in range(joints):
        bend = joint_rows(joint, hinge, link, k, local, h, one)
        a, b = link[k, L_A], link[k, L_B]
        if link[k, L_ROWS] == 0 or held(link, k, 0):
            for c in range(3):
                local[a, GOT + c] += one[FORCE, c]
                local[b, GOT + c] += one[FORCE, 3 + c]
            if bend != NO_BEND:
                put_stiffness(link, local, node, k, one, bend, h, band, matrix)
        if first:
            scale_rows(link, hinge, local, k, one)
        if link[k, L_SOFT] != 0 and held(link, k, 0):
            worst = max(worst, put_soft(link, hinge, local, node, k, one, h, band, matrix, right) / hinge[k, SIZE])
            continue
        put_rows(link, hinge, local, node, k, one, SLOPES, band, matrix)
        for r in range(link[k, L_ROWS]):
            row, scale = link[k, L_ROW] + r, hinge[k, SCALE + r]
            if held(link, k, r):
                error = one[VALUE, r] - hinge[k, TARGET + r] + give * 0.5 * h * hinge[k, LAM + r] / scale**2
                matrix[row, band] += give
                right[row] = -error * scale * 2.0 / h
                worst = max(worst, abs(error) / hinge[k, SIZE])
            else:
                matrix[row, band] = 1.0
                right[row] = -hinge[k, LAM + r] / scale
    return worst

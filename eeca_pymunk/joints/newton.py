"""The linear systems of Newton's method for the implicit step of an island.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2:

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target.

Systems are scaled by sqrt(M) and by the diagonal of G M^-1 G^T. `give` > 0 makes rows elastic:
g - target + (give h / 2 SCALE^2) lam = 0. Soft rows follow Alart and Curnier: with p = lam - u/A, A = 1/SCALE^2, either
|p| <= bound and u = 0, or lam = bound p/|p|.

The same systems with `still` bodies (h v_m = 0) correct poses, M dq = G^T mu, g(q + dq) = target, and velocities,
M dv = G^T lam, G (v + dv) = 0. A *condensed* system has the bodies' unknowns alone: see `condensed`.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .layout import GROOVE, RATCHET, ROTARY_LIMIT, SLIDE
from .rows import joint_rows
from .scratch import (
    BEFORE,
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
    LINEAR_STEP,
    MOBILITY,
    NO_BEND,
    POSES,
    ROOT,
    ROWS,
    SCALE,
    SIZE,
    SLOPES,
    SPEEDS,
    STEP,
    STIFFEST,
    TARGET,
    VALUE,
    WAY,
    WEIGHT,
)


@uncounted
def held(link: IntArray, k: int, r: int) -> bool:
    """Whether row r of joint k acts: rows of limits do where the joint stands on one."""
    kind = link[k, L_KIND]
    if kind == GROOVE:
        return r == 0 or link[k, L_SIDE] != 0
    return kind not in (SLIDE, ROTARY_LIMIT, RATCHET) or link[k, L_SIDE] != 0


@uncounted
def along(hinge: FloatArray, link: IntArray, k: int, row: int, local: FloatArray, column: int) -> float:
    """The six entries of joint k at `row` of `hinge` times those of its bodies at `column` of `local`."""
    a, b = link[k, L_A], link[k, L_B]
    total = 0.0
    for c in range(3):
        total += hinge[k, row + c] * local[a, column + c] + hinge[k, row + 3 + c] * local[b, column + c]
    return total


@uncounted
def put_rows(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, r: int, slopes: int, weight: float,
    band: int, matrix: FloatArray,
) -> None:  # fmt: skip
    """Scaled row G (at `slopes` of `hinge`, times `weight`) and, with weight 1, column -J^T of row r of joint k."""
    row, scale = link[k, L_ROW] + r, hinge[k, SCALE + r]
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            root = scale * local[i, ROOT + c]
            d = node[i, COLUMN] + c - row
            at = 6 * r + 3 * end + c
            matrix[row, d + band] += weight * hinge[k, slopes + at] * root
            matrix[row + d, band - d] -= hinge[k, ROWS + at] * root


@uncounted
def put_condensed(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, r: int, slopes: int, band: int,
    matrix: FloatArray,
) -> None:  # fmt: skip
    """WEIGHT J^T G of row r of joint k, scaled, into the bodies' unknowns."""
    weight = hinge[k, WEIGHT + r] * hinge[k, SCALE + r] ** 2
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            factor = weight * hinge[k, ROWS + 6 * r + 3 * end + c] * local[i, ROOT + c]
            row = node[i, COLUMN] + c
            for other in range(2):
                m = link[k, L_A + other]
                at, first = slopes + 6 * r + 3 * other, node[m, COLUMN] - row + band
                for d in range(node[m, FREEDOMS]):
                    matrix[row, first + d] += factor * hinge[k, at + d] * local[m, ROOT + d]


@uncounted
def put_stiffness(
    link: IntArray, local: FloatArray, node: IntArray, k: int, stiff: FloatArray, bend: int, h: float, band: int,
    matrix: FloatArray,
) -> None:  # fmt: skip
    """-(h/2) dF/dx of joint k, scaled."""
    low = 0 if bend == FULL_BEND else 2
    for end in range(2):
        i = link[k, L_A + end]
        for other in range(2):
            if bend != FULL_BEND and end != other:
                continue
            m = link[k, L_A + other]
            for c in range(low, node[i, FREEDOMS]):
                factor = 0.5 * h * local[i, ROOT + c]
                row = node[i, COLUMN] + c
                first = node[m, COLUMN] - row + band
                for d in range(low, node[m, FREEDOMS]):
                    matrix[row, first + d] -= stiff[3 * end + c, 3 * other + d] * factor * local[m, ROOT + d]


@uncounted
def put_soft(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, slopes: int, h: float,
    condensed: bool, band: int, matrix: FloatArray, right: FloatArray,
) -> float:  # fmt: skip
    """Rows of velocity of joint k with bounded impulses; the residual as a length."""
    row, rows, bound = link[k, L_ROW], link[k, L_ROWS], hinge[k, BOUND] * abs(h)
    kind, side = link[k, L_KIND], link[k, L_SIDE]
    if kind == GROOVE and side == 0:
        rows = 1
        put_free(link, hinge, k, rows, condensed, band, matrix, right)
    low, high = -bound, bound
    if kind in (SLIDE, ROTARY_LIMIT, RATCHET):
        low, high = (0.0, bound) if side < 0 else (-bound, 0.0)
    rho = hinge[k, SCALE] ** 2
    if rows == 2:
        rho = min(rho, hinge[k, SCALE + 1] ** 2)
    p0 = hinge[k, LAM] - rho * hinge[k, VALUE] * 2.0 / h
    p1 = hinge[k, LAM + 1] - rho * hinge[k, VALUE + 1] * 2.0 / h if rows == 2 else 0.0
    size = np.sqrt(p0 * p0 + p1 * p1)
    sticks = low <= p0 <= high if rows == 1 else size <= bound
    worst = 0.0
    for r in range(rows):
        scale = hinge[k, SCALE + r]
        if sticks:
            off = hinge[k, VALUE + r]
            worst = max(worst, abs(off))
            right[row + r] = -off * scale * 2.0 / h
            hinge[k, WEIGHT + r] = STIFFEST
            if condensed:
                put_condensed(link, hinge, local, node, k, r, slopes, band, matrix)
            else:
                put_rows(link, hinge, local, node, k, r, slopes, 1.0, band, matrix)
            continue
        p_r = p0 if r == 0 else p1
        goal = min(max(p0, low), high) if rows == 1 else bound * p_r / size
        off = hinge[k, LAM + r] - goal
        worst = max(worst, abs(off * h) / scale**2)
        right[row + r] = -off / scale
        hinge[k, WEIGHT + r] = -1.0
        if condensed:
            continue
        put_rows(link, hinge, local, node, k, r, slopes, 0.0, band, matrix)
        if rows == 1:
            matrix[row, band] += 1.0
            continue
        for q in range(2):
            same = 1.0 if q == r else 0.0
            turn = (same - p_r * (p0 if q == 0 else p1) / size**2) * bound / size
            matrix[row + r, q - r + band] += (same - turn) * hinge[k, SCALE + q] / scale
            for end in range(2):
                i = link[k, L_A + end]
                for c in range(node[i, FREEDOMS]):
                    slope = hinge[k, SLOPES + 6 * q + 3 * end + c] * local[i, ROOT + c]
                    matrix[row + r, node[i, COLUMN] + c - row - r + band] += turn * rho / scale * slope
    return worst


@uncounted
def put_free(
    link: IntArray, hinge: FloatArray, k: int, r: int, condensed: bool, band: int, matrix: FloatArray,
    right: FloatArray,
) -> None:  # fmt: skip
    """A row that does not act: its impulse becomes 0."""
    row = link[k, L_ROW] + r
    hinge[k, WEIGHT + r] = 0.0
    right[row] = -hinge[k, LAM + r] / hinge[k, SCALE + r]
    if not condensed:
        matrix[row, band] = 1.0


@uncounted
def assemble(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, give: float, first: bool, condensed: bool, band: int, matrix: FloatArray,
    right: FloatArray, stiff: FloatArray,
) -> float:  # fmt: skip
    """The scaled linear system for `what` (see `scratch`), and the joints' rows in `hinge`.

    Returns how far rows are from their targets, over the size of the island; for SPEEDS, the worst G v.
    """
    worst = 0.0
    still = what in (POSES, SPEEDS)
    slopes = SLOPES if what == STEP else ROWS
    for i in range(bodies):
        for c in range(3):
            local[i, GOT + c] = 0.0
        for c in range(node[i, FREEDOMS]):
            matrix[node[i, COLUMN] + c, band] += 1.0
    for k in range(joints):
        bend = joint_rows(joint, hinge, link, k, local, h, stiff)
        a, b = link[k, L_A], link[k, L_B]
        if first:
            scale_rows(link, hinge, local, k)
        if not still and (link[k, L_ROWS] == 0 or held(link, k, 0)):
            for c in range(3):
                local[a, GOT + c] += hinge[k, FORCE + c]
                local[b, GOT + c] += hinge[k, FORCE + 3 + c]
            if bend != NO_BEND:
                put_stiffness(link, local, node, k, stiff, bend, h, band, matrix)
        soft = link[k, L_SOFT] != 0
        if soft and not still and held(link, k, 0):
            worst = max(
                worst, put_soft(link, hinge, local, node, k, slopes, h, condensed, band, matrix, right) / hinge[k, SIZE]
            )
            continue
        for r in range(link[k, L_ROWS]):
            if soft or not held(link, k, r):
                put_free(link, hinge, k, r, condensed, band, matrix, right)
                continue
            scale = hinge[k, SCALE + r]
            if what == SPEEDS:
                error = along(hinge, link, k, ROWS + 6 * r, local, BEFORE)
            elif what == LINEAR_STEP:
                error = along(hinge, link, k, ROWS + 6 * r, local, WAY)
            else:
                error = hinge[k, VALUE + r] - hinge[k, TARGET + r] + give * 0.5 * h * hinge[k, LAM + r] / scale**2
            right[link[k, L_ROW] + r] = -error * scale * 2.0 / h
            worst = max(worst, abs(error) / hinge[k, SIZE])
            if condensed:
                hinge[k, WEIGHT + r] = min(STIFFEST, 1.0 / give) if give > 0.0 else STIFFEST
                put_condensed(link, hinge, local, node, k, r, slopes, band, matrix)
            else:
                put_rows(link, hinge, local, node, k, r, slopes, 1.0, band, matrix)
                matrix[link[k, L_ROW] + r, band] += give
    return worst


@uncounted
def scale_rows(link: IntArray, hinge: FloatArray, local: FloatArray, k: int) -> None:
    """SCALE of the rows of joint k."""
    for r in range(link[k, L_ROWS]):
        total = 0.0
        for end in range(2):
            i = link[k, L_A + end]
            for c in range(3):
                total += local[i, MOBILITY + c] * hinge[k, ROWS + 6 * r + 3 * end + c] ** 2
        hinge[k, SCALE + r] = 1.0 / np.sqrt(total) if total > 0.0 else 1.0

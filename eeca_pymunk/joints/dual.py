"""Systems of islands in the joints' rows alone, the bodies' unknowns eliminated: S lam = c - G A^-1 b, S = G A^-1 J^T.

A, the bodies' part of Newton's matrix, is taken to be diagonal: the masses, and of the bending of rows what is between
a body and itself. For pivots that is all there is; for other joints without springs what is left out is of the order
(h rate)^2, by which errors shrink at each iteration. `solve` takes the whole system where that is too slow.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import merged
from .condensed import factor, substitute
from .scratch import (
    COLUMN,
    DUAL_BAND,
    DUAL_SIZE,
    FIRST,
    FREEDOMS,
    FROZEN,
    INERTIA,
    L_A,
    L_DUAL,
    L_NEXT,
    L_ROW,
    L_ROWS,
    ROOT,
    ROWS,
    SCALE,
    WEIGHT,
)

STRIDE = 6  # of scratch per row
LEAST = 0.1  # of a body's inertia, that the bending of rows may leave


@merged
def freeze(
    hinge: FloatArray, k: int, end: int, r: int, slopes: int, x: float, y: float, z: float
) -> None:  # fmt: skip
    """Keep row r of joint k at one end, J and G, at FROZEN: scaled by its SCALE and the body's roots x, y, z."""
    scale = hinge[k, SCALE + r] if hinge[k, WEIGHT + r] != 0.0 else 0.0
    u, v, w, at = scale * x, scale * y, scale * z, 6 * r + 3 * end
    for first, to in ((ROWS + at, FROZEN + at), (slopes + at, FROZEN + 12 + at)):
        hinge[k, to] = u * hinge[k, first]
        hinge[k, to + 1] = v * hinge[k, first + 1]
        hinge[k, to + 2] = w * hinge[k, first + 2]


@merged
def factor_dual(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int, slopes: int,
    add: float, span: IntArray, matrix: FloatArray, more: FloatArray, numbers: IntArray,
) -> bool:  # fmt: skip
    """LU factors of S + `add` in `matrix`; False if there are none that can be trusted.

    Args:
        slopes: where the rows G stand in `hinge`; they and the rows J are kept at FROZEN, scaled.
        span: the island's row of SPAN.  more, numbers: scratch, STRIDE and 1 times the rows.
        local: INERTIA, the diagonal of A as `newton.assemble` left it; its reciprocal on return.
    """
    size, band = span[DUAL_SIZE], span[DUAL_BAND]
    width = 2 * band + 1
    for i in range(size * width):
        matrix[i] = 0.0
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            matrix[(link[k, L_DUAL] + r) * width + band] = add if hinge[k, WEIGHT + r] != 0.0 else 1.0
    for i in range(bodies):
        freedoms = node[i, FREEDOMS]
        if freedoms == 0:
            continue
        a, b, c = local[i, INERTIA], local[i, INERTIA + 1], local[i, INERTIA + 2] if freedoms > 2 else 1.0
        if not (a > LEAST and b > LEAST and c > LEAST):
            return False
        a, b, c = 1.0 / a, 1.0 / b, 1.0 / c
        local[i, INERTIA], local[i, INERTIA + 1], local[i, INERTIA + 2] = a, b, c
        x, y, z = local[i, ROOT], local[i, ROOT + 1], local[i, ROOT + 2] if freedoms > 2 else 0.0
        # The rows on this body, then all pairs of them.
        count, one = 0, node[i, FIRST]
        while one >= 0:
            k, end = one >> 1, one & 1
            for r in range(link[k, L_ROWS]):
                freeze(hinge, k, end, r, slopes, x, y, z)
                at, p = FROZEN + 6 * r + 3 * end, STRIDE * count
                more[p], more[p + 1], more[p + 2] = hinge[k, at], hinge[k, at + 1], hinge[k, at + 2]
                more[p + 3], more[p + 4] = hinge[k, at + 12] * a, hinge[k, at + 13] * b
                more[p + 5] = hinge[k, at + 14] * c
                numbers[count] = link[k, L_DUAL] + r
                count += 1
            one = link[k, L_NEXT + end]
        for m in range(count):
            p = STRIDE * m
            gx, gy, gw = more[p + 3], more[p + 4], more[p + 5]
            begin = numbers[m] * 2 * band + band
            for n in range(count):
                q = STRIDE * n
                matrix[begin + numbers[n]] += gx * more[q] + gy * more[q + 1] + gw * more[q + 2]
    return factor(matrix, size, band)


@merged
def refresh(hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, slopes: int) -> None:
    """Let the rows that `back_dual` takes be those of now, though the factors are of an earlier iterate: they say how
    impulses change velocities, and in long steps these rows turn."""
    for k in range(joints):
        for end in range(2):
            i = link[k, L_A + end]
            if node[i, FREEDOMS] == 0:
                continue
            x, y, z = local[i, ROOT], local[i, ROOT + 1], local[i, ROOT + 2] if node[i, FREEDOMS] > 2 else 0.0
            for r in range(link[k, L_ROWS]):
                freeze(hinge, k, end, r, slopes, x, y, z)


@merged
def back_dual(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int, span: IntArray,
    matrix: FloatArray, right: FloatArray, more: FloatArray,
) -> None:  # fmt: skip
    """Solve with the factors of `factor_dual` in place of `right`, bodies and rows; `more` is scratch for the rows."""
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            right[node[i, COLUMN] + c] *= local[i, INERTIA + c]
    for k in range(joints):
        rows, row = link[k, L_ROWS], link[k, L_ROW]
        for r in range(rows):
            more[link[k, L_DUAL] + r] = right[row + r]
        for end in range(2):
            i = link[k, L_A + end]
            first, freedoms = node[i, COLUMN], node[i, FREEDOMS]
            if freedoms == 0:
                continue
            x, y, w = right[first], right[first + 1], right[first + 2] if freedoms > 2 else 0.0
            for r in range(rows):
                at = FROZEN + 12 + 6 * r + 3 * end
                more[link[k, L_DUAL] + r] -= hinge[k, at] * x + hinge[k, at + 1] * y + hinge[k, at + 2] * w
    substitute(matrix, span[DUAL_SIZE], span[DUAL_BAND], more, 0)
    for k in range(joints):
        rows, row = link[k, L_ROWS], link[k, L_ROW]
        for r in range(rows):
            right[row + r] = more[link[k, L_DUAL] + r]
        for end in range(2):
            i = link[k, L_A + end]
            first, freedoms = node[i, COLUMN], node[i, FREEDOMS]
            if freedoms == 0:
                continue
            x = y = w = 0.0
            for r in range(rows):
                at, push = FROZEN + 6 * r + 3 * end, more[link[k, L_DUAL] + r]
                x += push * hinge[k, at]
                y += push * hinge[k, at + 1]
                w += push * hinge[k, at + 2]
            right[first] += x * local[i, INERTIA]
            right[first + 1] += y * local[i, INERTIA + 1]
            if freedoms > 2:
                right[first + 2] += w * local[i, INERTIA + 2]

"""Systems of islands in the joints' rows alone, the bodies' unknowns eliminated: S lam = c - G A^-1 b, S = G A^-1 J^T.

A, the bodies' part of Newton's matrix, is taken to be diagonal: the masses, and of the bending of rows what is between
a body and itself. For pivots that is all there is; for other joints without springs what is left out is of the order
(h rate)^2, by which errors shrink at each iteration. `solve` takes the whole system where that is too slow.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .condensed import factor, substitute
from .scratch import (
    COLUMN,
    DUAL_BAND,
    DUAL_SIZE,
    FIRST,
    FREEDOMS,
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

LEAST = 0.1  # of a body's inertia, that the bending of rows may leave


@uncounted
def factor_dual(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int, slopes: int,
    add: float, span: IntArray, matrix: FloatArray,
) -> bool:  # fmt: skip
    """LU factors of S + `add` in `matrix`; False if there are none that can be trusted.

    Args:
        slopes: where the rows G stand in `hinge`.  span: the island's row of SPAN.
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
        for c in range(freedoms):
            if not local[i, INERTIA + c] > LEAST:
                return False
            local[i, INERTIA + c] = 1.0 / local[i, INERTIA + c]
        one = node[i, FIRST]
        while one >= 0:
            k, end = one >> 1, one & 1
            for r in range(link[k, L_ROWS]):
                if hinge[k, WEIGHT + r] == 0.0:
                    continue
                g = slopes + 6 * r + 3 * end
                scale, y = hinge[k, SCALE + r], 0.0
                x = scale * hinge[k, g] * local[i, ROOT] ** 2 * local[i, INERTIA]
                if freedoms > 1:
                    y = scale * hinge[k, g + 1] * local[i, ROOT + 1] ** 2 * local[i, INERTIA + 1]
                w = scale * hinge[k, g + 2] * local[i, ROOT + 2] ** 2 * local[i, INERTIA + 2] if freedoms > 2 else 0.0
                row = link[k, L_DUAL] + r
                other = node[i, FIRST]
                while other >= 0:
                    m, side = other >> 1, other & 1
                    for s in range(link[m, L_ROWS]):
                        if hinge[m, WEIGHT + s] != 0.0:
                            j = ROWS + 6 * s + 3 * side
                            total = x * hinge[m, j] + y * hinge[m, j + 1] + w * hinge[m, j + 2]
                            matrix[row * width + link[m, L_DUAL] + s - row + band] += total * hinge[m, SCALE + s]
                    other = link[m, L_NEXT + side]
            one = link[k, L_NEXT + end]
    return factor(matrix, size, band)


@uncounted
def back_dual(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int, slopes: int,
    span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray,
) -> None:  # fmt: skip
    """Solve with the factors of `factor_dual` in place of `right`, bodies and rows; `more` is scratch for the rows."""
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            right[node[i, COLUMN] + c] *= local[i, INERTIA + c]
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            total = 0.0
            if hinge[k, WEIGHT + r] != 0.0:
                for end in range(2):
                    i = link[k, L_A + end]
                    for c in range(node[i, FREEDOMS]):
                        entry = hinge[k, slopes + 6 * r + 3 * end + c] * local[i, ROOT + c]
                        total += entry * right[node[i, COLUMN] + c]
            more[link[k, L_DUAL] + r] = right[link[k, L_ROW] + r] - hinge[k, SCALE + r] * total
    substitute(matrix, span[DUAL_SIZE], span[DUAL_BAND], more, 0)
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            push = more[link[k, L_DUAL] + r]
            right[link[k, L_ROW] + r] = push
            if hinge[k, WEIGHT + r] != 0.0:
                push *= hinge[k, SCALE + r]
                for end in range(2):
                    i = link[k, L_A + end]
                    for c in range(node[i, FREEDOMS]):
                        entry = hinge[k, ROWS + 6 * r + 3 * end + c] * local[i, ROOT + c]
                        right[node[i, COLUMN] + c] += push * entry * local[i, INERTIA + c]

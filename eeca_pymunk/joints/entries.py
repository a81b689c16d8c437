"""What one joint puts into the linear system of its island: rows, columns, stiffness, all scaled (see `newton`)."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import merged
from .layout import GROOVE, RATCHET, ROTARY_LIMIT, SLIDE
from .scratch import (
    COLUMN,
    DUAL,
    FREEDOMS,
    FROZEN,
    FULL_BEND,
    INERTIA,
    L_A,
    L_B,
    L_KIND,
    L_ROW,
    L_ROWS,
    L_SIDE,
    LAM,
    MOBILITY,
    ROOT,
    ROWS,
    SCALE,
    WEIGHT,
    WHOLE,
)


@merged
def held(link: IntArray, k: int, r: int) -> bool:
    """Whether row r of joint k acts: rows of limits do where the joint stands on one."""
    kind = link[k, L_KIND]
    if kind == GROOVE:
        return r == 0 or link[k, L_SIDE] != 0
    return kind not in (SLIDE, ROTARY_LIMIT, RATCHET) or link[k, L_SIDE] != 0


@merged
def along(hinge: FloatArray, link: IntArray, k: int, row: int, local: FloatArray, column: int) -> float:
    """The six entries of joint k at `row` of `hinge` times those of its bodies at `column` of `local`."""
    a, b = link[k, L_A], link[k, L_B]
    total = 0.0
    for c in range(3):
        total += hinge[k, row + c] * local[a, column + c] + hinge[k, row + 3 + c] * local[b, column + c]
    return total


@merged
def put_rows(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, r: int, slopes: int, weight: float,
    band: int, matrix: FloatArray,
) -> None:  # fmt: skip
    """Scaled row G (at `slopes` of `hinge`, times `weight`) and column -J^T of row r of joint k in a whole system."""
    row, scale, width = link[k, L_ROW] + r, hinge[k, SCALE + r], 3 * band + 1
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            root = scale * local[i, ROOT + c]
            d = node[i, COLUMN] + c - row
            at = 6 * r + 3 * end + c
            matrix[row * width + d + band] += weight * hinge[k, slopes + at] * root
            matrix[(row + d) * width + band - d] -= hinge[k, ROWS + at] * root


@merged
def put_condensed(
    link: IntArray, hinge: FloatArray, node: IntArray, k: int, r: int, band: int, matrix: FloatArray
) -> None:
    """WEIGHT J^T G of row r of joint k, as it has been frozen, into a condensed system."""
    weight, width = hinge[k, WEIGHT + r], 2 * band + 1
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            factor = weight * hinge[k, FROZEN + 6 * r + 3 * end + c]
            row = node[i, COLUMN] + c
            for other in range(2):
                m = link[k, L_A + other]
                at, first = FROZEN + 12 + 6 * r + 3 * other, row * width + node[m, COLUMN] - row + band
                for d in range(node[m, FREEDOMS]):
                    matrix[first + d] += factor * hinge[k, at + d]


@merged
def put_stiffness(
    link: IntArray, local: FloatArray, node: IntArray, k: int, stiff: FloatArray, bend: int, h: float, system: int,
    band: int, matrix: FloatArray,
) -> None:  # fmt: skip
    """-(h/2) dF/dx of joint k, scaled; in a dual system what is on the diagonal, into INERTIA."""
    low = 0 if bend == FULL_BEND else 2
    width = 3 * band + 1 if system == WHOLE else 2 * band + 1
    for end in range(2):
        i = link[k, L_A + end]
        if system == DUAL:
            for c in range(low, node[i, FREEDOMS]):
                local[i, INERTIA + c] -= stiff[3 * end + c, 3 * end + c] * 0.5 * h * local[i, ROOT + c] ** 2
            continue
        for other in range(2):
            if bend != FULL_BEND and end != other:
                continue
            m = link[k, L_A + other]
            for c in range(low, node[i, FREEDOMS]):
                factor = 0.5 * h * local[i, ROOT + c]
                row = node[i, COLUMN] + c
                first = row * width + node[m, COLUMN] - row + band
                for d in range(low, node[m, FREEDOMS]):
                    matrix[first + d] -= stiff[3 * end + c, 3 * other + d] * factor * local[m, ROOT + d]


@merged
def put_free(
    link: IntArray, hinge: FloatArray, k: int, r: int, system: int, build: bool, band: int, matrix: FloatArray,
    right: FloatArray,
) -> None:  # fmt: skip
    """A row that does not act: its impulse becomes 0."""
    row = link[k, L_ROW] + r
    hinge[k, WEIGHT + r] = 0.0
    right[row] = -hinge[k, LAM + r] / hinge[k, SCALE + r]
    if build and system == WHOLE:
        matrix[row * (3 * band + 1) + band] = 1.0


@merged
def scale_rows(link: IntArray, hinge: FloatArray, local: FloatArray, k: int) -> None:
    """SCALE of the rows of joint k."""
    for r in range(link[k, L_ROWS]):
        total = 0.0
        for end in range(2):
            i = link[k, L_A + end]
            for c in range(3):
                total += local[i, MOBILITY + c] * hinge[k, ROWS + 6 * r + 3 * end + c] ** 2
        hinge[k, SCALE + r] = 1.0 / np.sqrt(total) if total > 0.0 else 1.0

"""How an island of joints answers impulses on its bodies: the change of velocities per impulse.

About a solved step, d v1 = S p for impulses p spread over the step, S the inverse of Newton's matrix with springs and
bounded joints, but without the bending of rows, by which S would not be positive where joints press. At one instant (an
impact), S = M^-1 - M^-1 G^T (G M^-1 G^T)^-1 G M^-1: joints that hold exactly let no velocity through, and all others no
impulse.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .condensed import PASSES, back_condensed, factor
from .motion import move
from .newton import assemble
from .rows import start_joint
from .scratch import (
    AFTER,
    BEFORE,
    COLUMN,
    COS,
    FREEDOMS,
    L_ROW,
    L_ROWS,
    L_SOFT,
    LAM,
    MOBILITY,
    POSE,
    ROOT,
    ROWS,
    SAVED,
    SIN,
    SLOPES,
    STEP,
)
from .solve import LEAST_EPSILON, begin

_REFINE = 2  # passes that take back what epsilon, for redundant rows, has changed


@uncounted
def factor_banded(matrix: FloatArray, size: int, band: int, pivots: IntArray) -> bool:
    """LU factors with partial pivoting in place of `matrix` (layout of `banded`); False if a pivot vanishes."""
    for k in range(size):
        last = min(size, k + band + 1)
        pivot, largest = k, abs(matrix[k, band])
        for i in range(k + 1, last):
            entry = abs(matrix[i, k - i + band])
            if entry > largest:
                pivot, largest = i, entry
        pivots[k] = pivot
        if not largest > 1e-300:
            return False
        reach = min(2 * band + 1, size - k)
        if pivot != k:
            shift = k - pivot + band
            for j in range(reach):
                matrix[k, band + j], matrix[pivot, shift + j] = matrix[pivot, shift + j], matrix[k, band + j]
        for i in range(k + 1, last):
            shift = k - i + band
            below = matrix[i, shift] / matrix[k, band]
            matrix[i, shift] = below
            if below != 0.0:
                for j in range(1, reach):
                    matrix[i, shift + j] -= below * matrix[k, band + j]
    return True


@uncounted
def back_banded(matrix: FloatArray, size: int, band: int, pivots: IntArray, right: FloatArray) -> None:
    """Solve with the factors of `factor_banded`, in place of `right`."""
    for k in range(size):
        pivot = pivots[k]
        if pivot != k:
            right[k], right[pivot] = right[pivot], right[k]
        if right[k] != 0.0:
            for i in range(k + 1, min(size, k + band + 1)):
                right[i] -= matrix[i, k - i + band] * right[k]
    for k in range(size - 1, -1, -1):
        total = right[k]
        for j in range(1, min(2 * band + 1, size - k)):
            total -= matrix[k, band + j] * right[k + j]
        right[k] = total / matrix[k, band]


@uncounted
def prepare(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, condensed: bool, band: int, size: int, matrix: FloatArray, right: FloatArray,
    stiff: FloatArray, pivots: IntArray,
) -> bool:  # fmt: skip
    """Factors of the matrix that `respond` needs, in `matrix` and `pivots`; False if there are none.

    `what` is STEP, after `island_step` (whose start becomes that of `local` again), or SPEEDS, at the present poses.
    """
    if what == STEP:
        for i in range(bodies):
            for c in range(3):
                local[i, AFTER + c] = local[i, BEFORE + c]
                local[i, POSE + c], local[i, BEFORE + c] = local[i, SAVED + c], local[i, SAVED + 3 + c]
            local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
        for k in range(joints):
            start_joint(joint, hinge, link, k, local, h)
            # Without the bending of rows, S is symmetric and positive up to first order in h.
            if link[k, L_ROWS] > 0 and link[k, L_SOFT] == 0:
                hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
        move(local, bodies, h)
    else:
        begin(what, joint, hinge, link, joints, local, node, bodies, h)
    width = 2 * band + 1 if condensed else 3 * band + 1
    for i in range(size):
        for c in range(width):
            matrix[i, c] = 0.0
    for i in range(len(right)):
        right[i] = 0.0
    assemble(
        what, joint, hinge, link, joints, local, node, bodies, h, 0.0, True, condensed, band, matrix, right, stiff
    )  # fmt: skip
    if condensed:
        return factor(matrix, size, band)
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            matrix[link[k, L_ROW] + r, band] += LEAST_EPSILON
    return factor_banded(matrix, size, band, pivots)


@uncounted
def respond(
    what: int, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    condensed: bool, band: int, size: int, matrix: FloatArray, right: FloatArray, more: FloatArray, pivots: IntArray,
    push: FloatArray,
) -> None:  # fmt: skip
    """push (bodies, 3): impulses in (mass length/time, mass length²/time), changes of velocity out. `more`: scratch."""
    for i in range(len(right)):
        right[i] = 0.0
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            right[node[i, COLUMN] + c] = push[i, c] * local[i, ROOT + c]
    if condensed:
        slopes = SLOPES if what == STEP else ROWS
        back_condensed(
            hinge, link, joints, local, node, slopes, PASSES, size, band, matrix, right, len(right) - size
        )  # fmt: skip
    else:
        back_banded(matrix, size, band, pivots, right)
        # (A + epsilon) x = b leaves b - A x = epsilon x in the rows, and each correction d leaves epsilon d.
        for i in range(size):
            more[i] = right[i]
        for _ in range(_REFINE):
            for i in range(bodies):
                for c in range(node[i, FREEDOMS]):
                    more[node[i, COLUMN] + c] = 0.0
            for k in range(joints):
                for r in range(link[k, L_ROWS]):
                    more[link[k, L_ROW] + r] *= LEAST_EPSILON
            back_banded(matrix, size, band, pivots, more)
            for i in range(size):
                right[i] += more[i]
    for i in range(bodies):
        for c in range(3):
            if c < node[i, FREEDOMS]:
                push[i, c] = right[node[i, COLUMN] + c] * local[i, ROOT + c]
            else:
                push[i, c] *= local[i, MOBILITY + c]

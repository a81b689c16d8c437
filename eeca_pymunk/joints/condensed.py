"""Systems of wide islands in the bodies' unknowns alone, the joints' rows as stiff springs that are then corrected.

[A  -J^T; G  give] [x; mu] = [b; c] becomes (A + R J^T G) dx = b + R J^T (c - G x), dmu = R (c - G x - G dx), and again
with what is left of c: the balance of the bodies holds after the first pass, each further one takes the rows' error by
1/(1 + R s), s the least eigenvalue of G A^-1 J^T. Redundant rows do no harm. The band is that of the bodies' graph,
and needs no pivots.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .scratch import COLUMN, FREEDOMS, L_A, L_ROW, L_ROWS, MISSING, ROOT, ROWS, SCALE, WEIGHT

PASSES = 3


@uncounted
def factor(matrix: FloatArray, size: int, band: int) -> bool:
    """LU factors without pivots in place of `matrix`, A[i, j] at [i, j - i + band]; False if a pivot vanishes."""
    for k in range(size):
        pivot = matrix[k, band]
        if not abs(pivot) > 1e-300:
            return False
        reach = min(band + 1, size - k)
        for i in range(k + 1, k + reach):
            shift = k - i + band
            below = matrix[i, shift]
            if below != 0.0:
                below /= pivot
                matrix[i, shift] = below
                for j in range(1, reach):
                    matrix[i, shift + j] -= below * matrix[k, band + j]
    return True


@uncounted
def substitute(matrix: FloatArray, size: int, band: int, right: FloatArray, at: int) -> None:
    """Solve with the factors, in place of right[at : at + size]."""
    for i in range(size):
        total = right[at + i]
        for j in range(max(0, i - band), i):
            total -= matrix[i, j - i + band] * right[at + j]
        right[at + i] = total
    for i in range(size - 1, -1, -1):
        total = right[at + i]
        for j in range(i + 1, min(size, i + band + 1)):
            total -= matrix[i, j - i + band] * right[at + j]
        right[at + i] = total / matrix[i, band]


@uncounted
def spread(
    hinge: FloatArray, link: IntArray, local: FloatArray, node: IntArray, k: int, r: int, amount: float,
    right: FloatArray, at: int,
) -> None:  # fmt: skip
    """Add `amount` of the scaled column J^T of row r of joint k to right[at :]."""
    amount *= hinge[k, SCALE + r]
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            right[at + node[i, COLUMN] + c] += amount * hinge[k, ROWS + 6 * r + 3 * end + c] * local[i, ROOT + c]


@uncounted
def reach_of(
    hinge: FloatArray, link: IntArray, local: FloatArray, node: IntArray, k: int, r: int, slopes: int,
    right: FloatArray, at: int,
) -> float:  # fmt: skip
    """The scaled row G of row r of joint k times right[at :]."""
    total = 0.0
    for end in range(2):
        i = link[k, L_A + end]
        for c in range(node[i, FREEDOMS]):
            entry = hinge[k, slopes + 6 * r + 3 * end + c] * local[i, ROOT + c]
            total += entry * right[at + node[i, COLUMN] + c]
    return float(total * hinge[k, SCALE + r])


@uncounted
def solve_condensed(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, slopes: int, passes: int,
    size: int, band: int, matrix: FloatArray, right: FloatArray, room: int,
) -> bool:  # fmt: skip
    """Solve the condensed system in place of `right`: bodies first, then rows; right[room : room + size] is scratch."""
    if not factor(matrix, size, band):
        return False
    back_condensed(hinge, link, joints, local, node, slopes, passes, size, band, matrix, right, room)
    return True


@uncounted
def back_condensed(
    hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, slopes: int, passes: int,
    size: int, band: int, matrix: FloatArray, right: FloatArray, room: int,
) -> None:  # fmt: skip
    """`solve_condensed` with the factors of the matrix in its place."""
    for i in range(size):
        right[room + i] = right[i]
        right[i] = 0.0
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            row = link[k, L_ROW] + r
            if hinge[k, WEIGHT + r] < 0.0:
                spread(hinge, link, local, node, k, r, right[row], right, room)
            elif hinge[k, WEIGHT + r] > 0.0:
                hinge[k, MISSING + r] = right[row]
                right[row] = 0.0
    for _ in range(passes):
        for k in range(joints):
            for r in range(link[k, L_ROWS]):
                if hinge[k, WEIGHT + r] > 0.0:
                    amount = hinge[k, WEIGHT + r] * hinge[k, MISSING + r]
                    spread(hinge, link, local, node, k, r, amount, right, room)
        substitute(matrix, size, band, right, room)
        for k in range(joints):
            for r in range(link[k, L_ROWS]):
                if hinge[k, WEIGHT + r] > 0.0:
                    hinge[k, MISSING + r] -= reach_of(hinge, link, local, node, k, r, slopes, right, room)
                    right[link[k, L_ROW] + r] += hinge[k, WEIGHT + r] * hinge[k, MISSING + r]
        for i in range(size):
            right[i] += right[room + i]
            right[room + i] = 0.0

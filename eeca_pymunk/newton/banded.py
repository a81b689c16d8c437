"""Banded systems of bodies and rows together: elimination with partial pivoting inside the band."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating


@nonallocating
def factor_banded(matrix: FloatArray, size: int, band: int, pivots: IntArray) -> bool:
    """LU factors in place of `matrix`, reciprocals on the diagonal, and column k of L, below it, at the first entries
    of row k, where it is read in line; False if a pivot vanishes.

    `matrix` (size (3 band + 1) or more,): A[i, j] at i (3 band + 1) + j - i + band for |i - j| <= band; the last `band`
    entries of each row are 0, room for the rows that exchanges bring in. `pivots` (2 size or more,): out, the row that
    each row was exchanged with, then the last column of each that is not 0. Cost: size band^2 operations.
    """
    width, end = 3 * band + 1, 0
    for k in range(size):
        last = min(size, k + band + 1)
        at = k * width + band
        pivot, largest = k, abs(matrix[at])
        for i in range(k + 1, last):
            entry = abs(matrix[i * width + k - i + band])
            if entry > largest:
                pivot, largest = i, entry
        pivots[k] = pivot
        if not largest > 1e-300:
            return False
        end = max(end, min(pivot + band, size - 1))
        pivots[size + k] = end
        reach = end - k + 1
        if pivot != k:
            other = pivot * width + k - pivot + band
            for j in range(reach):
                keep = matrix[at + j]
                matrix[at + j] = matrix[other + j]
                matrix[other + j] = keep
        inverse = 1.0 / matrix[at]
        matrix[at] = inverse
        for i in range(k + 1, last):
            to = i * width + k - i + band
            below = matrix[to]
            if below != 0.0:
                below *= inverse
                for j in range(1, reach):
                    matrix[to + j] -= below * matrix[at + j]
            matrix[k * width + i - k - 1] = below
    return True


@nonallocating
def back_banded(matrix: FloatArray, size: int, band: int, pivots: IntArray, right: FloatArray) -> None:
    """Solve with the factors of `factor_banded`, in place of `right`."""
    width = 3 * band + 1
    for k in range(size):
        pivot = pivots[k]
        if pivot != k:
            keep = right[k]
            right[k] = right[pivot]
            right[pivot] = keep
        if right[k] != 0.0:
            amount, at = right[k], k * width
            for j in range(min(band, size - 1 - k)):
                right[k + 1 + j] -= matrix[at + j] * amount
    for k in range(size - 1, -1, -1):
        total = right[k]
        at = k * width + band
        # The unknown found last is used last, so that no other product waits for it.
        for j in range(pivots[size + k] - k, 0, -1):
            total -= matrix[at + j] * right[k + j]
        right[k] = total * matrix[at]

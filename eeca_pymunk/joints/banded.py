"""Dense and banded systems of the Newton steps: elimination with partial pivoting inside the band."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import uncounted


@uncounted
def solve_banded(matrix: FloatArray, size: int, band: int, right: FloatArray) -> bool:
    """Solve A x = b in place of `right` (size,); False if a pivot vanishes.

    `matrix` (size or more, 3 band + 1 or more): A[i, j] at [i, j - i + band] for |i - j| <= band; the last `band`
    columns are room for what rows swap in, and begin at 0. It is overwritten. Cost: size band^2 operations.
    """
    for k in range(size):
        last = min(size, k + band + 1)
        pivot, largest = k, abs(matrix[k, band])
        for i in range(k + 1, last):
            entry = abs(matrix[i, k - i + band])
            if entry > largest:
                pivot, largest = i, entry
        if not largest > 1e-300:
            return False
        reach = min(2 * band + 1, size - k)  # columns k .. k + 2 band
        if pivot != k:
            shift = k - pivot + band
            for j in range(reach):
                keep = matrix[k, band + j]
                matrix[k, band + j] = matrix[pivot, shift + j]
                matrix[pivot, shift + j] = keep
            keep = right[k]
            right[k] = right[pivot]
            right[pivot] = keep
        inverse = 1.0 / matrix[k, band]
        for i in range(k + 1, last):
            shift = k - i + band
            factor = matrix[i, shift] * inverse
            if factor != 0.0:
                for j in range(1, reach):
                    matrix[i, shift + j] -= factor * matrix[k, band + j]
                right[i] -= factor * right[k]
    for k in range(size - 1, -1, -1):
        total = right[k]
        for j in range(1, min(2 * band + 1, size - k)):
            total -= matrix[k, band + j] * right[k + j]
        right[k] = total / matrix[k, band]
    return True

"""Sorting, copying and adding in place: numpy's own functions, compiled, would allocate arrays."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating


@nonallocating
def copy(TO: FloatArray, FROM: FloatArray) -> None:
    """Copy FROM (n, k) to TO."""
    for i in range(TO.shape[0]):
        for k in range(TO.shape[1]):
            TO[i, k] = FROM[i, k]


@nonallocating
def add_multiple(row: FloatArray, other: FloatArray, amount: float) -> None:
    """row += amount other, over the length of the shorter one."""
    for i in range(min(len(row), len(other))):
        row[i] += amount * other[i]


@nonallocating
def sort(A: IntArray, n: int) -> None:
    """Sort the first n numbers of A in ascending order, by Shell's sort with Knuth's gaps: at most about n^1.5
    comparisons."""
    gap = 1
    while gap < n // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            value = A[i]
            j = i
            while j >= gap and A[j - gap] > value:
                A[j] = A[j - gap]
                j -= gap
            A[j] = value
        gap //= 3

"""Sorting and copying in place: numpy's own functions, compiled, would allocate arrays."""

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
def add(TO: FloatArray, MORE: FloatArray) -> None:
    """Add MORE (n, k) to TO."""
    for i in range(TO.shape[0]):
        for k in range(TO.shape[1]):
            TO[i, k] += MORE[i, k]


@nonallocating
def sort(A: IntArray, n: int) -> None:
    """Sort the first n numbers of A in ascending order, by heapsort: at most 2 n log2 n comparisons."""
    for root in range(n // 2 - 1, -1, -1):
        _sift(A, root, n)
    for end in range(n - 1, 0, -1):
        A[0], A[end] = A[end], A[0]
        _sift(A, 0, end)


@nonallocating
def _sift(A: IntArray, root: int, n: int) -> None:
    """Sift the number at `root` down in the heap of n numbers, until no child is larger."""
    value = A[root]
    while 2 * root + 1 < n:
        child = 2 * root + 1
        if child + 1 < n and A[child + 1] > A[child]:
            child += 1
        if A[child] <= value:
            break
        A[root] = A[child]
        root = child
    A[root] = value

"""Sorting in place, without memory of its own."""

from __future__ import annotations

from ..arrays import IntArray
from ..compiled import uncounted


@uncounted
def sort(A: IntArray, n: int) -> None:
    """Put the first n numbers in ascending order, by heapsort: at most 2 n log2 n comparisons."""
    for root in range(n // 2 - 1, -1, -1):
        _sift(A, root, n)
    for end in range(n - 1, 0, -1):
        A[0], A[end] = A[end], A[0]
        _sift(A, 0, end)


@uncounted
def _sift(A: IntArray, root: int, n: int) -> None:
    """Let the number at `root` sink until no child of it in the heap of n numbers is larger."""
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

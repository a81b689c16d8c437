"""Order of elimination of an island's bodies: nested dissection by their positions, and the pattern of the factor.

Separators of planar piles have about sqrt(n) bodies, so that the factor has O(n log n) blocks. A body with many
neighbours (a floor of boxes, a drum) would be in every separator: it is eliminated last.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..model.parameters.impulses import DISSECTION_LEAF, LATE_NEIGHBOURS


@kernel
def neighbours(A: IntArray, B: IntArray, m: int, n: int, used: IntArray) -> tuple[IntArray, IntArray]:
    """Neighbours of each of n bodies by the contacts with used[i] != 0, as start (n + 1,) and list; some appear
    repeatedly."""
    start = np.zeros(n + 1, np.int64)
    for i in range(m):
        a, b = A[i], B[i]
        if used[i] != 0 and a < n and b < n:
            start[a + 1] += 1
            start[b + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    other = np.empty(start[n], np.int64)
    fill = start[:n].copy()
    for i in range(m):
        a, b = A[i], B[i]
        if used[i] != 0 and a < n and b < n:
            other[fill[a]] = b
            fill[a] += 1
            other[fill[b]] = a
            fill[b] += 1
    return start, other


@kernel
def dissect(POSE: FloatArray, n: int, start: IntArray, other: IntArray, place: IntArray) -> None:
    """Set place (n,), the position of each body in the order of elimination."""
    ids = np.empty(n, np.int64)
    end = n
    count = 0
    for i in range(n):
        if start[i + 1] - start[i] > LATE_NEIGHBOURS:
            end -= 1
            place[i] = end
        else:
            ids[count] = i
            count += 1
    side = np.zeros(n, np.int64)
    right = np.empty(n, np.int64)
    stack = np.empty((128, 2), np.int64)
    stack[0, 0] = 0
    stack[0, 1] = count
    top, stamp = 1, 0
    while top > 0:
        # The range [low, high) of ids gets the last free places: its separator first, then its right part.
        top -= 1
        low = stack[top, 0]
        high = stack[top, 1]
        x0 = y0 = np.inf
        x1 = y1 = -np.inf
        x = y = 0.0
        for k in range(low, high):
            px = POSE[ids[k], 0]
            py = POSE[ids[k], 1]
            x0 = min(x0, px)
            x1 = max(x1, px)
            y0 = min(y0, py)
            y1 = max(y1, py)
            x += px
            y += py
        if high - low <= DISSECTION_LEAF or top > 120 or not max(x1 - x0, y1 - y0) > 0.0:
            for k in range(high - 1, low - 1, -1):
                end -= 1
                place[ids[k]] = end
            continue
        axis = 0 if x1 - x0 > y1 - y0 else 1
        mean = (x if axis == 0 else y) / (high - low)
        stamp += 2
        for k in range(low, high):
            side[ids[k]] = stamp if POSE[ids[k], axis] <= mean else stamp + 1
        left = low
        rights = 0
        for k in range(low, high):
            i = ids[k]
            if side[i] == stamp + 1:
                right[rights] = i
                rights += 1
                continue
            cut = False
            for q in range(start[i], start[i + 1]):
                if side[other[q]] == stamp + 1:
                    cut = True
            if cut:
                end -= 1
                place[i] = end
            else:
                ids[left] = i
                left += 1
        for k in range(rights):
            ids[left + k] = right[k]
        if left > low:
            stack[top, 0] = low
            stack[top, 1] = left
            top += 1
        if rights > 0:
            stack[top, 0] = left
            stack[top, 1] = left + rights
            top += 1


@nonallocating
def ascend(values: IntArray, low: int, high: int) -> None:
    """Sort values[low:high] by Shell's sort, which suits short columns."""
    gap = 1
    while gap < (high - low) // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(low + gap, high):
            value = values[i]
            j = i
            while j >= low + gap and values[j - gap] > value:
                values[j] = values[j - gap]
                j -= gap
            values[j] = value
        gap //= 3


@kernel
def pattern(n: int, start: IntArray, other: IntArray, place: IntArray) -> tuple[IntArray, IntArray]:
    """Column pointers (n + 1,) and rows below the diagonal, ascending, of the blocks of the factor."""
    body = np.empty(n, np.int64)
    for i in range(n):
        body[place[i]] = i
    head = np.full(n, -1, np.int64)
    after = np.full(n, -1, np.int64)
    mark = np.full(n, -1, np.int64)
    columns = np.zeros(n + 1, np.int64)
    room = 16 * n + 64
    rows = np.empty(room, np.int64)
    for j in range(n):
        first = columns[j]
        last = first
        mark[j] = j
        if first + n - j > room:
            room = 2 * room + n
            more = np.empty(room, np.int64)
            for q in range(first):
                more[q] = rows[q]
            rows = more
        i = body[j]
        for q in range(start[i], start[i + 1]):
            r = place[other[q]]
            if r > j and mark[r] != j:
                mark[r] = j
                rows[last] = r
                last += 1
        child = head[j]
        while child != -1:
            for q in range(columns[child], columns[child + 1]):
                r = rows[q]
                if r > j and mark[r] != j:
                    mark[r] = j
                    rows[last] = r
                    last += 1
            child = after[child]
        ascend(rows, first, last)
        columns[j + 1] = last
        if last > first:
            after[j] = head[rows[first]]
            head[rows[first]] = j
    return columns, rows[: columns[n]].copy()

"""Order of elimination of an island's bodies: nested dissection by their positions, and the pattern of the factor.

Separators of planar piles have about sqrt(n) bodies, so that the factor has O(n log n) blocks. A body with many
neighbours (a floor of boxes, a drum) would be in every separator: it is eliminated last.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.impulses import DISSECTION_LEAF, LATE_NEIGHBOURS
from .inplace import sort


@kernel
def neighbours(EDGE: IntArray, edges: int, n: int) -> tuple[IntArray, IntArray]:
    """Neighbours of n nodes of a graph by its edges EDGE (., 2): `start` (n + 1,) and `other`; those of node i are
    other[start[i] : start[i + 1]], some repeatedly, in the order of the edges."""
    start = np.zeros(n + 1, np.int64)
    for e in range(edges):
        for end in range(2):
            start[EDGE[e, end] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    other, fill = np.empty(start[n], np.int64), start[:n].copy()
    for e in range(edges):
        for end in range(2):
            i = EDGE[e, end]
            other[fill[i]] = EDGE[e, 1 - end]
            fill[i] += 1
    return start, other


@kernel
def contact_neighbours(ROWS: Rows[Row], m: int, n: int, used: IntArray) -> tuple[IntArray, IntArray]:
    """`neighbours` of n bodies by the contacts with used[i] != 0."""
    EDGE, edges = np.empty((m, 2), np.int64), 0
    for i in range(m):
        if used[i] != 0 and ROWS[i].a < n and ROWS[i].b < n:
            EDGE[edges, 0], EDGE[edges, 1] = ROWS[i].a, ROWS[i].b
            edges += 1
    return neighbours(EDGE, edges, n)


@kernel
def dissect(POSE: FloatArray, n: int, start: IntArray, other: IntArray, place: IntArray) -> None:
    """Set place (n,), the position of each body in the order of elimination, from the poses POSE (k, 3) of the bodies
    and their neighbours (`contact_neighbours`). A set of bodies is divided at the mean of the longer side of its box;
    those left of it with a neighbour on the right are the separator, which is eliminated after both parts."""
    ids, end, count = np.empty(n, np.int64), n, 0
    for i in range(n):
        if start[i + 1] - start[i] > LATE_NEIGHBOURS:
            end -= 1
            place[i] = end
        else:
            ids[count] = i
            count += 1
    side, right, stack = np.zeros(n, np.int64), np.empty(n, np.int64), np.empty((128, 2), np.int64)
    stack[0, 0], stack[0, 1] = 0, count
    top, stamp = 1, 0
    while top > 0:
        # The range [low, high) of ids gets the last free places: its separator first, then its right part.
        top -= 1
        low, high = stack[top, 0], stack[top, 1]
        x0, y0, x1, y1, x, y = np.inf, np.inf, -np.inf, -np.inf, 0.0, 0.0
        for k in range(low, high):
            px, py = POSE[ids[k], 0], POSE[ids[k], 1]
            x0, x1, y0, y1 = min(x0, px), max(x1, px), min(y0, py), max(y1, py)
            x, y = x + px, y + py
        # Not divided: few bodies, bodies at one place, and what the stack has no room for.
        if high - low <= DISSECTION_LEAF or top > 120 or not max(x1 - x0, y1 - y0) > 0.0:
            for k in range(high - 1, low - 1, -1):
                end -= 1
                place[ids[k]] = end
            continue
        axis = 0 if x1 - x0 > y1 - y0 else 1
        first, last, mean = (x0, x1, x / (high - low)) if axis == 0 else (y0, y1, y / (high - low))
        if not first <= mean < last:  # by round-off, where all are at nearly one place: both parts need a body
            mean = first
        stamp += 2
        for k in range(low, high):
            side[ids[k]] = stamp if POSE[ids[k], axis] <= mean else stamp + 1
        left, rights = low, 0
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
            stack[top, 0], stack[top, 1] = low, left
            top += 1
        stack[top, 0], stack[top, 1] = left, left + rights
        top += 1


@kernel
def pattern(n: int, start: IntArray, other: IntArray, place: IntArray) -> tuple[IntArray, IntArray]:
    """`columns` (n + 1,) and `rows` of the blocks of the factor, as in `cholesky.Factor`; the rows of a column ascend:
    those of its own neighbours, and of all columns whose first row it is (its children in the elimination tree)."""
    body = np.empty(n, np.int64)
    for i in range(n):
        body[place[i]] = i
    head, after, mark = np.full(n, -1, np.int64), np.full(n, -1, np.int64), np.full(n, -1, np.int64)
    columns, room = np.zeros(n + 1, np.int64), 16 * n + 64
    rows = np.empty(room, np.int64)
    for j in range(n):
        first = last = columns[j]
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
        sort(rows[first:last], last - first)
        columns[j + 1] = last
        if last > first:
            after[j] = head[rows[first]]
            head[rows[first]] = j
    return columns, rows[: columns[n]].copy()

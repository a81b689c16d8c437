"""Widths of shapes, and how deep contacts may close in an interval."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.parameters.intervals import INTERVAL_DEPTH, INTERVAL_DEPTH_LEAST, INTERVAL_DEPTH_WIDTH
from ..model.scene import Scene


@inlined
def size_of(A: Scene, s: int) -> float:
    """The extent of a shape, length; infinite for a static one, whose extent is its distance from the origin."""
    return A.SHAPE[s].extent if A.LINK[s].owner < A.BODY.shape[0] - 1 else math.inf


@inlined
def turns(A: Scene, s: int) -> bool:
    """Whether shape s moves as its body turns: it is no disk about the centre of mass."""
    return A.SHAPE[s].extent > A.SHAPE[s].rounding


@nonallocating
def smaller(A: Scene, a: int, b: int) -> float:
    """The smaller size of two shapes, of which one moves: length."""
    return min(size_of(A, a), size_of(A, b))


@inlined
def depth_below(VERTEX: FloatArray, edge: int, vertex: int) -> float:
    """The distance of a vertex of a polygon from one of its edges."""
    x, y = VERTEX[edge, 0] - VERTEX[vertex, 0], VERTEX[edge, 1] - VERTEX[vertex, 1]
    return float(x * VERTEX[edge, 2] + y * VERTEX[edge, 3])


@nonallocating
def half_width(A: Scene, s: int) -> float:
    """Half the least width of shape s: a shape that is less deep inside is on the side from which it came. The vertex
    farthest from an edge turns around the polygon with the edges."""
    VERTEX, first, count, least = A.VERTEX, A.LINK[s].first, A.LINK[s].vertices, math.inf
    if count < 3:
        return A.SHAPE[s].rounding
    far = first
    for k in range(first, first + count):
        if depth_below(VERTEX, first, k) > depth_below(VERTEX, first, far):
            far = k
    for j in range(first, first + count):
        most = depth_below(VERTEX, j, far)
        for _ in range(count):
            following = far + 1 if far + 1 < first + count else first
            if depth_below(VERTEX, j, following) <= most:
                break
            most, far = depth_below(VERTEX, j, following), following
        least = min(least, most)
    return A.SHAPE[s].rounding + 0.5 * least


@nonallocating
def depth_limit(A: Scene, a: int, b: int) -> float:
    """Depth (length) by which a contact of shapes a and b may close in one interval."""
    small, thick = smaller(A, a, b), half_width(A, a) + half_width(A, b)
    return max(min(INTERVAL_DEPTH * small, INTERVAL_DEPTH_WIDTH * thick), INTERVAL_DEPTH_LEAST * small)

"""How far two cores are apart along the normals of their edges, and which vertex and edge are closest (`convex`)."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating


@inlined
def separation(P: FloatArray, p: int, Q: FloatArray, q: int, mx: float, my: float) -> tuple[float, int, int]:
    """Largest distance of Q (q vertices) from P (p vertices) along an edge normal of P, that edge, and the vertex of Q
    that is nearest along it; (-inf, 0, 0) for a point P. Unless m = 0, only edges whose normals have a positive
    component along m count; m = 0 as a constant costs nothing, since the kernel is inlined."""
    best, edge, vertex, some = -math.inf, 0, 0, mx != 0.0 or my != 0.0
    if p > 1:
        for j in range(p):
            nx, ny = P[j, 2], P[j, 3]
            if some and nx * mx + ny * my <= 0.0:
                continue
            px, py = P[j, 0], P[j, 1]
            least, lowest = math.inf, 0
            for i in range(q):
                height = (Q[i, 0] - px) * nx + (Q[i, 1] - py) * ny
                if height < least:
                    least, lowest = height, i
            if least > best:
                best, edge, vertex = least, j, lowest
    return best, edge, vertex


@nonallocating
def separation_of_many(P: FloatArray, p: int, Q: FloatArray, q: int) -> tuple[float, int, int]:
    """`separation` of polygons with many corners, along all normals, in p + q operations: when the normal turns
    counter-clockwise, so does the nearest vertex."""
    best, edge, vertex, i = -math.inf, 0, 0, 0
    for j in range(p):
        px, py, nx, ny = P[j, 0], P[j, 1], P[j, 2], P[j, 3]
        least = (Q[i, 0] - px) * nx + (Q[i, 1] - py) * ny
        if j == 0:
            for k in range(1, q):
                height = (Q[k, 0] - px) * nx + (Q[k, 1] - py) * ny
                if height < least:
                    least, i = height, k
        for _ in range(q):
            k = i + 1 if i + 1 < q else 0
            height = (Q[k, 0] - px) * nx + (Q[k, 1] - py) * ny
            if height >= least:
                break
            least, i = height, k
        if least > best:
            best, edge, vertex = least, j, i
    return best, edge, vertex


@nonallocating
def along_edge(P: FloatArray, p: int, edge: int, x: float, y: float) -> tuple[float, float]:
    """Position of the foot of (x, y) along an edge, times the edge's length, and that length squared."""
    end = edge + 1 if edge + 1 < p else 0
    ex, ey = P[end, 0] - P[edge, 0], P[end, 1] - P[edge, 1]
    return (x - P[edge, 0]) * ex + (y - P[edge, 1]) * ey, ex * ex + ey * ey


@nonallocating
def beyond_edge(P: FloatArray, p: int, edge: int, x: float, y: float) -> float:
    """The distance of (x, y) from the nearer end of an edge if its foot is not on the edge, else 0."""
    along, squared = along_edge(P, p, edge, x, y)
    if 0.0 <= along <= squared:
        return 0.0
    end = edge
    if along > 0.0:
        end = edge + 1 if edge + 1 < p else 0
    return math.sqrt((x - P[end, 0]) ** 2 + (y - P[end, 1]) ** 2)


@nonallocating
def vertex_edge(
    P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float, low: float, high: float
) -> tuple[float, int, int, float, float, bool]:
    """The vertex of P closest to the outline of Q, q > 1: squared distance, vertex, edge, the point of the edge, and
    whether that is inside the edge. Only vertices up to the height `high` along n count, and edges with an end from
    `low` on: a distance that is not larger than some other one needs both."""
    best, vertex, edge, fx, fy, inside = math.inf, 0, 0, 0.0, 0.0, False
    for j in range(q):
        end = j + 1 if j + 1 < q else 0
        bx, by = Q[j, 0], Q[j, 1]
        if bx * nx + by * ny < low and Q[end, 0] * nx + Q[end, 1] * ny < low:
            continue
        ex, ey = Q[end, 0] - bx, Q[end, 1] - by
        squared = ex * ex + ey * ey
        for i in range(p):
            x, y = P[i, 0], P[i, 1]
            if x * nx + y * ny > high:
                continue
            along = (x - bx) * ex + (y - by) * ey
            within = 0.0 < along < squared
            if within:
                along /= squared
                px, py = bx + along * ex, by + along * ey
            elif along <= 0.0:
                px, py = bx, by
            else:
                px, py = Q[end, 0], Q[end, 1]
            d = (x - px) * (x - px) + (y - py) * (y - py)
            if d < best:
                best, vertex, edge, fx, fy, inside = d, i, j, px, py, within
    return best, vertex, edge, fx, fy, inside

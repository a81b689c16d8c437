"""Distances of convex cores: points, segments and polygons, which the shapes' radii round.

A core is rows (x, y, n_x, n_y) in the world: a vertex and the outward unit normal of the edge that begins there,
counter-clockwise. Apart along the normal n_j of edge j of P are

    s_j = min_i (q_i - p_j) . n_j,

and the largest of all s_j of both cores is their depth where it is negative. Where it is positive it bounds the
distance from below, and is the distance if the foot of the nearest vertex lies inside that edge (all other edges are
less far apart). Else some vertex and some edge of the other core are closest. Two parallel segments, and cores that
share a corner, need the second way also where s = 0.

Directions between points that are closer than `DIRECTION_ROUND_OFF` of the coordinates are round-off: there the
edge's normal holds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.parameters.detection import AXIS_TIE, DIRECTION_ROUND_OFF, EDGE_TIE, MANY_CORNERS
from ..model.scene import Scene
from .separation import along_edge, beyond_edge, separation, separation_of_many, vertex_edge


class Faces(NamedTuple):
    """The edges of two cores along whose normals they are farthest apart, and how far: -inf along those of a point."""

    edge_p: int
    apart_p: float
    edge_q: int
    apart_q: float


class Closest(NamedTuple):
    """The closest points of two cores P and Q, or in overlap the shortest way out."""

    distance: float  # negative in overlap
    nx: float  # unit normal from P to Q
    ny: float
    x: float  # point of P
    y: float
    flat: bool  # whether the normal is that of an edge
    faces: Faces


@nonallocating
def place_vertices(A: Scene, s: int, x: float, y: float, angle: float, OUT: FloatArray) -> int:
    """Write vertices and outward normals of shape s, with its body at (x, y, angle), to OUT (.., 4); returns the number
    of vertices.

    Exact for angle 0 and for a vertex at the centre of mass.
    """
    VERTEX, first, count = A.VERTEX, A.LINK[s].first, A.LINK[s].vertices
    if angle == 0.0 or (count == 1 and VERTEX[first, 0] == 0.0 and VERTEX[first, 1] == 0.0):
        for k in range(count):
            OUT[k, 0] = x + VERTEX[first + k, 0]
            OUT[k, 1] = y + VERTEX[first + k, 1]
            OUT[k, 2] = VERTEX[first + k, 2]
            OUT[k, 3] = VERTEX[first + k, 3]
        return count
    c, z = math.cos(angle), math.sin(angle)
    for k in range(count):
        px, py, nx, ny = VERTEX[first + k, 0], VERTEX[first + k, 1], VERTEX[first + k, 2], VERTEX[first + k, 3]
        OUT[k, 0] = x + (c * px - z * py)
        OUT[k, 1] = y + (z * px + c * py)
        OUT[k, 2] = c * nx - z * ny
        OUT[k, 3] = z * nx + c * ny
    return count


@nonallocating
def prefers_second(P: FloatArray, p: int, Q: FloatArray, q: int, faces: Faces, tie: float) -> bool:
    """Whether the normal of Q's edge is the axis of two cores: the one with the larger distance, or if both are equal
    within `tie`, that of the longer edge, so that parallel faces keep their axis under round-off."""
    if faces.apart_q > faces.apart_p + tie:
        return True
    if faces.apart_p > faces.apart_q + tie:
        return False
    length_p = along_edge(P, p, faces.edge_p, 0.0, 0.0)[1]
    length_q = along_edge(Q, q, faces.edge_q, 0.0, 0.0)[1]
    return length_q > length_p * EDGE_TIE


@nonallocating
def point_core(x: float, y: float, Q: FloatArray, q: int) -> tuple[float, float, float, bool, int, float]:
    """A point and a core: distance, unit normal toward the core, whether that is an edge's, the edge along which the
    core is farthest apart, and how far (-inf without edges)."""
    if q == 1:
        dx, dy = Q[0, 0] - x, Q[0, 1] - y
        d = math.sqrt(dx * dx + dy * dy)
        if d == 0.0:
            return 0.0, 1.0, 0.0, False, 0, -math.inf
        return d, dx / d, dy / d, False, 0, -math.inf
    apart, edge = -math.inf, 0
    for j in range(q):
        height = (x - Q[j, 0]) * Q[j, 2] + (y - Q[j, 1]) * Q[j, 3]
        if height > apart:
            apart, edge = height, j
    if apart >= 0.0:
        along, squared = along_edge(Q, q, edge, x, y)
        if along < 0.0 or along > squared:
            corner = edge
            if along > 0.0:
                corner = edge + 1 if edge + 1 < q else 0
            dx, dy = Q[corner, 0] - x, Q[corner, 1] - y
            d = math.sqrt(dx * dx + dy * dy)
            if d > DIRECTION_ROUND_OFF * (abs(x) + abs(y) + math.sqrt(squared)):
                return d, dx / d, dy / d, False, edge, apart
    return apart, -Q[edge, 2], -Q[edge, 3], True, edge, apart


@inlined
def from_faces(P: FloatArray, vertex_p: int, Q: FloatArray, vertex_q: int, faces: Faces, second: bool) -> Closest:
    """The closest points of cores P and Q along the normal of the face of Q, if `second`, or of P, by the vertex of the
    other core that is nearest along it."""
    d = faces.apart_q if second else faces.apart_p
    if second:
        return Closest(d, -Q[faces.edge_q, 2], -Q[faces.edge_q, 3], P[vertex_p, 0], P[vertex_p, 1], True, faces)
    nx, ny = P[faces.edge_p, 2], P[faces.edge_p, 3]
    return Closest(d, nx, ny, Q[vertex_q, 0] - d * nx, Q[vertex_q, 1] - d * ny, True, faces)


@nonallocating
def closest(P: FloatArray, p: int, Q: FloatArray, q: int) -> Closest:
    """Closest points of cores P and Q. Coincident points get the normal (1, 0)."""
    if p == 1:
        d, nx, ny, flat, edge, apart = point_core(P[0, 0], P[0, 1], Q, q)
        return Closest(d, nx, ny, P[0, 0], P[0, 1], flat, Faces(0, -math.inf, edge, apart))
    if q == 1:
        d, nx, ny, flat, edge, apart = point_core(Q[0, 0], Q[0, 1], P, p)
        return Closest(d, -nx, -ny, Q[0, 0] + d * nx, Q[0, 1] + d * ny, flat, Faces(edge, apart, 0, -math.inf))
    if min(p, q) < MANY_CORNERS:
        apart_p, edge_p, vertex_q = separation(P, p, Q, q, 0.0, 0.0)
        apart_q, edge_q, vertex_p = separation(Q, q, P, p, 0.0, 0.0)
    else:
        apart_p, edge_p, vertex_q = separation_of_many(P, p, Q, q)
        apart_q, edge_q, vertex_p = separation_of_many(Q, q, P, p)
    faces = Faces(edge_p, apart_p, edge_q, apart_q)
    size = abs(P[0, 0]) + abs(P[0, 1]) + abs(Q[0, 0]) + abs(Q[0, 1])
    size += abs(P[1, 0] - P[0, 0]) + abs(P[1, 1] - P[0, 1]) + abs(Q[1, 0] - Q[0, 0]) + abs(Q[1, 1] - Q[0, 1])
    near = DIRECTION_ROUND_OFF * size
    second = prefers_second(P, p, Q, q, faces, AXIS_TIE * size)
    apart = apart_q if second else apart_p
    if apart > -near:
        # If the foot of the nearest vertex is not on the edge, some other vertex and edge are closest.
        if second:
            off, nx, ny = beyond_edge(Q, q, edge_q, P[vertex_p, 0], P[vertex_p, 1]), Q[edge_q, 2], Q[edge_q, 3]
            high = Q[edge_q, 0] * nx + Q[edge_q, 1] * ny
        else:
            off, nx, ny = beyond_edge(P, p, edge_p, Q[vertex_q, 0], Q[vertex_q, 1]), -P[edge_p, 2], -P[edge_p, 3]
            high = P[edge_p, 0] * nx + P[edge_p, 1] * ny - apart
        if off > 0.0:
            # Along n, from Q to P, all of Q is below `high` and all of P above `high` + `apart`.
            low, high = high + apart - off - near, high + off + near
            d2, i, j, fx, fy, inside = vertex_edge(P, p, Q, q, nx, ny, low, high)
            e2, k, m, gx, gy, within = vertex_edge(Q, q, P, p, -nx, -ny, -high, -low)
            d = math.sqrt(min(d2, e2))
            if d > near:
                if d2 <= e2:
                    x, y, dx, dy = P[i, 0], P[i, 1], fx - P[i, 0], fy - P[i, 1]
                    nx, ny = -Q[j, 2], -Q[j, 3]
                else:
                    x, y, dx, dy = gx, gy, Q[k, 0] - gx, Q[k, 1] - gy
                    nx, ny, inside = P[m, 2], P[m, 3], within
                if not inside:
                    return Closest(d, dx / d, dy / d, x, y, False, faces)
                if nx * dx + ny * dy < 0.0:  # the other side of a segment
                    nx, ny = -nx, -ny
                return Closest(d, nx, ny, x, y, True, faces)
    return from_faces(P, vertex_p, Q, vertex_q, faces, second)

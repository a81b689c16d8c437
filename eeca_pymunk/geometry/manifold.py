"""Contact points of two shapes at one configuration: two if faces are opposite each other, else one.

The reference face is the edge along which the cores are farthest apart. The edge of the other core that is most opposed
to it is clipped to its length, along the tangent; both ends of the remaining part are contacts, with heights above the
reference as gaps. Rows are in the order of p . t with t = (-n_y, n_x): the key "pair and index of the row" remains
valid while the shapes stay on each other.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.contacts import ContactPoint
from ..model.parameters.detection import FACE_WIDTH
from ..model.scene import Scene
from .convex import place_vertices, prefers_second
from .gap import ordered_gap
from .sides import closest_on_side


@nonallocating
def clip(
    P: FloatArray, p: int, edge: int, Q: FloatArray, q: int, r_p: float, r_q: float, sign: float, reach: float,
    OUT: Rows[ContactPoint],
) -> int:  # fmt: skip
    """Write the contact points on an edge of P as reference face to OUT; returns their number. r_p, r_q: roundings.
    sign: 1 if the normal from a to b is P's, else -1."""
    nx, ny = P[edge, 2], P[edge, 3]
    tx, ty = -ny, nx
    end = edge + 1 if edge + 1 < p else 0
    x, y = P[edge, 0], P[edge, 1]
    width = (P[end, 0] - x) * tx + (P[end, 1] - y) * ty
    best, other = math.inf, 0
    for j in range(q):
        d = Q[j, 2] * nx + Q[j, 3] * ny
        if d < best:
            best, other = d, j
    last = other + 1 if other + 1 < q else 0
    # Counter-clockwise outlines: along P's edge, the opposite one runs backwards.
    u_0, h_0 = (Q[last, 0] - x) * tx + (Q[last, 1] - y) * ty, (Q[last, 0] - x) * nx + (Q[last, 1] - y) * ny
    u_1, h_1 = (Q[other, 0] - x) * tx + (Q[other, 1] - y) * ty, (Q[other, 0] - x) * nx + (Q[other, 1] - y) * ny
    low, high = max(u_0, 0.0), min(u_1, width)
    slope = 0.0
    if u_1 > u_0:
        slope = (h_1 - h_0) / (u_1 - u_0)
    count, points = 0, 2
    if high <= low:  # beside each other: the ends that are next to each other
        points = 1
        low = u_0 if u_0 >= width else u_1
        if 0.0 < u_1 <= u_0 < width:  # across: its end that is nearer
            h_0 = h_1 = min(h_0, h_1)
    for k in range(points + 1):
        # In the order of the tangent of the normal from a to b.
        u = low if (k == 0) == (sign > 0.0) or points == 1 else high
        h = h_0 if u == u_0 else (h_1 if u == u_1 else h_0 + slope * (u - u_0))
        if k == points:
            if count > 0:
                break
            # The part on the edge is beyond reach: the closest point of the cores is an end beside it.
            u, h = (u_0, h_0) if h_0 < h_1 else (u_1, h_1)
        g = h - r_p - r_q
        if g <= reach:
            away = r_p + 0.5 * g
            point = OUT[count]
            point.nx, point.ny, point.gap = sign * nx, sign * ny, g
            point.px, point.py = x + u * tx + away * nx, y + u * ty + away * ny
            count += 1
    return count


@nonallocating
def reverse(OUT: Rows[ContactPoint], count: int) -> None:
    """Exchange the two shapes of `count` rows: reverse normals, and with them the order along the tangent."""
    for k in range(count):
        OUT[k].nx, OUT[k].ny = -OUT[k].nx, -OUT[k].ny
    if count == 2:  # with the same normal
        one, two = OUT[0], OUT[1]
        one.px, one.py, one.gap, two.px, two.py, two.gap = two.px, two.py, two.gap, one.px, one.py, one.gap


@nonallocating
def ordered_manifold(
    A: Scene, s: int, r: int, POSE: FloatArray, a: int, b: int, reach: float, tolerance: float, OUT: Rows[ContactPoint]
) -> int:
    """`manifold` of shapes in the order of their numbers."""
    LINK, P, Q = A.LINK, A.CORE[0], A.CORE[1]
    r_s, r_r = A.SHAPE[s].rounding, A.SHAPE[r].rounding
    x_a, y_a, angle_a, x_b, y_b, angle_b = POSE[a, 0], POSE[a, 1], POSE[a, 2], POSE[b, 0], POSE[b, 1], POSE[b, 2]
    if LINK[s].vertices == 1 or LINK[r].vertices == 1:
        g, nx, ny, px, py = ordered_gap(A, s, x_a, y_a, angle_a, r, x_b, y_b, angle_b)
        OUT[0].nx, OUT[0].ny, OUT[0].px, OUT[0].py, OUT[0].gap = nx, ny, px, py, g
        return 1 if g <= reach else 0
    p = place_vertices(A, s, x_a, y_a, angle_a, P)
    q = place_vertices(A, r, x_b, y_b, angle_b, Q)
    near = closest_on_side(A, P, p, Q, q, s, r)
    g, faces = near.distance - r_s - r_r, near.faces
    if g > reach:
        return 0
    if not near.flat and near.distance > max(faces.apart_p, faces.apart_q) + tolerance:  # two corners
        away = r_s + 0.5 * g
        OUT[0].nx, OUT[0].ny, OUT[0].gap = near.nx, near.ny, g
        OUT[0].px, OUT[0].py = near.x + away * near.nx, near.y + away * near.ny
        return 1
    if prefers_second(P, p, Q, q, faces, tolerance):
        return clip(Q, q, faces.edge_q, P, p, r_r, r_s, -1.0, reach, OUT)
    return clip(P, p, faces.edge_p, Q, q, r_s, r_r, 1.0, reach, OUT)


@nonallocating
def manifold(
    A: Scene, s: int, r: int, POSE: FloatArray, a: int, b: int, reach: float, tolerance: float, OUT: Rows[ContactPoint]
) -> int:
    """Write the points at which shapes s and r are no farther apart than `reach` (length) to OUT (2,); returns their
    number, 0, 1 or 2.

    Args:
        POSE: (k, 3) x, y and angle; rows a and b are those of the bodies of s and r.
        tolerance: length, by which the shapes may be less far apart along the longer of two reference faces, and by
            which two corners must be farther apart than the faces beside them to be a contact of their own.
        OUT: normals from s to r, the gap along the reference face's normal.
    """
    if s <= r:
        return ordered_manifold(A, s, r, POSE, a, b, reach, tolerance, OUT)
    count = ordered_manifold(A, r, s, POSE, b, a, reach, tolerance, OUT)
    reverse(OUT, count)
    return count


@nonallocating
def support_range(P: FloatArray, p: int, nx: float, ny: float, tolerance: float) -> tuple[float, float, float, float]:
    """Of the vertices of a core that are at most `tolerance` below the highest along n: the least and largest position
    along t = (-n_y, n_x); then the height of the highest, and the extent of the whole core along t."""
    top, left, right = -math.inf, math.inf, -math.inf
    for k in range(p):
        top = max(top, P[k, 0] * nx + P[k, 1] * ny)
        u = P[k, 1] * nx - P[k, 0] * ny
        left, right = min(left, u), max(right, u)
    low, high = math.inf, -math.inf
    for k in range(p):
        if P[k, 0] * nx + P[k, 1] * ny >= top - tolerance:
            u = P[k, 1] * nx - P[k, 0] * ny
            low, high = min(low, u), max(high, u)
    return low, high, top, right - left


@nonallocating
def face_points(
    A: Scene, s: int, r: int, g: float, nx: float, ny: float, px: float, py: float, tolerance: float
) -> tuple[int, float, float, float, float]:  # fmt: skip
    """How many contact points `face` has for shapes s < r, whose placed cores stand in CORE, and these (2 each): the
    ends of their common face; else only p, given as the normal n and the gap g are."""
    P, Q, p, q = A.CORE[0], A.CORE[1], A.LINK[s].vertices, A.LINK[r].vertices
    if p > 1 and q > 1:
        slack = tolerance + max(-g, 0.0)
        low_p, high_p, top, size_p = support_range(P, p, nx, ny, slack)
        low_q, high_q, _, size_q = support_range(Q, q, -nx, -ny, slack)
        low, high = max(low_p, -high_q), min(high_p, -low_q)
        if high - low > FACE_WIDTH * max(size_p, size_q):
            top += A.SHAPE[s].rounding + 0.5 * g
            return 2, top * nx - low * ny, top * ny + low * nx, top * nx - high * ny, top * ny + high * nx
    return 1, px, py, px, py


@nonallocating
def face(A: Scene, s: int, r: int, POSE: FloatArray, a: int, b: int, tolerance: float, OUT: Rows[ContactPoint]) -> int:
    """Write the contact of shapes s < r that meet to OUT, as `manifold` does: 2 rows, the ends of their common face,
    if both have an edge normal to n within `tolerance` (length), else 1. The gap is the same at both ends.

    In overlap every corner inside the other shape acts: the tolerance is increased by the depth.
    """
    g, nx, ny, px, py = ordered_gap(A, s, POSE[a, 0], POSE[a, 1], POSE[a, 2], r, POSE[b, 0], POSE[b, 1], POSE[b, 2])
    count, OUT[0].px, OUT[0].py, OUT[1].px, OUT[1].py = face_points(A, s, r, g, nx, ny, px, py, tolerance)
    for k in range(count):
        OUT[k].nx, OUT[k].ny, OUT[k].gap = nx, ny, g
    return count

"""Gaps of shapes: the sole owner of their sign. g < 0 in overlap, n points from a to b.

    g = |closest points of the two cores| - r_a - r_b,    p = (point of a's core) + (r_a + g / 2) n,

with the roundings r; p is halfway between the two surfaces. Exchanging a and b changes no bit of g, n (but its sign)
and p: pairs are computed from the lower shape number to the higher one.

The placed cores of a and b stand in CORE afterwards, but for points; a segment in a corner is longer there, as
`sides.corner_of` extends it.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import Table, nonallocating
from ..model.parameters.detection import CORNER_ROUND_OFF, GAP_ROUND_OFF
from ..model.scene import Scene, scene_of
from .convex import place_vertices, point_core
from .flight import pose, rotated
from .sides import closest_on_side


@nonallocating
def disk_centre(A: Scene, s: int, x: float, y: float, angle: float) -> tuple[float, float]:
    """World position of the one vertex of disk s; that of the body, to the last digit, if it is the centre of mass."""
    px, py = rotated(A.VERTEX[A.LINK[s].first, 0], A.VERTEX[A.LINK[s].first, 1], angle)
    return x + px, y + py


@nonallocating
def ordered_gap(
    A: Scene, a: int, x_a: float, y_a: float, angle_a: float, b: int, x_b: float, y_b: float, angle_b: float
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """`gap_at` of shapes in the order of their numbers; a's placed core goes to CORE[0], b's to CORE[1]."""
    LINK, P, Q = A.LINK, A.CORE[0], A.CORE[1]
    r_a, r_b = A.SHAPE[a].rounding, A.SHAPE[b].rounding
    if LINK[a].vertices == 1 and LINK[b].vertices == 1:
        x, y = disk_centre(A, a, x_a, y_a, angle_a)
        px, py = disk_centre(A, b, x_b, y_b, angle_b)
        dx, dy = px - x, py - y
        d = math.sqrt(dx * dx + dy * dy)
        nx, ny = 1.0, 0.0
        if d > 0.0:
            nx, ny = dx / d, dy / d
    elif LINK[a].vertices == 1:
        x, y = disk_centre(A, a, x_a, y_a, angle_a)
        q = place_vertices(A, b, x_b, y_b, angle_b, Q)
        d, nx, ny, _, _, _ = point_core(x, y, Q, q)
    else:
        p = place_vertices(A, a, x_a, y_a, angle_a, P)
        q = place_vertices(A, b, x_b, y_b, angle_b, Q)
        near = closest_on_side(A, P, p, Q, q, a, b)
        d, nx, ny, x, y = near.distance, near.nx, near.ny, near.x, near.y
    g = d - r_a - r_b
    away = r_a + 0.5 * g
    return g, nx, ny, x + away * nx, y + away * ny


@nonallocating
def gap_at(
    A: Scene, a: int, x_a: float, y_a: float, angle_a: float, b: int, x_b: float, y_b: float, angle_b: float
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """Gap (length), unit normal (2) from a to b and point (2) of shapes a and b, their bodies at the given poses."""
    sign = 1.0
    if a > b:
        sign = -1.0
        a, x_a, y_a, angle_a, b, x_b, y_b, angle_b = b, x_b, y_b, angle_b, a, x_a, y_a, angle_a
    g, nx, ny, px, py = ordered_gap(A, a, x_a, y_a, angle_a, b, x_b, y_b, angle_b)
    return g, sign * nx, sign * ny, px, py


@nonallocating
def gap_along(
    A: Scene, a: int, x_a: float, y_a: float, angle_a: float, b: int, x_b: float, y_b: float, angle_b: float,
    nx: float, ny: float,
) -> float:  # fmt: skip
    """How far (length) shape b is beyond shape a along n, their bodies at the given poses: no more than their gap."""
    P, Q = A.CORE[0], A.CORE[1]
    p, q = place_vertices(A, a, x_a, y_a, angle_a, P), place_vertices(A, b, x_b, y_b, angle_b, Q)
    x, y = P[0, 0], P[0, 1]
    top, bottom = 0.0, math.inf  # of a, and the bottom of b, as heights above its first vertex
    for i in range(1, p):
        top = max(top, nx * (P[i, 0] - x) + ny * (P[i, 1] - y))
    for j in range(q):
        bottom = min(bottom, nx * (Q[j, 0] - x) + ny * (Q[j, 1] - y))
    return bottom - top - A.SHAPE[a].rounding - A.SHAPE[b].rounding


@nonallocating
def gap(A: Scene, a: int, b: int, t: float) -> tuple[float, float, float, float, float]:
    """`gap_at` of shapes a and b at instant t of their bodies' paths."""
    x_a, y_a, angle_a = pose(A.BODY, A.LINK[a].owner, t)
    x_b, y_b, angle_b = pose(A.BODY, A.LINK[b].owner, t)
    return gap_at(A, a, x_a, y_a, angle_a, b, x_b, y_b, angle_b)


@nonallocating
def gaps(table: Table, PAIRS: IntArray, POSE_A: FloatArray, POSE_B: FloatArray, OUT: FloatArray) -> None:
    """`gap_at` of PAIRS (m, 2) of shapes with their bodies at POSE_A and POSE_B (m, 3): rows (g, n_x, n_y, p_x, p_y) of
    OUT."""
    A = scene_of(table)
    for k in range(PAIRS.shape[0]):
        OUT[k, 0], OUT[k, 1], OUT[k, 2], OUT[k, 3], OUT[k, 4] = gap_at(
            A, PAIRS[k, 0], POSE_A[k, 0], POSE_A[k, 1], POSE_A[k, 2],
            PAIRS[k, 1], POSE_B[k, 0], POSE_B[k, 1], POSE_B[k, 2],
        )  # fmt: skip


@nonallocating
def gap_round_off(A: Scene, a: int, b: int) -> float:
    """Length up to which a gap of shapes a and b is round-off of positions and sizes: they touch exactly.

    GAP_ROUND_OFF (max(|x|, |y|) + sizes), where the sizes are the roundings for two single disks and for a single disk
    and a static shape; else CORNER_ROUND_OFF times the roundings and the larger extent of the two. Of a static shape,
    whose place is that of its vertices, the bounding circle is the extent; positions are those of the bodies that move.
    """
    BODY, SHAPE, LINK, disks = A.BODY, A.SHAPE, A.LINK, A.COUNT.disks
    ground = BODY.shape[0] - 1
    i, j = LINK[a].owner, LINK[b].owner
    far: float = max(max(abs(BODY[i].x), abs(BODY[i].y)), max(abs(BODY[j].x), abs(BODY[j].y)))
    size: float = SHAPE[a].rounding + SHAPE[b].rounding
    if not ((a < disks and (b < disks or j == ground)) or (b < disks and i == ground)):
        extent_a = SHAPE[a].bound if i == ground else SHAPE[a].extent
        extent_b = SHAPE[b].bound if j == ground else SHAPE[b].extent
        size = CORNER_ROUND_OFF * (size + max(extent_a, extent_b))
    return GAP_ROUND_OFF * (far + size)

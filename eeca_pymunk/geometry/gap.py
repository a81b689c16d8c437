"""Gaps of shapes: the sole owner of their sign. g < 0 in overlap, n points from a to b.

    g = |closest points of the two cores| - r_a - r_b,    p = (point of a's core) + (r_a + g / 2) n,

with the roundings r; p is halfway between the two surfaces. Exchanging a and b changes no bit of g, n (but its sign)
and p: pairs are computed from the lower shape number to the higher one.

WORK (2, K, 4) is scratch, K the most vertices of a shape: the placed cores of a and b.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..layout import BOUND, COUNT, FIRST, OWNER, ROUNDING, SIZE, X, Y
from .convex import closest, place, point_core
from .flight import pose

ROUND_OFF = 1e-12  # of lengths, relative to positions and sizes
CORNERS = 4.0  # times that, of corners placed by their angle


@kernel
def centre(LINK: IntArray, VERTEX: FloatArray, s: int, x: float, y: float, angle: float) -> tuple[float, float]:
    """World position of the one vertex of disk s; that of the body, to the last digit, if it is the centre of mass."""
    px, py = VERTEX[LINK[s, FIRST], 0], VERTEX[LINK[s, FIRST], 1]
    if px == 0.0 and py == 0.0:
        return x, y
    if angle == 0.0:
        return x + px, y + py
    c, z = math.cos(angle), math.sin(angle)
    return x + (c * px - z * py), y + (z * px + c * py)


@kernel
def ordered_gap(
    SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, WORK: FloatArray,
    a: int, x_a: float, y_a: float, angle_a: float, b: int, x_b: float, y_b: float, angle_b: float,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """`gap_at` of shapes in the order of their numbers; a's placed core goes to WORK[0], b's to WORK[1]."""
    r_a, r_b = SHAPE[a, ROUNDING], SHAPE[b, ROUNDING]
    if LINK[a, COUNT] == 1 and LINK[b, COUNT] == 1:
        x, y = centre(LINK, VERTEX, a, x_a, y_a, angle_a)
        px, py = centre(LINK, VERTEX, b, x_b, y_b, angle_b)
        dx, dy = px - x, py - y
        d = math.sqrt(dx * dx + dy * dy)
        nx, ny = 1.0, 0.0
        if d > 0.0:
            nx, ny = dx / d, dy / d
    elif LINK[a, COUNT] == 1:
        x, y = centre(LINK, VERTEX, a, x_a, y_a, angle_a)
        q = place(LINK, VERTEX, b, x_b, y_b, angle_b, WORK[1])
        d, nx, ny, _, _, _ = point_core(x, y, WORK[1], q)
    else:
        p = place(LINK, VERTEX, a, x_a, y_a, angle_a, WORK[0])
        q = place(LINK, VERTEX, b, x_b, y_b, angle_b, WORK[1])
        d, nx, ny, x, y, _, _, _, _, _ = closest(WORK[0], p, WORK[1], q)
    g = d - r_a - r_b
    away = r_a + 0.5 * g
    return g, nx, ny, x + away * nx, y + away * ny


@kernel
def gap_at(
    SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, WORK: FloatArray,
    a: int, x_a: float, y_a: float, angle_a: float, b: int, x_b: float, y_b: float, angle_b: float,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """Gap (length), unit normal (2) from a to b and point (2) of shapes a and b, their bodies at the given poses."""
    if a <= b:
        return ordered_gap(SHAPE, LINK, VERTEX, WORK, a, x_a, y_a, angle_a, b, x_b, y_b, angle_b)
    g, nx, ny, px, py = ordered_gap(SHAPE, LINK, VERTEX, WORK, b, x_b, y_b, angle_b, a, x_a, y_a, angle_a)
    return g, -nx, -ny, px, py


@kernel
def gap(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, WORK: FloatArray, a: int, b: int, t: float
) -> tuple[float, float, float, float, float]:
    """`gap_at` of shapes a and b at instant t of their bodies' paths."""
    x_a, y_a, angle_a = pose(BODY, LINK[a, OWNER], t)
    x_b, y_b, angle_b = pose(BODY, LINK[b, OWNER], t)
    return gap_at(SHAPE, LINK, VERTEX, WORK, a, x_a, y_a, angle_a, b, x_b, y_b, angle_b)


@kernel
def gaps(
    POSES: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, A: IntArray, B: IntArray,
    WORK: FloatArray, OUT: FloatArray,
) -> None:  # fmt: skip
    """`gap_at` of shapes A (m,) and B (m,) with all bodies at POSES (n, 3): rows (g, n_x, n_y, p_x, p_y) of OUT."""
    for k in range(A.shape[0]):
        a, b = A[k], B[k]
        i, j = LINK[a, OWNER], LINK[b, OWNER]
        OUT[k, 0], OUT[k, 1], OUT[k, 2], OUT[k, 3], OUT[k, 4] = gap_at(
            SHAPE, LINK, VERTEX, WORK,
            a, POSES[i, 0], POSES[i, 1], POSES[i, 2], b, POSES[j, 0], POSES[j, 1], POSES[j, 2],
        )  # fmt: skip


@kernel
def touching(BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, a: int, b: int, disks: int) -> float:
    """Length up to which a gap of shapes a and b is round-off of positions and sizes: they touch exactly.

    1e-12 (max(|x|, |y|) + sizes), where the sizes are the roundings for two lone disks and for a lone disk and a
    static shape; else four times the roundings and the larger extent of the two. Of a static shape, whose place is
    that of its vertices, the bounding circle is the extent; positions are those of the bodies that move.
    """
    ground = BODY.shape[0] - 1
    i, j = LINK[a, OWNER], LINK[b, OWNER]
    far = max(max(abs(BODY[i, X]), abs(BODY[i, Y])), max(abs(BODY[j, X]), abs(BODY[j, Y])))
    size = SHAPE[a, ROUNDING] + SHAPE[b, ROUNDING]
    if not ((a < disks and (b < disks or j == ground)) or (b < disks and i == ground)):
        extent_a = SHAPE[a, BOUND] if i == ground else SHAPE[a, SIZE]
        extent_b = SHAPE[b, BOUND] if j == ground else SHAPE[b, SIZE]
        size = CORNERS * (size + max(extent_a, extent_b))
    return ROUND_OFF * (far + size)

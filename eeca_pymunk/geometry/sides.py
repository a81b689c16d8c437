"""On which side of each other two thin shapes are: what their distance does not tell where they touch.

Thin are segments and planks, whose cores have no inside, or hardly any. Along the normals of an edge's two sides two
segments that lie flush are equally far apart, 0, and of thin shapes that have come to cross by round-off, or by the
error of a step, the nearer way out may be the wrong one. So pairs of them remember a normal m from a to b, in the
memory of sides, WORK[SIDES]: rows (1 + a k + b, m_x, m_y, depth) for the shapes a < b of k. It holds

* for cores that touch, up to 1e-4 of the smaller one, and
* for contacts that forces hold (`depth` > 0) as far as they may have come through one another: a normal against m is
  the wrong one up to that distance (length), and the gap is negative.

What is farther apart has its side from the geometry, and the forecasts of its next impact note it.

Segments of one body that meet, end to end or an end on the other, are one boundary. What lies in the corner between
two, by its side of one, and is nearest to the other where they meet, is on that one's side that looks into the corner:
there it meets that side as if it went on beyond the end, by a tenth of the smaller shape. In a corner of less than 180
degrees nothing of that is inside, so the corner stays what it is. (WORK[CORNERS], see `corners.py`)
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.parameters.detection import SIDE_HELD, SIDE_OPPOSITE, SIDE_TOUCH, SIDE_UNSURE, STRAIGHT
from ..model.shapes import Link, Shape
from .convex import closest

SIDES, CORNERS = 2, 3  # of WORK
_PROBES = 16  # rows that a pair may stand in
_SCATTER = 40503


@uncounted
def remembers(LINK: Rows[Link], WORK: FloatArray, a: int, b: int) -> bool:
    """Whether shapes a and b are thin, in a scene that remembers sides."""
    if WORK.shape[0] <= SIDES or LINK[a].vertices < 2 or LINK[b].vertices < 2:
        return False
    return bool(WORK[CORNERS, 4 * a, 3] > 0.0 and WORK[CORNERS, 4 * b, 3] > 0.0)


@uncounted
def side_row(WORK: FloatArray, key: int) -> int:
    """The row of a pair in the memory, or else one for it: a free one, if there is any nearby."""
    mask = WORK.shape[1] - 1
    first = (key * _SCATTER >> 3) & mask
    for k in range(_PROBES):
        row = (first + k) & mask
        if WORK[SIDES, row, 0] == key + 1.0 or WORK[SIDES, row, 0] == 0.0:
            return row
    return first


@uncounted
def note_side(
    SHAPE: Rows[Shape], LINK: Rows[Link], WORK: FloatArray, a: int, b: int, nx: float, ny: float, held: bool
) -> None:  # fmt: skip
    """Remember the normal n from shape a to shape b; `held` if forces hold them in contact."""
    if not remembers(LINK, WORK, a, b):
        return
    if a > b:
        a, b, nx, ny = b, a, -nx, -ny
    key = a * SHAPE.shape[0] + b
    row = side_row(WORK, key)
    WORK[SIDES, row, 0], WORK[SIDES, row, 1], WORK[SIDES, row, 2] = key + 1.0, nx, ny
    WORK[SIDES, row, 3] = SIDE_HELD * min(SHAPE[a].extent, SHAPE[b].extent) if held else 0.0


@uncounted
def near_side(SHAPE: Rows[Shape], a: int, b: int) -> float:
    """Length up to which cores touch, so that the memory tells their side."""
    return SIDE_TOUCH * min(SHAPE[a].extent, SHAPE[b].extent)


@uncounted
def known_side(SHAPE: Rows[Shape], LINK: Rows[Link], WORK: FloatArray, a: int, b: int) -> bool:
    """Whether the pair a < b of thin shapes has a remembered normal."""
    key = a * SHAPE.shape[0] + b
    return bool(WORK[SIDES, side_row(WORK, key), 0] == key + 1.0)


@uncounted
def forget_sides(LINK: Rows[Link], WORK: FloatArray, shapes: int, i: int) -> None:
    """Forget the sides of all shapes of body i, which was put where it is."""
    if WORK.shape[0] <= SIDES:
        return
    for row in range(WORK.shape[1]):
        key = int(WORK[SIDES, row, 0]) - 1
        if key >= 0 and (LINK[key // shapes].owner == i or LINK[key % shapes].owner == i):
            WORK[SIDES, row, 0] = -1.0  # others stand behind it


@uncounted
def keep_sides(KNOWN: FloatArray, WORK: FloatArray, PLACE: IntArray, shapes: int) -> None:
    """Remember what KNOWN (m, 4) has of pairs of shapes whose numbers now, PLACE (k,) of `shapes`, are not -1."""
    k = PLACE.shape[0]
    for row in range(KNOWN.shape[0]):
        key = int(KNOWN[row, 0]) - 1
        if key < 0 or PLACE[key // k] < 0 or PLACE[key % k] < 0:
            continue
        a, b, sign = PLACE[key // k], PLACE[key % k], 1.0
        if a > b:
            a, b, sign = b, a, -1.0
        key = a * shapes + b
        to = WORK[SIDES, side_row(WORK, key)]
        to[0], to[1], to[2], to[3] = (
            key + 1.0,
            sign * KNOWN[row, 1],
            sign * KNOWN[row, 2],
            KNOWN[row, 3],
        )


@uncounted
def axis(
    P: FloatArray, p: int, Q: FloatArray, q: int, sign: float, mx: float, my: float
) -> tuple[float, int, int]:  # fmt: skip
    """Of the edges of P whose normals, times `sign`, look along m, the one along which Q is farthest apart: how far,
    that edge, and Q's vertex that is nearest along it."""
    best, edge, vertex = -math.inf, 0, 0
    for j in range(p):
        nx, ny = P[j, 2], P[j, 3]
        if sign * (nx * mx + ny * my) <= 0.0:
            continue
        least, lowest = math.inf, 0
        for i in range(q):
            height = (Q[i, 0] - P[j, 0]) * nx + (Q[i, 1] - P[j, 1]) * ny
            if height < least:
                least, lowest = height, i
        if least > best:
            best, edge, vertex = least, j, lowest
    return best, edge, vertex


@uncounted
def side_of(SHAPE: Rows[Shape], WORK: FloatArray, a: int, b: int) -> tuple[float, float]:
    """The remembered normal from shape a to shape b, (0, 0) if there is none."""
    sign = 1.0
    if a > b:
        a, b, sign = b, a, -1.0
    key = a * SHAPE.shape[0] + b
    row = side_row(WORK, key)
    if WORK[SIDES, row, 0] != key + 1.0:
        return 0.0, 0.0
    return sign * WORK[SIDES, row, 1], sign * WORK[SIDES, row, 2]


@uncounted
def corner_of(
    SHAPE: Rows[Shape], WORK: FloatArray, W: FloatArray, w: int, o: int, sx: float, sy: float, deep: float
) -> tuple[int, float, float]:  # fmt: skip
    """Of shape o, which is nearest to the segment w, placed as W, along s, from o to w: the end of w at which it lies
    in a corner, -1 if in none, and the normal (2) of the side of w that looks into that. There W goes on by `deep`."""
    ex, ey = W[1, 0] - W[0, 0], W[1, 1] - W[0, 1]
    end = 0
    if ex * sx + ey * sy < 0.0:
        end, ex, ey = 1, -ex, -ey
    length = math.sqrt(ex * ex + ey * ey)
    ux, uy = ex / length, ey / length
    for turn in range(2):
        row = 4 * w + 2 * end + turn
        other = int(WORK[CORNERS, row, 0]) - 1
        sign = 1.0 - 2.0 * turn
        c, z = WORK[CORNERS, row, 1], WORK[CORNERS, row, 2]
        if other < 0 or other == o or sign * z <= STRAIGHT:
            continue
        lx, ly = -sign * uy, sign * ux
        mx, my = side_of(SHAPE, WORK, other, o)
        if sign * (mx * (z * ux + c * uy) - my * (c * ux - z * uy)) < SIDE_UNSURE:
            continue
        mx, my = side_of(SHAPE, WORK, w, o)
        if mx * lx + my * ly >= SIDE_OPPOSITE:
            W[end, 0], W[end, 1] = W[end, 0] - deep * ux, W[end, 1] - deep * uy
            return end, lx, ly
    return -1, 0.0, 0.0


@uncounted
def closest_on_side(
    SHAPE: Rows[Shape], LINK: Rows[Link], WORK: FloatArray, P: FloatArray, p: int, Q: FloatArray, q: int,
    a: int, b: int,
) -> tuple[float, float, float, float, float, bool, int, float, int, float]:  # fmt: skip
    """`closest` of the cores P and Q of shapes a < b; of thin ones that touch, or have come through one another, on the
    side that the pair remembers, and in corners on the side that looks into it."""
    d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q = closest(P, p, Q, q)
    if not remembers(LINK, WORK, a, b):
        return d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q
    deep = SIDE_HELD * min(SHAPE[a].extent, SHAPE[b].extent)
    end = -1
    if q == 2:
        end, mx, my = corner_of(SHAPE, WORK, Q, b, a, nx, ny, deep)
        mx, my = -mx, -my
    if end < 0 and p == 2:
        end, mx, my = corner_of(SHAPE, WORK, P, a, b, -nx, -ny, deep)
    near = near_side(SHAPE, a, b)
    if end >= 0:
        d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q = closest(P, p, Q, q)
        reach = deep
    else:
        key = a * SHAPE.shape[0] + b
        row = side_row(WORK, key)
        mx, my, reach = WORK[SIDES, row, 1], WORK[SIDES, row, 2], max(near, WORK[SIDES, row, 3])
        if WORK[SIDES, row, 0] != key + 1.0:
            return d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q
    along = nx * mx + ny * my
    if d > reach or (along >= SIDE_OPPOSITE and (along >= SIDE_UNSURE or d > near)):
        return d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q
    apart_p, edge_p, vertex_q = axis(P, p, Q, q, 1.0, mx, my)
    apart_q, edge_q, vertex_p = axis(Q, q, P, p, -1.0, mx, my)
    if apart_q > apart_p:
        nx, ny, x, y = -Q[edge_q, 2], -Q[edge_q, 3], P[vertex_p, 0], P[vertex_p, 1]
        return apart_q, nx, ny, x, y, True, edge_p, apart_p, edge_q, apart_q
    nx, ny = P[edge_p, 2], P[edge_p, 3]
    x, y = Q[vertex_q, 0] - apart_p * nx, Q[vertex_q, 1] - apart_p * ny
    return apart_p, nx, ny, x, y, True, edge_p, apart_p, edge_q, apart_q

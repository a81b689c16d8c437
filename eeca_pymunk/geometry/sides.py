"""On which side of each other two segments are: what their distance does not tell where it is 0.

The cores of segments have no inside. Along the normals of an edge's two sides two segments that lie flush are equally
far apart, 0, and of segments that have come to cross by round-off the nearer way out may be the wrong one. So pairs of
segments remember a normal m from a to b, in the memory of sides, WORK[2]: rows (1 + a k + b, m_x, m_y, depth) for the
shapes a < b of k. It holds

* for cores that touch, up to 1e-4 of the smaller one (at the common end of two walls a third segment that lies in one
  of them would else slip between them), and
* for contacts that forces hold (`depth` > 0) as far as they may have come through one another: a normal against m is
  the wrong one up to that distance (length), and the gap is negative.

What is farther apart has its side from the geometry, and the forecasts of its next impact note it.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.parameters.detection import SIDE_HELD, SIDE_OPPOSITE, SIDE_TOUCH, SIDE_UNSURE
from ..model.shapes import Link, Shape
from .convex import closest

SIDES = 2  # of WORK
_PROBES = 16  # rows that a pair may stand in
_SCATTER = 40503


@uncounted
def remembers(LINK: Rows[Link], WORK: FloatArray, a: int, b: int) -> bool:
    """Whether shapes a and b are segments, in a scene that remembers sides."""
    return bool(LINK[a].vertices == 2 and LINK[b].vertices == 2 and WORK.shape[0] > SIDES)


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
    """Remember the normal n from segment a to segment b; `held` if forces hold them in contact."""
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
    """Whether the pair a < b of segments has a remembered normal."""
    key = a * SHAPE.shape[0] + b
    return bool(WORK[SIDES, side_row(WORK, key), 0] == key + 1.0)


@uncounted
def forget_sides(LINK: Rows[Link], WORK: FloatArray, shapes: int, i: int) -> None:
    """Forget the sides of all segments of body i, which was put where it is."""
    if WORK.shape[0] <= SIDES:
        return
    for row in range(WORK.shape[1]):
        key = int(WORK[SIDES, row, 0]) - 1
        if key >= 0 and (LINK[key // shapes].owner == i or LINK[key % shapes].owner == i):
            WORK[SIDES, row, 0] = -1.0  # others stand behind it


@uncounted
def axis(P: FloatArray, Q: FloatArray, sign: float, mx: float, my: float) -> tuple[float, int, int]:
    """Of the edges of segment P the one whose normal, times `sign`, looks along m: how far Q is apart along it, that
    edge, and Q's vertex that is nearest along it."""
    best, edge, vertex = -math.inf, 0, 0
    for j in range(2):
        nx, ny = P[j, 2], P[j, 3]
        h_0 = (Q[0, 0] - P[j, 0]) * nx + (Q[0, 1] - P[j, 1]) * ny
        h_1 = (Q[1, 0] - P[j, 0]) * nx + (Q[1, 1] - P[j, 1]) * ny
        least, lowest = (h_0, 0) if h_0 <= h_1 else (h_1, 1)
        if sign * (nx * mx + ny * my) > 0.0 and least > best:
            best, edge, vertex = least, j, lowest
    return best, edge, vertex


@uncounted
def closest_on_side(
    SHAPE: Rows[Shape], LINK: Rows[Link], WORK: FloatArray, P: FloatArray, p: int, Q: FloatArray, q: int,
    a: int, b: int,
) -> tuple[float, float, float, float, float, bool, int, float, int, float]:  # fmt: skip
    """`closest` of the cores P and Q of shapes a < b; of segments that touch, or have come through one another, on the
    side that the pair remembers."""
    d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q = closest(P, p, Q, q)
    if not remembers(LINK, WORK, a, b):
        return d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q
    key = a * SHAPE.shape[0] + b
    row = side_row(WORK, key)
    mx, my = WORK[SIDES, row, 1], WORK[SIDES, row, 2]
    along, near = nx * mx + ny * my, near_side(SHAPE, a, b)
    right = along >= SIDE_OPPOSITE and (along >= SIDE_UNSURE or d > near)
    if WORK[SIDES, row, 0] != key + 1.0 or right or d > max(near, WORK[SIDES, row, 3]):
        return d, nx, ny, x, y, flat, edge_p, apart_p, edge_q, apart_q
    apart_p, edge_p, vertex_q = axis(P, Q, 1.0, mx, my)
    apart_q, edge_q, vertex_p = axis(Q, P, -1.0, mx, my)
    if apart_q > apart_p:
        nx, ny, x, y = -Q[edge_q, 2], -Q[edge_q, 3], P[vertex_p, 0], P[vertex_p, 1]
        return apart_q, nx, ny, x, y, True, edge_p, apart_p, edge_q, apart_q
    nx, ny = P[edge_p, 2], P[edge_p, 3]
    x, y = Q[vertex_q, 0] - apart_p * nx, Q[vertex_q, 1] - apart_p * ny
    return apart_p, nx, ny, x, y, True, edge_p, apart_p, edge_q, apart_q

"""On which side of each other two thin shapes are, which their distance does not tell where they touch.

Thin shapes are segments and planks, whose cores have almost no interior. Along the normals of both sides of an edge,
two parallel segments that touch have the same distance 0; and if thin shapes cross by round-off, or by the error of a
step, the shortest way apart may be the wrong one. So each pair of them remembers a normal m from a to b, in the rows of
SIDE. It is valid

* for cores that touch, up to the depth that an interval always allows, and
* for contacts that forces hold, and pairs that a correction displaces (`deep` > 0), as far as they may move relative to
  each other in an interval: a normal n with n . m < 0 is the wrong one up to that distance (length), and the gap is
  negative.

Pairs that are farther apart have their side from the geometry, and the prediction of their next impact notes it.

Segments of one body that meet, end to end or an end on the other, are one boundary. A shape in the corner between two
of them, on the inner side of one, and nearest to the other at the common end, is on that one's inner side: it meets
that side as if the segment extended beyond its end, by that distance. In a corner of less than 180 degrees none of this
extension is in the interior, so the corner keeps its shape. (CORNER, see `corners.py`)
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.parameters.detection import STRAIGHT
from ..model.parameters.intervals import INTERVAL_DEPTH_LEAST, INTERVAL_WAY
from ..model.scene import Scene
from ..model.shapes import Side
from .convex import Closest, Faces, closest, from_faces
from .separation import separation
from .widths import half_width, smaller

_PROBES = 16  # rows in which a pair may be
_SCATTER = 40503


@nonallocating
def remembers(A: Scene, a: int, b: int) -> bool:
    """Whether shapes a and b are thin, in a scene that remembers sides."""
    if len(A.SIDE) == 0 or A.LINK[a].vertices < 2 or A.LINK[b].vertices < 2:
        return False
    return bool(A.CORNER[4 * a].thin > 0 and A.CORNER[4 * b].thin > 0)


@inlined
def pair_of(A: Scene, a: int, b: int) -> int:
    """The number of the pair of shapes a and b, in either order."""
    return min(a, b) * A.SHAPE.shape[0] + max(a, b)


@inlined
def shapes_of_pair(shapes: int, pair: int) -> tuple[int, int]:
    """The shapes a < b of a pair, by its number >= 0, out of `shapes`."""
    return pair // shapes, pair % shapes


@inlined
def side_key(A: Scene, a: int, b: int) -> int:
    """The key of a pair in the memory."""
    return 1 + pair_of(A, a, b)


@nonallocating
def side_row(A: Scene, key: int) -> int:
    """Row of a pair in the memory, else a free one for it, if there is any within _PROBES rows, else one to be
    replaced."""
    SIDE, mask = A.SIDE, len(A.SIDE) - 1
    mixed = (((key - 1) ^ (key - 1 >> 15)) * _SCATTER) & 0xFFFFFFFF
    first = (mixed ^ mixed >> 13) & mask  # high digits count too: numbers of shapes may be powers of 2
    free = first
    for k in range(_PROBES):
        row = (first + k) & mask
        if SIDE[row].key == key:
            return row
        if SIDE[row].key <= 0 and SIDE[free].key > 0:
            free = row
        if SIDE[row].key == 0:
            break
    return free


@nonallocating
def held_side(A: Scene, a: int, b: int) -> float:
    """Distance of cores (length) up to which the memory determines the side of shapes that forces hold in contact."""
    return INTERVAL_WAY * smaller(A, a, b)


@nonallocating
def note_side(A: Scene, a: int, b: int, nx: float, ny: float, held: bool) -> None:
    """Remember the normal n from shape a to shape b; `held` if forces hold them in contact."""
    if not remembers(A, a, b):
        return
    key, sign = side_key(A, a, b), 1.0 if a < b else -1.0
    side = A.SIDE[side_row(A, key)]
    side.key, side.nx, side.ny = key, sign * nx, sign * ny
    side.deep = held_side(A, a, b) if held else 0.0


@nonallocating
def near_side(A: Scene, a: int, b: int) -> float:
    """Distance of cores (length) up to which the memory determines their side."""
    return INTERVAL_DEPTH_LEAST * smaller(A, a, b)


@nonallocating
def forget_sides(A: Scene, i: int, way: float) -> None:
    """Forget the sides of those shapes of body i, which the program has placed, that may be on others since: it was
    moved, or turned at its extent, by `way` (length), farther than from the middle of both shapes to their surfaces."""
    SIDE, LINK, shapes = A.SIDE, A.LINK, len(A.SHAPE)
    for row in range(len(SIDE)):
        if SIDE[row].key <= 0:
            continue
        a, b = shapes_of_pair(shapes, SIDE[row].key - 1)
        if LINK[a].owner != i and LINK[b].owner != i:
            continue
        thick = half_width(A, a) + half_width(A, b)
        if way > max(thick, INTERVAL_DEPTH_LEAST * A.BODY[i].extent):
            SIDE[row].key = -1  # deleted: rows behind it may belong to other pairs


@nonallocating
def forget_pair(A: Scene, a: int, b: int) -> None:
    """Forget the side of shapes a and b."""
    key = side_key(A, a, b)
    side = A.SIDE[side_row(A, key)]
    if side.key == key:
        side.key = -1


@nonallocating
def keep_sides(A: Scene, KNOWN: Rows[Side], PLACE: IntArray) -> None:
    """Remember the sides KNOWN of pairs of k shapes whose present numbers, PLACE (k,), are not -1."""
    k = PLACE.shape[0]
    for row in range(len(KNOWN)):
        known = KNOWN[row]
        a, b = shapes_of_pair(k, known.key - 1)
        if a < 0 or PLACE[a] < 0 or PLACE[b] < 0:
            continue
        key, sign = side_key(A, PLACE[a], PLACE[b]), 1.0 if PLACE[a] < PLACE[b] else -1.0
        side = A.SIDE[side_row(A, key)]
        side.key, side.nx, side.ny, side.deep = key, sign * known.nx, sign * known.ny, known.deep


@nonallocating
def side_of(A: Scene, a: int, b: int) -> tuple[float, float]:
    """The remembered normal from shape a to shape b, (0, 0) if there is none."""
    key, sign = side_key(A, a, b), 1.0 if a < b else -1.0
    side = A.SIDE[side_row(A, key)]
    if side.key != key:
        return 0.0, 0.0
    return sign * side.nx, sign * side.ny


@nonallocating
def corner_of(
    A: Scene, W: FloatArray, w: int, o: int, x: float, y: float, nx: float, ny: float, deep: float
) -> tuple[int, float, float]:  # fmt: skip
    """Find the corner of segment w in which shape o lies. (x, y): point of w nearest to o, n the normal from w to o.

    Returns the end of w at the corner, -1 if there is none, and the normal (2) of the inner side of w; extends the
    placed segment W by `deep` beyond that end. Where w ends on another segment, both of its sides are inner ones: o is
    on the one that the pair remembers, else on that of n.
    """
    ex, ey = W[1, 0] - W[0, 0], W[1, 1] - W[0, 1]
    length = math.sqrt(ex * ex + ey * ey)
    ux, uy = ex / length, ey / length
    end = 0
    if (x - W[0, 0]) * ux + (y - W[0, 1]) * uy > 0.5 * length:
        end, ux, uy = 1, -ux, -uy
    for turn in range(2):
        corner = A.CORNER[4 * w + 2 * end + turn]
        other, c, z = corner.other - 1, corner.cosine, corner.sine
        sign = 1.0 - 2.0 * turn
        if other < 0 or other == o or sign * z <= STRAIGHT:
            continue
        lx, ly = -sign * uy, sign * ux
        mx, my = side_of(A, other, o)
        if sign * (mx * (z * ux + c * uy) - my * (c * ux - z * uy)) <= 0.0:
            continue
        mx, my = side_of(A, w, o)
        opposite = A.CORNER[4 * w + 2 * end + 1 - turn]
        if mx == 0.0 and my == 0.0 and opposite.other == corner.other and sign * opposite.sine < -STRAIGHT:
            mx, my = nx, ny
        if mx * lx + my * ly >= 0.0:
            W[end, 0], W[end, 1] = W[end, 0] - deep * ux, W[end, 1] - deep * uy
            return end, lx, ly
    return -1, 0.0, 0.0


@nonallocating
def closest_on_side(A: Scene, P: FloatArray, p: int, Q: FloatArray, q: int, a: int, b: int) -> Closest:
    """`closest` of the cores P and Q of shapes a < b; for thin ones that touch or cross, on the side that the pair
    remembers, and in corners on the inner side: there P or Q is extended (`corner_of`), for the caller too."""
    near = closest(P, p, Q, q)
    if not remembers(A, a, b):
        return near
    d, nx, ny, x, y = near.distance, near.nx, near.ny, near.x, near.y
    deep = held_side(A, a, b)
    end = -1
    if q == 2:
        end, mx, my = corner_of(A, Q, b, a, x + d * nx, y + d * ny, -nx, -ny, deep)
        mx, my = -mx, -my
    if end < 0 and p == 2:
        end, mx, my = corner_of(A, P, a, b, x, y, nx, ny, deep)
    if end >= 0:
        near = closest(P, p, Q, q)
        reach = deep
    else:
        key = side_key(A, a, b)
        side = A.SIDE[side_row(A, key)]
        mx, my, reach = side.nx, side.ny, max(near_side(A, a, b), side.deep)
        if side.key != key:
            return near
    if near.distance > reach or near.nx * mx + near.ny * my >= 0.0:
        return near
    apart_p, edge_p, vertex_q = separation(P, p, Q, q, mx, my)
    apart_q, edge_q, vertex_p = separation(Q, q, P, p, -mx, -my)
    return from_faces(P, vertex_p, Q, vertex_q, Faces(edge_p, apart_p, edge_q, apart_q), apart_q > apart_p)

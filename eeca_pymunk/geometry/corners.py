"""Which shapes are thin, and at which corners segments meet: input of `sides.py`, made from the shapes once.

Row 4 s + 2 e + t of CORNER is about end e of segment s, with u the direction from there along s: of the segments that
meet there it has the next one about that end, counter-clockwise from u for t = 0, clockwise for t = 1, with the angle
from u to it. Row 4 s tells whether s is thin.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.parameters.detection import CORNER_MEET, SLENDER, STRAIGHT
from ..model.shapes import Corner, Link

_SIDES, _MANY = 64, 1 << 16  # pairs whose sides are remembered: of each thin shape that may move; of all, at most


def side_rows(few: int, shapes: int) -> int:
    """Rows of SIDE, a power of 2, for so many thin shapes that move or sleep among so many shapes; 0 if no thin shapes
    may meet."""
    rows = _SIDES if few else 0
    while few and rows < max(4 * shapes, min(_SIDES * few, _MANY)):
        rows *= 2
    return rows


@kernel
def find_corners(LINK: Rows[Link], VERTEX: FloatArray, CORNER: Rows[Corner]) -> None:
    """Fill in CORNER (4 k,): which shapes are thin, and the corners of all segments, at which segments of the same body
    meet."""
    for s in range(LINK.shape[0]):
        for r in range(4):
            row = CORNER[4 * s + r]
            row.other, row.cosine, row.sine, row.thin = 0, 0.0, 0.0, 0
        CORNER[4 * s].thin = 1 if thin(LINK[s], VERTEX) else 0
    for s in range(LINK.shape[0]):
        for j in range(LINK.shape[0] if LINK[s].vertices == 2 else 0):
            if j != s and LINK[j].vertices == 2 and LINK[s].owner == LINK[j].owner:
                if boxes_overlap(VERTEX, LINK[s].first, LINK[j].first):
                    note_meeting(LINK, VERTEX, CORNER, s, 0, j)
                    note_meeting(LINK, VERTEX, CORNER, s, 1, j)


@nonallocating
def boxes_overlap(VERTEX: FloatArray, mine: int, its: int) -> bool:
    """Whether the boxes of two segments overlap, with more room than corners have."""
    ax, ay, bx, by = VERTEX[mine, 0], VERTEX[mine, 1], VERTEX[mine + 1, 0], VERTEX[mine + 1, 1]
    px, py, qx, qy = VERTEX[its, 0], VERTEX[its, 1], VERTEX[its + 1, 0], VERTEX[its + 1, 1]
    room = 2.0 * CORNER_MEET * (abs(bx - ax) + abs(by - ay) + abs(qx - px) + abs(qy - py))
    across = max(min(ax, bx) - max(px, qx), min(px, qx) - max(ax, bx))
    along = max(min(ay, by) - max(py, qy), min(py, qy) - max(ay, by))
    return bool(across <= room and along <= room)


@nonallocating
def thin(link: Link, VERTEX: FloatArray) -> bool:
    """Whether a shape is thin: a segment, or a plank, whose area is small against its length (the largest distance of
    two of its vertices)."""
    if link.vertices <= 2:
        return bool(link.vertices == 2)
    area, length = 0.0, 0.0
    first = VERTEX[link.first]
    for i in range(link.vertices):
        one, two = VERTEX[link.first + i], VERTEX[link.first + (i + 1 if i + 1 < link.vertices else 0)]
        x, y = one[0] - first[0], one[1] - first[1]
        area += 0.5 * (x * (two[1] - first[1]) - y * (two[0] - first[0]))
        for j in range(i):
            from_one = VERTEX[link.first + j]
            length = max(length, math.hypot(one[0] - from_one[0], one[1] - from_one[1]))
    return bool(area < SLENDER * (0.5 * length) ** 2)


@nonallocating
def note_meeting(LINK: Rows[Link], VERTEX: FloatArray, CORNER: Rows[Corner], s: int, e: int, j: int) -> None:
    """Note whether segment j passes or ends at end e of segment s."""
    mine, its = LINK[s].first, LINK[j].first
    cx, cy, px, py = VERTEX[mine + e, 0], VERTEX[mine + e, 1], VERTEX[its, 0], VERTEX[its, 1]
    ux, uy = VERTEX[mine + 1 - e, 0] - cx, VERTEX[mine + 1 - e, 1] - cy
    vx, vy = VERTEX[its + 1, 0] - px, VERTEX[its + 1, 1] - py
    size, length = math.hypot(ux, uy), math.hypot(vx, vy)
    place = ((cx - px) * vx + (cy - py) * vy) / length**2
    within = min(max(place, 0.0), 1.0)
    apart_x, apart_y, tolerance = px + within * vx - cx, py + within * vy - cy, CORNER_MEET * max(size, length)
    if apart_x**2 + apart_y**2 > tolerance**2:
        return
    for sign in range(1, -2, -2):
        # Nothing of j is on this side of the end.
        if (sign > 0 and place > 1.0 - CORNER_MEET) or (sign < 0 and place < CORNER_MEET):
            continue
        scale = sign / (length * size)
        c, z = scale * (ux * vx + uy * vy), scale * (ux * vy - uy * vx)
        if c > 0.0 and abs(z) <= STRAIGHT:
            continue  # it lies on s, and would hide the next one
        for turn in range(2):
            row, way = CORNER[4 * s + 2 * e + turn], 1.0 - 2.0 * turn
            if row.other == 0 or before(way * z, c, way * row.sine, row.cosine):
                row.other, row.cosine, row.sine = j + 1, c, z


@nonallocating
def before(z: float, c: float, sine: float, cosine: float) -> bool:
    """Whether the angle of (c, z), from 0 to 2 pi, comes before that of (cosine, sine)."""
    return bool(math.atan2(z, c) % (2.0 * math.pi) < math.atan2(sine, cosine) % (2.0 * math.pi))

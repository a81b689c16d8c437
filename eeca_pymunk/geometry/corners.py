"""Which shapes are thin, and at which corners segments meet: input of `sides.py`, made from the shapes once.

Row 4 s + 2 e + t of CORNER is about end e of segment s, with u the direction from there along s: of the segments that
meet there it has the next one about that end, counter-clockwise from u for t = 0, clockwise for t = 1, with the angle
from u to it. Row 4 s tells whether s is thin.
"""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..compiled.records import Rows, rows
from ..model.parameters.detection import CORNER_MEET, SLENDER
from ..model.shapes import Corner, Link, Side

_SIDES, _MANY = 64, 1 << 16  # pairs of every thin shape that moves, whose sides are remembered; of all, at most
_CHUNK = 256


def core_room(LINK: Rows[Link]) -> FloatArray:
    """CORE: scratch for the vertices of two shapes."""
    return np.zeros((2, max(2, int(LINK["vertices"].max(initial=2))), 4))


def thin_memory(LINK: Rows[Link], VERTEX: FloatArray, moving: int) -> tuple[Rows[Side], Rows[Corner]]:
    """The tables SIDE and CORNER; without rows if no thin shapes may meet. moving: number of moving shapes, the first
    ones."""
    if LINK["vertices"][:moving].max(initial=1) < 2:
        return rows(Side, 0), rows(Corner, 0)
    flat = thin(LINK, VERTEX)
    few = int(flat[:moving].sum())
    if few == 0 or flat.sum() < 2:
        return rows(Side, 0), rows(Corner, 0)
    slots = 64
    while slots < max(4 * len(LINK), min(_SIDES * few, _MANY)):
        slots *= 2
    return rows(Side, slots), corners_of(LINK, VERTEX, flat)


def corners_of(LINK: Rows[Link], VERTEX: FloatArray, flat: BoolArray | None = None) -> Rows[Corner]:
    """The table CORNER of all shapes; `flat` (k,): which ones are thin, if already known."""
    CORNER = rows(Corner, 4 * len(LINK))
    CORNER["thin"][::4] = thin(LINK, VERTEX) if flat is None else flat
    note_corners(LINK, VERTEX, CORNER)
    return CORNER


def thin(LINK: Rows[Link], VERTEX: FloatArray) -> BoolArray:
    """(k,) which shapes are thin: segments, and planks."""
    flat: BoolArray = LINK["vertices"] == 2
    some: IntArray = np.flatnonzero(LINK["vertices"] > 2)
    if len(some):
        of = np.repeat(np.arange(len(LINK)), LINK["vertices"])
        following = np.arange(1, len(VERTEX) + 1)
        following[LINK["first"] + LINK["vertices"] - 1] = LINK["first"]
        from_first = VERTEX[:, :2] - VERTEX[LINK["first"][of], :2]
        x, y = from_first.T
        area = np.bincount(of, 0.5 * (x * y[following] - y * x[following]), len(LINK))
        length = np.zeros(len(LINK))
        np.maximum.at(length, of, np.hypot(x, y))
        flat[some] = area[some] < SLENDER * (0.5 * length[some]) ** 2
    return flat


def note_corners(LINK: Rows[Link], VERTEX: FloatArray, CORNER: Rows[Corner]) -> None:
    """Fill in the corners of all segments, at which segments of the same body meet."""
    some: IntArray = np.flatnonzero(LINK["vertices"] == 2)
    if len(some) < 2:
        return
    start, end = VERTEX[LINK["first"][some], :2], VERTEX[LINK["first"][some] + 1, :2]
    owner, along = LINK["owner"][some], end - start
    length = np.hypot(*along.T)
    for e, points in enumerate((start, end)):
        for first in range(0, len(some), _CHUNK):
            c = points[first : first + _CHUNK]
            place = np.einsum("ijk,jk->ij", c[:, None] - start, along) / length**2
            nearest = start + np.clip(place, 0.0, 1.0)[..., None] * along
            tolerance = CORNER_MEET * np.maximum(length, length[first : first + _CHUNK, None])
            apart = nearest - c[:, None]
            meet = (apart**2).sum(axis=2) <= tolerance**2
            meet &= owner == owner[first : first + _CHUNK, None]
            for i, j in np.argwhere(meet).tolist():
                s = first + i
                if s != j:
                    _note(CORNER, some, s, e, j, (along * (1.0 - 2.0 * e))[s], along[j], place[i, j] * length[j])


def _note(
    CORNER: Rows[Corner], some: IntArray, s: int, e: int, j: int, u: FloatArray, v: FloatArray, place: float
) -> None:  # fmt: skip
    """Note that segment j, along v, passes or ends at end e of segment s, so far from its own start."""
    length = float(np.hypot(*v))
    for sign, ends in ((1.0, place > (1.0 - CORNER_MEET) * length), (-1.0, place < CORNER_MEET * length)):
        if ends:
            continue
        scale = sign / (length * float(np.hypot(*u)))
        c, z = scale * float(u @ v), scale * float(u[0] * v[1] - u[1] * v[0])
        for turn in range(2):
            row = CORNER[4 * some[s] + 2 * e + turn]
            sign_of = 1.0 - 2.0 * turn
            if row.other == 0 or _before(sign_of * z, c, sign_of * row.sine, row.cosine):
                row.other, row.cosine, row.sine = some[j] + 1, c, z


def _before(z: float, c: float, sine: float, cosine: float) -> bool:
    """Whether the angle of (c, z), from 0 to 2 pi, comes before that of (cosine, sine)."""
    return bool(np.arctan2(z, c) % (2.0 * np.pi) < np.arctan2(sine, cosine) % (2.0 * np.pi))

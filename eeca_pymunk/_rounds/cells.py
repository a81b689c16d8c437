"""The cell list: pairs of near disks of a crowd from arrays alone, where pymunk's detection would be most of a step."""

from __future__ import annotations

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray
from ..space.shapes import Shapes
from .contacts import Pairs, pair_key
from .features import disk_wall

_QUANTILES = np.array([0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 1.0])  # of sizes that may set the length of the cells
_TALL = 16  # rows up and down up to which a disk's partners are sought row by row
_FARTHEST = 2.0**30  # cells from the first one, beyond which all are one


class CellList:
    """Pairs of disks and of disks and walls whose shapes, grown by margins of their own, overlap.

    Args:
        shapes: centred disks and walls.  moving: (D,) indices of the disks.
    """

    hashed = False

    def __init__(self, shapes: Shapes, moving: IntArray) -> None:
        self.shapes, self._moving = shapes, moving
        self._radius: FloatArray = shapes.radius[moving]
        self._size = self._radius.copy()
        self._walls: IntArray = np.flatnonzero(shapes.wall >= 0)
        self._wall_margin = 0.0
        filters = [s.filter for s in shapes.items]
        self._filtered = any(f != pymunk.ShapeFilter() for f in filters)
        self._filter: IntArray = np.array(filters, np.intp)
        # (W, 2) corners of the walls' boxes.
        rounding = shapes.radius[self._walls, None]
        self._low, self._high = shapes.walls.start.min(axis=1) - rounding, shapes.walls.start.max(axis=1) + rounding

    def grow(self, which: IntArray, margin: FloatArray) -> None:
        """Give the disks number `which` (m,) margins (m,), length."""
        self._size[which] = self._radius[which] + margin

    def grow_walls(self, margin: float) -> None:
        """Give all walls one margin, length."""
        self._wall_margin = margin

    def find(self, center: FloatArray) -> Pairs:
        """The pairs of overlapping grown shapes, disks at `center` (D, 2), sorted by `Pairs.key`."""
        self._cells = Cells(center, self._size)
        return self._pairs(*self._cells.pairs(), *self._at_walls(center, np.arange(len(center))))

    def find_more(self, which: IntArray, pairs: Pairs) -> Pairs:
        """`pairs`, and those that the disks number `which` (m,), which have grown, add where all were found last."""
        cells = self._cells
        cells.grow(which, self._size[which])
        more = self._pairs(*cells.pairs_of(which), *self._at_walls(cells.center, which))
        return pairs.merged(more)

    def _pairs(self, i: IntArray, j: IntArray, disk: IntArray, wall: IntArray) -> Pairs:
        """Disks number i and j (m,), and disks and walls (k,), as far as they may meet."""
        shapes, moving = self.shapes, self._moving
        i, j = moving[i], moving[j]
        first = np.concatenate((np.minimum(i, j), moving[disk]))
        second = np.concatenate((np.maximum(i, j), self._walls[wall]))
        keep = shapes.row[first] != shapes.row[second]
        if self._filtered:
            keep &= self._may_meet(first, second)
        if not keep.all():
            first, second = first[keep], second[keep]
        order = np.argsort(pair_key(shapes, first, second))
        return Pairs(shapes, first[order], second[order])

    def _may_meet(self, first: IntArray, second: IntArray) -> BoolArray:
        """(m,) whether the shapes' filters let them collide, as pymunk reads these."""
        a, b = self._filter[first].T, self._filter[second].T
        same_group = (a[0] != 0) & (a[0] == b[0])
        meet: BoolArray = ~same_group & (a[1] & b[2] != 0) & (b[1] & a[2] != 0)
        return meet

    def _at_walls(self, center: FloatArray, which: IntArray) -> tuple[IntArray, IntArray]:
        """Numbers (m,) of those of the disks `which` (k,) that are near walls, and of these walls."""
        x, y = center[which].T
        reach = self._size[which] + self._wall_margin
        (left, bottom), (right, top) = self._low.T[..., None], self._high.T[..., None]
        inside = (x >= left - reach) & (x <= right + reach) & (y >= bottom - reach) & (y <= top + reach)
        wall, number = np.nonzero(inside)
        disk = which[number]
        distance = disk_wall(self.shapes, self.shapes.wall[self._walls[wall]], center[disk])[0]
        near = distance <= reach[number] + self.shapes.radius[self._walls[wall]]
        return disk[near], wall[near]


class Cells:
    """Disks sorted by square cells, row by row, so that the disks of neighbouring cells of a row are one run.

    Args:
        center: (D, 2) length.  size: (D,) radius, length.
    """

    def __init__(self, center: FloatArray, size: FloatArray) -> None:
        self.center = center.copy()
        low = center.min(axis=0)
        self._cell = _cell(center.max(axis=0) - low, size)
        column, row = np.minimum((center - low) / self._cell, _FARTHEST).astype(np.intp).T
        self._width = int(column.max()) + 2  # one more, which stays empty, parts the ends of two rows
        key = row * self._width + column
        self._order: IntArray = np.argsort(key)
        self._key: IntArray = key[self._order]
        self._x, self._y = center[:, 0][self._order], center[:, 1][self._order]
        self._size: FloatArray = size[self._order]

    def grow(self, which: IntArray, size: FloatArray) -> None:
        """Give disks number `which` (m,) other sizes (m,), length."""
        self._size[self._places(which)] = size

    def pairs(self) -> tuple[IntArray, IntArray]:
        """Numbers (m,) and (m,) of the two disks of each overlapping pair, every pair once.

        Partners of a disk that fits into a cell are in its own cell, the next one and the three above: two runs.
        """
        small = self._size <= 0.5 * self._cell
        place, key = np.flatnonzero(small), self._key
        own = key[place]
        beside = _runs(place, place + 1, np.searchsorted(key, own + 1, "right"))
        above = np.searchsorted(key, own + self._width - 1), np.searchsorted(key, own + self._width + 1, "right")
        a, b = (np.concatenate(both) for both in zip(beside, _runs(place, *above), strict=True))
        if len(place) == len(key):
            return self._overlapping(a, b)
        few = np.flatnonzero(small[b])
        (a, b), (c, d) = self._overlapping(a[few], b[few]), self._of(~small)
        return np.concatenate((a, c)), np.concatenate((b, d))

    def pairs_of(self, which: IntArray) -> tuple[IntArray, IntArray]:
        """`pairs`, of which one is among the disks `which` (k,)."""
        chosen = np.zeros(len(self._key), bool)
        chosen[self._places(which)] = True
        return self._of(chosen)

    def _of(self, chosen: BoolArray) -> tuple[IntArray, IntArray]:
        """Pairs with a disk at the places `chosen` (D,): a run in each row within its reach, or all these rows as one
        run where they are many."""
        place = np.flatnonzero(chosen)
        key, width = self._key, self._width
        reach = np.minimum((self._size[place] + self._size.max()) / self._cell + 1.0, _FARTHEST).astype(np.intp)
        row, column = np.divmod(key[place], width)
        tall = reach > _TALL
        begin, end = row - reach, np.where(tall, row - reach, row + reach) + 1
        which, row = _runs(np.arange(len(place)), begin, end)
        low, high = (row * width + np.clip(column[which] + s * reach[which], 0, width - 1) for s in (-1, 1))
        high = np.where(tall[which], (row + 2 * reach[which] + 1) * width, high)
        a, b = _runs(place[which], np.searchsorted(key, low), np.searchsorted(key, high, "right"))
        once = np.flatnonzero(~chosen[b] | (b < a))
        return self._overlapping(a[once], b[once])

    @np.errstate(over="ignore")  # the square of an absurd size: near everybody
    def _overlapping(self, a: IntArray, b: IntArray) -> tuple[IntArray, IntArray]:
        dx, dy, extent = self._x[a] - self._x[b], self._y[a] - self._y[b], self._size[a] + self._size[b]
        found = np.flatnonzero(dx * dx + dy * dy <= extent * extent)
        return self._order[a[found]], self._order[b[found]]

    def _places(self, which: IntArray) -> IntArray:
        place = np.empty(len(self._order), np.intp)
        place[self._order] = np.arange(len(place))
        return place[which]


def _runs(place: IntArray, begin: IntArray, end: IntArray) -> tuple[IntArray, IntArray]:
    """Every place (k,) with each of begin ... end - 1 (k,)."""
    count = end - begin
    shift = begin - (np.cumsum(count) - count)
    return np.repeat(place, count), np.arange(int(count.sum())) + np.repeat(shift, count)


def _cell(box: FloatArray, size: FloatArray) -> float:
    """The length of cells for which the fewest pairs are looked at, of disks (D,) spread evenly over a box (2,)."""
    ordered = np.sort(size)
    number = (_QUANTILES * (len(size) - 1)).astype(np.intp)
    length = 2.0 * ordered[number]
    large = len(size) - np.searchsorted(ordered, ordered[number], "right")
    width, height = box[0] + length, box[1] + length
    pairs = 4.5 * len(size) * (length / width) * (length / height)
    pairs += large * np.minimum((2.0 * ordered[-1] + 4.0 * length) / height, 1.0)
    return float(length[np.argmin(pairs)])

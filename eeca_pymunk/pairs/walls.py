"""Walls: static shapes near a moving one. A few are all tested; many are in a grid of their own, built once."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..model.scene import Scene
from ..model.shapes import Grid
from .rules import append, may_collide, place_in

_CELLS_OF_A_WALL = 32


@nonallocating
def cell_of(distance: float, length: float, count: int) -> int:
    """Column or row of a distance from the grid's corner; the outermost ones reach to infinity."""
    place = distance / length
    return 0 if not place > 0.0 else (count - 1 if place >= count else int(place))


@nonallocating
def cells_of(GRID: Grid, left: float, bottom: float, right: float, top: float) -> tuple[int, int, int, int]:
    """The first and last column, and the first and last row, of the cells that a box overlaps."""
    length = GRID.wall_cell
    return (
        cell_of(left - GRID.left, length, GRID.columns), cell_of(right - GRID.left, length, GRID.columns),
        cell_of(bottom - GRID.bottom, length, GRID.rows), cell_of(top - GRID.bottom, length, GRID.rows),
    )  # fmt: skip


@nonallocating
def box_wall(A: Scene, w: int) -> None:
    """Write left, bottom, right and top of static shape number w to BOX."""
    s = A.GRID.moving + w
    first, size = A.LINK[s].first, A.SHAPE[s].rounding
    left, bottom, right, top = math.inf, math.inf, -math.inf, -math.inf
    for j in range(first, first + A.LINK[s].vertices):
        x, y = A.VERTEX[j, 0], A.VERTEX[j, 1]
        left, bottom, right, top = min(left, x), min(bottom, y), max(right, x), max(top, y)
    A.BOX[w, 0], A.BOX[w, 1], A.BOX[w, 2], A.BOX[w, 3] = left - size, bottom - size, right + size, top + size


@nonallocating
def try_wall(A: Scene, s: int, w: int) -> bool:
    """Enter static shape number w into the list of s if it may meet its margin circle. False if the pool is full."""
    BOX, mark, o = A.BOX, A.MARK[s], A.GRID.moving + w
    dx = max(BOX[w, 0] - mark.x, mark.x - BOX[w, 2], 0.0)
    dy = max(BOX[w, 1] - mark.y, mark.y - BOX[w, 3], 0.0)
    new = dx * dx + dy * dy <= mark.reach * mark.reach and place_in(A, s, o) < 0 and may_collide(A, s, o)
    return not new or append(A, s, o)


@nonallocating
def seek_walls(A: Scene, s: int) -> bool:
    """Enter the static neighbours of s that are not in its list. False if the pool is full."""
    GRID, BOX, CSR = A.GRID, A.BOX, A.CSR
    columns, rows = GRID.columns, GRID.rows
    if columns == 0:
        room = True
        for w in range(BOX.shape[0]):
            room = room and try_wall(A, s, w)
        return room
    x, y, radius = A.MARK[s].x, A.MARK[s].y, A.MARK[s].reach
    west, east, south, north = cells_of(GRID, x - radius, y - radius, x + radius, y + radius)
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            c = row * columns + column
            for q in range(CSR[c], CSR[c + 1]):
                w = CSR[columns * rows + 1 + q]
                # A wall in several cells is tested in the first of the visited ones only.
                first_column, _, first_row, _ = cells_of(GRID, BOX[w, 0], BOX[w, 1], BOX[w, 2], BOX[w, 3])
                if max(west, first_column) == column and max(south, first_row) == row and not try_wall(A, s, w):
                    return False
    return True


@nonallocating
def size_walls(BOX: FloatArray, GRID: Grid) -> int:
    """Choose the cells of the grid of static shapes with boxes (W, 4), W > 0: about as many as shapes; fewer if these
    would have more than _CELLS_OF_A_WALL on average. Returns the number of cells that the shapes overlap, counted for
    each shape."""
    count, left, bottom, right, top = BOX.shape[0], math.inf, math.inf, -math.inf, -math.inf
    for w in range(count):
        left, bottom = min(left, BOX[w, 0]), min(bottom, BOX[w, 1])
        right, top = max(right, BOX[w, 2]), max(top, BOX[w, 3])
    wide, tall = max(right - left, 1e-300), max(top - bottom, 1e-300)
    # The area of walls in a line is small or 0: there are at most 4 cells along the longer side for each.
    length = max(math.sqrt(wide * tall / count), max(wide, tall) / (4.0 * count))
    GRID.left, GRID.bottom = left, bottom
    while True:
        GRID.wall_cell = length
        GRID.columns, GRID.rows = max(1, math.ceil(wide / length)), max(1, math.ceil(tall / length))
        entries = 0
        for w in range(count):
            west, east, south, north = cells_of(GRID, BOX[w, 0], BOX[w, 1], BOX[w, 2], BOX[w, 3])
            entries += (east - west + 1) * (north - south + 1)
        if entries <= _CELLS_OF_A_WALL * count or GRID.columns * GRID.rows == 1:
            return entries
        length *= 2.0


@nonallocating
def wall_grid(BOX: FloatArray, GRID: Grid, CSR: IntArray) -> None:
    """Enter static shapes with boxes (W, 4) into the cells of their grid: CSR has columns * rows + 1 starts and then
    the shapes of all cells."""
    columns, cells = GRID.columns, GRID.columns * GRID.rows
    CSR[: cells + 1] = 0
    for fill in range(2):
        for w in range(BOX.shape[0]):
            west, east, south, north = cells_of(GRID, BOX[w, 0], BOX[w, 1], BOX[w, 2], BOX[w, 3])
            for row in range(south, north + 1):
                for column in range(west, east + 1):
                    c = row * columns + column
                    if fill == 0:
                        CSR[c + 1] += 1
                    else:
                        CSR[cells + 1 + CSR[c]] = w
                        CSR[c] += 1
        if fill == 0:
            for c in range(cells):
                CSR[c + 1] += CSR[c]
    for c in range(cells, 0, -1):
        CSR[c] = CSR[c - 1]
    CSR[0] = 0

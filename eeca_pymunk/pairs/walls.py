"""Static shapes near a moving one: all of them where they are few, else a grid of their own, laid out once."""

from __future__ import annotations

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.shapes import Link, List, Mark, Shape
from .layout import (
    MOVING,
    WALL_COLUMNS,
    WALL_LENGTH,
    WALL_ROWS,
    WALL_X,
    WALL_Y,
)  # fmt: skip
from .lists import append, may_meet, place_in


@uncounted
def cell_of(distance: float, length: float, count: int) -> int:
    """Column or row, the outermost ones reaching to infinity."""
    place = distance / length
    return 0 if not place > 0.0 else (count - 1 if place >= count else int(place))


@uncounted
def near_wall(BOX: FloatArray, w: int, x: float, y: float, radius: float) -> bool:
    """Whether a circle overlaps the box of static shape number w: (W, 4) left, bottom, right, top."""
    dx = max(BOX[w, 0] - x, x - BOX[w, 2], 0.0)
    dy = max(BOX[w, 1] - y, y - BOX[w, 3], 0.0)
    return bool(dx * dx + dy * dy <= radius * radius)


@uncounted
def seek_walls(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], MARK: Rows[Mark], LIST: Rows[List], POOL: PoolArray,
    FLAG: FlagArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray, CSR: IntArray, s: int,
) -> bool:  # fmt: skip
    """Static neighbours of s, but for those in its list already. False if the pool is full."""
    x, y = MARK[s].x, MARK[s].y
    radius, moving = MARK[s].reach, INFO[MOVING]
    columns, rows = INFO[WALL_COLUMNS], INFO[WALL_ROWS]
    if columns == 0:
        for w in range(BOX.shape[0]):
            if near_wall(BOX, w, x, y, radius) and place_in(LIST, POOL, s, moving + w) < 0:
                if may_meet(BODY, LINK, s, moving + w) and not append(LIST, POOL, FLAG, INFO, s, moving + w):
                    return False
        return True
    length = GRID[WALL_LENGTH]
    left, bottom = x - GRID[WALL_X], y - GRID[WALL_Y]
    west, east = cell_of(left - radius, length, columns), cell_of(left + radius, length, columns)
    south, north = cell_of(bottom - radius, length, rows), cell_of(bottom + radius, length, rows)
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            c = row * columns + column
            for q in range(CSR[c], CSR[c + 1]):
                w = CSR[columns * rows + 1 + q]
                # A wall of several cells counts in the first one of these that is looked at.
                first_column = max(west, cell_of(BOX[w, 0] - GRID[WALL_X], length, columns))
                first_row = max(south, cell_of(BOX[w, 1] - GRID[WALL_Y], length, rows))
                if first_column != column or first_row != row:
                    continue
                if near_wall(BOX, w, x, y, radius) and place_in(LIST, POOL, s, moving + w) < 0:
                    if may_meet(BODY, LINK, s, moving + w) and not append(LIST, POOL, FLAG, INFO, s, moving + w):
                        return False
    return True


@uncounted
def wall_grid(BOX: FloatArray, GRID: FloatArray, INFO: IntArray, CSR: IntArray) -> int:
    """Lay static shapes, of boxes (W, 4), into the cells of their grid, whose numbers stand in INFO and GRID.

    CSR holds columns * rows + 1 starts and then the numbers; returns how many these are. Called with a CSR that has no
    room for them, it only counts.
    """
    columns, rows, length = INFO[WALL_COLUMNS], INFO[WALL_ROWS], GRID[WALL_LENGTH]
    cells = columns * rows
    total = 0
    for w in range(BOX.shape[0]):
        wide = cell_of(BOX[w, 2] - GRID[WALL_X], length, columns) - cell_of(BOX[w, 0] - GRID[WALL_X], length, columns)
        high = cell_of(BOX[w, 3] - GRID[WALL_Y], length, rows) - cell_of(BOX[w, 1] - GRID[WALL_Y], length, rows)
        total += (wide + 1) * (high + 1)
    if CSR.shape[0] < cells + 1 + total:
        return total
    CSR[: cells + 1] = 0
    for fill in range(2):
        for w in range(BOX.shape[0]):
            west = cell_of(BOX[w, 0] - GRID[WALL_X], length, columns)
            east = cell_of(BOX[w, 2] - GRID[WALL_X], length, columns)
            south = cell_of(BOX[w, 1] - GRID[WALL_Y], length, rows)
            north = cell_of(BOX[w, 3] - GRID[WALL_Y], length, rows)
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
    return total

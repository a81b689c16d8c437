"""The grid: near lists of all shapes, made anew one at a time as shapes leave their margin circles.

Bounding circles are hashed by their centres into square cells, on levels of size: level l holds circles (with their
margins) of up to half its cell, which is twice that of level l - 1. A search on a level looks at the cells that the
circle, grown by half a cell, overlaps; or at all shapes of the level, where they are fewer than these cells.

Static shapes stand in a grid of their own (`CSR`: START of each cell, then numbers of shapes), made once.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import uncounted
from ..layout import BOUND
from .layout import (
    AT_X,
    AT_Y,
    BUCKET,
    COLUMN,
    ROW,
    CAPACITY,
    CELL_LENGTH,
    LEAVES,
    LEVEL,
    LEVEL_COUNT,
    LEVELS,
    MARGIN,
    MOVING,
    NEXT,
    NUMBER,
    POOL_END,
    PREVIOUS,
    START,
    WALL_COLUMNS,
    WALL_LENGTH,
    WALL_ROWS,
    WALL_X,
    WALL_Y,
)  # fmt: skip
from .lists import append, centre, may_meet, remove

_FIRST_CAPACITY = 8


@uncounted
def bucket(level: int, column: int, row: int, mask: int) -> int:
    """Place of a cell in the hash table."""
    return ((column * 73856093) ^ (row * 19349663) ^ (level * 83492791)) & mask


@uncounted
def level_of(radius: float, cell: float) -> int:
    """The lowest level whose cells are at least twice as long as the radius."""
    level, length = 0, cell
    while length < 2.0 * radius and level < LEVEL_COUNT - 1:
        length *= 2.0
        level += 1
    return level


@uncounted
def link(
    MARK: FloatArray, CELL: IntArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, radius: float, s: int
) -> None:
    """Put shape s into the grid where its margin circle is."""
    level = level_of(radius + MARK[s, MARGIN], GRID[CELL_LENGTH])
    length = GRID[CELL_LENGTH] * 2.0**level
    CELL[s, COLUMN], CELL[s, ROW] = math.floor(MARK[s, AT_X] / length), math.floor(MARK[s, AT_Y] / length)
    k = bucket(level, CELL[s, COLUMN], CELL[s, ROW], HEAD.shape[0] - 1)
    head = HEAD[k]
    CELL[s, LEVEL], CELL[s, BUCKET], CELL[s, NEXT], CELL[s, PREVIOUS] = level, k, head, -1
    if head >= 0:
        CELL[head, PREVIOUS] = s
    HEAD[k] = s
    INFO[LEVELS + level] += 1


@uncounted
def unlink(CELL: IntArray, HEAD: IntArray, INFO: IntArray, s: int) -> None:
    """Take shape s out of the grid."""
    after, before = CELL[s, NEXT], CELL[s, PREVIOUS]
    if before >= 0:
        CELL[before, NEXT] = after
    else:
        HEAD[CELL[s, BUCKET]] = after
    if after >= 0:
        CELL[after, PREVIOUS] = before
    INFO[LEVELS + CELL[s, LEVEL]] -= 1


@uncounted
def near(MARK: FloatArray, SHAPE: FloatArray, o: int, x: float, y: float, radius: float) -> bool:
    """Whether the margin circle of shape o overlaps that of centre (x, y)."""
    dx, dy = MARK[o, AT_X] - x, MARK[o, AT_Y] - y
    reach = radius + SHAPE[o, BOUND] + MARK[o, MARGIN]
    return dx * dx + dy * dy <= reach * reach


@uncounted
def join(
    BODY: FloatArray, LINK: IntArray, LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, INFO: IntArray, s: int, o: int
) -> bool:
    """Put two moving shapes that may meet into each other's lists. False if the pool is full."""
    return not may_meet(BODY, LINK, s, o) or (
        append(LIST, POOL, FLAG, INFO, s, o) and append(LIST, POOL, FLAG, INFO, o, s)
    )


@uncounted
def seek_moving(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, CELL: IntArray, LIST: IntArray,
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, s: int,
) -> bool:  # fmt: skip
    """Neighbours of s, which is not in the grid, among the shapes that are. False if the pool is full."""
    x, y = MARK[s, AT_X], MARK[s, AT_Y]
    radius = SHAPE[s, BOUND] + MARK[s, MARGIN]
    mask = HEAD.shape[0] - 1
    length = 0.5 * GRID[CELL_LENGTH]
    for level in range(LEVEL_COUNT):
        length *= 2.0
        left = INFO[LEVELS + level]
        if left == 0:
            continue
        reach = radius + 0.5 * length
        west, east = math.floor((x - reach) / length), math.floor((x + reach) / length)
        south, north = math.floor((y - reach) / length), math.floor((y + reach) / length)
        if float(east - west + 1) * float(north - south + 1) > 4.0 * left + 16.0:
            for o in range(INFO[MOVING]):
                listed = CELL[o, LEVEL] == level and CELL[o, BUCKET] >= 0 and o != s
                if listed and near(MARK, SHAPE, o, x, y, radius):
                    if not join(BODY, LINK, LIST, POOL, FLAG, INFO, s, o):
                        return False
            continue
        for column in range(west, east + 1):
            for row in range(south, north + 1):
                o = HEAD[bucket(level, column, row, mask)]
                while o >= 0:
                    # Cells may share a place of the table: a shape counts in its own cell alone.
                    here = CELL[o, LEVEL] == level and CELL[o, COLUMN] == column and CELL[o, ROW] == row
                    if here and near(MARK, SHAPE, o, x, y, radius):
                        if not join(BODY, LINK, LIST, POOL, FLAG, INFO, s, o):
                            return False
                    o = CELL[o, NEXT]
    return True


@uncounted
def near_wall(BOX: FloatArray, w: int, x: float, y: float, radius: float) -> bool:
    """Whether a circle overlaps the box of static shape number w: (W, 4) left, bottom, right, top."""
    dx = max(BOX[w, 0] - x, x - BOX[w, 2], 0.0)
    dy = max(BOX[w, 1] - y, y - BOX[w, 3], 0.0)
    return dx * dx + dy * dy <= radius * radius


@uncounted
def seek_walls(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, LIST: IntArray, POOL: PoolArray,
    FLAG: FlagArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray, CSR: IntArray, s: int,
) -> bool:  # fmt: skip
    """Static neighbours of s. False if the pool is full."""
    x, y = MARK[s, AT_X], MARK[s, AT_Y]
    radius, moving = SHAPE[s, BOUND] + MARK[s, MARGIN], INFO[MOVING]
    columns, rows = INFO[WALL_COLUMNS], INFO[WALL_ROWS]
    if columns == 0:
        for w in range(BOX.shape[0]):
            if near_wall(BOX, w, x, y, radius) and may_meet(BODY, LINK, s, moving + w):
                if not append(LIST, POOL, FLAG, INFO, s, moving + w):
                    return False
        return True
    length = GRID[WALL_LENGTH]
    west, east = (
        cell_of(x - radius - GRID[WALL_X], length, columns),
        cell_of(x + radius - GRID[WALL_X], length, columns),
    )
    south, north = cell_of(y - radius - GRID[WALL_Y], length, rows), cell_of(y + radius - GRID[WALL_Y], length, rows)
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
                if near_wall(BOX, w, x, y, radius) and may_meet(BODY, LINK, s, moving + w):
                    if not append(LIST, POOL, FLAG, INFO, s, moving + w):
                        return False
    return True


@uncounted
def cell_of(distance: float, length: float, count: int) -> int:
    """Column or row, the outermost ones reaching to infinity."""
    place = distance / length
    return 0 if not place > 0.0 else (count - 1 if place >= count else int(place))


@uncounted
def clear(LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, INFO: IntArray, s: int) -> None:
    """Empty the list of s, and take s out of those of the others."""
    start = LIST[s, START]
    for q in range(start, start + LIST[s, NUMBER]):
        if POOL[q] < INFO[MOVING]:
            remove(LIST, POOL, FLAG, POOL[q], s)
    LIST[s, NUMBER] = 0


@uncounted
def renew(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, CELL: IntArray, LIST: IntArray,
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray,
    CSR: IntArray, s: int, t: float,
) -> bool:  # fmt: skip
    """Draw the margin circle of s about where it is at instant t, and make its list anew. False if the pool is full:
    then `build` is due."""
    clear(LIST, POOL, FLAG, INFO, s)
    unlink(CELL, HEAD, INFO, s)
    MARK[s, AT_X], MARK[s, AT_Y] = centre(BODY, SHAPE, LINK, s, t)
    INFO[LEAVES] += 1
    found = seek_walls(BODY, SHAPE, LINK, MARK, LIST, POOL, FLAG, GRID, INFO, BOX, CSR, s) and seek_moving(
        BODY, SHAPE, LINK, MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, s
    )
    link(MARK, CELL, HEAD, GRID, INFO, SHAPE[s, BOUND], s)
    return found


@uncounted
def build(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, CELL: IntArray, LIST: IntArray,
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray,
    CSR: IntArray, t: float,
) -> bool:  # fmt: skip
    """Make all lists at instant t. False if the pool is full: give a larger one, and call again."""
    moving = INFO[MOVING]
    if POOL.shape[0] < moving * _FIRST_CAPACITY:
        return False
    HEAD[:] = -1
    for level in range(LEVEL_COUNT):
        INFO[LEVELS + level] = 0
    for s in range(moving):
        LIST[s, START], LIST[s, CAPACITY], LIST[s, NUMBER] = s * _FIRST_CAPACITY, _FIRST_CAPACITY, 0
        CELL[s, BUCKET] = -1
        MARK[s, AT_X], MARK[s, AT_Y] = centre(BODY, SHAPE, LINK, s, t)
    INFO[POOL_END] = moving * _FIRST_CAPACITY
    everybody = moving > 0 and MARK[0, MARGIN] == math.inf
    for s in range(moving):
        if not seek_walls(BODY, SHAPE, LINK, MARK, LIST, POOL, FLAG, GRID, INFO, BOX, CSR, s):
            return False
        if everybody:
            for o in range(s):
                if not join(BODY, LINK, LIST, POOL, FLAG, INFO, s, o):
                    return False
        else:
            # Each pair once: s seeks among those that were put in before it.
            if not seek_moving(BODY, SHAPE, LINK, MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, s):
                return False
            link(MARK, CELL, HEAD, GRID, INFO, SHAPE[s, BOUND], s)
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

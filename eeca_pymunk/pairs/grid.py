"""The grid: near lists of all shapes, made anew one at a time as shapes leave their margin circles.

A search on a level of `cells.py` looks at the cells that the circle, grown by half a cell, overlaps; or at all shapes
of the level, where they are fewer than these cells.

Static shapes stand in a grid of their own (`CSR`: START of each cell, then numbers of shapes), made once.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import fetch, uncounted
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.shapes import Cell, Link, List, Mark, Shape
from .cells import bucket, cell_at, draw, link, near, unlink
from .layout import (
    CELL_LENGTH,
    CHOSEN,
    LEAVES,
    LEVEL_COUNT,
    LEVELS,
    MOVING,
    POOL_END,
    ROOM,
    WALKED,
)  # fmt: skip
from .lists import append, centre, course, may_meet, place_in, remove
from .walls import seek_walls

_FIRST_CAPACITY = 8


@uncounted
def join(
    BODY: Rows[Body],
    LINK: Rows[Link],
    LIST: Rows[List],
    POOL: PoolArray,
    FLAG: FlagArray,
    INFO: IntArray,
    s: int,
    o: int,
) -> bool:
    """Put two moving shapes that may meet into each other's lists. False if the pool is full."""
    return not may_meet(BODY, LINK, s, o) or (
        append(LIST, POOL, FLAG, INFO, s, o) and append(LIST, POOL, FLAG, INFO, o, s)
    )


@uncounted
def join_chosen(
    BODY: Rows[Body],
    LINK: Rows[Link],
    LIST: Rows[List],
    POOL: PoolArray,
    FLAG: FlagArray,
    INFO: IntArray,
    s: int,
    n: int,
) -> bool:
    """`join` s with the n shapes in INFO[CHOSEN:] that are not in its list."""
    for k in range(n):
        fetch(LIST, INFO[CHOSEN + k], 0)
        fetch(BODY, INFO[CHOSEN + k], 0)
    for k in range(n):
        o = INFO[CHOSEN + k]
        # Cells may share a place of the table: a shape may come up more than once.
        if place_in(LIST, POOL, s, o) < 0 and not join(BODY, LINK, LIST, POOL, FLAG, INFO, s, o):
            return False
    return True


@uncounted
def walk(
    BODY: Rows[Body], LINK: Rows[Link], MARK: Rows[Mark], LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray,
    INFO: IntArray, s: int, n: int,
) -> bool:  # fmt: skip
    """`join` s with the shapes near its margin circle in the n places of the grid whose first ones are in
    INFO[WALKED:]. One step in each place at a time: so their rows come at the same time."""
    x, y, radius, chosen = MARK[s].x, MARK[s].y, MARK[s].reach, 0
    while n > 0:
        more = 0
        for k in range(n):
            o = INFO[WALKED + k]
            INFO[CHOSEN + chosen] = o
            chosen += 1 if near(MARK, o, x, y, radius) else 0
            after = int(MARK[o].following)
            fetch(MARK, after, 0)
            INFO[WALKED + more] = after
            more += 1 if after >= 0 else 0
            if chosen == ROOM:
                if not join_chosen(BODY, LINK, LIST, POOL, FLAG, INFO, s, chosen):
                    return False
                chosen = 0
        n = more
    return join_chosen(BODY, LINK, LIST, POOL, FLAG, INFO, s, chosen)


@uncounted
def seek_moving(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], MARK: Rows[Mark], CELL: Rows[Cell], LIST: Rows[List],
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, s: int,
) -> bool:  # fmt: skip
    """Neighbours of s, which is not in the grid, among the shapes that are, but for those in its list already. False if
    the pool is full."""
    x, y = MARK[s].x, MARK[s].y
    radius = MARK[s].reach
    mask = HEAD.shape[0] - 1
    length = 0.5 * GRID[CELL_LENGTH]
    for level in range(LEVEL_COUNT):
        length *= 2.0
        left = INFO[LEVELS + level]
        if left == 0:
            continue
        reach = radius + 0.5 * length
        west, east = cell_at(x - reach, length), cell_at(x + reach, length)
        south, north = cell_at(y - reach, length), cell_at(y + reach, length)
        # Circles that are too large for the last level stand there too.
        last = level == LEVEL_COUNT - 1
        if last or float(east - west + 1) * float(north - south + 1) > 4.0 * left + 16.0:
            for o in range(INFO[MOVING]):
                here = CELL[o].level == level and CELL[o].bucket >= 0 and o != s
                if here and near(MARK, o, x, y, radius) and place_in(LIST, POOL, s, o) < 0:
                    if not join(BODY, LINK, LIST, POOL, FLAG, INFO, s, o):
                        return False
            continue
        heads = 0
        for column in range(west, east + 1):
            for row in range(south, north + 1):
                o = HEAD[bucket(level, column, row, mask)]
                fetch(MARK, o, 0)
                INFO[WALKED + heads] = o
                heads += 1 if o >= 0 else 0
                if heads == ROOM or (heads > 0 and column == east and row == north):
                    if not walk(BODY, LINK, MARK, LIST, POOL, FLAG, INFO, s, heads):
                        return False
                    heads = 0
    return True


@uncounted
def part(LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray, INFO: IntArray, MARK: Rows[Mark], s: int) -> int:
    """Leave in the list of s the moving shapes that are near its margin circle, with their flags, and take s out of the
    lists of the others; how many are left."""
    start, kept = LIST[s].start, 0
    for q in range(start, start + LIST[s].number):
        fetch(MARK, int(POOL[q]), 0)
        fetch(LIST, int(POOL[q]), 0)
    x, y, radius = MARK[s].x, MARK[s].y, MARK[s].reach
    for q in range(start, start + LIST[s].number):
        o = int(POOL[q])
        # Static ones are sought again, but for their flags.
        if near(MARK, o, x, y, radius) if o < INFO[MOVING] else FLAG[q] != 0:
            POOL[start + kept], FLAG[start + kept] = o, FLAG[q]
            kept += 1
        elif o < INFO[MOVING]:
            remove(LIST, POOL, FLAG, o, s)
    LIST[s].number = kept
    return kept


@uncounted
def renew(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], MARK: Rows[Mark], CELL: Rows[Cell], LIST: Rows[List],
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray,
    CSR: IntArray, s: int, t: float, ahead: float,
) -> int:  # fmt: skip
    """Draw the margin circle of s anew about where it is at instant t, and bring its list up to date.

    Args:
        ahead: how far before the shape on its way, in margins, the centre of the circle is to be; below 1.

    Returns:
        how many of the list were in it before: they are the first. -1 if the pool is full: then `build` is due.
    """
    if MARK[s].margin == math.inf:
        return int(LIST[s].number)
    unlink(MARK, CELL, HEAD, INFO, s)
    x, y = centre(BODY, SHAPE, LINK, s, t)
    if ahead > 0.0:
        ux, uy = course(BODY, LINK, s, t)
        x, y = x + ahead * MARK[s].margin * ux, y + ahead * MARK[s].margin * uy
    draw(MARK, SHAPE, s, x, y)
    INFO[LEAVES] += 1
    kept = part(LIST, POOL, FLAG, INFO, MARK, s)
    found = seek_moving(BODY, SHAPE, LINK, MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, s) and seek_walls(
        BODY, SHAPE, LINK, MARK, LIST, POOL, FLAG, GRID, INFO, BOX, CSR, s
    )
    link(MARK, CELL, HEAD, GRID, INFO, s)
    return kept if found else -1


@uncounted
def build(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], MARK: Rows[Mark], CELL: Rows[Cell], LIST: Rows[List],
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray,
    CSR: IntArray, t: float,
) -> bool:  # fmt: skip
    """Make all lists at instant t. False if the pool is full: give a larger one, and call again."""
    moving = INFO[MOVING]
    if POOL.shape[0] < moving * _FIRST_CAPACITY:
        return False
    HEAD[:] = -1
    INFO[LEVELS : LEVELS + LEVEL_COUNT] = 0
    for s in range(moving):
        LIST[s].start, LIST[s].capacity, LIST[s].number = s * _FIRST_CAPACITY, _FIRST_CAPACITY, 0
        CELL[s].bucket = -1
        x, y = centre(BODY, SHAPE, LINK, s, t)
        draw(MARK, SHAPE, s, x, y)
    INFO[POOL_END] = moving * _FIRST_CAPACITY
    everybody = moving > 0 and MARK[0].margin == math.inf
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
            link(MARK, CELL, HEAD, GRID, INFO, s)
    return True

"""Cells of the grid of moving shapes: buckets of a hash table, each a chain of shapes.

Margin circles are hashed by their centres into square cells on levels of size (Teschner et al. 2003). Level l holds
circles whose radius, bounding circle and margin together, is at most half its cell; the cells of level l are twice as
long as those of level l - 1.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..model.parameters.detection import CELL_LIMIT
from ..model.scene import Scene
from ..model.shapes import LEVELS


@nonallocating
def bucket(level: int, column: int, row: int, mask: int) -> int:
    """Bucket of a cell in the hash table, which has mask + 1 of them, a power of 2."""
    return ((column * 73856093) ^ (row * 19349663) ^ (level * 83492791)) & mask


@nonallocating
def cell_at(x: float, length: float) -> int:
    """Column or row of a cell of the grid of moving shapes."""
    return math.floor(min(max(x / length, -CELL_LIMIT), CELL_LIMIT))


@nonallocating
def level_of(radius: float, cell: float) -> int:
    """The lowest level whose cells are at least twice as long as the radius, the last one if there is none. `cell`:
    length of the cells of level 0."""
    level, length = 0, cell
    while length < 2.0 * radius and level < LEVELS - 1:
        length *= 2.0
        level += 1
    return level


@nonallocating
def set_circle(A: Scene, s: int, x: float, y: float) -> None:
    """Set the centre of the margin circle of shape s to (x, y), and `reach` from its present margin."""
    mark = A.MARK[s]
    mark.x, mark.y, mark.reach = x, y, A.SHAPE[s].bound + mark.margin


@nonallocating
def enter(A: Scene, s: int) -> None:
    """Enter shape s into the grid at its margin circle."""
    MARK, HEAD = A.MARK, A.HEAD
    level = level_of(MARK[s].reach, A.GRID.cell)
    length = A.GRID.cell * 2.0**level
    k = bucket(level, cell_at(MARK[s].x, length), cell_at(MARK[s].y, length), HEAD.shape[0] - 1)
    head = HEAD[k]
    A.CELL[s].level, A.CELL[s].bucket = level, k
    MARK[s].following, MARK[s].previous = head, -1.0
    if head >= 0:
        MARK[head].previous = s
    HEAD[k] = s
    A.GRID.level[level] += 1


@nonallocating
def unlink(A: Scene, s: int) -> None:
    """Remove shape s from the grid."""
    MARK, cell = A.MARK, A.CELL[s]
    after, before = int(MARK[s].following), int(MARK[s].previous)
    if before >= 0:
        MARK[before].following = after
    else:
        A.HEAD[cell.bucket] = after
    if after >= 0:
        MARK[after].previous = before
    A.GRID.level[cell.level] -= 1


@nonallocating
def overlaps(A: Scene, o: int, x: float, y: float, radius: float) -> bool:
    """Whether the circle of radius `MARK.reach` of shape o overlaps the circle (x, y, radius)."""
    dx, dy = A.MARK[o].x - x, A.MARK[o].y - y
    reach = radius + A.MARK[o].reach
    return bool(dx * dx + dy * dy <= reach * reach)

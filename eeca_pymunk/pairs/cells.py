"""Cells of the grid: where a margin circle stands, and the chains of shapes that stand in the same place.

Bounding circles are hashed by their centres into square cells, on levels of size: level l holds circles (with their
margins) of up to half its cell, which is twice that of level l - 1.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.parameters.detection import CELL_LIMIT
from ..model.shapes import Cell, Mark, Shape
from .layout import (
    CELL_LENGTH,
    LEVEL_COUNT,
    LEVELS,
)  # fmt: skip


@uncounted
def bucket(level: int, column: int, row: int, mask: int) -> int:
    """Place of a cell in the hash table."""
    return ((column * 73856093) ^ (row * 19349663) ^ (level * 83492791)) & mask


@uncounted
def cell_at(x: float, length: float) -> int:
    """Column or row of a cell of the grid of moving shapes."""
    return math.floor(min(max(x / length, -CELL_LIMIT), CELL_LIMIT))


@uncounted
def level_of(radius: float, cell: float) -> int:
    """The lowest level whose cells are at least twice as long as the radius."""
    level, length = 0, cell
    while length < 2.0 * radius and level < LEVEL_COUNT - 1:
        length *= 2.0
        level += 1
    return level


@uncounted
def draw(MARK: Rows[Mark], SHAPE: Rows[Shape], s: int, x: float, y: float) -> None:
    """Let the margin circle of shape s have its centre at (x, y)."""
    MARK[s].x, MARK[s].y, MARK[s].reach = x, y, SHAPE[s].bound + MARK[s].margin


@uncounted
def link(MARK: Rows[Mark], CELL: Rows[Cell], HEAD: IntArray, GRID: FloatArray, INFO: IntArray, s: int) -> None:
    """Put shape s into the grid where its margin circle is."""
    level = level_of(MARK[s].reach, GRID[CELL_LENGTH])
    length = GRID[CELL_LENGTH] * 2.0**level
    k = bucket(level, cell_at(MARK[s].x, length), cell_at(MARK[s].y, length), HEAD.shape[0] - 1)
    head = HEAD[k]
    CELL[s].level, CELL[s].bucket = level, k
    MARK[s].following, MARK[s].previous = head, -1.0
    if head >= 0:
        MARK[head].previous = s
    HEAD[k] = s
    INFO[LEVELS + level] += 1


@uncounted
def unlink(MARK: Rows[Mark], CELL: Rows[Cell], HEAD: IntArray, INFO: IntArray, s: int) -> None:
    """Take shape s out of the grid."""
    after, before = int(MARK[s].following), int(MARK[s].previous)
    if before >= 0:
        MARK[before].following = after
    else:
        HEAD[CELL[s].bucket] = after
    if after >= 0:
        MARK[after].previous = before
    INFO[LEVELS + CELL[s].level] -= 1


@uncounted
def near(MARK: Rows[Mark], o: int, x: float, y: float, radius: float) -> bool:
    """Whether the margin circle of shape o overlaps that of centre (x, y)."""
    dx, dy = MARK[o].x - x, MARK[o].y - y
    reach = radius + MARK[o].reach
    return bool(dx * dx + dy * dy <= reach * reach)

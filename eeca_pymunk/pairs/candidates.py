"""Candidates: the pairs that may meet within a step, for those who solve all contacts of a step at once.

A shape goes no farther than its body's reach. Its list is complete for a step if it stays within its margin circle all
the way; lists are made anew where it may not, with a margin that lasts for some steps.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..geometry.flight import norm
from ..geometry.gap import gap, touching
from ..model.bodies import Body
from ..model.parameters.detection import FARTHEST_CELL, MARGIN_OF_FAST
from ..model.shapes import Cell, Link, List, Mark, Shape
from .grid import renew
from .layout import CELL_LENGTH
from .lists import centre


@uncounted
def cover(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], MARK: Rows[Mark], CELL: Rows[Cell], LIST: Rows[List],
    POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray, INFO: IntArray, BOX: FloatArray, CSR: IntArray,
    USUAL: FloatArray, s: int, reach: float,
) -> bool:  # fmt: skip
    """Make the list of shape s complete for a way of length `reach` from the start of the step. False if the pool is
    full: then `grid.build` is due.

    Args:
        USUAL: (k,) margins where nothing is fast, length; margins of shapes that were fast go back to these.
    """
    margin = MARK[s].margin
    if margin == math.inf:
        return True
    reach = min(reach, FARTHEST_CELL * GRID[CELL_LENGTH])
    x, y = centre(BODY, SHAPE, LINK, s, 0.0)
    if norm(x - MARK[s].x, y - MARK[s].y) + reach <= margin:
        return True
    MARK[s].margin = max(USUAL[s], MARGIN_OF_FAST * reach)
    return renew(BODY, SHAPE, LINK, MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, BOX, CSR, s, 0.0, 0.0) >= 0


@uncounted
def candidates(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, WORK: FloatArray, MARK: Rows[Mark],
    CELL: Rows[Cell], LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray, HEAD: IntArray, GRID: FloatArray,
    INFO: IntArray, BOX: FloatArray, CSR: IntArray, USUAL: FloatArray, disks: int, REACH: FloatArray,
    PAIRS: IntArray, OUT: FloatArray,
) -> int:  # fmt: skip
    """The pairs of shapes whose gap at the start of the step is at most the sum of their bodies' reaches.

    Args:
        disks: see `..model`.  REACH: (n,) length by body.
        PAIRS: (p, 2) shapes a < b, out.  OUT: (p, 6) gap, normal (2) and point (2), and the length up to which the gap
            is round-off.

    Returns:
        how many there are; only the first p of them are written. -1 if the pool is full.
    """
    moving = LIST.shape[0]
    for s in range(moving):
        if not cover(
            BODY, SHAPE, LINK, MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, BOX, CSR, USUAL, s, REACH[LINK[s].owner]
        ):
            return -1
    found = 0
    for s in range(moving):
        for q in range(LIST[s].start, LIST[s].start + LIST[s].number):
            o = int(POOL[q])
            if o < s:
                continue
            g, nx, ny, px, py = gap(BODY, SHAPE, LINK, VERTEX, WORK, s, o, 0.0)
            if g > REACH[LINK[s].owner] + REACH[LINK[o].owner]:
                continue
            if found < PAIRS.shape[0]:
                PAIRS[found, 0], PAIRS[found, 1] = s, o
                OUT[found, 0], OUT[found, 1], OUT[found, 2], OUT[found, 3], OUT[found, 4] = g, nx, ny, px, py
                OUT[found, 5] = touching(BODY, SHAPE, LINK, s, o, disks)
            found += 1
    return found

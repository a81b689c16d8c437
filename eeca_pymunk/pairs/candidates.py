"""Candidates: the pairs that may meet within a step, for closures that solve all contacts of a step at once.

The reach of a body bounds the displacement of its shapes in the step. A near list is complete for the step if its shape
stays inside its margin circle; if that is not certain, the list is renewed with MARGIN_OF_FAST times the reach as
margin.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import Table, nonallocating
from ..geometry.flight import norm
from ..geometry.gap import gap, gap_round_off
from ..model.parameters.detection import FARTHEST_CELL, MARGIN_OF_FAST
from ..model.scene import Scene, scene_of
from .grid import renew_circle
from .rules import circle_centre


@nonallocating
def cover(A: Scene, s: int, reach: float) -> bool:
    """Make the list of shape s complete for a displacement of length `reach` from the start of the step. False if the
    pool is full: then `grid.build` has to be called."""
    mark = A.MARK[s]
    if mark.margin == math.inf:
        return True
    reach = min(reach, FARTHEST_CELL * A.GRID.cell)
    x, y = circle_centre(A, s, 0.0)
    if norm(x - mark.x, y - mark.y) + reach <= mark.margin:
        return True
    mark.margin = max(mark.usual, MARGIN_OF_FAST * reach)
    return renew_circle(A, s, 0.0, 0.0) >= 0


@nonallocating
def candidates(table: Table, REACH: FloatArray, PAIRS: IntArray, OUT: FloatArray) -> int:
    """The pairs of shapes whose gap at the start of the step is at most the sum of their bodies' reaches.

    Args:
        REACH: (n,) bound of the displacement of each body's points in the step, length.
        PAIRS: (p, 2) shapes a < b, out.  OUT: (p, 6) gap, normal (2), point (2), and the round-off of the gap, length.

    Returns:
        the number of pairs; only the first p of them are written. -1 if the pool is full.
    """
    A = scene_of(table)
    LINK, LIST = A.LINK, A.LIST
    moving = LIST.shape[0]
    for s in range(moving):
        if not cover(A, s, REACH[LINK[s].owner]):
            return -1
    found = 0
    for s in range(moving):
        for q in range(LIST[s].start, LIST[s].start + LIST[s].number):
            o = int(A.POOL[q])
            if o < s:
                continue
            g, nx, ny, px, py = gap(A, s, o, 0.0)
            if g > REACH[LINK[s].owner] + REACH[LINK[o].owner]:
                continue
            if found < PAIRS.shape[0]:
                PAIRS[found, 0], PAIRS[found, 1] = s, o
                OUT[found, 0], OUT[found, 1], OUT[found, 2], OUT[found, 3], OUT[found, 4] = g, nx, ny, px, py
                OUT[found, 5] = gap_round_off(A, s, o)
            found += 1
    return found

"""Margins of a scene, the cell lengths of both grids, and the first lists.

Shapes of radius r with margins m, spread evenly, have (2 + 2 m / r)² phi neighbours each, where the packing phi is the
part of the area that bounding circles cover. Margins are chosen for a number of neighbours by this equation, and all
are halved if the lists become longer, as those of shapes that are not spread evenly do. A margin is in proportion to
twice the bounding radius, or to the median of these radii if that is less.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import Table, nonallocating
from ..model.parameters.detection import (
    ALL_PAIRS,
    ALL_WALLS,
    MARGIN_HALVINGS,
    MARGIN_LEAST,
    MARGIN_MOST,
    MOST_NEIGHBOURS,
    NEIGHBOURS,
)
from ..model.scene import Scene, scene_of
from .grid import make_lists
from .walls import box_wall, size_walls, wall_grid

LISTS_MADE, POOL_TOO_SMALL = -1, -2


@nonallocating
def begin_lists(table: Table) -> int:
    """Write the boxes of static shapes; if shapes are so few that each is in all lists, make these lists too.

    Returns:
        if shapes are few: LISTS_MADE, or POOL_TOO_SMALL; else the length that CSR must have, 0 if static shapes need no
        grid.
    """
    A = scene_of(table)
    A.GRID.moving = A.LIST.shape[0]
    for w in range(A.BOX.shape[0]):
        box_wall(A, w)
    if A.GRID.moving <= ALL_PAIRS and A.BOX.shape[0] <= ALL_WALLS:
        for s in range(A.GRID.moving):
            A.MARK[s].margin = A.MARK[s].usual = math.inf
        set_cell(A)
        return LISTS_MADE if make_lists(A, 0.0) else POOL_TOO_SMALL
    if A.BOX.shape[0] <= ALL_WALLS:
        return 0
    entries = size_walls(A.BOX, A.GRID)
    return int(A.GRID.columns * A.GRID.rows) + 1 + entries


@nonallocating
def fill_lists(table: Table, BOUND: FloatArray) -> bool:
    """Choose margins, unless there are some, and make all lists.

    Args:
        BOUND: (m,) bounding radii of the shapes that move, in ascending order.

    Returns:
        False if the pool is full: call again with a larger one.
    """
    A = scene_of(table)
    if A.GRID.cell == 0.0:
        if A.GRID.columns > 0:
            wall_grid(A.BOX, A.GRID, A.CSR)
        choose_margins(A, middle(BOUND))
    while True:
        set_cell(A)
        made, entries = make_lists(A, 0.0), 0
        for s in range(A.GRID.moving):
            entries += A.LIST[s].number
        # Margins do not fall with the bounding radius, so the shapes of median radius have the median margin.
        small, large = margin_at(A, BOUND, (A.GRID.moving - 1) // 2), margin_at(A, BOUND, A.GRID.moving // 2)
        least = 0.5 * (small + large) <= MARGIN_LEAST * middle(BOUND) or A.GRID.halvings >= MARGIN_HALVINGS
        if least or entries <= MOST_NEIGHBOURS * A.GRID.moving:
            return made
        for s in range(A.GRID.moving):
            A.MARK[s].margin *= 0.5
            A.MARK[s].usual = A.MARK[s].margin
        A.GRID.halvings += 1


@nonallocating
def middle(BOUND: FloatArray) -> float:
    """The median of numbers in ascending order, 0 if there are none."""
    m = BOUND.shape[0]
    return 0.5 * float(BOUND[(m - 1) // 2] + BOUND[m // 2]) if m > 0 else 0.0


@nonallocating
def margin_at(A: Scene, BOUND: FloatArray, place: int) -> float:
    """The margin of a shape with the bounding radius at this place of BOUND."""
    for s in range(A.GRID.moving):
        if A.SHAPE[s].bound == BOUND[place]:
            return float(A.MARK[s].margin)
    return math.inf


@nonallocating
def set_cell(A: Scene) -> None:
    """Set the length of the cells of level 0: twice the radius of the smallest margin circle and its shape together."""
    least = math.inf
    for s in range(A.GRID.moving):
        least = min(least, A.SHAPE[s].bound + A.MARK[s].margin)
    A.GRID.cell = 2.0 * least


@nonallocating
def neighbours_factor(A: Scene, wide: float, tall: float) -> float:
    """The factor (2 + 2 m / r)² of the packing for which a shape has NEIGHBOURS. A shape of a large part of the area
    wide x tall is one neighbour of each, not more, as the walls of a container that turns."""
    squared, before = 0.0, -1.0
    while squared > before:
        large, packing, before = 0, 0.0, squared
        for s in range(A.GRID.moving):
            part = math.pi * (A.SHAPE[s].bound / wide) * (A.SHAPE[s].bound / tall)
            if squared * part > 1.0:
                large += 1
            else:
                packing += part
        squared = max(NEIGHBOURS - large, 0.0) / max(packing, 1e-6)
    return squared


@nonallocating
def choose_margins(A: Scene, median: float) -> None:
    """Set the margins of the shapes that move, whose bounding radii have this median, for NEIGHBOURS."""
    left, bottom, right, top, largest = math.inf, math.inf, -math.inf, -math.inf, 0.0
    for s in range(A.GRID.moving):
        body, bound = A.BODY[A.LINK[s].owner], A.SHAPE[s].bound
        left, bottom = min(left, body.x - bound), min(bottom, body.y - bound)
        right, top = max(right, body.x + bound), max(top, body.y + bound)
        largest = max(largest, bound)
    squared = neighbours_factor(A, max(right - left, 1e-300), max(top - bottom, 1e-300))
    factor = min(max(0.5 * math.sqrt(squared) - 1.0, MARGIN_LEAST), MARGIN_MOST)
    factor = MARGIN_MOST if A.GRID.moving <= ALL_PAIRS else factor
    # Points have a margin too; if all shapes are points, any length will do.
    size = median if median > 0.0 else largest if largest > 0.0 else 1.0
    for s in range(A.GRID.moving):
        A.MARK[s].margin = A.MARK[s].usual = factor * max(min(2.0 * A.SHAPE[s].bound, median), 1e-3 * size)

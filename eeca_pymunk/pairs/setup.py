"""The first near lists of a scene: margins, the lengths of both grids, and room for the lists."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray, side_by_side
from ..compiled.records import Rows, columns
from ..model.bodies import Body
from ..model.parameters.detection import ALL_PAIRS, ALL_WALLS, MARGIN_HALVINGS, MOST_NEIGHBOURS, NEIGHBOURS
from ..model.shapes import Cell, Link, List, Mark, Shape
from .grid import build
from .layout import (
    CELL_LENGTH,
    GRID_LENGTH,
    INFO_LENGTH,
    MOVING,
    WALL_COLUMNS,
    WALL_LENGTH,
    WALL_ROWS,
    WALL_X,
    WALL_Y,
)  # fmt: skip
from .walls import wall_grid

_MARGINS = (0.1, 20.0)  # least and most, in radii


class Near(NamedTuple):
    """The arrays of the near lists, see `..model.shapes`; BOX (W, 4) and CSR are those of the static shapes."""

    MARK: Rows[Mark]
    CELL: Rows[Cell]
    LIST: Rows[List]
    POOL: PoolArray
    FLAG: FlagArray
    HEAD: IntArray
    GRID: FloatArray
    INFO: IntArray
    BOX: FloatArray
    CSR: IntArray

    def larger(self) -> Near:
        """The same with twice the room for lists, which are to be made anew."""
        room = 2 * len(self.POOL)
        return self._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8))


def margins(bound: FloatArray, centre: FloatArray, walls: int) -> FloatArray:
    """(m,) how far shapes of radius `bound` (m,) at `centre` (m, 2) may go before their lists are made anew.

    (2 + 2 m / r)² phi is the number of neighbours at the packing phi, if shapes are spread evenly; `near_lists` takes
    less where they are not. Small shapes among large ones do not get more than twice their own share, large ones no
    more than the median's. Few shapes among few walls stand in all lists.
    """
    if len(bound) <= ALL_PAIRS and walls <= ALL_WALLS:
        return np.full(len(bound), np.inf)
    low, high = (centre - bound[:, None]).min(axis=0), (centre + bound[:, None]).max(axis=0)
    wide, tall = np.maximum(high - low, 1e-300)
    phi = max(math.pi * float((bound / wide) @ (bound / tall)), 1e-6)
    few = len(bound) <= ALL_PAIRS
    factor = _MARGINS[1] if few else min(max(math.sqrt(0.25 * NEIGHBOURS / phi) - 1.0, _MARGINS[0]), _MARGINS[1])
    median = float(np.median(bound))
    # Points have a margin too; where all are points, any length will do.
    least = 1e-3 * (median or float(bound.max()) or 1.0)
    result: FloatArray = factor * np.maximum(np.minimum(2.0 * bound, median), least)
    return result


def boxes(SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, moving: int) -> FloatArray:
    """(W, 4) left, bottom, right and top of the static shapes, which are those from number `moving` on."""
    result = np.zeros((len(SHAPE) - moving, 4))
    if len(result):
        first, count = LINK["first"][moving:], LINK["vertices"][moving:]
        points = VERTEX[first[0] : first[-1] + count[-1], :2]
        result[:, :2] = np.minimum.reduceat(points, first - first[0]) - SHAPE["rounding"][moving:, None]
        result[:, 2:] = np.maximum.reduceat(points, first - first[0]) + SHAPE["rounding"][moving:, None]
    return result


def near_lists(BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, moving: int) -> Near:
    """Lists of the shapes [0, moving), where BODY has them now."""
    bound = SHAPE["bound"][:moving]
    INFO, GRID, room = np.zeros(INFO_LENGTH, np.int64), np.zeros(GRID_LENGTH), 32 * moving + 1024
    MARK, CELL, LIST, POOL, FLAG, HEAD = side_by_side(
        ((moving,), Mark.TYPE), ((moving,), Cell.TYPE), ((moving,), List.TYPE),
        ((room,), np.int32), ((room,), np.uint8), ((1 << max(1, math.ceil(math.log2(2 * moving + 2))),), np.int64),
    )  # fmt: skip
    INFO[MOVING] = moving
    BOX = boxes(SHAPE, LINK, VERTEX, moving)
    CSR = _wall_cells(BOX, GRID, INFO)
    MARK["margin"] = margins(bound, columns(BODY, "x", "y")[LINK["owner"][:moving]], len(BOX)) if moving else 0.0
    HEAD[:] = -1
    near = Near(MARK, CELL, LIST, POOL, FLAG, HEAD, GRID, INFO, BOX, CSR)
    for _ in range(MARGIN_HALVINGS):
        GRID[CELL_LENGTH] = 2.0 * float((bound + MARK["margin"]).min(initial=1e300))
        near = rebuilt(near, BODY, SHAPE, LINK, 0.0)
        # What is crowded in places needs less, unless that is next to nothing, or everybody knows all.
        if moving == 0 or near.LIST["number"].mean() <= MOST_NEIGHBOURS or math.isinf(MARK["margin"][0]):
            break
        if np.median(MARK["margin"]) <= _MARGINS[0] * np.median(bound):
            break
        MARK["margin"] *= 0.5
    return near


def rebuilt(near: Near, BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], t: float) -> Near:
    """The lists made anew at instant t, with more room if they want it."""
    while not build(
        BODY, SHAPE, LINK, near.MARK, near.CELL, near.LIST, near.POOL, near.FLAG, near.HEAD, near.GRID, near.INFO,
        near.BOX, near.CSR, t,
    ):  # fmt: skip
        near = near.larger()
    return near


def _wall_cells(BOX: FloatArray, GRID: FloatArray, INFO: IntArray) -> IntArray:
    """The grid of static shapes: about as many cells as shapes, fewer where large ones would fill too many."""
    if len(BOX) <= ALL_WALLS:
        return np.zeros(1, np.int64)
    low, high = BOX[:, :2].min(axis=0), BOX[:, 2:].max(axis=0)
    wide, tall = np.maximum(high - low, 1e-300)
    length = max(math.sqrt(wide * tall / len(BOX)), max(wide, tall) / (4.0 * len(BOX)))
    GRID[WALL_X], GRID[WALL_Y] = low
    while True:
        GRID[WALL_LENGTH] = length
        INFO[WALL_COLUMNS], INFO[WALL_ROWS] = max(1, math.ceil(wide / length)), max(1, math.ceil(tall / length))
        cells = int(INFO[WALL_COLUMNS] * INFO[WALL_ROWS])
        entries = wall_grid(BOX, GRID, INFO, np.zeros(1, np.int64))
        if entries <= 32 * len(BOX) or cells == 1:
            CSR = np.zeros(cells + 1 + entries, np.int64)
            wall_grid(BOX, GRID, INFO, CSR)
            return CSR
        length *= 2.0

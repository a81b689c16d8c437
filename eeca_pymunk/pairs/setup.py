"""The first near lists of a scene: margins, cell lengths of both grids, and memory for the lists."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray, side_by_side
from ..compiled import Table, table_of
from ..compiled.records import columns, row
from ..model.parameters.detection import ALL_PAIRS, ALL_WALLS, MARGIN_HALVINGS, MOST_NEIGHBOURS, NEIGHBOURS
from ..model.scene import Scene
from ..model.shapes import Cell, Grid, List, Mark
from .grid import build
from .walls import size_walls, wall_grid

_MARGINS = (0.1, 20.0)  # least and most, in radii
# Fields of `Scene` that are the near lists.
NEAR = ("MARK", "CELL", "LIST", "POOL", "FLAG", "HEAD", "GRID", "BOX", "CSR")


def margins(bound: FloatArray, centre: FloatArray, walls: int) -> FloatArray:
    """(m,) margins, length, of shapes with bounding radii `bound` (m,) at `centre` (m, 2).

    (2 + 2 m / r)² phi is the number of neighbours at the packing phi, if shapes are spread evenly; `near_lists` takes
    less where they are not. Small shapes among large ones do not get more than twice their own share, large ones no
    more than the median's.
    """
    low, high = (centre - bound[:, None]).min(axis=0), (centre + bound[:, None]).max(axis=0)
    wide, tall = np.maximum(high - low, 1e-300)
    phi = max(math.pi * float((bound / wide) @ (bound / tall)), 1e-6)
    few = len(bound) <= ALL_PAIRS
    factor = _MARGINS[1] if few else min(max(math.sqrt(0.25 * NEIGHBOURS / phi) - 1.0, _MARGINS[0]), _MARGINS[1])
    median = _median(bound)
    # Points have a margin too; if all shapes are points, any length will do.
    least = 1e-3 * (median or float(bound.max()) or 1.0)
    result: FloatArray = factor * np.maximum(np.minimum(2.0 * bound, median), least)
    return result


def _median(values: FloatArray) -> float:
    """Of (m,) values, m > 0. numpy's own imports its masked arrays at the first call: 40 ms within a step."""
    ordered, half = np.sort(values), (len(values) - 1) // 2
    return 0.5 * float(ordered[half] + ordered[len(values) // 2])


def boxes(scene: Scene, moving: int) -> FloatArray:
    """(W, 4) left, bottom, right and top of the static shapes, those with numbers from `moving` on."""
    SHAPE, LINK = scene.SHAPE, scene.LINK
    result = np.zeros((len(SHAPE) - moving, 4))
    if len(result):
        first, count = LINK["first"][moving:], LINK["vertices"][moving:]
        points = scene.VERTEX[first[0] : first[-1] + count[-1], :2]
        result[:, :2] = np.minimum.reduceat(points, first - first[0]) - SHAPE["rounding"][moving:, None]
        result[:, 2:] = np.maximum.reduceat(points, first - first[0]) + SHAPE["rounding"][moving:, None]
    return result


def near_lists(scene: Scene, moving: int) -> Scene:
    """The scene with lists of the shapes [0, moving), for the present poses in BODY."""
    return with_lists(scene, moving)[0]


def with_lists(scene: Scene, moving: int) -> tuple[Scene, Table]:
    """`near_lists`, and the table of that scene."""
    bound, room = scene.SHAPE["bound"][:moving], 32 * moving + 1024
    GRID, BOX = row(Grid), boxes(scene, moving)
    GRID.moving = moving
    MARK, CELL, LIST, POOL, FLAG, HEAD = side_by_side(
        ((moving,), Mark.TYPE), ((moving,), Cell.TYPE), ((moving,), List.TYPE),
        ((room,), np.int32), ((room,), np.uint8), ((1 << max(1, (2 * moving + 1).bit_length()),), np.int64),
    )  # fmt: skip
    CSR = _wall_cells(BOX, GRID)
    if moving == 0 or (moving <= ALL_PAIRS and len(BOX) <= ALL_WALLS):
        MARK["margin"] = math.inf  # each in all lists
    else:
        MARK["margin"] = margins(bound, columns(scene.BODY, "x", "y")[scene.LINK["owner"][:moving]], len(BOX))
    scene = scene._replace(
        MARK=MARK, CELL=CELL, LIST=LIST, POOL=POOL, FLAG=FLAG, HEAD=HEAD, GRID=GRID, BOX=BOX, CSR=CSR
    )
    table = table_of(scene)
    for _ in range(MARGIN_HALVINGS):
        GRID.cell = 2.0 * float((bound + MARK["margin"]).min(initial=1e300))
        if not build(table, 0.0):
            scene = with_more_room(scene, 0.0)
            table = table_of(scene, table)
        # Uneven scenes get smaller margins, down to the least one, unless all pairs are listed anyway.
        if moving == 0 or math.isinf(MARK["margin"][0]) or scene.LIST["number"].mean() <= MOST_NEIGHBOURS:
            break
        if _median(MARK["margin"]) <= _MARGINS[0] * _median(bound):
            break
        MARK["margin"] *= 0.5
    return scene, table


def rebuilt(scene: Scene, t: float) -> Scene:
    """The scene with its lists built at instant t, with a larger pool if necessary."""
    return scene if build(table_of(scene), t) else with_more_room(scene, t)


def with_more_room(scene: Scene, t: float) -> Scene:
    """The scene with its lists built at instant t, with a pool at least twice as long (recursion with `rebuilt`)."""
    room = more_room(len(scene.POOL))
    return rebuilt(scene._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8)), t)


def more_room(room: int) -> int:
    """Length of the pool that replaces a full one of length `room`."""
    return 2 * room


def _wall_cells(BOX: FloatArray, GRID: Grid) -> IntArray:
    """The grid of static shapes, if there are many."""
    if len(BOX) <= ALL_WALLS:
        return np.zeros(1, np.int64)
    entries = size_walls(BOX, GRID)
    CSR = np.zeros(int(GRID.columns * GRID.rows) + 1 + entries, np.int64)
    wall_grid(BOX, GRID, CSR)
    return CSR

"""The first near lists of a scene: margins, cell lengths of both grids, and memory for the lists."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import FloatArray, IntArray, side_by_side
from ..compiled import Table, table_of
from ..compiled.records import columns
from ..model.parameters.detection import ALL_PAIRS, ALL_WALLS, MARGIN_HALVINGS, MOST_NEIGHBOURS, NEIGHBOURS
from ..model.scene import Scene
from ..model.shapes import Cell, Grid, List, Mark
from .grid import begin_lists, build
from .walls import size_walls, wall_grid

_MARGINS = (0.1, 20.0)  # least and most, in radii
# Fields of `Scene` that are the near lists.
Size: TypeAlias = tuple[tuple[int, ...], npt.DTypeLike]
NEAR = ("MARK", "CELL", "LIST", "POOL", "FLAG", "HEAD", "GRID", "BOX", "CSR")
NO_GRID: IntArray = np.zeros(1, np.int64)  # CSR of few static shapes


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


def near_sizes(moving: int, walls: int) -> tuple[Size, ...]:
    """Shapes and dtypes of NEAR, without CSR, for so many moving and so many static shapes."""
    room, heads = 32 * moving + 1024, 1 << max(1, (2 * moving + 1).bit_length())
    return (
        ((moving,), Mark.TYPE), ((moving,), Cell.TYPE), ((moving,), List.TYPE), ((room,), np.int32),
        ((room,), np.uint8), ((heads,), np.int64), ((1,), Grid.TYPE), ((walls, 4), np.float64),
    )  # fmt: skip


def near_lists(scene: Scene, moving: int) -> Scene:
    """The scene with lists of the shapes [0, moving), for the present poses in BODY."""
    arrays = side_by_side(*near_sizes(moving, len(scene.SHAPE) - moving))
    arrays[NEAR.index("GRID")] = GRID = arrays[NEAR.index("GRID")][0]
    GRID.moving = moving
    scene = scene._replace(**dict(zip(NEAR, (*arrays, NO_GRID), strict=True)))
    return filled(scene, table_of(scene))[0]


def filled(scene: Scene, table: Table) -> tuple[Scene, Table]:
    """The scene with its lists, whose arrays are new, and the table of that scene."""
    moving, walls = len(scene.LIST), len(scene.BOX)
    few = moving == 0 or (moving <= ALL_PAIRS and walls <= ALL_WALLS)
    room = begin_lists(table, few)
    if few:
        return (scene, table) if room else _and_table(with_more_room(scene, 0.0), table)
    if walls > ALL_WALLS:
        scene, table = _and_table(scene._replace(CSR=_wall_cells(scene.BOX, scene.GRID)), table)
    bound, margin = scene.SHAPE["bound"][:moving], scene.MARK["margin"]
    margin[:] = margins(bound, columns(scene.BODY, "x", "y")[scene.LINK["owner"][:moving]], walls)
    for _ in range(MARGIN_HALVINGS):
        scene.GRID.cell = 2.0 * float((bound + margin).min())
        if not build(table, 0.0):
            scene, table = _and_table(with_more_room(scene, 0.0), table)
        # Uneven scenes get smaller margins, down to the least one.
        if scene.LIST["number"].mean() <= MOST_NEIGHBOURS or _median(margin) <= _MARGINS[0] * _median(bound):
            break
        margin *= 0.5
    return scene, table


def _and_table(scene: Scene, before: Table) -> tuple[Scene, Table]:
    return scene, table_of(scene, before)


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
    """The grid of static shapes, of which there are many."""
    entries = size_walls(BOX, GRID)
    CSR = np.zeros(int(GRID.columns * GRID.rows) + 1 + entries, np.int64)
    wall_grid(BOX, GRID, CSR)
    return CSR

"""The first near lists of a scene, and memory for them."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import IntArray, side_by_side
from ..compiled import Table, table_of
from ..model.parameters.detection import ALL_PAIRS, ALL_WALLS, NEIGHBOURS
from ..model.scene import Scene
from ..model.shapes import Cell, Grid, List, Mark
from .grid import build
from .margins import DONE, begin_lists, fill_lists

Size: TypeAlias = tuple[tuple[int, ...], npt.DTypeLike]  # dimensions and dtype of an array
# Fields of `Scene` that are the near lists.
NEAR = ("MARK", "CELL", "LIST", "POOL", "FLAG", "HEAD", "GRID", "BOX", "CSR")
NO_GRID: IntArray = np.zeros(1, np.int64)  # CSR of few static shapes


def near_sizes(moving: int, walls: int) -> tuple[Size, ...]:
    """Dimensions and dtypes of the arrays NEAR, without CSR, in a scene with so many moving and static shapes."""
    room, heads = 32 * moving + 1024, 1 << max(1, (2 * moving + 1).bit_length())
    return (
        ((moving,), Mark.TYPE), ((moving,), Cell.TYPE), ((moving,), List.TYPE), ((room,), np.int32),
        ((room,), np.uint8), ((heads,), np.int64), ((1,), Grid.TYPE), ((walls, 4), np.float64),
    )  # fmt: skip


def near_lists(scene: Scene, moving: int, like: Table | None = None) -> Scene:
    """The scene with lists of the shapes [0, moving), for the present poses in BODY; `like`: its table, if there is
    one."""
    arrays = side_by_side(*near_sizes(moving, len(scene.SHAPE) - moving))
    arrays[NEAR.index("GRID")] = GRID = arrays[NEAR.index("GRID")][0]
    GRID.moving = moving
    scene = scene._replace(**dict(zip(NEAR, (*arrays, NO_GRID), strict=True)))
    return filled(scene, table_of(scene, like))[0]


def filled(scene: Scene, table: Table) -> tuple[Scene, Table]:
    """The scene with its first lists, for which its arrays NEAR must be those of a new scene, and its table."""
    few = len(scene.LIST) <= ALL_PAIRS and len(scene.BOX) <= ALL_WALLS
    found = begin_lists(table, few)
    if few:
        return (scene, table) if found == DONE else _and_table(with_more_room(scene, 0.0, table), table)
    if found > 0:
        scene, table = _and_table(scene._replace(CSR=np.zeros(found, np.int64)), table)
    bounds = np.sort(scene.SHAPE["bound"][: len(scene.LIST)])
    halved = fill_lists(table, bounds, NEIGHBOURS, 0, False)
    while halved != DONE:
        scene, table = _and_table(with_more_room(scene, 0.0, table), table)
        halved = fill_lists(table, bounds, NEIGHBOURS, halved, True)
    return scene, table


def _and_table(scene: Scene, before: Table) -> tuple[Scene, Table]:
    """A scene with its table; `before`: that of the scene that it replaces."""
    return scene, table_of(scene, before)


def rebuilt(scene: Scene, t: float, like: Table | None = None) -> Scene:
    """The scene with its lists built at instant t, with a larger pool if necessary; `like`: a table of the scene, as it
    was, if there is one."""
    return scene if build(table_of(scene, like), t) else with_more_room(scene, t, like)


def with_more_room(scene: Scene, t: float, like: Table | None = None) -> Scene:
    """The scene with its lists built at instant t, with a pool at least twice as long (recursion with `rebuilt`)."""
    room = more_room(len(scene.POOL))
    return rebuilt(scene._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8)), t, like)


def more_room(room: int) -> int:
    """Length of the pool that replaces a full one of length `room`."""
    return 2 * room

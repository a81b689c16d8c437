"""Memory of the near lists of a scene."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import Table, replaced, table_of
from ..compiled.records import Rows
from ..model.scene import Scene, scene_of
from ..model.shapes import Shape
from .grid import build
from .margins import LISTS_MADE, begin_lists, fill_lists

# Fields of `Scene` that are the near lists.
NEAR = ("MARK", "CELL", "LIST", "POOL", "FLAG", "HEAD", "GRID", "BOX", "CSR")
NO_GRID: IntArray = np.zeros(1, np.int64)  # CSR of few static shapes


def pool_sizes(moving: int) -> tuple[int, int]:
    """Lengths of POOL and of HEAD in a scene with so many moving shapes.

    A list of MOST_NEIGHBOURS = 20 has had room for 8 and then for 24 shapes (`rules.append`), and the pool has twice
    that for each; few shapes may have longer lists. More than half of the buckets in HEAD are empty.
    """
    return 64 * moving + 1024, 1 << max(1, (2 * moving + 1).bit_length())


def refilled(table: Table) -> Table:
    """The table of a scene with lists as of a new one, in their place if these fit there."""
    scene = scene_of(table)
    moving = len(scene.LIST)
    room, _ = pool_sizes(moving)
    if len(scene.POOL) != room:
        scene = scene._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8))
        table = table_of(scene)
    for name in NEAR:
        if name != "CSR":
            array = np.asarray(getattr(scene, name))
            np.ndarray(array.nbytes, np.uint8, array).fill(0)
    return filled(table, scene.SHAPE, moving, begin_lists(table), scene.CSR)


def filled(table: Table, SHAPE: Rows[Shape], moving: int, found: int, CSR: IntArray = NO_GRID) -> Table:
    """The table of a scene with these shapes, the first ones of which move, and with arrays NEAR as in a new one, with
    its first lists. found: the result of `begin_lists`.  CSR: that of the table, to be written if it fits."""
    if found < 0:
        return table if found == LISTS_MADE else table_of(with_more_room(scene_of(table), 0.0))
    if found > 0 and (CSR is NO_GRID or len(CSR) != found):
        table = replaced(table, Scene, "CSR", np.zeros(found, np.int64))
    bounds = np.sort(SHAPE["bound"][:moving])
    while not fill_lists(table, bounds):
        table = table_of(_with_larger_pool(scene_of(table)))
    return table


def _with_larger_pool(scene: Scene) -> Scene:
    """The scene with an empty pool, twice as long."""
    room = 2 * len(scene.POOL)
    return scene._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8))


def with_more_room(scene: Scene, t: float) -> Scene:
    """The scene with its lists built at instant t, with a pool at least twice as long."""
    built = False
    while not built:
        scene = _with_larger_pool(scene)
        built = build(table_of(scene), t)
    return scene

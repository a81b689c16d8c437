"""All arrays of a scene."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import AnyArray, FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import Opener
from ..compiled.entries import table_fields
from ..compiled.records import Record, Rows
from .bodies import Body, Member, Next, Rest
from .contacts import Force, Impulse, Pair, Pushed
from .shapes import Cell, Corner, Grid, Link, List, Mark, Shape, Side
from .step import Count, Missed, Step


class Scene(NamedTuple):
    """All arrays of a scene of n bodies and k shapes.

    VERTEX: see `shapes.Link`. POOL int32: numbers of shapes, all neighbour lists one after the other; FLAG, of the same
    length, 1 where an island's solve has taken the pair over, so that it makes no events. HEAD, GRID, BOX, CSR: the
    grids of `..pairs`. RULE (r, 6): what collision handlers say of pairs, a < b: shapes a, b, elasticity (below 0:
    none), friction, surface velocity of b relative to a. LOG: impulses of the step. BEGAN (n, 3): poses at the start of
    the step. CORE (2, K, 4): scratch, the placed cores of two shapes. SIDE, CORNER: of thin shapes
    (`..geometry.sides`), empty where there are none. MISSED: what was not met. PLACE (n,): -1, or a body's place in the
    block in BLOCK (n,). PULL (n, 3): accelerations without contacts. KEYS, FORCES: memory of forces
    (`..contacts.memory`).
    """

    BODY: Rows[Body]
    STATE: Rows[Next]
    SHAPE: Rows[Shape]
    LINK: Rows[Link]
    VERTEX: FloatArray
    MARK: Rows[Mark]
    CELL: Rows[Cell]
    LIST: Rows[List]
    POOL: PoolArray
    FLAG: FlagArray
    HEAD: IntArray
    GRID: Grid
    BOX: FloatArray
    CSR: IntArray
    RULE: FloatArray
    HEAP_TIME: FloatArray
    HEAP_BODY: IntArray
    LOG: Rows[Impulse]
    BEGAN: FloatArray
    PLACE: IntArray
    BLOCK: IntArray
    PULL: FloatArray
    MEMBER: Rows[Member]
    RESTING: Rows[Rest]
    PUSHED_BY: Rows[Pair]
    PUSHED: Rows[Pushed]
    KEYS: IntArray
    FORCES: Rows[Force]
    CORE: FloatArray
    SIDE: Rows[Side]
    CORNER: Rows[Corner]
    MISSED: Rows[Missed]
    PAR: Step
    COUNT: Count


scene_of = Opener(Scene)


def scene_with(**arrays: AnyArray | Record) -> Scene:
    """A scene of these arrays; the others have no rows, and records are 0."""
    for name, dtype, dimensions in table_fields("Scene"):
        if name not in arrays:
            arrays[name] = _nothing(dtype, dimensions) if dimensions else np.zeros(1, dtype)[0]
    return Scene(**arrays)  # type: ignore[arg-type]


@cache
def _nothing(dtype: Any, dimensions: int) -> AnyArray:
    """An array without rows."""
    return np.zeros((0,) * dimensions, dtype)

"""All arrays of a scene."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import Opener
from ..compiled.records import Rows
from .bodies import Body, Member, Next, Rest
from .contacts import Force, Impulse, Pair, Pushed
from .shapes import Cell, Link, List, Mark, Shape
from .step import Count, Missed, Step


class Scene(NamedTuple):
    """All arrays of a scene of n bodies and k shapes.

    VERTEX: see `shapes.Link`. POOL int32: numbers of shapes, all neighbour lists one after the other; FLAG, of the same
    length, 1 where an island's solve has taken the pair over, so that it makes no events. HEAD, GRID, INFO, BOX, CSR:
    the grids of `..pairs`. RULE (r, 6): what collision handlers say of pairs, a < b: shapes a, b, elasticity (below 0:
    none), friction, surface velocity of b relative to a. LOG: impulses of the step. BEGAN (n, 3): poses at the start of
    the step. WORK (2, K, 4): scratch for vertices, and sides (`..geometry.sides`). MISSED: what
    was not met. PLACE (n,): -1, or a body's place in the block in BLOCK (n,). PULL
    (n, 3): accelerations without contacts. KEYS, FORCES: memory of forces (`..contacts.memory`).
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
    GRID: FloatArray
    INFO: IntArray
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
    WORK: FloatArray
    MISSED: Rows[Missed]
    PAR: Step
    COUNT: Count


scene_of = Opener(Scene)

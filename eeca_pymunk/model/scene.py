"""All arrays of a scene."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import Opener
from ..compiled.records import Rows
from .bodies import Body, Member, Next, Rest
from .contacts import Force, Impulse, Pair, Pushed
from .shapes import Cell, Corner, Grid, Link, List, Mark, Shape, Side
from .step import Count, Missed, Step


class Scene(NamedTuple):
    """All arrays of a scene of n bodies and k shapes, of which the first `moving` move.

    BODY, STATE (n,): bodies, and their next events.  SHAPE, LINK (k,): shapes.  VERTEX (v, 4): see `shapes.Link`.
    MARK, CELL (k,), LIST (moving,): margin circles, places in the grid, near lists.
    POOL int32: numbers of shapes, all near lists one after the other.  FLAG (as POOL): 1 if an island's solve contains
    the pair, or its impact was left out in this step: it makes no events.
    HEAD (power of 2,): first shape in each bucket of the grid of moving shapes, -1 for none.  GRID: its record.
    BOX (static shapes, 4): left, bottom, right, top.  CSR: starts of the cells of their grid, then shapes.
    RULE (r, 6): pairs a < b for which a collision handler or a joint decides: shapes a, b, elasticity (negative: no
    contact), friction, surface velocity of b relative to a.
    HEAP_TIME, HEAP_BODY: the queue of events.  LOG: impulses of the step.
    BEGAN (n, 3): poses at the start of the step.  PULL (n, 3): accelerations without contacts.
    PLACE (n,): -1, or a number that a function gives to bodies as long as it runs: the place in BLOCK (n,), a scratch
    list of bodies, or in an island. What needs it within another one calls `islands.local.take_places`.
    MEMBER, RESTING (n,): islands, and the state of their solves and rest.
    PUSHED_BY, PUSHED: contacts of the intervals, shapes and impulses, one row each.
    KEYS, FORCES: hash table of the forces of the last step (`..contacts.forces`).
    CORE (2, K, 4): scratch, the placed cores of two shapes.
    SIDE, CORNER: of thin shapes (`..geometry.sides`), empty if there are none.
    MISSED: budgets and tolerances that were not met.  PAR, COUNT: settings and energies, counters and flags.
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

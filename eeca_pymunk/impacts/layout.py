"""The arrays of the event loop: what their columns mean."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray

# STATE (n, 8) int: one row per body
OWN, OTHER = 0, 1  # shapes of the next event; OTHER may be one of these:
LEAVE, CHECK, NOTHING = -1, -2, -3  # OWN leaves its margin circle; the body is to be forecast anew; no event
KNOWN = 2  # KINKS of the other body when the event was forecast
KINKS = 3  # how often the body's path has changed
FIRST_SHAPE, SHAPES = 4, 5
EVENTS = 6  # impacts of the body in this step
ISLAND = 7  # first body of the island it is solved in, -1 for none
STATE_COLUMNS = 8

# PAR float: of the step
DT, NOW = 0, 1  # length of the step; instant at which the loop has stopped for more room
GRAVITY_X, GRAVITY_Y = 2, 3
LEFT_OVER = 4  # what the damping of half a step leaves of velocities
LOCK = 5  # scale of an energy lock that was farthest from 1
LAST = 6  # length of the step before
LEDGER = 7  # energy of the step: PAR[LEDGER + ...]
RESTITUTION, FRICTIONAL, EXTERNAL, DAMPED = 0, 1, 2, 3
LEDGER_LENGTH = 4
BEFORE, AFTER = 12, 13  # kinetic energy and -m g.x at both ends of the step
PAR_LENGTH = 14

# COUNT int: of the step
HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE, LIMIT, UNMET, STRUCK = 0, 1, 2, 3, 4, 5, 6, 7, 8
COUNT_LENGTH = 9

# Status of a step
DONE, POOL_FULL, LOG_FULL, BLOCK_DUE = 0, 1, 2, 3


class Scene(NamedTuple):
    """All arrays of a scene: bodies and shapes (`..layout`), lists (`..pairs.layout`), and those of the loop.

    RULE (r, 6): what collision handlers say of pairs, a < b: shapes a, b, elasticity (below 0: none), friction, surface
    velocity of b relative to a. LOG: EVENT rows. BEGAN (n, 3): poses at the start of the step. WORK (2, K, 4): scratch
    for vertices. PLACE (n,): -1, or a body's place in the block in BLOCK (n,).
    """

    BODY: FloatArray
    STATE: IntArray
    SHAPE: FloatArray
    LINK: IntArray
    VERTEX: FloatArray
    MARK: FloatArray
    CELL: IntArray
    LIST: IntArray
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
    LOG: FloatArray
    BEGAN: FloatArray
    PLACE: IntArray
    BLOCK: IntArray
    WORK: FloatArray
    PAR: FloatArray
    COUNT: IntArray

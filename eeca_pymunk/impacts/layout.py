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

# LOG (l, 12) float: one row per impulse
BY, ON = 0, 1  # shapes; the normal points from the first to the second
INSTANT = 2  # time after the start of the step
IMPULSE, TANGENTIAL = 3, 4  # mass length/time, along the normal n and t = (-n_y, n_x)
NORMAL_X, NORMAL_Y, POINT_X, POINT_Y = 5, 6, 7, 8
GAP = 9  # at the start of the step, length
CHANGE = 10  # of the normal velocity by the impulse alone, length/time
LOG_COLUMNS = 12

# PAR float: of the step
DT, NOW = 0, 1  # length of the step; instant at which the loop has stopped for more room
GRAVITY_X, GRAVITY_Y = 2, 3
DAMPING = 4  # what is left of velocities after half a step
LOCK = 5  # scale of an energy lock that was farthest from 1
LAST = 6  # length of the step before
LEDGER = 7  # energy of the step: PAR[LEDGER + ...]
RESTITUTION, FRICTIONAL, EXTERNAL, DAMPED, LIFTED = 0, 1, 2, 3, 4
BEFORE, AFTER = 12, 13  # kinetic energy at both ends of the step, and -m g.x of gravity
PAR_LENGTH = 14

# COUNT int: of the step
HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE, LIMIT, UNMET, STRUCK = 0, 1, 2, 3, 4, 5, 6, 7, 8
COUNT_LENGTH = 9

# Status of a step
DONE, POOL_FULL, LOG_FULL, BLOCK_DUE, NOT_FINITE, CHANGED = 0, 1, 2, 3, 4, 5


class Edge(NamedTuple):
    """What passes between a space and the loop: N bodies in the space's order, n rows of BODY.

    Attributes:
        G: (N, 9) as read: position, angle, velocity, spin, force, torque.  IDS: (N,) pymunk's numbers of the bodies.
        KNOWN: (N,) what these numbers were when the scene was read.
        ROW: (N,) row in BODY; -1 for static bodies.
        EXPECT: (N, 6) what was written last.  OUT: (N, 6) what is to be written.
        COG: (n, 2) centre of mass in the body's frame.
        EXTRA: (n, 4) whether the body's acceleration is given, and that acceleration.
    """

    G: FloatArray
    IDS: IntArray
    KNOWN: IntArray
    ROW: IntArray
    EXPECT: FloatArray
    OUT: FloatArray
    COG: FloatArray
    EXTRA: FloatArray


class Scene(NamedTuple):
    """All arrays of a scene: bodies and shapes (`..layout`), lists (`..pairs.layout`), and those of the loop."""

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
    START: FloatArray
    PLACE: IntArray
    BLOCK: IntArray
    WORK: FloatArray
    PAR: FloatArray
    COUNT: IntArray

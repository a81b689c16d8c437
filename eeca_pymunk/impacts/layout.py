"""The arrays of the event loop: what their columns mean."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import Opener

# STATE (n, 8) int: one row per body
OWN, OTHER = 0, 1  # shapes of the next event; OTHER may be one of these:
LEAVE, CHECK, NOTHING = -1, -2, -3  # OWN leaves its margin circle; the body is to be forecast anew; no event
RENEW = -4  # the span of the body's island ends
KNOWN = 2  # KINKS of the other body when the event was forecast
KINKS = 3  # how often the body's path has changed
FIRST_SHAPE, SHAPES = 4, 5
EVENTS = 6  # impacts of the body in this step
ISLAND = 7  # first body of the island it is solved in, -1 for none
STATE_COLUMNS = 8

# MEMBER (n, 14) int: islands of bodies in sustained contact as chains from their first body, the root
AFTER_ME, LAST_ONE, BODIES = 0, 1, 2  # next body of the chain, -1 for none; of the root: the last one, and how many
HITS = 3  # of the root: how often the island was hit in this step
BUSY = 4  # steps for which what comes near joins the island rather than hits it
OPEN = 5  # of the root: 1 while contacts of its span are not booked
TIED, NEXT_TIED = 6, 7  # of a body held by joints: the first body of those it hangs together with, else -1; the next
JOINTED = 8  # of the root: 1 if bodies of its island are held by joints
STILL = 9  # 1 if the body's island goes on as it was (`still.py`)
LOADED = 10  # of the root of an island that stands: 1 while it is to be seen whether it carries what moves on it
AMONG = 11  # of the root: BODIES, and those of the islands that carry them
PUT = 12  # 1 if the body was put where it is, and may be in others (`crammed.py`)
ANEW = 13  # of the root of an island that stands: 1 while its forces are new to what carries it
MEMBER_COLUMNS = 14

# RESTING (n, 14) float: of a body in an island
LIFT = 0  # RESTING[LIFT : LIFT + 6]: what to add to pose and velocity at the end of the span; of an island with joints
# that is OPEN, what to add to the pose, and the velocity itself: its path may be of a span as short as round-off
RELAX = 6  # of the root, RESTING[RELAX : RELAX + 3]: state of the solve
LOST = 9  # of the root: energy lost in this step; below 0 it is owed
UNTIL = 10  # of the root: instant at which the span ends
CALM_FOR = 11  # steps in a row at whose start the body hardly moved
SPEED = 12  # that points of the body may get in the step, where all contacts act together
STILL_DUE = 13  # DUE of a still body at the end of the last step
RESTING_COLUMNS = 14

# PUSHED_BY (c, 3) int: the contacts of islands in their present spans
PUSH_A, PUSH_B, ROOT = 0, 1, 2  # shapes, first body of the island; of a span that is over one of these:
ENDED, LASTED = -1, -2  # before the end of the step, with it
# PUSHED (c, 15) float
LAM, BETA = 0, 1  # impulses over the span
UN_BEFORE, UN_AFTER, UT_BEFORE, UT_AFTER = 2, 3, 4, 5  # velocities of the contact at both ends
WORK_OF = 6  # energy that moving bodies and surfaces give over the span
SPAN_FROM, SPAN = 7, 8  # instant and length of the span
PUSH_NX, PUSH_NY, PUSH_X, PUSH_Y = 9, 10, 11, 12
PUSH_CHANGE = 13  # of the normal velocity by the impulse alone
PUSH_GAP = 14  # at the start of the step, nan where the span began later
PUSHED_COLUMNS = 15

# PAR float: of the step
DT, NOW = 0, 1  # length of the step; instant at which the loop has stopped for more room
GRAVITY_X, GRAVITY_Y = 2, 3
LEFT_OVER = 4  # what the damping of half a step leaves of velocities
LOCK = 5  # scale of an energy lock that was farthest from 1
LAST = 6  # length of the step before
STAMP = 14  # number of the step
PULLED = 15  # largest acceleration without contacts
LEDGER = 7  # energy of the step: PAR[LEDGER + ...]
RESTITUTION, FRICTIONAL, EXTERNAL, DAMPED = 0, 1, 2, 3
LEDGER_LENGTH = 4
STORED = 11  # change of what springs hold
BEFORE, AFTER = 12, 13  # kinetic energy and -m g.x at both ends of the step
PAR_LENGTH = 16

# COUNT int: of the step
HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE, LIMIT, UNMET, STRUCK = 0, 1, 2, 3, 4, 5, 6, 7, 8
PUSHES = 9  # rows of PUSHED in use
SOLVES, IGNORED = 10, 11
PENDING, WAITING = 12, 13  # island whose span is to be begun, -1 for none; bodies in BLOCK to be forecast then
PHASE = 14  # of the step that is to be resumed
SWEEPS, DIRECT = 15, 16  # of all solves: sweeps, direct solutions
REMEMBERED = 17  # COUNT[REMEMBERED:]: rows of the memory of forces in use
TOGETHER = 18  # 1 where all contacts of a step act together, and no events are followed
EVEN = 19  # 1 while one acceleration pulls all that impulses move, and no body is in an island
QUIET = 20  # steps in a row in which that was so to the end
DISKS = 21  # of the scene: lone disks
SOLVED = 22  # bodies of all solves
CARRIES = 23  # 1 where islands that stand may carry others that move (`carrying.py`)
CRAMMED = 24  # 1 if there are bodies that were put where they are
COUNT_LENGTH = 25

# Status of a step
DONE, POOL_FULL, LOG_FULL, BLOCK_DUE, PUSHES_FULL = 0, 1, 2, 3, 4
JOINTS_DUE = 5  # a span or an impact of an island that is held by joints: `..jointed`


class Scene(NamedTuple):
    """All arrays of a scene: bodies and shapes (`..layout`), lists (`..pairs.layout`), and those of the loop.

    RULE (r, 6): what collision handlers say of pairs, a < b: shapes a, b, elasticity (below 0: none), friction, surface
    velocity of b relative to a. LOG: EVENT rows. BEGAN (n, 3): poses at the start of the step. WORK (2, K, 4): scratch
    for vertices. PLACE (n,): -1, or a body's place in the block in BLOCK (n,). PULL (n, 3): accelerations
    without contacts. KEYS, FORCES: memory of forces (`..sustained.memory`).
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
    PULL: FloatArray
    MEMBER: IntArray
    RESTING: FloatArray
    PUSHED_BY: IntArray
    PUSHED: FloatArray
    KEYS: IntArray
    FORCES: FloatArray
    WORK: FloatArray
    PAR: FloatArray
    COUNT: IntArray


scene_of = Opener(Scene)

"""A step of bodies that meet at computed times of impact: the stages between what pymunk holds before and after."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..geometry.gap import gap_at
from ..layout import (
    ANGLE,
    AX,
    AY,
    BODY_ROW,
    DUE,
    EXTENT,
    GAP,
    II,
    IM,
    OWNER,
    SPECIAL,
    STEERED,
    TWIST,
    X,
    Y,
)  # fmt: skip
from ..layout import (
    FIRST_SHAPE as FIRST_OF,
)
from ..layout import (
    SECOND_SHAPE as SECOND_OF,
)
from ..tables import Table
from ..transfer import EVENTS as SOME
from ..transfer import give, take
from .booking import book, flag_spans, lift_out
from .calm import LIKELY, find_still
from .layout import (
    AFTER,
    BEFORE,
    BLOCKS,
    BUSY,
    DAMPED,
    DIRECT,
    DISKS,
    DONE,
    DT,
    EVEN,
    EVENTS,
    EXTERNAL,
    FORECASTS,
    FRICTIONAL,
    GRAVITY_X,
    GRAVITY_Y,
    HEAP,
    IGNORED,
    IMPACTS,
    ISLAND,
    KINKS,
    LAST,
    LEDGER,
    LEDGER_LENGTH,
    LEFT_OVER,
    LOCK,
    LOG_FULL,
    LOGGED,
    PENDING,
    PHASE,
    POOL_FULL,
    PULLED,
    PUSHES,
    QUIET,
    RESTITUTION,
    ROOT,
    SOLVED,
    SOLVES,
    STALE,
    STAMP,
    STILL,
    STILL_DUE,
    STORED,
    SWEEPS,
    UNMET,
    Scene,
    scene_of,
)  # fmt: skip
from .loop import follow, forecast_due
from .settle import BUSY_FOR, settle
from .still import halt, keep, leave, stand, stays, watch
from .strike import kinetic, move_to

# Answers of a step that wants more memory: give some, and `resume`.
ROOM_FOR_LISTS, ROOM_FOR_EVENTS, ROOM_FOR_CONTACTS = -10, -11, -12


@uncounted
def energy(A: Scene, i: int) -> float:
    """Kinetic energy of body i, and potential energy -m g.x in the uniform gravity; 0 for what impulses do not move."""
    BODY = A.BODY
    if BODY[i, IM] == 0.0:
        return 0.0
    return kinetic(BODY, i) - (A.PAR[GRAVITY_X] * BODY[i, X] + A.PAR[GRAVITY_Y] * BODY[i, Y]) / BODY[i, IM]


@uncounted
def total(A: Scene) -> float:
    """Energy of all bodies."""
    whole = 0.0
    for i in range(A.BODY.shape[0] - 1):
        whole += energy(A, i)
    return whole


@uncounted
def begin(A: Scene, WALK: IntArray) -> None:
    """Count from the start of this step; forecast the bodies that were edited, and all that is due."""
    BODY, STATE, PAR, COUNT = A.BODY, A.STATE, A.PAR, A.COUNT
    for c in (HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE, SOLVES, SOLVED, IGNORED, SWEEPS, DIRECT):
        COUNT[c] = 0
    if COUNT[UNMET] > 0:
        A.FLAG[:] = 0
        COUNT[UNMET] = 0
        # Pairs that were passed over are in nobody's forecast.
        for i in range(BODY.shape[0] - 1):
            BODY[i, DUE], A.RESTING[i, STILL_DUE] = min(BODY[i, DUE], 0.0), 0.0
        flag_spans(A)
    for c in range(LEDGER_LENGTH):
        PAR[LEDGER + c] = 0.0
    PAR[LOCK], PAR[STORED] = 1.0, 0.0
    PAR[BEFORE] = total(A)
    left = PAR[LEFT_OVER]
    if left != 1.0:
        # `take` has damped velocities already, by half a step's worth.
        for k in range(WALK.shape[1]):
            i = WALK[BODY_ROW, k]
            if i >= 0 and not WALK[SPECIAL, k] & STEERED:
                PAR[LEDGER + DAMPED] += kinetic(BODY, i) * (1.0 / (left * left) - 1.0)
        PAR[BEFORE] += PAR[LEDGER + DAMPED]
    PAR[STAMP] += 1.0
    COUNT[PENDING], COUNT[PHASE] = -1, 0
    n, last = BODY.shape[0] - 1, PAR[LAST]
    pulled, even = 0.0, True
    quiet = COUNT[QUIET] > BUSY_FOR
    for i in range(n):
        STATE[i, EVENTS] = 0
        if not quiet:
            A.MEMBER[i, BUSY] = max(A.MEMBER[i, BUSY] - 1, 0)
        if not quiet and A.MEMBER[i, STILL] == 1 and stays(A, i, last):
            pulled = max(pulled, A.PULL[i, 0] * A.PULL[i, 0] + A.PULL[i, 1] * A.PULL[i, 1])
            even = False
            continue
        if BODY[i, IM] == 0.0:
            watch(A, i)
        ax, ay = BODY[i, AX], BODY[i, AY]
        A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2] = ax, ay, BODY[i, TWIST]
        pulled = max(pulled, ax * ax + ay * ay)
        A.BEGAN[i, 0], A.BEGAN[i, 1], A.BEGAN[i, 2] = BODY[i, X], BODY[i, Y], BODY[i, ANGLE]
        if BODY[i, DUE] == -math.inf:
            STATE[i, KINKS] += 1
        else:
            BODY[i, DUE] = max(BODY[i, DUE] - last, 0.0)
        alike = BODY[i, IM] == 0.0 or (ax == BODY[0, AX] and ay == BODY[0, AY])
        even = even and alike and STATE[i, ISLAND] < 0
    PAR[PULLED] = math.sqrt(pulled)
    COUNT[EVEN] = 1 if even else 0


@uncounted
def close(A: Scene, WALK: IntArray) -> None:
    """Bring all paths to the end of the step; book islands, the work of forces, the energy; gaps at the start."""
    BODY, PAR, LOG, BEGAN, COUNT = A.BODY, A.PAR, A.LOG, A.BEGAN, A.COUNT
    end = PAR[DT]
    even = COUNT[EVEN] > 0  # no islands
    COUNT[QUIET] = COUNT[QUIET] + 1 if even else 0
    if not even:
        find_still(A)
    for c in range(COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root >= 0 and A.MEMBER[root, STILL] == 1:
            stand(A, c)
        elif root >= 0:
            book(A, c, end)
            if A.MEMBER[root, STILL] == LIKELY:
                keep(A, c, root)
    gx, gy = PAR[GRAVITY_X], PAR[GRAVITY_Y]
    for i in range(BODY.shape[0] - 1):
        move_to(BODY, i, end)
        if not even and A.STATE[i, ISLAND] == i:
            lift_out(A, i, end)
            if A.MEMBER[i, STILL] == LIKELY:
                halt(A, i)
    for i in range(BODY.shape[0] - 1):
        fx, fy, twist = A.PULL[i, 0] - gx, A.PULL[i, 1] - gy, A.PULL[i, 2]
        if BODY[i, IM] > 0.0 and (fx != 0.0 or fy != 0.0 or twist != 0.0):
            work = (fx * (BODY[i, X] - BEGAN[i, 0]) + fy * (BODY[i, Y] - BEGAN[i, 1])) / BODY[i, IM]
            if BODY[i, II] > 0.0:
                work += twist * (BODY[i, ANGLE] - BEGAN[i, 2]) / BODY[i, II]
            PAR[LEDGER + EXTERNAL] += work
    # What friction gives back counts against restitution, and the other way round.
    for one, other in ((RESTITUTION, FRICTIONAL), (FRICTIONAL, RESTITUTION)):
        if PAR[LEDGER + one] < 0.0 and PAR[LEDGER + other] > 0.0:
            PAR[LEDGER + other] += PAR[LEDGER + one]
            PAR[LEDGER + one] = 0.0
    PAR[AFTER] = total(A) + PAR[STORED]
    left = PAR[LEFT_OVER]
    if left != 1.0:
        lost = 0.0
        for k in range(WALK.shape[1]):
            i = WALK[BODY_ROW, k]
            if i >= 0 and not WALK[SPECIAL, k] & STEERED:
                lost += kinetic(BODY, i) * (1.0 - left * left)
        PAR[LEDGER + DAMPED] += lost
        PAR[AFTER] -= lost
    PAR[LAST] = end
    for n in range(COUNT[LOGGED]):
        if not math.isnan(LOG[n, GAP]):
            continue
        a, b = int(LOG[n, FIRST_OF]), int(LOG[n, SECOND_OF])
        if max(a, b) < COUNT[DISKS]:
            dx, dy = BEGAN[a, 0] - BEGAN[b, 0], BEGAN[a, 1] - BEGAN[b, 1]
            LOG[n, GAP] = math.sqrt(dx * dx + dy * dy) - BODY[min(a, b), EXTENT] - BODY[max(a, b), EXTENT]
            continue
        i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
        LOG[n, GAP] = gap_at(
            A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, BEGAN[i, 0], BEGAN[i, 1], BEGAN[i, 2],
            b, BEGAN[j, 0], BEGAN[j, 1], BEGAN[j, 2],
        )[0]  # fmt: skip
    if not even:
        leave(A)


@kernel
def start(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, dt: float, gx: float, gy: float, left: float
) -> int:
    """Take the states that were read, and begin a step of length dt on them; the bits so far, or a negative code."""
    status = take(STATES, WALK, EXTRA, A.BODY, gx, gy, left)
    if status >= 0:
        A.PAR[DT], A.PAR[GRAVITY_X], A.PAR[GRAVITY_Y], A.PAR[LEFT_OVER] = dt, gx, gy, left
        begin(A, WALK)
    return status


@kernel
def finish(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, status: int
) -> int:  # fmt: skip
    """Close the step, and give the states at its end; the bits of the step, or a negative code."""
    close(A, WALK)
    if A.COUNT[LOGGED] > 0:
        status |= SOME
    return give(STATES, WALK, EXTRA, A.BODY, ENDS, A.PAR[DT], A.PAR[LEFT_OVER], status)


@uncounted
def wish(met: int) -> int:
    """The room that the loop wants, which has answered with one of its arrays being full."""
    if met == POOL_FULL:
        return ROOM_FOR_LISTS
    return ROOM_FOR_EVENTS if met == LOG_FULL else ROOM_FOR_CONTACTS


@kernel
def resume(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, disks: int, lossy: bool,
    status: int,
) -> int:  # fmt: skip
    """The rest of a step, whose bits so far are `status`."""
    COUNT = A.COUNT
    if COUNT[PHASE] == 0:
        if COUNT[PUSHES] > 0 and settle(A) != DONE:
            return ROOM_FOR_CONTACTS
        COUNT[PHASE] = 1
        forecast_due(A, disks)
    if COUNT[PHASE] == 1:
        met = follow(A, disks, lossy or A.PAR[PULLED] > 0.0)
        if met != DONE:
            return wish(met)
        COUNT[PHASE] = 2
    if COUNT[LOGGED] + COUNT[PUSHES] > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    return finish(A, STATES, WALK, EXTRA, ENDS, status)


@kernel
def step(
    TABLE: Table, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float,
    gy: float, left: float, disks: int, lossy: bool, bits: int,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written, see `transfer.py`.

    Args:
        TABLE: `table_of` a Scene.
        dt: time, > 0.  gx, gy: gravity, length/time².  left: what half the step's damping leaves of velocities.
        disks: the first so many rows of BODY are lone disks.  lossy: whether any shape's elasticity is below 1.
        bits: negative for a new step; those of one that wished for room and goes on.

    Returns:
        the bits EVENTS, FORCES, TURNS, a negative code of `transfer.py`, or a wish for room.
    """
    A = scene_of(TABLE)
    if bits >= 0:
        return resume(A, STATES, WALK, EXTRA, ENDS, disks, lossy, bits)
    status = start(A, STATES, WALK, EXTRA, dt, gx, gy, left)
    if status < 0:
        return status
    return resume(A, STATES, WALK, EXTRA, ENDS, disks, lossy, status)

"""A step of a scene with joints: the event loop, whose islands with joints are begun and hit here.

`..impacts.loop.follow` does all else. It comes back for the span of such an island (COUNT[PENDING]) and for an impact
on one (of body COUNT[STRUCK]).
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..impacts.heap import push
from ..impacts.layout import (
    DONE,
    DT,
    GRAVITY_X,
    GRAVITY_Y,
    HEAP,
    ISLAND,
    JOINTED,
    JOINTS_DUE,
    LEFT_OVER,
    LOG_FULL,
    LOGGED,
    NOW,
    OPEN,
    OTHER,
    OWN,
    PENDING,
    PHASE,
    POOL_FULL,
    PULLED,
    PUSHES,
    PUSHES_FULL,
    REMEMBERED,
    STRUCK,
    UNMET,
    WAITING,
    Scene,
)  # fmt: skip
from ..impacts.loop import follow, forecast
from ..impacts.settle import settle
from ..impacts.step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, ROOM_FOR_LISTS, begin, close
from ..joints.layout import BODY_A, BODY_B, ELASTIC, TOUCHED
from ..layout import BODY_ROW, DUE, LEFT, SINCE
from ..layout import NOW as READ
from ..transfer import EVENTS as SOME
from ..transfer import give, take
from .layout import COMPONENTS, REPEATS, WORST, Joints
from .solve import begin_span
from .strike import book_component, collide

_ROOM = 64  # contacts more than there are, that there must be room for before an impact


@uncounted
def feel(A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray) -> None:
    """Mark the joints of bodies that were edited since the last step: their velocities may not fit."""
    now, before = STATES[READ], STATES[LEFT]
    for k in range(WALK.shape[1]):
        i = WALK[BODY_ROW, k]
        if i < 0:
            continue
        same = True
        for c in range(6):
            same = same and now[k, c] == before[k, c]
        if not same:
            for j in range(J.TIE.shape[0]):
                if J.TIE[j, BODY_A] == i or J.TIE[j, BODY_B] == i:
                    J.TIE[j, TOUCHED] = 1


@uncounted
def roomy(A: Scene) -> bool:
    """Whether there is room for the contacts that an impact may bring."""
    more = 2 * A.COUNT[PUSHES] + _ROOM
    return bool(more <= A.PUSHED.shape[0] and 2 * (A.COUNT[REMEMBERED] + more) <= A.KEYS.shape[0])


@kernel
def follow_jointed(A: Scene, J: Joints, disks: int, may_rest: bool) -> int:
    """The events of the step; results as `..impacts.loop.follow`."""
    COUNT, STATE, BLOCK = A.COUNT, A.STATE, A.BLOCK
    moving, end = A.LIST.shape[0], A.PAR[DT]
    status = JOINTS_DUE if COUNT[PENDING] >= 0 else follow(A, disks, may_rest)
    while True:
        if status != JOINTS_DUE:
            return status
        if COUNT[PENDING] < 0:
            i = COUNT[STRUCK]
            t = A.PAR[NOW]
            if not roomy(A):
                COUNT[HEAP] = push(A.HEAP_TIME, A.HEAP_BODY, COUNT[HEAP], t, i)
                return PUSHES_FULL
            status, COUNT[WAITING] = collide(A, J, disks, STATE[i, OWN], STATE[i, OTHER], t)
        elif A.MEMBER[COUNT[PENDING], JOINTED] == 0:
            status = follow(A, disks, may_rest)
            continue
        if COUNT[PENDING] >= 0:
            root = COUNT[PENDING]
            t = A.BODY[root, SINCE]
            if t < end and begin_span(A, J, root, t, end - t) != DONE:
                return PUSHES_FULL
            COUNT[PENDING] = -1
        for q in range(COUNT[WAITING]):
            forecast(A, disks, moving, BLOCK[q], A.BODY[BLOCK[q], SINCE], end)
        status = follow(A, disks, may_rest)


@kernel
def settle_jointed(A: Scene, J: Joints) -> int:
    """The islands of the start of a step, and their spans. DONE, or PUSHES_FULL, to be called again with more room."""
    if settle(A) != DONE:
        return PUSHES_FULL
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i, ISLAND] == i and A.MEMBER[i, JOINTED] > 0 and A.MEMBER[i, OPEN] == 0:
            if begin_span(A, J, i, 0.0, A.PAR[DT]) != DONE:
                return PUSHES_FULL
    return DONE


@kernel
def resume_jointed(
    A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, disks: int,
    lossy: bool, status: int,
) -> int:  # fmt: skip
    """The rest of a step, whose bits so far are `status`: as `..impacts.step.resume`."""
    COUNT, BODY = A.COUNT, A.BODY
    dt = A.PAR[DT]
    if COUNT[PHASE] == 0:
        if settle_jointed(A, J) != DONE:
            return ROOM_FOR_CONTACTS
        COUNT[PHASE] = 1
        for i in range(BODY.shape[0] - 1):
            if BODY[i, DUE] < dt or A.STATE[i, ISLAND] >= 0:
                forecast(A, disks, A.LIST.shape[0], i, 0.0, dt)
    if COUNT[PHASE] == 1:
        met = follow_jointed(A, J, disks, lossy or A.PAR[PULLED] > 0.0)
        if met == POOL_FULL:
            return ROOM_FOR_LISTS
        if met == LOG_FULL:
            return ROOM_FOR_EVENTS
        if met == PUSHES_FULL:
            return ROOM_FOR_CONTACTS
        COUNT[PHASE] = 2
    if COUNT[LOGGED] + COUNT[PUSHES] > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    for s in range(J.TALLY[COMPONENTS]):
        book_component(A, J, s)
    if J.TALLY[WORST] >= ELASTIC:
        COUNT[UNMET] += 1
    close(A, WALK)
    if COUNT[LOGGED] > 0:
        status |= SOME
    return give(STATES, WALK, EXTRA, BODY, ENDS, dt, A.PAR[LEFT_OVER], status)


@kernel
def step_jointed(
    A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float,
    gy: float, left: float, disks: int, lossy: bool,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written: arguments and answer as `..impacts.step.step`."""
    feel(A, J, STATES, WALK)
    status = take(STATES, WALK, EXTRA, A.BODY, gx, gy, left)
    if status < 0:
        return status
    A.PAR[DT], A.PAR[GRAVITY_X], A.PAR[GRAVITY_Y], A.PAR[LEFT_OVER] = dt, gx, gy, left
    begin(A, WALK)
    J.TALLY[WORST] = J.TALLY[REPEATS] = 0
    J.STEPPED[:] = 0.0
    return resume_jointed(A, J, STATES, WALK, EXTRA, ENDS, disks, lossy, status)

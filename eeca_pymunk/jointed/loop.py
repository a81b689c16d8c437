"""A step of a scene with joints: the event loop, whose islands with joints are begun and hit here.

`..impacts.loop.follow` does all else. It comes back for the interval of such an island (COUNT[PENDING]) and for an
impact on one (of body COUNT[STRUCK]).
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel, uncounted
from ..contacts.unmet import note_unmet
from ..impacts.loop import cut_short, follow, with_mover
from ..impacts.step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, finish, start, wish
from ..islands.building import build_islands
from ..islands.membership import members
from ..joints.ledger import clear_interval
from ..layout import BODY_ROW, LEFT
from ..layout import NOW as READ
from ..model.bodies import RENEW
from ..model.joints import ELASTIC, Joints, joints_of
from ..model.parameters.joints import STEP_WORK, STEP_WORK_BODY
from ..model.scene import Scene, scene_of
from ..model.step import DONE, JOINTS_DUE, PUSHES_FULL
from ..model.step import JOINTS as UNMET_JOINTS
from ..prediction.heap import push
from ..prediction.scheduling import forecast, forecast_due
from .meet import account_component, end_here, shorten
from .solve import SPENT, begin_interval
from .strike import collide

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
        A.PLACE[i] = -1 if same else 1
    n = A.PLACE.shape[0]
    for j in range(J.JOINT.shape[0]):
        a, b = J.JOINT[j].body[0], J.JOINT[j].body[1]
        if (a < n and A.PLACE[a] > 0) or (b < n and A.PLACE[b] > 0):
            J.JOINT[j].touched = 1
    A.PLACE[:] = -1


@kernel
def start_jointed(
    A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, dt: float, gx: float, gy: float,
    left: float,
) -> int:  # fmt: skip
    """As `..impacts.step.start`, with the joints."""
    feel(A, J, STATES, WALK)
    J.TALLY.worst = J.TALLY.repeats = 0
    J.PROGRESS.effort, J.PROGRESS.budget = 0.0, STEP_WORK + STEP_WORK_BODY * A.BODY.shape[0]
    for s in range(len(J.STEPPED)):
        clear_interval(J.STEPPED[s])
    return start(A, STATES, WALK, EXTRA, dt, gx, gy, left)


@uncounted
def account_joints(A: Scene, J: Joints) -> None:
    """Book what all joints have done until the end of the step."""
    for s in range(J.TALLY.components):
        account_component(A, J, s)
    if J.TALLY.worst >= ELASTIC:
        note_unmet(A, UNMET_JOINTS, -1, -1, float(J.TALLY.worst), float(ELASTIC))


@uncounted
def roomy(A: Scene) -> bool:
    """Whether there is room for the contacts that an impact may bring."""
    more = 2 * A.COUNT.pushes + _ROOM
    return bool(more <= A.PUSHED.shape[0] and 2 * (A.COUNT.remembered + more) <= A.KEYS.shape[0])


@kernel
def follow_jointed(A: Scene, J: Joints, may_rest: bool) -> int:
    """The events of the step; results as `..impacts.loop.follow`."""
    COUNT, STATE, BLOCK = A.COUNT, A.STATE, A.BLOCK
    end = A.PAR.dt
    status = JOINTS_DUE if COUNT.pending >= 0 else follow(A, may_rest)
    while True:
        if status != JOINTS_DUE:
            return status
        if COUNT.pending < 0:
            i = COUNT.struck
            t = A.PAR.now
            if J.PROGRESS.effort > J.PROGRESS.budget:
                return cut_short(A, t)
            if not roomy(A):
                COUNT.heap = push(A.HEAP_TIME, A.HEAP_BODY, COUNT.heap, t, i)
                return PUSHES_FULL
            if STATE[i].other == RENEW:
                end_here(A, J, i, t)
                COUNT.waiting, COUNT.pending = members(A, i, BLOCK), i
            else:
                status, n = collide(A, J, STATE[i].own, STATE[i].other, t)
                COUNT.waiting = with_mover(A, i, n)
        elif A.MEMBER[COUNT.pending].jointed == 0:
            status = follow(A, may_rest)
            continue
        if COUNT.pending >= 0:
            root = COUNT.pending
            t = A.BODY[root].since
            if t < end:
                status = begin_interval(A, J, root, t, end - t)
                if status == PUSHES_FULL:
                    return PUSHES_FULL
                if status == SPENT:
                    A.COUNT.struck = root
                    return cut_short(A, t)
            COUNT.pending = -1
        for q in range(COUNT.waiting):
            forecast(A, BLOCK[q], A.BODY[BLOCK[q]].since, end, False)
        status = follow(A, may_rest)


@kernel
def settle_jointed(A: Scene, J: Joints) -> int:
    """The islands of the start of a step, and their intervals. DONE, or PUSHES_FULL, to be called again with more
    room."""
    if build_islands(A) != DONE:
        return PUSHES_FULL
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.MEMBER[i].jointed > 0 and A.MEMBER[i].open == 0:
            if begin_interval(A, J, i, 0.0, A.PAR.dt) != DONE:
                return PUSHES_FULL
    return DONE


@kernel
def resume_jointed(
    A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, lossy: bool,
    status: int,
) -> int:  # fmt: skip
    """The rest of a step, whose bits so far are `status`: as `..impacts.step.resume`."""
    COUNT = A.COUNT
    if COUNT.phase == 0:
        if settle_jointed(A, J) != DONE:
            return ROOM_FOR_CONTACTS
        COUNT.phase = 1
        forecast_due(A)
        COUNT.work = 0
    if COUNT.phase == 1:
        whole = A.PAR.dt
        met = follow_jointed(A, J, lossy or A.PAR.pulled > 0.0)
        if met != DONE:
            return wish(met)
        if A.PAR.dt < whole:
            # The step was cut short.
            J.PROGRESS.budget = J.PROGRESS.effort + STEP_WORK
            for i in range(A.BODY.shape[0] - 1):
                if A.STATE[i].island == i:
                    shorten(A, J, i, A.PAR.dt)
                    end_here(A, J, i, A.PAR.dt)
        COUNT.phase = 2
    if COUNT.logged + COUNT.pushes > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    account_joints(A, J)
    return finish(A, STATES, WALK, EXTRA, ENDS, status)


@kernel
def step_jointed(
    TABLE: Table, JOINTS: Table, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float,
    gx: float, gy: float, left: float, lossy: bool, bits: int,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written: arguments and answer as `..impacts.step.step`."""
    A, J = scene_of(TABLE), joints_of(JOINTS)
    if bits >= 0:
        return resume_jointed(A, J, STATES, WALK, EXTRA, ENDS, lossy, bits)
    status = start_jointed(A, J, STATES, WALK, EXTRA, dt, gx, gy, left)
    if status < 0:
        return status
    return resume_jointed(A, J, STATES, WALK, EXTRA, ENDS, lossy, status)

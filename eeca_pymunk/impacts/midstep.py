"""A step whose contacts act together at its middle, psi2 = 0: one bounded solve of each island with all its contacts.

No events are followed. Each pair that may close within the step is a contact of an island, and each island has one
interval, the step. The speed of a body bounds its travel; if impulses move it farther and into others, these become
contacts too, and all is solved again, MIDSTEP_PASSES times at most.
"""

from __future__ import annotations

from ..compiled import kernel, nonallocating
from ..geometry.flight import fastest, norm, pose
from ..geometry.gap import gap
from ..geometry.widths import smaller
from ..islands.building import hold_penetrating
from ..islands.candidates import travel_bound
from ..islands.membership import approach, unite
from ..jointed.ends import components_of
from ..jointed.gathered import restore_joints
from ..model.bodies import AWAKE
from ..model.joints import Joints
from ..model.parameters.intervals import MIDSTEP_PASSES, TOUCH
from ..model.scene import Scene
from ..model.step import DONE, POOL_FULL, PUSHES_FULL
from ..pairs.candidates import cover
from ..pairs.rules import barred, mark_pair
from .intervals import start_interval


@nonallocating
def list_reach(A: Scene, i: int) -> bool:
    """Extend the near lists of body i to all that it may reach within the step; False if they need more memory."""
    way, room = travel_bound(A, i, A.PAR.dt), True
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        room = room and cover(A, s, way)
    return room


@nonallocating
def join_all(A: Scene) -> bool:
    """Build islands of all bodies that may touch within the step, or are jointed; False if near lists need more
    memory."""
    BODY, LINK = A.BODY, A.LINK
    n, dt = BODY.shape[0] - 1, A.PAR.dt
    for i in range(n):
        if not list_reach(A, i):
            return False
    for s in range(A.LIST.shape[0]):
        i = LINK[s].owner
        if BODY[i].inv_mass == 0.0:
            continue
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            o = int(A.POOL[w])
            j = LINK[o].owner
            moves = BODY[j].inv_mass > 0.0
            if (moves and o < s) or barred(A, s, o):
                continue
            touch = TOUCH * smaller(A, s, o)
            g = approach(A, s, o, 0.0)[0]
            if g <= travel_bound(A, i, dt) + travel_bound(A, j, dt) + touch:
                unite(A, i, j if moves else i)
    for i in range(n):
        if A.MEMBER[i].tied >= 0:
            unite(A, i, A.MEMBER[i].tied)
    return True


@nonallocating
def undo_intervals(A: Scene) -> None:
    """Undo the intervals begun so far, but for joints: no body is in an island, or at rest, no impulse has changed a
    path, and nothing is reported."""
    for c in range(A.COUNT.pushes):
        mark_pair(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, 0)
    A.COUNT.pushes = A.COUNT.unmet = 0
    A.PAR.lock = 1.0
    for i in range(A.BODY.shape[0] - 1):
        A.STATE[i].island = -1
        if A.BODY[i].inv_mass > 0.0:
            A.MEMBER[i].rest = AWAKE  # at rest in the last step, of another closure
        A.BODY[i].ax, A.BODY[i].ay, A.BODY[i].angular = A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2]


@kernel
def undo_joints(A: Scene, J: Joints) -> None:
    """Restore the joints of the islands whose intervals have begun, and the budgets of the step."""
    A.COUNT.work = J.PROGRESS.effort = 0.0
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.MEMBER[i].jointed > 0 and A.MEMBER[i].open > 0:
            for s in components_of(A, J, i):
                restore_joints(J, s)


@nonallocating
def missed_bodies(A: Scene) -> int:
    """Number of bodies that travel farther than their bound, and into others that are no contacts of the solve; their
    speed bounds are increased to that. -1 if near lists need more memory."""
    BODY, RESTING = A.BODY, A.RESTING
    dt, found = A.PAR.dt, 0
    for i in range(BODY.shape[0] - 1):
        if A.STATE[i].island < 0:
            continue
        x, y, angle = pose(BODY, i, dt)
        way = norm(x - BODY[i].x, y - BODY[i].y) + abs(angle - BODY[i].angle) * BODY[i].extent
        if way <= travel_bound(A, i, dt):
            continue
        before, RESTING[i].speed = RESTING[i].speed, way / dt
        if not list_reach(A, i):
            return -1
        into = 0
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                if A.FLAG[w] != 0 or barred(A, s, o):
                    continue
                small = smaller(A, s, o)
                if gap(A, s, o, dt)[0] < -TOUCH * small:
                    into += 1
        if into > 0:
            found += 1
        else:
            RESTING[i].speed = before
    return found


@kernel
def act_together(A: Scene, J: Joints) -> int:
    """Solve all contacts of a step, from its start also when it is called again after more memory was needed
    (COUNT.phase 1). DONE, or which memory is full."""
    BODY = A.BODY
    n = BODY.shape[0] - 1
    if A.COUNT.phase == 1:
        undo_joints(A, J)
    A.COUNT.phase = 1
    A.RESTING[n].speed = 0.0
    for i in range(n):
        A.RESTING[i].speed = fastest(BODY[i])
        BODY[i].due = 0.0  # no event is predicted, and in the next step the body counts as placed only if it is
    if A.COUNT.any_placed > 0:
        undo_intervals(A)  # of the last step
        hold_penetrating(A)  # here only for which bodies count as placed any longer: islands are built below
    for solves in range(MIDSTEP_PASSES + 1):
        undo_intervals(A)
        if not join_all(A):
            return POOL_FULL
        # A solve may make another body the root of its island, which then would be solved again.
        roots = 0
        for i in range(n):
            if A.STATE[i].island == i:
                A.BLOCK[roots] = i
                roots += 1
        for q in range(roots):
            if start_interval(A, J, A.BLOCK[q], 0.0) != DONE:
                return PUSHES_FULL
        # Components have taken their step, which is not undone for bodies that moved into others.
        if solves == MIDSTEP_PASSES or J.TALLY.components > 0:
            break
        more = missed_bodies(A)
        if more < 0:
            return POOL_FULL
        if more == 0:
            break
    return DONE

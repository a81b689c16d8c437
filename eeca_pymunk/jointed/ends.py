"""The end of the interval of an island with joints: moved to an earlier instant, and entered in the ledger."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, nonallocating
from ..islands.accounting import account_contact, move_to_end
from ..islands.local import contact_range, drop_contacts
from ..islands.membership import members_of
from ..joints.bounds import hold_passed, stand_as_stepped
from ..joints.closing import close_poses, farthest
from ..joints.start import compute_rows, springs_of
from ..joints.workspace import workspace
from ..model.joint_steps import UNHELD
from ..model.joints import Joints
from ..model.parameters.intervals import INTERVAL_RETRY
from ..model.parameters.joints import LINEAR_APART
from ..model.scene import Scene
from ..pairs.rules import mark_pair
from .component import keep_apart, size_joints
from .gathered import gather_alone, gave_way, restore_joints
from .ledger import account_component
from .rest import end_rest, has_moving_partner
from .solve import try_jointed


@kernel
def components_of(A: Scene, J: Joints, root: int) -> IntArray:
    """The components in an island, each once."""
    found, count = np.empty(A.MEMBER[root].bodies, np.int64), 0
    for i in members_of(A, root):
        if A.MEMBER[i].tied == i:
            found[count] = J.OF[i]
            count += 1
    return found[:count]


@nonallocating
def under_way(A: Scene, root: int) -> bool:
    """Whether an interval of an island with joints has begun; root -1 for no island."""
    return bool(root >= 0 and A.MEMBER[root].open > 0 and A.MEMBER[root].jointed > 0)


@nonallocating
def take_back(A: Scene, root: int) -> None:
    """Remove the contacts of the interval that an island has begun."""
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            mark_pair(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, 0)
    drop_contacts(A, root, root)


@kernel
def shorten(A: Scene, J: Joints, root: int, t: float) -> int:
    """Let the interval of an island end at instant t, by a new solve from its start; nothing is entered in the ledger.
    Nothing changes if no interval is under way, or if it was solved to end at t. Returns how many contacts it had."""
    if not under_way(A, root):
        return 0
    end_rest(A, root)
    first, after = contact_range(A, root)
    if A.RESTING[root].until != t:
        take_back(A, root)
        began, A.RESTING[root].excess_left, A.RESTING[root].until = A.BODY[root].since, 0.0, t
        for s in components_of(A, J, root):
            restore_joints(J, s)
        if t - began > A.PAR.instant:
            try_jointed(A, J, root, began, t - began, True)
    return after - first


@kernel
def end_here(A: Scene, J: Joints, root: int, t: float) -> None:
    """End the interval of an island at instant t, its own end: account for it, and move its bodies there."""
    if not under_way(A, root):
        return
    end_rest(A, root)
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            account_contact(A, c, t)
    empty = t - A.BODY[root].since <= A.PAR.instant
    for s in components_of(A, J, root):
        A.RESTING[root].lost -= J.STEPPED[s].lifted
        account_component(A, J, s)
    A.MEMBER[root].open, A.RESTING[root].until = 0, math.inf
    for i in members_of(A, root):
        A.STATE[i].version += 1
        if empty:
            # No interval was solved: the path is that of an earlier attempt.
            A.BODY[i].since = t
            A.BODY[i].ax, A.BODY[i].ay, A.BODY[i].angular = 0.0, 0.0, 0.0
        else:
            move_to_end(A, i, t)


@kernel
def left_apart(A: Scene, J: Joints, root: int) -> bool:
    """Whether the interval of an island ends in a state that no impact should start from: joints are not closed, or
    were opened by more than LINEAR_APART, or the interval is still too long (`Rest.excess_left`)."""
    if not under_way(A, root):
        return False
    if A.RESTING[root].excess_left > INTERVAL_RETRY:
        return True
    for s in components_of(A, J, root):
        if (J.STEPPED[s].status == UNHELD and gave_way(J, s)) or J.STEPPED[s].misfit_added > LINEAR_APART:
            return True
    return False


@kernel
def carry(A: Scene, J: Joints, root: int, t: float) -> None:
    """Move an island whose bodies are at an earlier instant to t, the end of the step, as far as its joints with moving
    partners require it, along M^-1 G^T: otherwise these joints would be apart by the partners' way. The work against
    all forces on the bodies is the partners', external."""
    began = A.BODY[root].since
    if began == t:
        return
    for s in components_of(A, J, root):
        if not has_moving_partner(A, J, s):
            continue
        W, first = workspace(J, s), J.COMPONENT[s].first_body
        size_joints(W, gather_alone(A, J, s, began, A.PAR.planned))
        stand_as_stepped(W)
        stored = springs_of(W)
        if hold_passed(W):
            compute_rows(W)
        keep_apart(W)
        gather_alone(A, J, s, t, A.PAR.planned)
        close_poses(W)
        stored = springs_of(W) - stored
        if not farthest(W) <= LINEAR_APART:
            continue
        work = stored
        for w in range(W.bodies):
            if J.LOCAL[w].freedoms == 0:
                continue
            i, place = int(J.JOINED[first + w].body), J.LOCAL[w].pose
            body = A.BODY[i]
            work -= (A.PULL[i, 0] * (place[0] - body.x) + A.PULL[i, 1] * (place[1] - body.y)) / body.inv_mass
            if body.inv_inertia > 0.0:
                work -= A.PULL[i, 2] * (place[2] - body.angle) / body.inv_inertia
            body.x, body.y, body.angle = place[0], place[1], place[2]
        A.PAR.stored += stored
        A.PAR.external += work

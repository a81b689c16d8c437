"""Intervals of islands, with joints or without: begun at the start of a step and after events, cut where the step ends
early."""

from __future__ import annotations

from ..compiled import kernel, nonallocating
from ..contacts.counts import note_unmet
from ..islands.accounting import end_interval
from ..islands.building import begin_islands, build_islands
from ..islands.intervals import begin_interval
from ..islands.local import contact_range
from ..jointed.ends import carry, under_way
from ..jointed.ledger import most_looks
from ..jointed.meet import end_by
from ..jointed.rest import wake_disturbed
from ..jointed.solve import begin_jointed
from ..model.bodies import AT_REST
from ..model.joints import Joints
from ..model.parameters.joints import CUT_WORK
from ..model.scene import Scene
from ..model.step import DONE, LOG_FULL, PUSHES_FULL, SOLVES, SPENT
from ..prediction.scheduling import predict_all
from ..prediction.work import most_work


@nonallocating
def start_interval(A: Scene, J: Joints, root: int, t: float) -> int:
    """Begin an interval of an island at instant t, at which all its bodies are; with joints none that would be shorter
    than PAR.instant. Returns DONE; or, with everything as it was, PUSHES_FULL (more memory is needed), or SPENT (the
    budget of the step for joints is spent)."""
    if A.MEMBER[root].jointed == 0:
        return begin_interval(A, root, t)
    return begin_jointed(A, J, root, t, A.PAR.dt - t) if A.PAR.dt - t > A.PAR.instant else DONE


@kernel
def start_islands(A: Scene, J: Joints) -> int:
    """Build the islands of the start of a step and begin their intervals. DONE, or PUSHES_FULL: to be called again with
    more memory, when it goes on where it was (COUNT.phase, see `step.act`): bodies that come near the busy ones make
    these busy, so that islands built a second time would be larger."""
    if A.COUNT.phase == 0:
        if J.TALLY.components > 0:
            wake_disturbed(A, J)
        build_islands(A)
        A.COUNT.phase = 1
    if A.COUNT.phase == 1:
        if begin_islands(A) != DONE:
            return PUSHES_FULL
        A.COUNT.phase = 2
    for i in range(A.BODY.shape[0] - 1 if J.TALLY.components > 0 else 0):
        if A.STATE[i].island == i and A.MEMBER[i].jointed > 0 and A.MEMBER[i].open == 0:
            if start_interval(A, J, i, 0.0) != DONE:
                return PUSHES_FULL
    return DONE


@kernel
def start_waiting(A: Scene, J: Joints) -> int:
    """Begin intervals of the islands of the COUNT.waiting bodies in A.BLOCK, which are at the instant of an event, and
    predict the events of these bodies. DONE, or PUSHES_FULL or LOG_FULL: to be called again with more memory."""
    COUNT, BLOCK = A.COUNT, A.BLOCK
    for q in range(COUNT.waiting):
        root = A.STATE[BLOCK[q]].island
        if root >= 0 and A.MEMBER[root].open == 0:
            status = start_interval(A, J, root, A.BODY[root].since)
            if status == PUSHES_FULL:
                return status
            if status == SPENT and COUNT.logged + COUNT.pushes > A.LOG.shape[0]:
                return LOG_FULL
            if status == SPENT:
                COUNT.waiting = 0
                return cut_short(A, J, root, A.BODY[root].since)
    predict_all(A, COUNT.waiting, A.PAR.now)
    COUNT.waiting = 0
    return DONE


@kernel
def cut_short(A: Scene, J: Joints, i: int, t: float) -> int:
    """End the step at instant t, that of the event of body i, since its budget is spent; so no impact is ignored.

    Impacts of jointed bodies come later than predicted, or earlier (`..jointed.meet`), so that bodies may have been
    brought beyond t. What becomes of an island that is not at rest:

    | island | in the first loop | in the last one |
    |---|---|---|
    | without joints | its interval ends at t, or where it begins after t | |
    | with joints, in an interval | if that begins after t, it moves with its partners | it is solved again, up to t |
    | with joints, whose interval has ended | it moves with its partners | |

    In between all bodies whose intervals have ended, or that are beyond t, count as there at t. What would be corrected
    at the planned ends of these intervals is left to the next step.
    """
    own, other = A.STATE[i].own, A.STATE[i].other
    if other < 0:  # the end of an interval, without a partner
        own, other = A.STATE[i].first_shape if A.STATE[i].shapes > 0 else -1, -1
    most = most_work(A)
    # What was left did not suffice for what comes next, and counts as spent.
    note_unmet(A, SOLVES, own, other, max(A.COUNT.work + most - most_looks(A, J), most), most)
    A.PAR.dt = t
    A.COUNT.heap = 0
    if J.TALLY.components > 0:
        # The shortened intervals are solved again below, beyond the budget that is spent, of events or of joints.
        A.COUNT.work, J.PROGRESS.budget = 0.0, J.PROGRESS.effort + CUT_WORK
    for k in range(A.BODY.shape[0] - 1):
        if A.STATE[k].island != k or A.MEMBER[k].rest == AT_REST:
            continue
        if A.MEMBER[k].jointed == 0 and A.MEMBER[k].open > 0:
            first, after = contact_range(A, k)
            end_interval(A, k, max(A.PUSHED[first].start, t) if first < after else t)
        elif A.MEMBER[k].jointed > 0 and (A.MEMBER[k].open == 0 or A.BODY[k].since > t):
            carry(A, J, k, t)
    for k in range(A.BODY.shape[0] - 1):
        root = A.STATE[k].island
        over = root >= 0 and A.MEMBER[root].rest != AT_REST and A.MEMBER[root].open == 0
        A.BODY[k].since = t if over else min(A.BODY[k].since, t)
        if over and A.MEMBER[root].jointed == 0:
            rest = A.RESTING[k]
            rest.lift_x = rest.lift_y = rest.lift_angle = rest.lift_vx = rest.lift_vy = rest.lift_spin = 0.0
    for k in range(A.BODY.shape[0] - 1):
        if A.STATE[k].island == k and A.MEMBER[k].rest != AT_REST and A.MEMBER[k].jointed > 0 and under_way(A, k):
            end_by(A, J, k, t)
    return DONE

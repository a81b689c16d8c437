"""Joints at the start of a step; their works and impulses at its end."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..contacts.counts import note_unmet
from ..joints.ledger import clear_interval
from ..layout import BODY_ROW, READ, WRITTEN
from ..model.joint_steps import ELASTIC
from ..model.joints import EDITED, TAKEN_OVER, Joints
from ..model.parameters.joints import STEP_WORK, STEP_WORK_BODY
from ..model.scene import Scene
from ..model.step import JOINTS as UNMET_JOINTS
from ..prediction.work import growth, most_work


@nonallocating
def mark_edited(A: Scene, J: Joints, STATES: FloatArray, IDS: IntArray) -> None:
    """Mark the joints of bodies that were edited since the last step as EDITED, and those of bodies whose last step is
    not known as TAKEN_OVER: velocities may violate them. Earlier lengths of intervals of these bodies do not count
    either."""
    now, before = STATES[READ], STATES[WRITTEN]
    for k in range(IDS.shape[1]):
        i = IDS[BODY_ROW, k]
        if i < 0:
            continue
        same, known = True, False
        for c in range(6):
            same = same and now[k, c] == before[k, c]
            known = known or before[k, c] == before[k, c]  # NaN is unknown
        A.PLACE[i] = -1 if same else 1 if known else 0  # scratch until the end of this function
        if not same:
            A.RESTING[i].longest = math.inf
    n = A.PLACE.shape[0]
    for j in range(J.JOINT.shape[0]):
        changed, known = False, False
        for end in range(2):
            i = J.JOINT[j].body[end]
            if i < n:
                changed, known = changed or A.PLACE[i] >= 0, known or A.PLACE[i] != 0
        if changed:
            # Bodies that were put elsewhere start as new ones do, so that equal states give equal paths, bit by bit.
            J.JOINT[j].touched = EDITED if known else TAKEN_OVER
            J.JOINT[j].impulse[0] = J.JOINT[j].impulse[1] = 0.0
            for c in range(6):
                J.JOINT[j].led[c // 3, c % 3] = 0.0
    A.PLACE[:] = -1


@nonallocating
def joint_budget(A: Scene, J: Joints, dt: float) -> float:
    """Operations that a step of length dt may spend on joints: STEP_WORK + STEP_WORK_BODY (n - 2 c/3), times `growth`,
    with n bodies, of which joints move c of the largest component. These count by a third, as what ends a step early is
    not in this budget: some motions of a component."""
    largest = 0
    for s in range(J.TALLY.components):
        moved = 0
        for i in range(J.COMPONENT[s].first_body, J.COMPONENT[s].end_body):
            moved += 1 if J.JOINED[i].freedoms > 0 else 0
        largest = max(largest, moved)
    return float((STEP_WORK + STEP_WORK_BODY * (A.BODY.shape[0] - 2.0 / 3.0 * largest)) * growth(A, dt))


@nonallocating
def start_joints(A: Scene, J: Joints, STATES: FloatArray, IDS: IntArray, dt: float) -> None:
    """Begin a step of length dt of a scene with joints, before `read_states`."""
    mark_edited(A, J, STATES, IDS)
    J.TALLY.worst = 0
    J.PROGRESS.effort = 0.0
    J.PROGRESS.budget = joint_budget(A, J, dt)
    for s in range(len(J.STEPPED)):
        clear_interval(J.STEPPED[s])
    for j in range(J.JOINT.shape[0]):
        J.JOINT[j].struck[0] = J.JOINT[j].struck[1] = 0.0


@nonallocating
def work_left(A: Scene, J: Joints) -> float:
    """Operations that this step may still spend on joints. Events and joints share the time of a step: the part of its
    budget that events have used is subtracted from that of joints."""
    return float(J.PROGRESS.budget * (1.0 - A.COUNT.work / most_work(A)) - J.PROGRESS.effort)


@nonallocating
def has_work_for(A: Scene, J: Joints, t: float, h: float, parts: float, effort: float) -> bool:
    """Whether the step has work for intervals of length h / `parts` from instant t to its end, if each takes as much
    effort as one of length h has taken."""
    return bool(parts * (A.PAR.dt - t) * effort <= h * work_left(A, J))


@nonallocating
def most_looks(A: Scene, J: Joints) -> float:
    """Largest work of the events of this step, in looks: `most_work`, less the part of their budget that joints have
    used."""
    taken = J.PROGRESS.effort / J.PROGRESS.budget if J.TALLY.components > 0 else 0.0
    return float(most_work(A) * (1.0 - taken))


@nonallocating
def note_spent(A: Scene, J: Joints) -> None:
    """At the end of a step that may have to be repeated, note the part of the budgets of a step that it has spent: its
    share, if it was cut short. The next step may spend all, unless it gets a share again."""
    most, part = most_work(A), 1.0
    if A.PAR.dt == A.PAR.planned:
        part = min((A.COUNT.work + most - most_looks(A, J)) / most, 1.0)
    A.PAR.spent, A.PAR.share = part * A.PAR.share, 1.0


@nonallocating
def account_component(A: Scene, J: Joints, s: int) -> None:
    """Enter the works of the joints of component s in their interval into the ledger of the step.

    If a limit stops bodies within a short time h, a joint that holds exactly works by its impulse times round-off of
    its place over h, and the loss of the limit is smaller by as much: only the difference of both is real (`passed`).
    """
    PAR, stepped = A.PAR, J.STEPPED[s]
    passed = min(max(stepped.closed, 0.0), max(stepped.limited, 0.0))
    PAR.external += stepped.motors + stepped.supports + (stepped.closed - passed) + stepped.turned_work
    PAR.damped += stepped.damped
    PAR.restitution += (stepped.limited - passed) + stepped.projected - stepped.lifted
    PAR.frictional += stepped.clamped
    PAR.stored += stepped.stored
    J.TALLY.worst = max(J.TALLY.worst, stepped.status)
    clear_interval(stepped)


@nonallocating
def account_joints(A: Scene, J: Joints) -> None:
    """At the end of a step: enter the works of all joints, and scale the impulses of joints whose last solve had
    another length (a shorter interval, or an earlier step) to the length of this step: forces are kept."""
    for s in range(J.TALLY.components):
        account_component(A, J, s)
    if J.TALLY.worst >= ELASTIC:
        note_unmet(A, UNMET_JOINTS, -1, -1, float(J.TALLY.worst), float(ELASTIC))
    for j in range(J.JOINT.shape[0]):
        joint = J.JOINT[j]
        if joint.last_step > 0.0 and joint.last_step != A.PAR.planned:
            longer = A.PAR.planned / joint.last_step
            joint.impulse[0], joint.impulse[1] = joint.impulse[0] * longer, joint.impulse[1] * longer
            joint.last_step = A.PAR.planned

"""Bodies and joints of a component: read into its scratch, saved and restored."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..geometry.flight import pose, rate
from ..joints.ledger import clear_interval
from ..joints.parts import meets_limit
from ..model.joint_steps import ELASTIC, UNHELD
from ..model.joints import GIVES_WAY, LEFT_APART, RATCHET, UNTESTED, Joints
from ..model.parameters.joints import GIVEN_INTERVAL, NEARLY_HELD
from ..model.scene import Scene
from ..newton.motion import seat, size_up
from .groups import Groups
from .ledger import has_work_for, work_left


@nonallocating
def save_joints(J: Joints, s: int) -> None:
    """Save the joints of component s, at the start of an interval, and forget what is known of its rows and parts."""
    J.COMPONENT[s].parts, J.COMPONENT[s].dependence, J.PROGRESS.factors_of = 0, UNTESTED, 0
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        J.AT_START[j] = J.JOINT[j]


@nonallocating
def restore_joints(J: Joints, s: int) -> None:
    """Restore the joints that `save_joints` has saved, and clear the ledger of the interval."""
    clear_interval(J.STEPPED[s])
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        J.JOINT[j] = J.AT_START[j]


@nonallocating
def compliance_of(J: Joints, s: int) -> float:
    """The compliance of the joints of component s, one for all of them."""
    return float(J.JOINT[J.COUPLING[J.COMPONENT[s].first_joint].joint].compliance)


@nonallocating
def compliance_before(J: Joints, s: int) -> float:
    """`compliance_of` component s at the start of its interval."""
    return float(J.AT_START[J.COUPLING[J.COMPONENT[s].first_joint].joint].compliance)


@nonallocating
def gave_way(J: Joints, s: int) -> bool:
    """Whether joints of component s hold worse in the interval that it has just taken than they did at its start:
    elastically, or by linear rows. Not if an earlier step has left some apart: these contradict one another in an
    interval of any length. Joints that were elastic before hold worse only if they are softer, and more than twice as
    far apart."""
    stepped = J.STEPPED[s]
    if stepped.status < ELASTIC:
        return False
    worse = compliance_of(J, s) > compliance_before(J, s) and stepped.misfit_added > max(stepped.misfit, NEARLY_HELD)
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        touched = J.AT_START[J.COUPLING[k].joint].touched
        if touched == LEFT_APART or (touched == GIVES_WAY and stepped.status == ELASTIC and not worse):
            return False
    return True


@nonallocating
def takes_shorter(A: Scene, J: Joints, s: int, t: float, h: float, effort: float) -> bool:
    """Whether an interval h from instant t is to be shorter, as joints of component s `gave_way` in it. Not so if they
    were elastic before, have opened by no more than NEARLY_HELD, and the step has too little work for shorter ones, of
    the effort that this one took: joints that hold in an interval of no length, as of a chain that is straight up to
    round-off, would stop the step. Nor below GIVEN_INTERVAL: limits that contradict each other lie ever closer ahead of
    what slows down between them, and intervals that end before would come to no end. Without work it is shorter, too:
    the step then ends early."""
    if h <= GIVEN_INTERVAL * A.PAR.planned or not gave_way(J, s):
        return False
    if compliance_before(J, s) == 0.0 or J.STEPPED[s].misfit_added > NEARLY_HELD or work_left(A, J) < 0.0:
        return True
    return has_work_for(A, J, t, h, 2.0, effort)


@nonallocating
def some_taut(J: Joints, groups: Groups) -> bool:
    """Whether a component is held across its joints by their pull (`..joints.step`)."""
    for s in groups.JOINTED:
        if J.COMPONENT[s].taut > 0:
            return True
    return False


@nonallocating
def some_give(J: Joints, groups: Groups) -> bool:
    """Whether joints of a component have given way elastically in its last step."""
    for s in groups.JOINTED:
        if compliance_of(J, s) > 0.0:
            return True
    return False


@nonallocating
def some_refused(J: Joints, groups: Groups) -> bool:
    """Whether a component `gave_way` in a long interval, or failed to take it as a whole."""
    for s in groups.JOINTED:
        if gave_way(J, s) or J.STEPPED[s].status == UNHELD:
            return True
    return False


@nonallocating
def rewind_joints(J: Joints, s: int) -> None:
    """Restore what a step of component s changes in its joints, but for impulses, accelerations and parts of the step,
    with which the next solve begins."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        if J.COUPLING[k].kind == RATCHET:
            J.JOINT[j].notch = J.AT_START[j].notch
        J.JOINT[j].side, J.JOINT[j].touched = J.AT_START[j].side, J.AT_START[j].touched
        J.JOINT[j].compliance = J.AT_START[j].compliance


@nonallocating
def gather_fixed(A: Scene, J: Joints, s: int, i: int, t: float) -> bool:
    """Whether joints do not move body i of component s. If so, write its state at instant t to its scratch."""
    local, member, n = J.LOCAL[i], J.JOINED[J.COMPONENT[s].first_body + i], A.BODY.shape[0]
    seat(local, member)
    if member.freedoms > 0:
        return False
    body = int(member.body)
    for c in range(3):
        local.acceleration[c] = local.mobility[c] = 0.0
    if body < n:
        local.pose[0], local.pose[1], local.pose[2] = pose(A.BODY, body, t)
        local.v0[0], local.v0[1], local.v0[2] = rate(A.BODY, body, t)
        local.acceleration[0], local.acceleration[1] = A.PULL[body, 0], A.PULL[body, 1]
        local.acceleration[2] = A.PULL[body, 2]
    else:
        P = J.PARTNER[body - n]
        local.pose[0], local.pose[1], local.pose[2] = P.x, P.y, P.angle
        local.v0[0], local.v0[1], local.v0[2] = P.vx, P.vy, P.spin
    return True


@nonallocating
def gather_component(
    A: Scene, J: Joints, s: int, POSE_OF: FloatArray, V: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """Write the bodies of component s to its scratch; its size, the length relative to which errors are measured.

    Bodies that joints move have the rows A.PLACE in the arrays of the island; others are read at instant t. ACC:
    accelerations without joints, any array where velocities or poses are projected, which does not depend on them.
    """
    component = J.COMPONENT[s]
    for i in range(component.end_body - component.first_body):
        if not gather_fixed(A, J, s, i, t):
            local, q = J.LOCAL[i], A.PLACE[J.JOINED[component.first_body + i].body]
            for c in range(3):
                local.pose[c], local.v0[c], local.acceleration[c] = POSE_OF[q, c], V[q, c], ACC[q, c]
                local.mobility[c] = IM[q] if c < 2 else II[q]
    return size_up(J, s, h)


@nonallocating
def gather_alone(A: Scene, J: Joints, s: int, t: float, h: float) -> float:
    """`gather_component` for a component that is an island of its own, whose bodies are at instant t."""
    component = J.COMPONENT[s]
    for i in range(component.end_body - component.first_body):
        if not gather_fixed(A, J, s, i, t):
            local, row = J.LOCAL[i], int(J.JOINED[component.first_body + i].body)
            body = A.BODY[row]
            local.pose[0], local.pose[1], local.pose[2] = body.x, body.y, body.angle
            local.v0[0], local.v0[1], local.v0[2] = body.vx, body.vy, body.spin
            for c in range(3):
                local.mobility[c] = body.inv_mass if c < 2 else body.inv_inertia
                local.acceleration[c] = A.PULL[row, c]
    return size_up(J, s, h)


@nonallocating
def number_of(A: Scene, J: Joints, s: int, i: int) -> int:
    """The number in the island (A.PLACE) of body i of component s; -1 if joints do not move it."""
    member = J.JOINED[J.COMPONENT[s].first_body + i]
    return int(A.PLACE[member.body]) if member.freedoms > 0 else -1


@nonallocating
def lead_component(A: Scene, J: Joints, s: int, V: FloatArray, ACC: FloatArray, GUESS: FloatArray, h: float) -> None:
    """Begin Newton's method in the next step of component s with velocities GUESS (k, 3) at the end: (GUESS - V)/h -
    ACC by joints. Not if the last step met a limit: it has a guess for each part (`..joints.parts`)."""
    if meets_limit(J.COMPONENT[s]):
        return
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        for end in range(2):
            q = number_of(A, J, s, J.COUPLING[k].body[end])
            for c in range(3 if q >= 0 else 0):
                J.JOINT[J.COUPLING[k].joint].led[end, c] = (GUESS[q, c] - V[q, c]) / h - ACC[q, c]


@nonallocating
def find_places(A: Scene, J: Joints, s: int, INDEX: IntArray) -> int:
    """Write to INDEX (k,) the places in the scratch of the bodies of an island that joints of component s move; how
    many bodies the scratch has."""
    size = J.COMPONENT[s].end_body - J.COMPONENT[s].first_body
    for i in range(size):
        q = number_of(A, J, s, i)
        if q >= 0:
            INDEX[q] = i
    return int(size)

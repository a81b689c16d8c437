"""Bodies and joints of a component: into its scratch, and what is remembered of them."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..geometry.flight import pose, rate
from ..joints.ledger import clear_interval
from ..joints.motion import size_up
from ..model.joints import RATCHET, Joints
from ..model.scene import Scene


@nonallocating
def keep_joints(J: Joints, s: int) -> None:
    """Remember the joints of component s as they are."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        J.KEPT[j] = J.JOINT[j]


@nonallocating
def restore_joints(J: Joints, s: int) -> None:
    """What `keep_joints` remembers; nothing is done."""
    clear_interval(J.STEPPED[s])
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        J.JOINT[j] = J.KEPT[j]


@nonallocating
def rewind_joints(J: Joints, s: int) -> None:
    """What `keep_joints` remembers, but for impulses, with which the next solution begins."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        if J.COUPLING[k].kind == RATCHET:
            J.JOINT[j].notch = J.KEPT[j].notch
        J.JOINT[j].side, J.JOINT[j].touched = J.KEPT[j].side, J.KEPT[j].touched
        J.JOINT[j].owed, J.JOINT[j].compliance = J.KEPT[j].owed, J.KEPT[j].compliance


@nonallocating
def seat(A: Scene, J: Joints, m: int, i: int, t: float) -> None:
    """The body of row m of JOINED to i of the scratch: what does not move by joints where it is at instant t, others
    all but what they do."""
    LOCAL, n = J.LOCAL, A.BODY.shape[0]
    LOCAL[i].column, LOCAL[i].freedoms = J.JOINED[m].column, J.JOINED[m].freedoms
    LOCAL[i].first, LOCAL[i].cayley = J.JOINED[m].first, J.JOINED[m].cayley
    if LOCAL[i].freedoms > 0:
        return
    body = int(J.JOINED[m].body)
    x, y, angle, vx, vy, spin = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if body < n:
        x, y, angle = pose(A.BODY, body, t)
        vx, vy, spin = rate(A.BODY, body, t)
    else:
        P = J.PARTNER[body - n]
        x, y, angle, vx, vy, spin = P.x, P.y, P.angle, P.vx, P.vy, P.spin
    LOCAL[i].pose[0], LOCAL[i].pose[1], LOCAL[i].pose[2] = x, y, angle
    LOCAL[i].v0[0], LOCAL[i].v0[1], LOCAL[i].v0[2] = vx, vy, spin
    for c in range(3):
        LOCAL[i].acceleration[c] = 0.0
        LOCAL[i].mobility[c] = 0.0


@nonallocating
def measured(J: Joints, s: int, h: float) -> float:
    """Complete the bodies in the scratch of component s; its size."""
    count = J.COMPONENT[s].end_body - J.COMPONENT[s].first_body
    return float(size_up(J.JOINT, J.COUPLING, J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint, J.LOCAL, count, h))


@nonallocating
def gather_component(
    A: Scene, J: Joints, s: int, POSE_OF: FloatArray, V: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """The bodies of component s into its scratch; its size, the length that errors are measured by.

    Moved bodies stand at A.PLACE in the arrays of the island; others where they are at instant t.
    """
    LOCAL = J.LOCAL
    b0 = J.COMPONENT[s].first_body
    for i in range(J.COMPONENT[s].end_body - b0):
        seat(A, J, b0 + i, i, t)
        if J.LOCAL[i].freedoms > 0:
            q = A.PLACE[J.JOINED[b0 + i].body]
            for c in range(3):
                LOCAL[i].pose[c], LOCAL[i].v0[c], LOCAL[i].acceleration[c] = POSE_OF[q, c], V[q, c], ACC[q, c]
                LOCAL[i].mobility[c] = IM[q] if c < 2 else II[q]
    return measured(J, s, h)


@nonallocating
def gather_alone(A: Scene, J: Joints, s: int, t: float, h: float) -> float:
    """`gather_component` of one that is an island of its own, whose bodies are at instant t."""
    LOCAL, BODY = J.LOCAL, A.BODY
    b0 = J.COMPONENT[s].first_body
    for i in range(J.COMPONENT[s].end_body - b0):
        seat(A, J, b0 + i, i, t)
        if J.LOCAL[i].freedoms > 0:
            body = J.JOINED[b0 + i].body
            b = BODY[body]
            LOCAL[i].pose[0], LOCAL[i].pose[1], LOCAL[i].pose[2] = b.x, b.y, b.angle
            LOCAL[i].v0[0], LOCAL[i].v0[1], LOCAL[i].v0[2] = b.vx, b.vy, b.spin
            LOCAL[i].mobility[0], LOCAL[i].mobility[1], LOCAL[i].mobility[2] = b.inv_mass, b.inv_mass, b.inv_inertia
            for c in range(3):
                LOCAL[i].acceleration[c] = A.PULL[body, c]
    return measured(J, s, h)


@nonallocating
def lead_component(A: Scene, J: Joints, s: int, V: FloatArray, ACC: FloatArray, GUESS: FloatArray, h: float) -> None:
    """Let the next step of component s begin with velocities GUESS (k, 3) at its end, from V under ACC at its start."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        for end in range(2):
            member = J.COMPONENT[s].first_body + J.COUPLING[k].body[end]
            if J.JOINED[member].freedoms > 0:
                q = A.PLACE[J.JOINED[member].body]
                for c in range(3):
                    J.JOINT[J.COUPLING[k].joint].led[end, c] = (GUESS[q, c] - V[q, c]) / h - ACC[q, c]


@nonallocating
def find_places(A: Scene, J: Joints, s: int, INDEX: IntArray) -> int:
    """INDEX (k,) of the moved bodies of component s: their places in its scratch; how many bodies that has."""
    b0, size = J.COMPONENT[s].first_body, J.COMPONENT[s].end_body - J.COMPONENT[s].first_body
    for w in range(size):
        body = J.JOINED[b0 + w].body
        if body < A.PLACE.shape[0] and A.PLACE[body] >= 0:
            INDEX[A.PLACE[body]] = w
    return int(size)

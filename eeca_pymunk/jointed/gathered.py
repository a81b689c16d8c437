"""Bodies and joints of a component: into its scratch, and what is remembered of them."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..geometry.flight import pose, rate
from ..joints.layout import COMPLIANCE, JOINT_COLUMNS, LED, NOTCH, OWED, RATCHET, SIDE, TIE_COLUMNS, TOUCHED
from ..joints.motion import size_up
from ..joints.scratch import (
    BEFORE,
    BODY_0,
    BODY_1,
    CAYLEY,
    COLUMN,
    FIRST,
    FREE,
    FREEDOMS,
    JOINT_0,
    JOINT_1,
    L_A,
    L_JOINT,
    L_KIND,
    M_BODY,
    M_CAYLEY,
    M_COLUMN,
    M_FIRST,
    M_FREEDOMS,
    MOBILITY,
    POSE,
)
from ..model.scene import Scene
from .layout import Joints


@uncounted
def keep_joints(J: Joints, s: int) -> None:
    """Remember the joints of component s as they are."""
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        j = J.LINK[k, L_JOINT]
        for c in range(JOINT_COLUMNS):
            J.KEPT[j, c] = J.JOINT[j, c]
        for c in range(TIE_COLUMNS):
            J.SIDES[j, c] = J.TIE[j, c]


@uncounted
def restore_joints(J: Joints, s: int) -> None:
    """What `keep_joints` remembers."""
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        j = J.LINK[k, L_JOINT]
        for c in range(JOINT_COLUMNS):
            J.JOINT[j, c] = J.KEPT[j, c]
        for c in range(TIE_COLUMNS):
            J.TIE[j, c] = J.SIDES[j, c]


@uncounted
def rewind_joints(J: Joints, s: int) -> None:
    """What `keep_joints` remembers, but for impulses, with which the next solution begins."""
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        j = J.LINK[k, L_JOINT]
        if J.LINK[k, L_KIND] == RATCHET:
            J.JOINT[j, NOTCH] = J.KEPT[j, NOTCH]
        J.TIE[j, SIDE], J.TIE[j, TOUCHED] = J.SIDES[j, SIDE], J.SIDES[j, TOUCHED]
        J.JOINT[j, OWED], J.JOINT[j, COMPLIANCE] = J.KEPT[j, OWED], J.KEPT[j, COMPLIANCE]


@uncounted
def seat(A: Scene, J: Joints, m: int, i: int, t: float) -> None:
    """The body of row m of MEMBER to i of the scratch: what does not move by joints where it is at instant t, others
    all but what they do."""
    LOCAL, NODE, n = J.LOCAL, J.NODE, A.BODY.shape[0]
    NODE[i, COLUMN], NODE[i, FREEDOMS] = J.MEMBER[m, M_COLUMN], J.MEMBER[m, M_FREEDOMS]
    NODE[i, FIRST], LOCAL[i, CAYLEY] = J.MEMBER[m, M_FIRST], J.MEMBER[m, M_CAYLEY]
    if NODE[i, FREEDOMS] > 0:
        return
    body = int(J.MEMBER[m, M_BODY])
    x, y, angle, vx, vy, spin = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if body < n:
        x, y, angle = pose(A.BODY, body, t)
        vx, vy, spin = rate(A.BODY, body, t)
    else:
        P = J.PARTNER[body - n]
        x, y, angle, vx, vy, spin = P.x, P.y, P.angle, P.vx, P.vy, P.spin
    LOCAL[i, POSE], LOCAL[i, POSE + 1], LOCAL[i, POSE + 2] = x, y, angle
    LOCAL[i, BEFORE], LOCAL[i, BEFORE + 1], LOCAL[i, BEFORE + 2] = vx, vy, spin
    for c in range(3):
        LOCAL[i, FREE + c] = 0.0
        LOCAL[i, MOBILITY + c] = 0.0


@uncounted
def measured(J: Joints, s: int, h: float) -> float:
    """Complete the bodies in the scratch of component s; its size."""
    count = J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]
    return float(size_up(J.JOINT, J.LINK, J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.LOCAL, count, h))


@uncounted
def gather_component(
    A: Scene, J: Joints, s: int, POSE_OF: FloatArray, V: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """The bodies of component s into its scratch; its size, the length that errors are measured by.

    Moved bodies stand at A.PLACE in the arrays of the island; others where they are at instant t.
    """
    LOCAL = J.LOCAL
    b0 = J.SPAN[s, BODY_0]
    for i in range(J.SPAN[s, BODY_1] - b0):
        seat(A, J, b0 + i, i, t)
        if J.NODE[i, FREEDOMS] > 0:
            q = A.PLACE[J.MEMBER[b0 + i, M_BODY]]
            for c in range(3):
                LOCAL[i, POSE + c], LOCAL[i, BEFORE + c], LOCAL[i, FREE + c] = POSE_OF[q, c], V[q, c], ACC[q, c]
                LOCAL[i, MOBILITY + c] = IM[q] if c < 2 else II[q]
    return measured(J, s, h)


@uncounted
def gather_alone(A: Scene, J: Joints, s: int, t: float, h: float) -> float:
    """`gather_component` of one that is an island of its own, whose bodies are at instant t."""
    LOCAL, BODY = J.LOCAL, A.BODY
    b0 = J.SPAN[s, BODY_0]
    for i in range(J.SPAN[s, BODY_1] - b0):
        seat(A, J, b0 + i, i, t)
        if J.NODE[i, FREEDOMS] > 0:
            body = J.MEMBER[b0 + i, M_BODY]
            b = BODY[body]
            LOCAL[i, POSE], LOCAL[i, POSE + 1], LOCAL[i, POSE + 2] = b.x, b.y, b.angle
            LOCAL[i, BEFORE], LOCAL[i, BEFORE + 1], LOCAL[i, BEFORE + 2] = b.vx, b.vy, b.spin
            LOCAL[i, MOBILITY], LOCAL[i, MOBILITY + 1], LOCAL[i, MOBILITY + 2] = b.inv_mass, b.inv_mass, b.inv_inertia
            for c in range(3):
                LOCAL[i, FREE + c] = A.PULL[body, c]
    return measured(J, s, h)


@uncounted
def lead_component(A: Scene, J: Joints, s: int, V: FloatArray, ACC: FloatArray, GUESS: FloatArray, h: float) -> None:
    """Let the next step of component s begin with velocities GUESS (k, 3) at its end, from V under ACC at its start."""
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        for end in range(2):
            member = J.SPAN[s, BODY_0] + J.LINK[k, L_A + end]
            if J.MEMBER[member, M_FREEDOMS] > 0:
                q = A.PLACE[J.MEMBER[member, M_BODY]]
                for c in range(3):
                    J.JOINT[J.LINK[k, L_JOINT], LED + 3 * end + c] = (GUESS[q, c] - V[q, c]) / h - ACC[q, c]


@uncounted
def find_places(A: Scene, J: Joints, s: int, INDEX: IntArray) -> int:
    """INDEX (k,) of the moved bodies of component s: their places in its scratch; how many bodies that has."""
    b0, size = J.SPAN[s, BODY_0], J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]
    for w in range(size):
        body = J.MEMBER[b0 + w, M_BODY]
        if body < A.PLACE.shape[0] and A.PLACE[body] >= 0:
            INDEX[A.PLACE[body]] = w
    return int(size)

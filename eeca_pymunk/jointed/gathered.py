"""Bodies and joints of a component: into its scratch, and what is remembered of them."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..geometry.flight import pose, rate
from ..impacts.layout import Scene
from ..joints.layout import ANCHOR_AX, JOINT_COLUMNS, NOTCH, RATCHET, SIDE, TIE_COLUMNS, TOUCHED
from ..joints.scratch import (
    BEFORE,
    BODY_0,
    BODY_1,
    CAYLEY,
    COLUMN,
    COS,
    FIRST,
    FREE,
    FREEDOMS,
    JOINT_0,
    JOINT_1,
    L_JOINT,
    L_KIND,
    M_BODY,
    M_CAYLEY,
    M_COLUMN,
    M_FIRST,
    M_FREEDOMS,
    MOBILITY,
    POSE,
    ROOT,
    SIN,
)
from ..layout import ANGLE, SPIN, VX, VY, X, Y
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


@uncounted
def gather_component(
    A: Scene, J: Joints, s: int, POSE_OF: FloatArray, V: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """The bodies of component s into its scratch; its size, the length that errors are measured by.

    Moved bodies stand at A.PLACE in the arrays of the island; others where they are at instant t.
    """
    LOCAL, NODE, n = J.LOCAL, J.NODE, A.BODY.shape[0]
    length = 0.0
    b0 = J.SPAN[s, BODY_0]
    for i in range(J.SPAN[s, BODY_1] - b0):
        body = int(J.MEMBER[b0 + i, M_BODY])
        NODE[i, COLUMN], NODE[i, FREEDOMS] = J.MEMBER[b0 + i, M_COLUMN], J.MEMBER[b0 + i, M_FREEDOMS]
        NODE[i, FIRST], LOCAL[i, CAYLEY] = J.MEMBER[b0 + i, M_FIRST], J.MEMBER[b0 + i, M_CAYLEY]
        if NODE[i, FREEDOMS] > 0:
            q = A.PLACE[body]
            for c in range(3):
                LOCAL[i, POSE + c], LOCAL[i, BEFORE + c], LOCAL[i, FREE + c] = POSE_OF[q, c], V[q, c], ACC[q, c]
                LOCAL[i, MOBILITY + c] = IM[q] if c < 2 else II[q]
        else:
            x, y, angle, vx, vy, spin = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            if body < n:
                x, y, angle = pose(A.BODY, body, t)
                vx, vy, spin = rate(A.BODY, body, t)
            else:
                P = J.PARTNER[body - n]
                x, y, angle, vx, vy, spin = P[X], P[Y], P[ANGLE], P[VX], P[VY], P[SPIN]
            LOCAL[i, POSE], LOCAL[i, POSE + 1], LOCAL[i, POSE + 2] = x, y, angle
            LOCAL[i, BEFORE], LOCAL[i, BEFORE + 1], LOCAL[i, BEFORE + 2] = vx, vy, spin
            for c in range(3):
                LOCAL[i, FREE + c] = 0.0
                LOCAL[i, MOBILITY + c] = 0.0
        for c in range(3):
            LOCAL[i, ROOT + c] = math.sqrt(LOCAL[i, MOBILITY + c])
        LOCAL[i, COS], LOCAL[i, SIN] = math.cos(LOCAL[i, POSE + 2]), math.sin(LOCAL[i, POSE + 2])
        for c in range(2):
            length = max(length, abs(LOCAL[i, POSE + c]), abs(h * LOCAL[i, BEFORE + c]))
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        for c in range(4):
            length = max(length, abs(J.JOINT[J.LINK[k, L_JOINT], ANCHOR_AX + c]))
    return length if length > 0.0 else 1.0


@uncounted
def find_places(A: Scene, J: Joints, s: int, INDEX: IntArray) -> int:
    """INDEX (k,) of the moved bodies of component s: their places in its scratch; how many bodies that has."""
    b0, size = J.SPAN[s, BODY_0], J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]
    for w in range(size):
        body = J.MEMBER[b0 + w, M_BODY]
        if body < A.PLACE.shape[0] and A.PLACE[body] >= 0:
            INDEX[A.PLACE[body]] = w
    return int(size)

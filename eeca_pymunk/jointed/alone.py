"""The span of what hangs together by joints and meets nobody: no contacts, and no arrays to be made."""

from __future__ import annotations

import math

from ..compiled import uncounted
from ..impacts.layout import (
    AFTER_ME,
    BODIES,
    FIRST_SHAPE,
    ISLAND,
    KINKS,
    LIFT,
    OPEN,
    SHAPES,
    SOLVES,
    UNTIL,
    Scene,
)
from ..joints.scratch import BEFORE, BODY_0, BODY_1, FREEDOMS, M_BODY, M_FREEDOMS, POSE, TRAVEL
from ..layout import ANGLE, AX, II, VX, X
from ..pairs.layout import NUMBER, START
from ..pairs.rules import barred
from .component import step_in_scratch
from .gathered import gather_alone, keep_joints
from .layout import STEPPED_COLUMNS, TURNED_WORK, Joints


@uncounted
def is_component(A: Scene, J: Joints, root: int) -> bool:
    """Whether an island is one component."""
    s = J.OF[root]
    if s < 0:
        return False
    count = 0
    for i in range(J.SPAN[s, BODY_0], J.SPAN[s, BODY_1]):
        if J.MEMBER[i, M_FREEDOMS] > 0:
            if A.STATE[J.MEMBER[i, M_BODY], ISLAND] != root:
                return False
            count += 1
    return bool(count == A.MEMBER[root, BODIES])


@uncounted
def meets_nobody(A: Scene, root: int) -> bool:
    """Whether no shape of an island has another one near that it may meet."""
    i = root
    while i >= 0:
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            for w in range(A.LIST[s, START], A.LIST[s, START] + A.LIST[s, NUMBER]):
                if not barred(A.RULE, s, int(A.POOL[w])):
                    return False
        i = A.MEMBER[i, AFTER_ME]
    return True


@uncounted
def begin_alone(A: Scene, J: Joints, root: int, t: float, h: float) -> None:
    """Begin a span of length h, without contacts, of an island that `is_component` at instant t, at which all its
    bodies are."""
    s = J.OF[root]
    keep_joints(J, s)
    for c in range(STEPPED_COLUMNS):
        J.STEPPED[s, c] = 0.0
    step_in_scratch(J, s, h, gather_alone(A, J, s, t, h), True)
    first = J.SPAN[s, BODY_0]
    for i in range(J.SPAN[s, BODY_1] - first):
        if J.NODE[i, FREEDOMS] > 0:
            lay_path(A, J, s, J.MEMBER[first + i, M_BODY], i, h)
    A.COUNT[SOLVES] += 1
    A.MEMBER[root, OPEN] = 1
    A.RESTING[root, UNTIL] = math.inf


@uncounted
def lay_path(A: Scene, J: Joints, s: int, body: int, i: int, h: float) -> None:
    """Let a body go to where the scratch of its component has it at i: see `..jointed.solve`."""
    BODY, LOCAL = A.BODY, J.LOCAL
    if BODY[body, II] > 0.0 and A.PULL[body, 2] != 0.0:
        turned = LOCAL[i, POSE + 2] - BODY[body, ANGLE]
        J.STEPPED[s, TURNED_WORK] += A.PULL[body, 2] * (LOCAL[i, TRAVEL + 2] - turned) / BODY[body, II]
    A.STATE[body, KINKS] += 1
    for c in range(3):
        rate = BODY[body, VX + c]
        BODY[body, AX + c] = 2.0 * (LOCAL[i, POSE + c] - BODY[body, X + c] - h * rate) / (h * h)
        A.RESTING[body, LIFT + c] = 0.0
        A.RESTING[body, LIFT + 3 + c] = LOCAL[i, BEFORE + c]

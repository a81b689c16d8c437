"""One component, the bodies that hang together by joints, within an island of the event loop."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import uncounted
from ..joints.bounds import bounded, gap
from ..joints.entries import held as stands
from ..joints.layout import COMPLIANCE, GEAR
from ..joints.ledger import springs_hold
from ..joints.response import prepare, respond
from ..joints.scratch import (
    BEFORE,
    BODY_0,
    BODY_1,
    FREEDOMS,
    JOINT_0,
    JOINT_1,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LOOPS,
    M_BODY,
    MEAN,
    POSE,
    POSES,
    SIZE,
    SPEEDS,
    STEP,
    TARGET,
    TRAVEL,
    VALUE,
)
from ..joints.solve import solve
from ..joints.start import look
from ..joints.step import island_step
from ..model.scene import Scene
from .gathered import gather_component
from .layout import ANSWERS, ORDER, REPEATS, WORST, Joints

_CLOSED = 1e-11  # of the size of a component, that joints may be off where bodies are lifted


@uncounted
def step_in_scratch(J: Joints, s: int, h: float, length: float, whole: bool) -> int:
    """Step component s by h from what is in its scratch, where its end stands then; its status.

    `whole`: whether order 4 may be had: nothing else acts in the span.
    """
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    n = J.SPAN[s, BODY_1] - b0
    order = J.TALLY[ORDER] if whole else 2
    status = island_step(
        J.JOINT, J.TIE, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, n, h, order, length, J.SPAN[s], J.MATRIX,
        J.RIGHT, J.MORE, J.PIVOTS, J.STIFF, J.FOUND, J.PART, J.STEPPED[s],
    )  # fmt: skip
    J.TALLY[REPEATS] += 1
    J.TALLY[WORST] = max(J.TALLY[WORST], status)
    return int(status)


@uncounted
def step_component(
    A: Scene, J: Joints, s: int, h: float, length: float, whole: bool, VN: FloatArray, WAY: FloatArray,
    END: FloatArray, MID: FloatArray,
) -> int:  # fmt: skip
    """`step_in_scratch` from what `gather_component` has put there; its status.

    VN, WAY, END: (k, 3) of the island, out: velocities at the end, ways (sums of h v_m), poses at the end.
    MID: (k, 2), out: where constant forces have acted, means of the places over time.
    """
    status = step_in_scratch(J, s, h, length, whole)
    b0 = J.SPAN[s, BODY_0]
    for i in range(J.SPAN[s, BODY_1] - b0):
        if J.NODE[i, FREEDOMS] > 0:
            q = A.PLACE[J.MEMBER[b0 + i, M_BODY]]
            for c in range(3):
                VN[q, c], END[q, c], WAY[q, c] = J.LOCAL[i, BEFORE + c], J.LOCAL[i, POSE + c], J.LOCAL[i, TRAVEL + c]
            MID[q, 0], MID[q, 1] = J.LOCAL[i, MEAN] / h, J.LOCAL[i, MEAN + 1] / h
    return status


@uncounted
def fit_speeds(A: Scene, J: Joints, s: int, length: float) -> None:
    """Make the velocities that `gather_component` has put into the scratch fit the joints, closed limits included, as
    an impact at which nothing bounces. What this costs is the caller's to book."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    for k in range(j1 - j0):
        J.HINGE[k, SIZE] = 1.0 if J.LINK[j0 + k, L_KIND] >= GEAR else length
    solve(
        int(SPEEDS), J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, J.SPAN[s, BODY_1] - b0, 2.0, length,
        J.SPAN[s, LOOPS] > 0, 0.0, J.SPAN[s], J.MATRIX, J.RIGHT, J.MORE, J.PIVOTS, J.STIFF, J.FOUND,
    )  # fmt: skip


@uncounted
def springs_of(J: Joints, s: int, bodies: int) -> float:
    """The energy that the springs of component s hold at the poses in the scratch."""
    j0, j1 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]
    look(J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, bodies, J.STIFF)
    return springs_hold(J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0)


@uncounted
def close_joints(
    A: Scene, J: Joints, s: int, OLD: FloatArray, NEW: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray,
    t: float, h: float,
) -> float:  # fmt: skip
    """Close the joints of component s at the poses NEW (k, 3) of an island, along M^-1 G^T; how much more its springs
    hold there than at OLD, infinite if joints do not close or limits are passed."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    n = J.SPAN[s, BODY_1] - b0
    length = gather_component(A, J, s, OLD, V, V, IM, II, t, h)
    for k in range(j1 - j0):
        J.HINGE[k, SIZE] = 1.0 if J.LINK[j0 + k, L_KIND] >= GEAR else length
    held = springs_of(J, s, n)
    for k in range(j1 - j0):
        # What is apart stays as far apart.
        for r in range(J.LINK[j0 + k, L_ROWS]):
            J.HINGE[k, TARGET + r] = J.HINGE[k, VALUE + r]
    gather_component(A, J, s, NEW, V, V, IM, II, t, h)
    solve(
        int(POSES), J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, n, 2.0, length, J.SPAN[s, LOOPS] > 0,
        0.0, J.SPAN[s], J.MATRIX, J.RIGHT, J.MORE, J.PIVOTS, J.STIFF, J.FOUND,
    )  # fmt: skip
    for i in range(n):
        if J.NODE[i, FREEDOMS] > 0:
            q = A.PLACE[J.MEMBER[b0 + i, M_BODY]]
            for c in range(3):
                NEW[q, c] = J.LOCAL[i, POSE + c]
    held = springs_of(J, s, n) - held
    for k in range(j1 - j0):
        link, small = J.LINK[j0 + k], _CLOSED * J.HINGE[k, SIZE]
        if link[L_SOFT] != 0:
            continue
        for r in range(link[L_ROWS]):
            if stands(J.LINK, j0 + k, r) and abs(J.HINGE[k, VALUE + r] - J.HINGE[k, TARGET + r]) > small:
                return math.inf
        for side in (-1, 1):
            passed = bounded(J.JOINT, J.LINK[j0:j1], k, side) and link[L_SIDE] != side
            if passed and gap(J.JOINT, J.HINGE, J.LINK[j0:j1], k, side) < -small:
                return math.inf
    return held


@uncounted
def ready(J: Joints, s: int, h: float, about_step: bool) -> bool:
    """Whether component s can answer impulses: about the step that `step_component` has just taken (its scratch is back
    at the start then), or at the poses that `gather_component` has put there."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    what = STEP if about_step else SPEEDS
    J.TALLY[ANSWERS] = prepare(
        what, J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, J.SPAN[s, BODY_1] - b0, h, J.SPAN[s],
        J.MATRIX, J.RIGHT, J.MORE, J.STIFF, J.PIVOTS,
    )  # fmt: skip
    return bool(J.TALLY[ANSWERS] >= 0)


@uncounted
def answer(J: Joints, s: int, about_step: bool, PUSH: FloatArray) -> None:
    """PUSH (bodies of the component, 3): impulses in, changes of velocity out."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    what = STEP if about_step else SPEEDS
    gives = about_step and J.JOINT[J.LINK[j0, L_JOINT], COMPLIANCE] > 0.0
    respond(
        what, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, J.SPAN[s, BODY_1] - b0, J.TALLY[ANSWERS],
        J.SPAN[s], J.MATRIX, J.RIGHT, J.MORE, J.PIVOTS, PUSH, gives,
    )  # fmt: skip

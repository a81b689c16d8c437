"""One component, the bodies that hang together by joints, within an island of the event loop."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..geometry.flight import pose, rate
from ..impacts.layout import Scene
from ..joints.bounds import bounded, gap
from ..joints.correct import kinetic
from ..joints.entries import held as stands
from ..joints.layout import (
    ANCHOR_AX,
    GEAR,
    JOINT_COLUMNS,
    MAX_FORCE,
    MOTOR,
    ROTARY_SPRING,
    SOFT,
    SPRING,
    TIE_COLUMNS,
)
from ..joints.ledger import springs_hold
from ..joints.response import prepare, respond
from ..joints.scratch import (
    BAND,
    BEFORE,
    BODY_0,
    BODY_1,
    BOUNDED,
    CAYLEY,
    COLUMN,
    CONDENSED,
    COS,
    FREE,
    FREEDOMS,
    GIVEN,
    JOINT_0,
    JOINT_1,
    KEPT,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LOOPS,
    M_BODY,
    M_CAYLEY,
    M_COLUMN,
    M_FREEDOMS,
    MOBILITY,
    POSE,
    POSES,
    ROOT,
    SIN,
    SIZE,
    SPEEDS,
    STEP,
    TARGET,
    TRAVEL,
    UNKNOWNS,
    VALUE,
)
from ..joints.solve import solve
from ..joints.start import look
from ..joints.step import island_step
from ..layout import ANGLE, SPIN, VX, VY, X, Y
from .layout import ORDER, REPEATS, WORST, Joints

_CLOSED = 1e-11  # of the size of a component, that joints may be off where bodies are lifted


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
        LOCAL[i, CAYLEY] = J.MEMBER[b0 + i, M_CAYLEY]
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
def step_component(
    A: Scene, J: Joints, s: int, h: float, length: float, whole: bool, VN: FloatArray, WAY: FloatArray, END: FloatArray
) -> int:
    """Step component s by h from what `gather_component` has put into its scratch; its status.

    Args:
        whole: whether order 4 may be had: nothing else acts in the span.
        VN, WAY, END: (k, 3) of the island, out: velocities at the end, ways (sums of h v_m), poses at the end.
    """
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    n = J.SPAN[s, BODY_1] - b0
    band, size = J.SPAN[s, BAND], J.SPAN[s, UNKNOWNS]
    condensed = J.SPAN[s, CONDENSED] != 0
    width = 2 * band + 1 if condensed else 3 * band + 1
    order = J.TALLY[ORDER] if whole else 2
    status = island_step(
        J.JOINT, J.TIE, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, n, h, order, length, J.SPAN[s, LOOPS] > 0,
        condensed, band, size, J.MATRIX[: size * width].reshape((size, width)), J.RIGHT, J.STIFF, J.FOUND, J.PART,
        J.STEPPED[s],
    )  # fmt: skip
    J.TALLY[REPEATS] += 1
    J.TALLY[WORST] = max(J.TALLY[WORST], status)
    for i in range(n):
        if J.NODE[i, FREEDOMS] > 0:
            q = A.PLACE[J.MEMBER[b0 + i, M_BODY]]
            for c in range(3):
                VN[q, c], END[q, c], WAY[q, c] = J.LOCAL[i, BEFORE + c], J.LOCAL[i, POSE + c], J.LOCAL[i, TRAVEL + c]
    return status


@uncounted
def fit_speeds(A: Scene, J: Joints, s: int, length: float) -> float:
    """Make the velocities that `gather_component` has put into the scratch fit the joints, closed limits included, as
    an impact at which nothing bounces; the kinetic energy that this costs."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    n = J.SPAN[s, BODY_1] - b0
    band, size = J.SPAN[s, BAND], J.SPAN[s, UNKNOWNS]
    condensed = J.SPAN[s, CONDENSED] != 0
    width = 2 * band + 1 if condensed else 3 * band + 1
    for k in range(j1 - j0):
        J.HINGE[k, SIZE] = 1.0 if J.LINK[j0 + k, L_KIND] >= GEAR else length
    solve(
        int(SPEEDS), J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, n, 2.0, length, J.SPAN[s, LOOPS] > 0,
        0.0, condensed, band, size, J.MATRIX[: size * width].reshape((size, width)), J.RIGHT, J.STIFF, J.FOUND,
    )  # fmt: skip
    return kinetic(J.LOCAL, n, KEPT) - kinetic(J.LOCAL, n, BEFORE)


@uncounted
def find_places(A: Scene, J: Joints, s: int, INDEX: IntArray) -> int:
    """INDEX (k,) of the moved bodies of component s: their places in its scratch; how many bodies that has."""
    b0, size = J.SPAN[s, BODY_0], J.SPAN[s, BODY_1] - J.SPAN[s, BODY_0]
    for w in range(size):
        body = J.MEMBER[b0 + w, M_BODY]
        if body < A.PLACE.shape[0] and A.PLACE[body] >= 0:
            INDEX[A.PLACE[body]] = w
    return int(size)


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
    band, size = J.SPAN[s, BAND], J.SPAN[s, UNKNOWNS]
    condensed = J.SPAN[s, CONDENSED] != 0
    width = 2 * band + 1 if condensed else 3 * band + 1
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
        0.0, condensed, band, size, J.MATRIX[: size * width].reshape((size, width)), J.RIGHT, J.STIFF, J.FOUND,
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
def drives(J: Joints, s: int) -> bool:
    """Whether the joints of component s move its bodies by themselves: springs, motors, joints with a max_force."""
    some = False
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        kind = J.LINK[k, L_KIND]
        some = some or kind in (SPRING, ROTARY_SPRING, MOTOR) or J.TIE[J.LINK[k, L_JOINT], SOFT] != 0
    return some


@uncounted
def may_slip(J: Joints, s: int) -> bool:
    """Whether component s has motors, or joints with a finite max_force, that enough impulse on its bodies moves."""
    some = False
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        some = some or (J.LINK[k, L_SOFT] != 0 and J.JOINT[J.LINK[k, L_JOINT], MAX_FORCE] < 1e300)
    return some


@uncounted
def let_slip(J: Joints, s: int, slips: bool) -> None:
    """Let the impulses of such joints count as given in answers, or no longer."""
    for k in range(J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1]):
        if J.LINK[k, L_SOFT] != 0 and J.JOINT[J.LINK[k, L_JOINT], MAX_FORCE] < 1e300:
            J.LINK[k, L_SOFT] = GIVEN if slips else BOUNDED


@uncounted
def ready(J: Joints, s: int, h: float, about_step: bool) -> bool:
    """Whether component s can answer impulses: about the step that `step_component` has just taken (its scratch is back
    at the start then), or at the poses that `gather_component` has put there."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    band, size = J.SPAN[s, BAND], J.SPAN[s, UNKNOWNS]
    condensed = J.SPAN[s, CONDENSED] != 0
    width = 2 * band + 1 if condensed else 3 * band + 1
    what = STEP if about_step else SPEEDS
    return prepare(
        what, J.JOINT, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, J.SPAN[s, BODY_1] - b0, h,
        condensed, band, size, J.MATRIX[: size * width].reshape((size, width)), J.RIGHT, J.STIFF, J.PIVOTS,
    )  # fmt: skip


@uncounted
def answer(J: Joints, s: int, about_step: bool, PUSH: FloatArray) -> None:
    """PUSH (bodies of the component, 3): impulses in, changes of velocity out."""
    j0, j1, b0 = J.SPAN[s, JOINT_0], J.SPAN[s, JOINT_1], J.SPAN[s, BODY_0]
    band, size = J.SPAN[s, BAND], J.SPAN[s, UNKNOWNS]
    condensed = J.SPAN[s, CONDENSED] != 0
    width = 2 * band + 1 if condensed else 3 * band + 1
    what = STEP if about_step else SPEEDS
    respond(
        what, J.HINGE, J.LINK[j0:j1], j1 - j0, J.LOCAL, J.NODE, J.SPAN[s, BODY_1] - b0, condensed, band, size,
        J.MATRIX[: size * width].reshape((size, width)), J.RIGHT, J.MORE, J.PIVOTS, PUSH,
    )  # fmt: skip

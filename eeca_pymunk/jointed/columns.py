"""Contact laws with the responses of components in place of inverse masses: Y (., 3), change of velocities per impulse.

An impulse on one body moves all bodies of its component. Every contact has two columns, one for its normal and one for
its tangential impulse, over the *groups* of its two bodies: a group is a component, or one body without joints.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..joints.workspace import workspace
from ..model.contacts import Columns, Row
from ..model.joints import Joints
from ..model.parameters.joints import CONDENSED_PASSES
from ..newton.effort import work_of_solution
from ..newton.response import respond
from ..rows.build import invert
from ..rows.columns import put_unjointed
from .groups import Groups, least_mobility

NORMALS, WITH_TANGENTS = 1, 2  # columns that `fill_group` computes: how many for each contact


@kernel
def make_columns(groups: Groups, ROWS: Rows[Row], m: int) -> Columns:
    """Room for the columns of m contacts, zero."""
    NUMBERS = np.zeros(2 * m + 1, np.int64)
    AT, LEFT_OUT, BODY = NUMBERS[: m + 1], NUMBERS[m + 1 :], NUMBERS[:0]
    for fill in range(2):  # first AT, then BODY
        if fill == 1:
            BODY = np.empty(AT[m], np.int64)
        for i in range(m):
            at = AT[i]
            a, b = groups.GROUP[ROWS[i].a], groups.GROUP[ROWS[i].b]
            for g in (a, b):
                if g < 0 or (g == a and g == b and at > AT[i]):
                    continue
                for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
                    if fill == 1:
                        BODY[at] = groups.BODY[w]
                    at += 1
            if fill == 0:
                AT[i + 1] = at
    BOTH = np.zeros((2 * AT[m], 3))
    return Columns(AT, BODY, BOTH[: AT[m]], BOTH[AT[m] :], LEFT_OUT, np.zeros(1))


@nonallocating
def count_operations(J: Joints, C: Columns) -> None:
    """Add the operations that solves with the columns have taken to the work of the step."""
    J.PROGRESS.effort += C.WORK[0]
    C.WORK[0] = 0.0


@nonallocating
def work_of_columns(J: Joints, groups: Groups, ROWS: Rows[Row], m: int) -> float:
    """Operations of the columns of m contacts on components: two solutions with factors for each."""
    total = 0.0
    for i in range(m):
        a, b = groups.GROUP[ROWS[i].a], groups.GROUP[ROWS[i].b]
        for g in (a, -1 if b == a else b):
            s = groups.COMPONENT[g] if g >= 0 else -1
            if s >= 0:
                component = J.COMPONENT[s]
                joints = component.end_joint - component.first_joint
                total += 2.0 * work_of_solution(component.system, CONDENSED_PASSES, joints, component)
    return total


@nonallocating
def fill_unjointed(groups: Groups, C: Columns, ROWS: Rows[Row], IM: FloatArray, II: FloatArray, m: int) -> None:
    """Compute the columns' entries on bodies without joints."""
    for i in range(m):
        for w in range(C.AT[i], C.AT[i + 1]):
            q = C.BODY[w]
            if groups.COMPONENT[groups.GROUP[q]] >= 0:
                continue
            put_unjointed(C, w, ROWS[i], q == ROWS[i].b, IM[q], II[q])


@nonallocating
def push_group(groups: Groups, g: int, INDEX: IntArray, row: Row, lam: float, beta: float, PUSH: FloatArray) -> None:
    """Add the impulses lam, beta of a contact on bodies of group g to PUSH (., 3). INDEX (k,): row of PUSH of each
    body."""
    for q, sign, arm_n, arm_t in ((row.a, -1.0, row.arm_na, row.arm_ta), (row.b, 1.0, row.arm_nb, row.arm_tb)):
        if groups.GROUP[q] == g:
            n, f = sign * lam, sign * beta
            PUSH[INDEX[q], 0] += n * row.nx - f * row.ny
            PUSH[INDEX[q], 1] += n * row.ny + f * row.nx
            PUSH[INDEX[q], 2] += n * arm_n + f * arm_t


@nonallocating
def fill_group(
    J: Joints, groups: Groups, C: Columns, g: int, INDEX: IntArray, ROWS: Rows[Row], m: int, PUSH: FloatArray, ways: int
) -> None:
    """Compute the columns' entries on the bodies of group g, whose component is prepared
    (`..newton.response`).

    Args:
        INDEX: (k,) places of bodies in the scratch of their component.  PUSH: (bodies of the component, 3) scratch.
        ways: NORMALS, or WITH_TANGENTS, those of tangential impulses too.
    """
    s = groups.COMPONENT[g]
    for i in range(m):
        if groups.GROUP[ROWS[i].a] != g and groups.GROUP[ROWS[i].b] != g:
            continue
        for tangent in range(ways):
            PUSH[:] = 0.0
            push_group(groups, g, INDEX, ROWS[i], 1.0 - tangent, float(tangent), PUSH)
            respond(workspace(J, s), PUSH)
            ANSWER = C.N if tangent == 0 else C.T
            for w in range(C.AT[i], C.AT[i + 1]):
                if groups.GROUP[C.BODY[w]] == g:
                    for c in range(3):
                        ANSWER[w, c] = PUSH[INDEX[C.BODY[w]], c]


@nonallocating
def column_rate(C: Columns, ROWS: Rows[Row], i: int, ANSWER: FloatArray, tangent: bool) -> float:
    """Change of contact i's normal (or tangential) velocity by its own column, whose entries are ANSWER; 1/mass."""
    x, y = (-ROWS[i].ny, ROWS[i].nx) if tangent else (ROWS[i].nx, ROWS[i].ny)
    arm_a = ROWS[i].arm_ta if tangent else ROWS[i].arm_na
    arm_b = ROWS[i].arm_tb if tangent else ROWS[i].arm_nb
    total = 0.0
    for w in range(C.AT[i], C.AT[i + 1]):
        if C.BODY[w] == ROWS[i].a:
            total -= x * ANSWER[w, 0] + y * ANSWER[w, 1] + arm_a * ANSWER[w, 2]
        if C.BODY[w] == ROWS[i].b:
            total += x * ANSWER[w, 0] + y * ANSWER[w, 1] + arm_b * ANSWER[w, 2]
    return total


@nonallocating
def is_movable(groups: Groups, row: Row, mobility: float) -> bool:
    """Whether a contact's mobility along n (1/mass) is larger than the error of the response."""
    return bool(mobility * row.k_n > least_mobility(groups, row.a, row.b))


@nonallocating
def set_effective_masses(groups: Groups, C: Columns, ROWS: Rows[Row], m: int) -> None:
    """Compute k, a and w of the rows from the columns, and LEFT_OUT: whether a contact is hardly moved by its own
    impulse. At a given normal rate impulses change the slip by a_tt - a_nt^2/a_nn; where that is no more than the error
    of the response, the bodies can move in one direction only, and it is set to 0: the contact then does not stick."""
    for i in range(m):
        nn, tt = column_rate(C, ROWS, i, C.N, False), column_rate(C, ROWS, i, C.T, True)
        nt = 0.5 * (column_rate(C, ROWS, i, C.N, True) + column_rate(C, ROWS, i, C.T, False))
        least = least_mobility(groups, ROWS[i].a, ROWS[i].b)
        C.LEFT_OUT[i] = 0 if is_movable(groups, ROWS[i], nn) else 1
        if C.LEFT_OUT[i] == 0:
            ROWS[i].k_n, ROWS[i].a_nn = 1.0 / nn, nn
        if C.LEFT_OUT[i] == 0 and (tt - nt * nt / nn) * ROWS[i].k_t <= least:
            tt = nt * nt / nn
        if tt * ROWS[i].k_t > least:
            ROWS[i].k_t, ROWS[i].a_tt, ROWS[i].a_nt = 1.0 / tt, tt, nt
        else:
            ROWS[i].friction, ROWS[i].a_nt = 0.0, 0.0
        if ROWS[i].friction > 0.0:
            invert(ROWS[i], nn, nt, tt)

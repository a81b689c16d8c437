"""Joint rows with bounded impulses (motors, joints with a finite max_force, limits) as unknowns beside those of
contacts.

The columns of contacts and of these rows are responses with all exact joints, bounded impulses being given: so contacts
and bounded rows are one problem (`..rows`). It only predicts bounded impulses: the next step of the components computes
them again (`..newton.saturation`), exactly within their bounds.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..joints.workspace import workspace
from ..model.contacts import Bounded
from ..model.joints import BOUNDED, PRESCRIBED, Joints
from ..model.parameters.joints import MOTOR_OFF
from ..model.scene import Scene
from ..newton.entries import acting_rows, interval_of, is_limit
from ..newton.response import respond
from ..rows.bounded import FIRST_OF_DISC, SECOND_OF_DISC, SINGLE, bounded_rate, room_for_rows, weigh_rows
from .groups import Groups


@nonallocating
def is_exact_limit(J: Joints, k: int) -> bool:
    """Whether coupling k is a limit of unlimited force."""
    return bool(is_limit(J.COUPLING[k].kind) and J.JOINT[J.COUPLING[k].joint].finite_force == 0)


@nonallocating
def prescribe_bounded(J: Joints, s: int, given: bool, limits: bool) -> None:
    """Count bounded impulses as `given` in responses, or no longer: those of joints with a max_force that are solved
    with contacts, and, if `limits`, those of limits that act."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        link = J.COUPLING[k]
        if link.bounded != 0 and J.JOINT[link.joint].finite_force != 0 and J.COMPONENT[s].bounded_rows > 0:
            link.bounded = PRESCRIBED if given else BOUNDED
        elif limits and is_exact_limit(J, k):
            link.bounded = PRESCRIBED if given and link.side != 0 else 0


@kernel
def make_bounded(J: Joints, groups: Groups, limits: bool) -> Bounded:
    """Room for the bounded rows of all components of an island, with or without those of limits."""
    n, entries = 0, 0
    for g in range(len(groups.COMPONENT)):
        if groups.COMPONENT[g] >= 0:
            s = groups.COMPONENT[g]
            rows = J.COMPONENT[s].bounded_rows
            for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint if limits else 0):
                rows += 1 if is_exact_limit(J, k) else 0
            n += rows
            entries += rows * (groups.FIRST[g + 1] - groups.FIRST[g])
    return room_for_rows(n, entries)


@nonallocating
def note_row(A: Scene, J: Joints, B: Bounded, s: int, i: int, h: float, V: FloatArray) -> None:
    """Write row i of B at the end V of the step h that component s has just taken. A limit that acts keeps the velocity
    that it has; one that was released keeps its last row. An impulse inside its bounds whose row is not at its target
    was at different bounds in parts of the step: it is then given, low = high."""
    k, r = B.OF[i, 0], B.OF[i, 1]
    hinge = J.HINGE[k - J.COMPONENT[s].first_joint]
    B.ROWS[i].now = hinge.total[r]
    limit = is_exact_limit(J, k)
    if limit and J.COUPLING[k].side == 0:
        return
    B.ROWS[i].speed = -hinge.target[r]
    for end in range(2):
        at = J.COUPLING[k].body[end]
        B.END[i, end] = A.PLACE[J.JOINED[J.COMPONENT[s].first_body + at].body] if J.LOCAL[at].freedoms > 0 else -1
        for c in range(3):
            B.ROW[i, 3 * end + c] = hinge.rows[r, 3 * end + c]
            if B.END[i, end] < 0:
                B.ROWS[i].speed += B.ROW[i, 3 * end + c] * J.LOCAL[at].v0[c]
    rate = bounded_rate(B, i, V)
    off = B.ROWS[i].speed + rate
    low, high = interval_of(J.COUPLING, k, r, hinge.bound * h)
    if limit:
        B.ROWS[i].speed = -rate
    elif B.ROWS[i].part == SINGLE and low < hinge.total[r] < high:
        # The bound changes the speed by at most high / scale².
        if abs(off) * hinge.scale[r] ** 2 > MOTOR_OFF * (high + abs(rate) * hinge.scale[r] ** 2):
            low = high = hinge.total[r]
    B.ROWS[i].low, B.ROWS[i].high = low, high


@nonallocating
def note_rows(A: Scene, J: Joints, B: Bounded, s: int, h: float, V: FloatArray) -> None:
    """`note_row` for the rows of component s that B has, after another step of it."""
    for i in range(B.NUMBER[0]):
        if J.COMPONENT[s].first_joint <= B.OF[i, 0] < J.COMPONENT[s].end_joint:
            note_row(A, J, B, s, i, h, V)


@nonallocating
def list_rows(A: Scene, J: Joints, B: Bounded, s: int, h: float, V: FloatArray) -> int:
    """Append to B the rows of component s whose impulses count as given (`prescribe_bounded`); the first of them."""
    first = B.NUMBER[0]
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        rows = acting_rows(J.COUPLING, k) if J.COUPLING[k].bounded == PRESCRIBED else 0
        for r in range(rows):
            i = B.NUMBER[0]
            B.OF[i, 0], B.OF[i, 1] = k, r
            B.ROWS[i].part = SINGLE if rows == 1 else FIRST_OF_DISC if r == 0 else SECOND_OF_DISC
            note_row(A, J, B, s, i, h, V)
            B.NUMBER[0] = i + 1
    return int(first)


@nonallocating
def fill_rows(J: Joints, groups: Groups, B: Bounded, g: int, first: int, INDEX: IntArray, PUSH: FloatArray) -> None:
    """Compute the columns of the rows of B from `first` on, which are those of group g, whose component is prepared
    (`..newton.response`)."""
    s = groups.COMPONENT[g]
    for i in range(first, B.NUMBER[0]):
        PUSH[:] = 0.0
        for end in range(2):
            if B.END[i, end] >= 0:
                for c in range(3):
                    PUSH[INDEX[B.END[i, end]], c] += B.ROW[i, 3 * end + c]
        respond(workspace(J, s), PUSH)
        at = B.AT[i]
        for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
            q = groups.BODY[w]
            B.BODY[at] = q
            for c in range(3):
                B.N[at, c] = PUSH[INDEX[q], c]
            at += 1
        B.AT[i + 1] = at


@kernel
def with_bounded(B: Bounded, L: FloatArray, m: int) -> FloatArray:
    """(m + rows, 2) the impulses L of m contacts, then those of the bounded rows in the last motion, which get their
    effective masses."""
    weigh_rows(B)
    BOTH = np.zeros((m + B.NUMBER[0], 2))
    for i in range(m):
        BOTH[i, 0], BOTH[i, 1] = L[i, 0], L[i, 1]
    for i in range(B.NUMBER[0]):
        BOTH[m + i, 0] = B.ROWS[i].now
    return BOTH

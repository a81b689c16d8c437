"""The motion of an island with joints under given impulses of its contacts."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..joints.workspace import workspace
from ..model.contacts import Bounded, Columns, Row
from ..model.islands import Island
from ..model.joint_steps import STEP
from ..model.joints import INDEPENDENT, Joints
from ..model.parameters.joints import ARM_ERROR, ARM_ITERATIONS
from ..model.scene import Scene
from ..newton.response import prepare_response
from ..rows.build import push_contact
from ..rows.inplace import copy
from .bounded_rows import fill_rows, list_rows, note_rows, prescribe_bounded
from .columns import WITH_TANGENTS, fill_group
from .component import step_in_scratch
from .gathered import find_places, gather_component, lead_component, number_of, rewind_joints
from .groups import Groups


class Motion(NamedTuple):
    """The motion of the k bodies of an island over an interval h, arrays (k, 3); v is the velocity at the start. V,
    END: velocities and poses at the end. WAY: sums of h v_m over the parts of the interval. EVEN = 2 WAY/h - v, the
    velocity at the end if an even acceleration led this way: not V if a limit is met within the interval, since joints
    then change the velocity there. MID (k, 2): mean places over time, where constant forces act. PUSHED: accelerations
    without joints under which it was computed, to round-off, else NaN.

    Contacts have their laws by EVEN: an impulse lam that is spread over the interval does the work lam . WAY/h, with
    WAY/h the mean of v and EVEN. So the losses of contacts follow their laws, whatever joints do within the interval.
    """

    V: FloatArray
    EVEN: FloatArray
    WAY: FloatArray
    END: FloatArray
    MID: FloatArray
    PUSHED: FloatArray


class Interval(NamedTuple):
    """An island over an interval of length h from instant t: its k bodies, of which impulses move the first n; their
    groups; m contacts ROWS with columns C; and, out, the motion of the bodies. few: whether so few contacts may act
    (`contact_laws.few_act`) that they are solved exactly."""

    isle: Island
    groups: Groups
    ROWS: Rows[Row]
    motion: Motion
    C: Columns
    m: int
    n: int
    t: float
    h: float
    few: bool


@kernel
def motion_at_start(isle: Island, k: int) -> Motion:
    """The motion of the k bodies of an island over an interval of length 0, with arrays of its own."""
    STATES = np.zeros((5 * k, 3))
    motion = Motion(
        STATES[:k], STATES[k : 2 * k], STATES[2 * k : 3 * k], STATES[3 * k : 4 * k], np.zeros((k, 2)), STATES[4 * k :]
    )
    copy(motion.V, isle.V)
    copy(motion.EVEN, isle.V)
    copy(motion.END, isle.POSE)
    motion.PUSHED[:] = math.nan
    return motion


@kernel
def find_hit(groups: Groups, ROWS: Rows[Row], m: int) -> IntArray:
    """(groups,) 1 for each group that one of the m contacts acts on, else 0."""
    HIT = np.zeros(len(groups.COMPONENT) + 1, np.int64)  # the first entry is for GROUP -1
    for i in range(m):
        HIT[groups.GROUP[ROWS[i].a] + 1] = HIT[groups.GROUP[ROWS[i].b] + 1] = 1
    return HIT[1:]


@nonallocating
def stays(J: Joints, groups: Groups, g: int, PUSHED: FloatArray, ACC: FloatArray) -> bool:
    """Whether the component of group g need not be stepped: its motion was computed under the accelerations ACC. False
    if rows are redundant, since their impulses depend on those with which the solve begins."""
    component = J.COMPONENT[groups.COMPONENT[g]]
    same = component.cycles == 0 or component.dependence == INDEPENDENT
    for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
        for c in range(3):
            same = same and PUSHED[groups.BODY[w], c] == ACC[groups.BODY[w], c]
    return same


@kernel
def advance(A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, fill: bool, GUESS: FloatArray) -> None:
    """Step all bodies of an island by h under the impulses L (m, 2) of its contacts, with joints as at the start. GUESS
    (k, 3): predicted velocities at the end, with which Newton's method begins; (0, 3) for none. `fill`: also compute
    the columns C and the bounded rows B about this step, bounded impulses being given. Else C is kept, B gets the new
    impulses and bounds of its rows, and a component that `stays` is not stepped."""
    isle, groups, ROWS, motion, C, m, _, t, h, few = interval
    k = len(isle.IM)
    ACC = isle.ACC.copy()
    for i in range(m):
        push_contact(ROWS[i], isle.IM, isle.II, L[i, 0] / h, L[i, 1] / h, ACC)
    INDEX, HIT = np.full(k, -1, np.int64), find_hit(groups, ROWS, m if fill else 0)
    if fill:
        B.NUMBER[0] = 0
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0 or (not fill and stays(J, groups, g, motion.PUSHED, ACC)):
            continue
        rewind_joints(J, s)
        if len(GUESS) > 0:
            lead_component(A, J, s, isle.V, ACC, GUESS, h)
        extent = gather_component(A, J, s, isle.POSE, isle.V, ACC, isle.IM, isle.II, t, h)
        step_in_scratch(J, s, h, extent, m == 0)
        for i in range(J.COMPONENT[s].end_body - J.COMPONENT[s].first_body):
            q, local = number_of(A, J, s, i), J.LOCAL[i]
            for c in range(3 if q >= 0 else 0):
                motion.V[q, c], motion.END[q, c], motion.WAY[q, c] = local.v0[c], local.pose[c], local.travel[c]
            for c in range(2 if q >= 0 else 0):
                motion.MID[q, c] = local.mean[c] / h
        for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
            q = groups.BODY[w]
            for c in range(3):
                motion.EVEN[q, c] = 2.0 * motion.WAY[q, c] / h - isle.V[q, c]
                motion.PUSHED[q, c] = ACC[q, c] if J.PROGRESS.near == 0.0 else math.nan
        if not fill:
            note_rows(A, J, B, s, h, motion.EVEN)
        elif HIT[g] > 0:
            size = find_places(A, J, s, INDEX)
            prescribe_bounded(J, s, True, few)
            first = list_rows(A, J, B, s, h, motion.EVEN)
            if prepare_response(workspace(J, s), STEP, h):
                PUSH = np.empty((size, 3))
                fill_group(J, groups, C, g, INDEX, ROWS, m, PUSH, WITH_TANGENTS)
                fill_rows(J, groups, B, g, first, INDEX, PUSH)
            else:
                B.NUMBER[0] = first
            prescribe_bounded(J, s, False, True)
    for q in range(k):
        if groups.GROUP[q] >= 0 and groups.COMPONENT[groups.GROUP[q]] >= 0:
            continue
        for c in range(3):
            motion.V[q, c] = isle.V[q, c] + h * ACC[q, c]
            motion.WAY[q, c] = 0.5 * h * (isle.V[q, c] + motion.V[q, c])
            motion.END[q, c] = isle.POSE[q, c] + motion.WAY[q, c]
            motion.EVEN[q, c] = motion.V[q, c]
        for c in range(2):
            motion.MID[q, c] = isle.POSE[q, c] + 0.5 * motion.WAY[q, c]


@nonallocating
def separation(row: Row, PLACE: FloatArray) -> tuple[float, float]:
    """The distance d + r_b - r_a of the points of a contact on both bodies, along n and along -t, with bodies at PLACE
    (k, 2 or more): d leads from the centre of body a to that of b. Arms are r = arm_t n - arm_n t."""
    x, y = PLACE[row.b, 0] - PLACE[row.a, 0], PLACE[row.b, 1] - PLACE[row.a, 1]
    along = x * row.nx + y * row.ny + (row.arm_tb - row.arm_ta)
    return along, x * row.ny - y * row.nx + (row.arm_nb - row.arm_na)


@nonallocating
def join_points(row: Row, along: float, across: float, of_disks: float) -> None:
    """Change the arms of a contact so that its points, whose `separation` this is, become one: the middle, or, if one
    of the shapes is a disk (arm_n = 0), its point, on which the normal impulse still exerts no torque. of_disks: the
    part of the way that the point on body a goes if both arms are 0."""
    one = 0.0 if row.arm_na == 0.0 else 1.0 if row.arm_nb == 0.0 else 0.5
    part = of_disks if row.arm_na == 0.0 and row.arm_nb == 0.0 else one
    row.arm_na += part * across
    row.arm_ta += part * along
    row.arm_nb -= (1.0 - part) * across
    row.arm_tb -= (1.0 - part) * along


@nonallocating
def points_apart(interval: Interval, i: int) -> tuple[float, float, float]:
    """The `separation` of contact i of a free island at the mean places of its bodies, and its amount over the size of
    bodies and places. 0 if that is farther than the smaller body is large."""
    isle, row, MID = interval.isle, interval.ROWS[i], interval.motion.MID
    a, b = row.a, row.b
    along, across = separation(row, MID)
    off, size = abs(along) + abs(across), min(isle.EXTENT[a], isle.EXTENT[b])
    if not off <= size:
        return 0.0, 0.0, 0.0
    return along, across, off / (size + abs(MID[a, 0]) + abs(MID[a, 1]))


@nonallocating
def align(interval: Interval) -> float:
    """Join the two points of each contact of a free island at the mean places of its bodies. Returns how far they were
    apart at most (`points_apart`). An impulse p spread over a step changes the angular momentum of a body by
    (x + r) x p, with x its mean place: the two changes only cancel if both points are one."""
    worst = 0.0
    for i in range(interval.m):
        along, across, off = points_apart(interval, i)
        join_points(interval.ROWS[i], along, across, 0.5)
        worst = max(worst, off)
    return worst


@nonallocating
def farthest_apart(V: FloatArray, W: FloatArray, EXTENT: FloatArray, n: int) -> float:
    """The largest difference of two sets of velocities (k, 3) at the points of the first n bodies."""
    worst = 0.0
    for q in range(n):
        change = math.sqrt((V[q, 0] - W[q, 0]) ** 2 + (V[q, 1] - W[q, 1]) ** 2)
        worst = max(worst, change + abs(V[q, 2] - W[q, 2]) * EXTENT[q])
    return worst


@kernel
def advance_aligned(A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool) -> float:
    """`advance`; in a `free` island repeated until the arms of contacts with an impulse are those of the motion
    (`align`), which keeps angular momentum. Returns the error of the arms that is left.

    Each motion has errors r of the arms. They change by w r, with w by Aitken's method for vectors:
    w+ = -w r.(r+ - r)/|r+ - r|^2, from 1 on. So they converge where arms turn bodies as much as these move them.
    """
    m, weight, worst = interval.m, 1.0, 0.0
    OFF, BEFORE = np.zeros((m, 2)), np.zeros((m, 2))
    for turn in range(ARM_ITERATIONS):
        advance(A, J, interval, L, B, False, np.empty((0, 3)))
        if not free:
            break
        worst, change, square = 0.0, 0.0, 0.0
        for i in range(m):
            if L[i, 0] == 0.0 and L[i, 1] == 0.0:
                continue
            OFF[i, 0], OFF[i, 1], off = points_apart(interval, i)
            worst = max(worst, off)
            for c in range(2):
                change += BEFORE[i, c] * (OFF[i, c] - BEFORE[i, c])
                square += (OFF[i, c] - BEFORE[i, c]) ** 2
        if worst <= ARM_ERROR or turn + 1 == ARM_ITERATIONS:
            break
        if turn > 0 and square > 0.0:
            weight *= -change / square
        for i in range(m):
            join_points(interval.ROWS[i], weight * OFF[i, 0], weight * OFF[i, 1], 0.5)
        copy(BEFORE, OFF)
    return worst

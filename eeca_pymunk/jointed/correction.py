"""Penetration correction of islands with joints, paid from what contacts have just lost."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FlagArray, FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..contacts.correction import admissible, connect, least_of, mark_group, turn_groups, unturn_groups
from ..contacts.works import work_of_forces
from ..islands.depths import left_to_lift, lifts_through
from ..islands.payment import payment
from ..joints.bounds import stand_as_stepped
from ..joints.workspace import workspace
from ..model.contacts import Columns, JointedProblem, Row
from ..model.islands import Island
from ..model.joint_steps import SPEEDS
from ..model.joints import Joints
from ..model.parameters import joints
from ..model.parameters.intervals import CORRECTION_ROUND_OFF
from ..model.scene import Scene
from ..newton.response import prepare_response
from ..rows.bounded import room_for_rows
from ..rows.build import normal_rate
from ..rows.inplace import copy
from ..rows.lifting import lift_above_walls
from .advance import Interval, separation
from .columns import NORMALS, fill_group, set_effective_masses
from .component import close_at_poses, passes_limit
from .gathered import find_places, gather_component
from .groups import is_free
from .losses import lost


@kernel
def raise_gaps(problem: JointedProblem, n: int, GAPS: FloatArray, D: FloatArray, tolerance: float) -> FloatArray:
    """Displacements D (k, 3) = Y mu with 0 <= mu _|_ g + G D >= 0, for contacts that are not left out; GAPS (m,) of
    those that are become infinite. Returns mu (m,). `projection.stop_closing` has velocities in the place of gaps."""
    for i in range(problem.m):
        if problem.C.LEFT_OUT[i] != 0:
            GAPS[i] = np.inf
    return lift_above_walls(problem, n, GAPS, D, tolerance, joints.JOINTED_CORRECTION_SWEEPS)


@kernel
def fill_at_end(A: Scene, J: Joints, interval: Interval, C: Columns, g: int, ROWS: Rows[Row], m: int) -> bool:
    """Compute the columns C of the normal impulses of m contacts on group g, a component, at the poses and the instant
    at the end of an interval; False if there is no response."""
    isle, groups, _, motion, _, _, _, t, h, _ = interval
    s, INDEX = groups.COMPONENT[g], np.empty(len(isle.IM), np.int64)
    gather_component(A, J, s, motion.END, motion.V, np.zeros_like(isle.V), isle.IM, isle.II, t + h, h)
    size = find_places(A, J, s, INDEX)
    if not prepare_response(workspace(J, s), SPEEDS, 2.0):
        return False
    fill_group(J, groups, C, g, INDEX, ROWS, m, np.empty((size, 3)), NORMALS)
    return True


@kernel
def lift_island(A: Scene, J: Joints, interval: Interval, L: FloatArray, root: int, error: float) -> None:
    """Correct penetration at the end of an island's motion under impulses L (m, 2) of its contacts. error: round-off of
    the energy that these lose (`losses.work_error`)."""
    isle, groups, ROWS, motion, _, m, n, _, _, _ = interval
    loss = lost(interval, L)
    loss = loss if abs(loss) > error else 0.0
    budget, payable = payment(A, isle, ROWS, L, motion.V, n, m, loss, A.RESTING[root].lost, False, True)
    spent = correct_overlaps(A, J, interval, L, budget)
    for s in groups.JOINTED:
        stand_as_stepped(workspace(J, s))
    paid, one = min(spent, payable), J.STEPPED[groups.JOINTED[0]]
    one.lifted += paid
    one.supports += spent - paid


@nonallocating
def keep_centre(D: FloatArray, IM: FloatArray, ONE: FlagArray) -> None:
    """Add a common displacement to D (k, 3) of the bodies with flags ONE (n,), with which their centre of mass stays:
    columns that were updated by motions (`broyden.update_columns`) do not conserve momentum exactly."""
    mass = x = y = 0.0
    for i in range(len(ONE)):
        if ONE[i] != 0:
            mass, x, y = mass + 1.0 / IM[i], x + D[i, 0] / IM[i], y + D[i, 1] / IM[i]
    for i in range(len(ONE)):
        if ONE[i] != 0:
            D[i, 0] -= x / mass
            D[i, 1] -= y / mass


@kernel
def pressing(interval: Interval, L: FloatArray, MU: FloatArray) -> IntArray:
    """(n,) the groups of bodies that joints, and contacts with impulses L (m, 2) or corrections MU (m,), connect."""
    GROUP, ROWS = interval.groups.GROUP[: interval.n].copy(), interval.ROWS
    for i in range(interval.m):
        if L[i, 0] > 0.0 or MU[i] > 0.0:
            connect(GROUP, ROWS[i].a, ROWS[i].b)
    return GROUP


@kernel
def keep_angular_momentum(J: Joints, interval: Interval, L: FloatArray) -> None:
    """Remove the angular momentum that contacts of a free island give, whose points on both bodies are not one at their
    mean places, as arms have not converged (`advance_aligned`): s x p for the impulse p and the way s between these
    points, by a common rotation of the velocities of bodies that press on each other. Losses of contacts pay for it."""
    isle, groups, ROWS, motion, _, m, n, _, _, _ = interval
    if m == 0 or not is_free(isle, groups, n, J):
        return
    GROUP, EXCESS, TURN, ONE = pressing(interval, L, np.zeros(m)), np.zeros(n), np.zeros((n, 3)), np.empty(n, np.uint8)
    size = most = 0.0
    for i in range(m):
        along, across = separation(ROWS[i], motion.MID)
        EXCESS[GROUP[ROWS[i].a]] += along * L[i, 1] + across * L[i, 0]
    for q in range(n):
        x, y, v = motion.END[q, 0] - motion.END[0, 0], motion.END[q, 1] - motion.END[0, 1], motion.V[q]
        size += (abs(v[0]) + abs(v[1])) * (abs(x) + abs(y)) / isle.IM[q]
        size += abs(v[2]) / isle.II[q] if isle.II[q] > 0.0 else 0.0
        most = max(most, abs(EXCESS[q]))
    if not most > joints.MOMENTUM_LEFT * size:
        return
    gained, square = unturn_groups(motion.END, np.zeros((n, 2)), motion.V, isle.IM, isle.II, GROUP, ONE, EXCESS, TURN)
    turn_groups(motion.END, GROUP, ONE, TURN, motion.V, 0)
    J.STEPPED[groups.JOINTED[0]].lifted += gained + square


@kernel
def lift_along_joints(
    A: Scene, J: Joints, interval: Interval, GAPS: FloatArray, D: FloatArray, error: float
) -> FloatArray:  # fmt: skip
    """Set D (k, 3) to the displacements at the end of an interval that close the gaps GAPS (m,) of its contacts to
    `error`, along the joints and along limits that a solution passes, which hold in the next. Returns `raise_gaps`'
    mu (m,)."""
    isle, groups, ROWS, motion, C, m, n, t, h, _ = interval
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        # The columns of the interval, in which stiff springs resist, so that D hardly strains them; but bounded rows
        # prescribe speeds at its end.
        if s >= 0 and J.COMPONENT[s].bounded_joints > 0:
            fill_at_end(A, J, interval, C, g, ROWS, m)
    MU = np.zeros(m)
    for _ in range(joints.IMPACT_LIMITS):
        KEEP, D[:] = ROWS[:m].copy(), 0.0
        set_effective_masses(groups, C, KEEP, m)
        MU = raise_gaps(JointedProblem(KEEP, C, room_for_rows(0, 0), m), n, GAPS, D, error)
        again = False
        for g in range(len(groups.COMPONENT)):
            s = groups.COMPONENT[g]
            if s >= 0 and passes_limit(A, J, s, motion.END, D, isle.IM, isle.II, t + h, h, error):
                again = fill_at_end(A, J, interval, C, g, ROWS, m) or again
        if not again:
            break
    return MU


@kernel
def part_within(isle: Island, n: int, D: FloatArray, budget: float, size: float, round_off: float) -> float:
    """The part of displacements D (k, 3) that is taken. Contacts that contradict one another give displacements without
    bound. What closing joints costs is known only once it is done, so that there is no
    `..contacts.correction.part_for`: it has the other half of the budget."""
    cost, part = -work_of_forces(isle.ACC, isle.IM, isle.II, n, D), admissible(D, isle.EXTENT, n, size)
    return 0.5 * budget / cost if cost * part > max(0.5 * budget, round_off * part) else part


@kernel
def close_displaced(
    A: Scene, J: Joints, interval: Interval, D: FloatArray, NEW: FloatArray, STORED: FloatArray
) -> float:  # fmt: skip
    """Close the joints of the components that displacements D (k, 3) have moved to poses NEW (k, 3). Returns what
    springs gain by that, the sum of STORED, its value for each group."""
    isle, groups, _, motion, _, _, _, t, h, _ = interval
    gained = 0.0
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        moves = 0.0
        for w in range(groups.FIRST[g], groups.FIRST[g + 1]):
            for c in range(3):
                moves = max(moves, abs(D[groups.BODY[w], c]))
        if s >= 0 and moves > 0.0:
            STORED[g] = close_at_poses(A, J, s, motion.END, NEW, motion.V, isle.IM, isle.II, t + h, h)
            gained += STORED[g]
    return gained


@kernel
def correct_overlaps(A: Scene, J: Joints, interval: Interval, L: FloatArray, budget: float) -> float:
    """Move the poses at the end of an island's motion out of each other, at a cost of at most `budget`, not at all if
    that is below 0; returns the cost.

    It is -m a.D for displacements D (`lift_along_joints`), rotations included, and the energy that springs gain; errors
    of second order are then closed. A free island keeps its centre of mass, and components in it that impulses L (m, 2)
    press on each other keep their angular momentum: their velocities at the end rotate by what the displacements have
    changed of it. Of displacements that cost too much JOINTED_CORRECTION_LESS is tried next.
    """
    isle, groups, ROWS, motion, _, m, n, t, h, _ = interval
    V, END = motion.V, motion.END
    GAPS, deepest = np.empty(m), 0.0
    for i in range(m):
        GAPS[i] = ROWS[i].gap + normal_rate(ROWS[i], motion.WAY)
        deepest = min(deepest, GAPS[i])
    size = least_of(isle.EXTENT, n)
    if deepest >= -left_to_lift(A, t + h) * size or not budget >= 0.0:
        return 0.0
    D = np.zeros_like(V)
    MU = lift_along_joints(A, J, interval, GAPS, D, joints.JOINTED_LIFT_ERROR * -deepest)
    free = is_free(isle, groups, n, J)
    # In an island that is not free no body is rotated.
    GROUP, NONE = pressing(interval, L, MU) if free else np.empty(0, np.int64), np.zeros(n)
    ONE, TURN = np.empty(n, np.uint8), np.zeros((n, 3))
    if free:
        for g in range(n):
            if mark_group(GROUP, g, ONE):
                keep_centre(D, isle.IM, ONE)
    FORCE = np.abs(isle.ACC)
    round_off = CORRECTION_ROUND_OFF * work_of_forces(FORCE, isle.IM, isle.II, n, np.abs(D))
    # The cost is that of differences of places.
    of_places = CORRECTION_ROUND_OFF * work_of_forces(FORCE, isle.IM, isle.II, n, np.abs(END))
    part = part_within(isle, n, D, budget, size, round_off)
    if lifts_through(A, isle, END, part * D, n, t + h):
        return 0.0
    STORED = np.zeros(len(groups.COMPONENT))
    for _ in range(joints.JOINTED_CORRECTION_TRIES):
        NEW = END + part * D
        spent = close_displaced(A, J, interval, D, NEW, STORED)
        spent -= work_of_forces(isle.ACC, isle.IM, isle.II, n, NEW - END)
        gained, square = unturn_groups(NEW, NEW - END, V, isle.IM, isle.II, GROUP, ONE, NONE, TURN)
        spent += gained + square
        if spent <= budget + round_off * part + of_places and math.isfinite(spent):
            turn_groups(NEW, GROUP, ONE, TURN, V, 0)
            for g in range(len(groups.COMPONENT)):
                s = groups.COMPONENT[g]
                if s >= 0:
                    J.STEPPED[s].stored += STORED[g]
            copy(END, NEW)
            return spent
        part *= joints.JOINTED_CORRECTION_LESS
    return 0.0

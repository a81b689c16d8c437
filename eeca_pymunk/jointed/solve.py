"""The interval of an island with joints: contacts, penetration correction, projection of velocities, paths."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..contacts.counts import note_unmet, spend
from ..contacts.geometry import gather_contacts
from ..contacts.interval import make_contacts, recall, speeds
from ..contacts.memory import remember_loads, shapes_of
from ..geometry.widths import depth_limit
from ..islands import local
from ..islands.candidates import pairs_within
from ..islands.membership import lossy
from ..model.contacts import JointedProblem
from ..model.joint_steps import FINAL, LONG, SHORT
from ..model.joints import Joints
from ..model.parameters.events import RESOLUTION
from ..model.parameters.intervals import INTERVAL_RETRY, INTERVAL_TRIES, REACH_ROUND_OFF, UNSOLVED_PART
from ..model.parameters.joints import COLUMN_CONTACTS, INTERVAL_SHARE, INTERVAL_WORK, SPACING
from ..model.scene import Scene
from ..model.step import AGAIN, CONTACTS, DONE, PUSHES_FULL, SPENT
from ..rows.bounded import room_for_rows
from ..rows.build import conserves, normal_rate
from ..rows.columns import breach
from ..rows.laws import give_slips, take_slips
from .advance import Interval, advance, motion_at_start
from .alone import account_turning, begin_alone, is_component, meets_no_other, set_path
from .columns import make_columns
from .contact_laws import few_act
from .correction import keep_angular_momentum, lift_island
from .fitting import project_velocities
from .gathered import restore_joints, save_joints, takes_shorter
from .groups import find_groups
from .iteration import solve_contacts
from .ledger import has_work_for, work_left
from .lengths import excess, forced_deeper, next_length, too_deep_on_way, within_sagitta
from .losses import slip_of
from .rest import rest_if_still
from .settling import GIVEN_UP, SOLVED


@kernel
def note_residual(A: Scene, interval: Interval, L: FloatArray, solved: bool, tolerance: float) -> None:
    """Report a contact that joints force deeper, with its velocities, present and allowed; else, if the laws of
    contacts, with Coulomb's friction alone (`take_slips`), are not `solved`, the velocity by which they are broken, if
    above `tolerance`. Joints hold in any case."""
    ROWS, h, z = interval.ROWS, interval.h, forced_deeper(A, interval)
    if z >= 0:
        a, b = shapes_of(A, ROWS[z])
        most = max(ROWS[z].gap + depth_limit(A, a, b), 0.0) / h
        note_unmet(A, CONTACTS, a, b, -normal_rate(ROWS[z], interval.motion.WAY) / h, most)
    elif not solved and interval.m > 0:
        SLIP, free = take_slips(ROWS, interval.m), room_for_rows(0, 0)
        residual = breach(JointedProblem(ROWS, interval.C, free, interval.m), L, interval.motion.MEAN)
        give_slips(ROWS, interval.m, SLIP)
        if not residual <= tolerance:
            a, b = shapes_of(A, ROWS[0])
            note_unmet(A, CONTACTS, a, b, residual, tolerance)


@kernel
def begin_jointed(A: Scene, J: Joints, root: int, t: float, h: float) -> int:
    """Begin an interval of an island with joints at instant t, the instant of all its bodies: of length h, or shorter
    if joints do not hold, contacts are not solved, work is short, or bodies move too far (`lengths`).

    A length that was too long is not tried again at once: the next interval is at most INTERVAL_RETRY times as long as
    one that was shortened, and else as long as its motion allows, at most INTERVAL_GROWTH times (`Rest.longest`).

    Returns DONE; PUSHES_FULL, with everything as before; or SPENT if the step has no work left, with only
    `Rest.longest` set.
    """
    rest, longest = A.RESTING[root], h
    # One as short as PAR.instant would be empty (`ends.end_here`).
    least = min(h, 2.0 * A.PAR.instant)
    # How a step was cut does not tell how short the intervals of the next one have to be.
    tried = h = min(h, rest.longest if t > 0.0 else max(rest.longest, h / RESOLUTION**2))
    spent = work_left(A, J) < 0.0
    for attempt in range(INTERVAL_TRIES):
        h = max(h, least)
        last = attempt + 1 == INTERVAL_TRIES or A.COUNT.together > 0 or h <= least or (spent and attempt > 0)
        if t > 0.0 and spent:
            rest.longest = max(h, tried / UNSOLVED_PART)  # with which the next step begins
            return SPENT
        left = work_left(A, J)
        status, then = try_jointed(A, J, root, t, h, last)
        if status != AGAIN:
            if status == DONE:
                longer = max(then if attempt == 0 else INTERVAL_RETRY * h, 0.0 if h < longest else rest.longest)
                i = root
                while i >= 0:
                    A.RESTING[i].longest = longer
                    i = A.MEMBER[i].following
                if t == 0.0 and h == longest:
                    rest_if_still(A, J, root)
            return status
        # Whether there is no work for another attempt, which takes a part of this one's, as it is solved more easily.
        spent = UNSOLVED_PART * work_left(A, J) < left - work_left(A, J)
        tried, h = h, min(then, h / RESOLUTION) if spent else then
    return DONE  # not reached: the last attempt is never AGAIN


@kernel
def excess_length(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, root: int, effort: float, solved: bool, last: bool
) -> float:
    """How many times too long the interval of an island is, whose motion under impulses L of its contacts took so much
    effort; also sets its `excess_left`. `iteration.solve_contacts` gives a long interval up before there is a motion,
    for what only its iterations show: components that are not stepped as a whole, or work that is spent.

    Args:
        solved: whether contacts are.  last: whether no other attempt follows, see `try_jointed`.
    """
    far = 0.0
    for s in interval.groups.JOINTED:
        if takes_shorter(A, J, s, interval.t, interval.h, effort):
            far = 2.0
    if last and solved:
        A.RESTING[root].excess_left = too_deep_on_way(A, interval)
        return far
    long = excess(A, interval, L)
    A.RESTING[root].excess_left, far = 0.0 if solved else long, max(far, long)
    if solved:
        return far
    # A motion that is no solution does not tell how long the interval may be. Contacts that are not solved in a long
    # interval may be in a short one, if the step has work for all of these.
    hard = interval.few and has_work_for(A, J, interval.t, interval.h, UNSOLVED_PART, effort)
    return UNSOLVED_PART if hard and J.PROGRESS.length == LONG else min(far, UNSOLVED_PART)


@kernel
def try_jointed(A: Scene, J: Joints, root: int, t: float, h: float, last: bool) -> tuple[int, float]:
    """`begin_jointed` for one length h. Returns DONE and the length that the next interval may have; or, with nothing
    done, PUSHES_FULL, or AGAIN and the length to try next, if h is too long and this is not the `last` attempt."""
    single, A.RESTING[root].excess_left = is_component(A, J, root), 0.0
    if single and meets_no_other(A, root):
        return begin_alone(A, J, root, t, h, last)
    COUNT = A.COUNT
    MINE = local.number_bodies(A, root)
    n = len(MINE)
    # All pairs within the step, also if the interval is shorter: others would not be searched for impacts.
    found = pairs_within(A, root, t, A.PAR.planned - t, lossy(A, root), MINE)
    p = len(found)
    spend(A, n, 2 * p, 0.0)  # besides what joints take
    J.PROGRESS.effort += INTERVAL_WORK * (p + 2)
    if p == 0 and single:
        local.clear_places(A, MINE)
        return begin_alone(A, J, root, t, h, last)
    shorter = within_sagitta(A, found, t)
    if shorter < h and not last:
        local.clear_places(A, MINE)
        return AGAIN, shorter
    if local.needs_memory(A, p):
        local.clear_places(A, MINE)
        return PUSHES_FULL, h
    isle = local.local_island(A, MINE, found, t)
    k = len(isle.WHO)
    groups = find_groups(isle.WHO, isle.IM, J, False)
    for s in groups.JOINTED:
        save_joints(J, s)
    contacts, EXPECTED = make_contacts(p, k), np.zeros(2 * p + 1)
    ROWS, L = contacts.ROWS, contacts.L
    motion, REACH = motion_at_start(isle, k), np.empty(k)
    slow, fast, pull = speeds(isle, n, h, REACH)
    for q in range(n):
        slow = max(slow, SPACING * REACH_ROUND_OFF * isle.EXTENT[q] / h)  # tolerances must not underflow
    fast = max(slow, fast)
    m = 0
    if p > 0:
        m = gather_contacts(A, isle, contacts, REACH, h, k == n)
    # Many near contacts of which few act are dear: roughly, once the work of the step is spent.
    few = m <= COLUMN_CONTACTS or (work_left(A, J) >= 0.0 and few_act(ROWS, isle.V, m, h, pull))
    interval = Interval(isle, groups, ROWS, motion, make_columns(groups, ROWS, m), m, n, t, h, few)
    outcome, before = SOLVED, J.PROGRESS.effort
    if not last:  # contacts of a short interval are solved more easily than those of components stepped in parts
        J.PROGRESS.length = LONG if m > 0 and h * UNSOLVED_PART**2 > A.PAR.dt / RESOLUTION else SHORT
    part = max(INTERVAL_SHARE, n / (A.BODY.shape[0] - 1)) if J.PROGRESS.length == LONG else INTERVAL_SHARE
    J.PROGRESS.share = before + part * max(work_left(A, J), 0.0)
    if m > 0:
        recall(A, ROWS, m, h, not interval.few, L, EXPECTED)
        owed = max(-A.RESTING[root].lost, 0.0)
        outcome = solve_contacts(A, J, interval, L, EXPECTED, slow, fast, pull, owed)
        if outcome == SOLVED or not interval.few:  # impulses of few contacts that are no solution are a bad guess
            remember_loads(A, ROWS, L, m, h)
    if m == 0:
        advance(A, J, interval, L, room_for_rows(0, 0), False, np.empty((0, 3)))
    COUNT.solves += 1
    COUNT.solved += n
    solved, far = outcome == SOLVED, UNSOLVED_PART
    if outcome != GIVEN_UP:
        far = excess_length(A, J, interval, L, root, J.PROGRESS.effort - before, solved, last)
    J.PROGRESS.length = FINAL
    if far > INTERVAL_RETRY and not last:
        for s in groups.JOINTED:
            restore_joints(J, s)
        local.clear_places(A, MINE)
        return AGAIN, h / far
    note_residual(A, interval, L, solved, J.PROGRESS.tolerance)
    for s in groups.JOINTED:
        J.STEPPED[s].turned_work = J.STEPPED[s].lifted = 0.0
    for q in range(n):
        s = groups.COMPONENT[groups.GROUP[q]]
        if s >= 0:
            account_turning(A, J, s, MINE[q], motion.END[q, 2], motion.WAY[q, 2])
    keep_angular_momentum(J, interval, L)
    # Corrected at the end of the interval: within a short one, paths would be steep.
    WHERE, HELD = motion.END.copy(), np.zeros(m)
    if not conserves(ROWS, m):
        lift_island(A, J, interval, L, root)
        HELD = project_velocities(A, J, interval, L, slow + pull * h)
    local.clear_places(A, MINE)
    first = COUNT.pushes
    local.open_interval(A, root, isle, contacts, motion.V, m, t, h)
    for z in range(m):
        pushed = A.PUSHED[first + z]
        pushed.un_before = pushed.un_after = normal_rate(ROWS[z], motion.WAY) / h
        pushed.ut_before = pushed.ut_after = slip_of(ROWS[z], motion.WAY, h) / h
        pushed.held = HELD[z]
    for q in range(n):
        set_path(A, MINE[q], h, WHERE[q], motion.END[q], motion.V[q])
    return DONE, next_length(h, far if solved or not interval.few else 1.0)

"""An interval that is tried (`solve.py`): its contacts are gathered, solved with the joints, and taken, with
penetration correction, projection of velocities and paths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..contacts.counts import note_unmet
from ..contacts.forces import remember_loads, shapes_of
from ..contacts.gathering import gather_contacts
from ..contacts.interval import make_contacts, recall, speeds
from ..geometry.widths import depth_limit
from ..islands import local
from ..islands.candidates import shortest_interval
from ..model.contacts import JointedProblem
from ..model.islands import IslandContacts
from ..model.joint_steps import FINAL, LONG, SHORT
from ..model.joints import Joints
from ..model.parameters.intervals import REACH_ROUND_OFF, UNSOLVED_PART
from ..model.parameters.joints import COLUMN_CONTACTS, INTERVAL_SHARE, LOSS_ROUND_OFF, SPACING
from ..model.scene import Scene
from ..model.step import CONTACTS
from ..rows.bounded import room_for_rows
from ..rows.build import conserves, normal_rate
from ..rows.columns import breach
from ..rows.laws import give_slips, take_slips
from .advance import Interval, advance, motion_at_start
from .alone import account_turning, set_path
from .columns import make_columns
from .contact_laws import few_act
from .correction import keep_angular_momentum, lift_island
from .gathered import save_joints, takes_shorter
from .groups import find_groups
from .iteration import solve_contacts
from .ledger import has_work_for, work_left
from .lengths import excess, forced_deeper, too_deep_on_way
from .losses import slip_of, work_error
from .projection import project_velocities
from .settling import GIVEN_UP, SOLVED


class Attempt(NamedTuple):
    """An interval that is tried: its contacts, and `speeds` of the island, the first two not below round-off."""

    interval: Interval
    contacts: IslandContacts
    slow: float
    fast: float
    pull: float


@kernel
def gather_attempt(A: Scene, J: Joints, MINE: IntArray, found: IntArray, t: float, h: float) -> Attempt:
    """The bodies MINE (n,), which have their places, from instant t on over a length h, with the contacts of the pairs
    `found`; joints are saved."""
    n, p = len(MINE), len(found)
    isle = local.local_island(A, MINE, found, t)
    k = len(isle.WHO)
    groups, contacts = find_groups(isle.WHO, isle.IM, J, False), make_contacts(p, k)
    for s in groups.JOINTED:
        save_joints(J, s)
    ROWS, motion, REACH = contacts.ROWS, motion_at_start(isle, k), np.empty(k)
    slow, fast, pull = speeds(isle, n, h, REACH)
    for q in range(n):
        slow = max(slow, SPACING * REACH_ROUND_OFF * isle.EXTENT[q] / h)  # tolerances must not underflow
    m = gather_contacts(A, isle, contacts, REACH, h, k == n) if p > 0 else 0
    # Many near contacts of which few act are dear: roughly, once the work of the step is spent.
    few = m <= COLUMN_CONTACTS or (work_left(A, J) >= 0.0 and few_act(ROWS, isle.V, m, h, pull))
    interval = Interval(isle, groups, ROWS, motion, make_columns(groups, ROWS, m), m, n, t, h, few)
    return Attempt(interval, contacts, slow, max(slow, fast), pull)


@kernel
def excess_length(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, root: int, effort: float, solved: bool, last: bool
) -> float:
    """How many times too long the interval of an island is, whose motion under impulses L of its contacts took so much
    effort; also sets its `excess_left`. `iteration.solve_contacts` gives a long interval up before there is a motion,
    for what only its iterations show: components that are not stepped as a whole, or work that is spent.

    Args:
        solved: whether contacts are.  last: whether no other attempt follows, see `solve.try_jointed`.
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
    return UNSOLVED_PART if hard and J.PROGRESS.attempt == LONG else min(far, UNSOLVED_PART)


@kernel
def solve_attempt(A: Scene, J: Joints, tried: Attempt, root: int, last: bool) -> tuple[bool, float]:
    """Solve contacts and joints of an attempt. Returns whether contacts are solved, and how many times the interval is
    too long (`excess_length`). last: see `solve.try_jointed`."""
    interval, progress, outcome, before = tried.interval, J.PROGRESS, SOLVED, J.PROGRESS.effort
    L, m, n, h = tried.contacts.L, interval.m, interval.n, interval.h
    if not last:
        # Contacts of a short interval, which could not be shortened twice, are solved more easily than those of
        # components stepped in parts.
        progress.attempt = LONG if m > 0 and h * UNSOLVED_PART**2 > shortest_interval(A) else SHORT
    part = max(INTERVAL_SHARE, n / (A.BODY.shape[0] - 1)) if progress.attempt == LONG else INTERVAL_SHARE
    progress.share = before + part * max(work_left(A, J), 0.0)
    if m > 0:
        EXPECTED = np.zeros(len(L))
        recall(A, interval.ROWS, m, h, not interval.few, L, EXPECTED)
        owed = max(-A.RESTING[root].lost, 0.0)
        outcome = solve_contacts(A, J, interval, L, EXPECTED, tried.slow, tried.fast, tried.pull, owed)
        if outcome == SOLVED or not interval.few:  # impulses of few contacts that are no solution are a bad guess
            remember_loads(A, interval.ROWS, L, m, h)
    if m == 0:
        advance(A, J, interval, L, room_for_rows(0, 0), False, np.empty((0, 3)))
    A.COUNT.solves += 1
    A.COUNT.solved += n
    solved, far = outcome == SOLVED, UNSOLVED_PART
    if outcome != GIVEN_UP:
        far = excess_length(A, J, interval, L, root, progress.effort - before, solved, last)
    progress.attempt = FINAL
    return solved, far


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
        residual = breach(JointedProblem(ROWS, interval.C, free, interval.m), L, interval.motion.EVEN)
        give_slips(ROWS, interval.m, SLIP)
        if not residual <= tolerance:
            a, b = shapes_of(A, ROWS[0])
            note_unmet(A, CONTACTS, a, b, residual, tolerance)


@kernel
def take_attempt(A: Scene, J: Joints, tried: Attempt, root: int, MINE: IntArray) -> None:
    """Let the bodies MINE go along an attempt that was solved: account spins, correct penetration, project velocities
    onto joints, and open the interval."""
    interval, contacts, first = tried.interval, tried.contacts, A.COUNT.pushes
    isle, groups, ROWS, motion, _, m, n, t, h, _ = interval
    for s in groups.JOINTED:
        J.STEPPED[s].turned_work = J.STEPPED[s].lifted = 0.0
    for q in range(n):
        s = groups.COMPONENT[groups.GROUP[q]]
        if s >= 0:
            account_turning(A, J, s, MINE[q], motion.END[q, 2], motion.WAY[q, 2])
    keep_angular_momentum(J, interval, contacts.L)
    # Corrected at the end of the interval: within a short one, paths would be steep.
    WHERE, HELD = motion.END.copy(), np.zeros(m)
    if not conserves(ROWS, m):
        lift_island(
            A, J, interval, contacts.L, root, work_error(interval, contacts.L, tried.slow, tried.pull, LOSS_ROUND_OFF)
        )
        HELD = project_velocities(A, J, interval, contacts.L, tried.slow + tried.pull * h)
    local.clear_places(A, MINE)
    local.open_interval(A, root, isle, contacts, motion.V, m, t, h)
    for z in range(m):
        pushed = A.PUSHED[first + z]
        pushed.un_before = pushed.un_after = normal_rate(ROWS[z], motion.WAY) / h
        pushed.ut_before = pushed.ut_after = slip_of(ROWS[z], motion.WAY, h) / h
        pushed.held = HELD[z]
    for q in range(n):
        set_path(A, MINE[q], h, WHERE[q], motion.END[q], motion.V[q])

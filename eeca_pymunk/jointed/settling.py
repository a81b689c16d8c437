"""What follows the iterations between the contacts and the components of an interval: impulses that are no solution are
replaced, arms and energies made exact."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import Bounded, JointedProblem
from ..model.joint_steps import LONG, Agreement
from ..model.joints import Joints
from ..model.parameters import joints
from ..model.scene import Scene
from ..rows.columns import push_columns
from ..rows.gentle import excessive, sweep_gently
from ..rows.inplace import copy
from .advance import Interval, advance, advance_aligned, align
from .bounded_rows import with_bounded
from .columns import count_operations, fill_unjointed, set_effective_masses, work_of_columns
from .gathered import some_give, some_taut
from .iterates import Iterates, difference, gives_up
from .losses import lock_jointed, work_error

GIVEN_UP, UNSOLVED, SOLVED = -1, 0, 1  # what becomes of the contacts of an interval


@kernel
def solve_gently(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool, top_speed: float, filled: bool
) -> None:
    """Impulses L (m, 2) by sweeps that begin at 0; none if these are excessive for bodies of the speed `top_speed`; and
    the motion under them. Columns are those about the motion without impulses; or, if they are `filled` and there is no
    work for others, about the present one, under L."""
    isle, groups, ROWS, _, C, m, n, _, _, _ = interval
    if not filled:
        L[:m] = 0.0
        advance(A, J, interval, L, B, True, np.empty((0, 3)))
        if free:
            align(interval)
    fill_unjointed(groups, C, ROWS, isle.IM, isle.II, m)
    set_effective_masses(groups, C, ROWS, m)
    V = interval.motion.EVEN.copy()
    push_columns(C, L, m, -1.0, V)
    L[:m] = 0.0
    BOTH = with_bounded(B, L, m)
    problem = JointedProblem(ROWS, C, B, m)
    sweep_gently(problem, BOTH, V)
    count_operations(J, C)
    for i in range(m):
        L[i, 0], L[i, 1] = BOTH[i, 0], BOTH[i, 1]
    advance(A, J, interval, L, B, False, np.empty((0, 3)))
    if excessive(L, m, isle.IM, n, top_speed):
        L[:] = 0.0
        advance(A, J, interval, L, B, False, np.empty((0, 3)))


@kernel
def settle(A: Scene, J: Joints, interval: Interval, X: Iterates, S: Agreement) -> int:
    """What `solve_contacts` returns, after these stages:

    1. Unless impulses are dropped below, components are stepped once more if iterations ended without agreement, or
       joints were only near (PROGRESS.near); under BEST if L agrees no better. Only what agrees counts as converged.
    2. A long interval that has not converged and has no work left is given up.
    3. Impulses that are excessive, and those of few contacts that have not converged, are replaced.
    4. The arms of contacts of a free island become those of the motion. After another motion their error `bent` is not
       known: infinite.
    5. The energy lock scales the impulses.
    """
    isle, groups, ROWS, motion, _, m, n, _, h, few = interval
    L, B, free, FORESEEN, near = X.L, X.B, X.free, X.FORESEEN, J.PROGRESS.near
    J.PROGRESS.near = 0.0
    # Impulses that will be replaced, or given up with the interval: their motion does not count.
    dropped = S.agreed == 0 and S.converged == 0 and (few or gives_up(J, 0.0))
    if not dropped and (S.agreed == 0 or near > 0.0):
        S.bent = np.inf if free else 0.0
        advance(A, J, interval, L, B, False, X.UNKNOWN)
    if not dropped and S.agreed == 0:
        off = difference(interval, FORESEEN)
        if not off <= S.least:
            copy(L, X.BEST)
            advance(A, J, interval, L, B, False, X.UNKNOWN)
        S.converged = int(S.converged > 0 and min(off, S.least) <= S.enough)
    if S.converged == 0 and gives_up(J, 0.0):
        return GIVEN_UP
    S.top_speed = S.fast + S.pull * h
    # Impulses that are no solution may let walls do any work.
    if excessive(L, m, isle.IM, n, S.top_speed) or (S.converged == 0 and few):
        if gives_up(J, work_of_columns(J, groups, ROWS, m)):
            return GIVEN_UP
        solve_gently(A, J, interval, L, B, free, S.top_speed, S.filled > 0)
        S.converged, S.bent = 0, np.inf if free else 0.0
    if S.bent > joints.ARM_ERROR:
        S.bent = advance_aligned(A, J, interval, L, B, free)
        if S.bent > joints.ARM_LEFT and J.PROGRESS.attempt == LONG:
            return GIVEN_UP  # contacts move less in a shorter interval
    # If joints pull hard, velocities, and so works, are only as exact as they agree.
    known = joints.LOSS_ROUND_OFF
    if some_give(J, groups) or some_taut(J, groups):
        known = max(known, min(2.0 * S.reached / (S.slow + S.pull * h), joints.LOSS_ROUND_OFF_TAUT))
    copy(FORESEEN, motion.EVEN)
    error = work_error(interval, L, S.slow, S.pull, known)
    S.bent = lock_jointed(A, J, interval, L, B, free, X.manner.elastic, S.owed, error, S.bent)
    J.PROGRESS.tolerance = joints.AGREE * S.scale
    agreed = difference(interval, FORESEEN) <= joints.LOCK_SHIFT * S.scale
    return SOLVED if S.converged > 0 and agreed and S.bent <= joints.ARM_LEFT else UNSOLVED

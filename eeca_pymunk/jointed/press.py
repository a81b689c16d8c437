"""Contacts of an island with joints in one bounded solve; joints are exact.

    M (v+ - v) = h M a + F_s + J^T Lam + G^T lam + T^T beta,    J, F_s the discrete rows of the joints,

contact rows at the predicted middle, as in `..contacts.geometry`. The impulses of contacts act on components as
constant forces over the interval. So joints, springs, limits and motors satisfy `..joints` to round-off even if the
contacts' solve is truncated, and a contact loses exactly -lam . (way of its row)/h. Impulses follow from Newton's
method in the space of contacts: components are stepped under the present impulses, their columns linearise them, and
the contacts' laws are solved with the columns, until the velocities of both agree.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..contacts.targets import target
from ..model.contacts import Bounded, JointedProblem
from ..model.joint_steps import LONG
from ..model.joints import Joints
from ..model.parameters import joints
from ..model.parameters.events import RESOLUTION
from ..model.scene import Scene
from ..rows.build import rates
from ..rows.columns import push_columns
from ..rows.gentle import excessive, sweep_gently
from ..rows.inplace import copy
from ..rows.laws import give_slips, take_slips
from .advance import Interval, advance, advance_aligned, align, farthest_apart
from .bounded_rows import make_bounded, with_bounded
from .columns import count_operations, fill_unjointed, set_effective_masses, work_of_columns
from .gathered import some_give, some_refused, some_taut
from .groups import is_free
from .losses import lock_jointed, lost, scale_of_loss, without_contacts, work_error
from .press_laws import aims, manner_of, solve_laws
from .secant import fit_columns

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
    V = interval.motion.MEAN.copy()
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
def accelerations(interval: Interval, L: FloatArray, B: Bounded) -> tuple[FloatArray, float]:
    """Accelerations (k, 3) of the bodies without contacts: those of the motion, less the effect of its impulses L by
    the columns; and the largest of any point."""
    EFFECT = (without_contacts(interval, L, B) - interval.isle.V) / interval.h
    return EFFECT, farthest_apart(EFFECT, np.zeros_like(EFFECT), interval.isle.EXTENT, interval.n)


@nonallocating
def gives_up(J: Joints, more: float) -> bool:
    """Whether a long interval that is not solved is given up, as it has no work for `more` operations."""
    return bool(J.PROGRESS.length == LONG and J.PROGRESS.effort + more >= J.PROGRESS.share)


@kernel
def solve_contacts(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, EXPECTED: FloatArray, slow: float, fast: float, pull: float,
    owed: float,
) -> int:  # fmt: skip
    """Impulses L (in: guesses) of the m contacts of an island, and the motion under them. Returns SOLVED if they have
    converged, else UNSOLVED, or GIVEN_UP without a result.

    Each iteration steps the components under L, and ends if their velocities agree with FORESEEN, those that the
    contacts' laws gave before; else it solves these laws with the columns, for L and FORESEEN. Columns are computed
    again in every CHORD-th iteration, else updated (`secant`). A long interval (PROGRESS.length) is given up where a
    component gives way or is not stepped as a whole; of many contacts only if the step has work for many shorter
    intervals; and where contacts have not converged when its work is spent, or is for what replaces their impulses.
    Iterations end in five ways:

    | because | `agreed` | `converged` | impulses |
    |---|---|---|---|
    | contacts and components agree, and contacts gain no energy | yes | yes | L |
    | of many contacts, the laws' residual is larger than their difference | yes | as the laws' last solution | L |
    | the laws' last solution gives the present motion | yes | as that solution | USED, those of this motion |
    | iterations or work are used up | no | as that solution, if it agrees | L, or LEAST if these agreed better |
    | of few contacts, work is used up by the step of the components | no | no | as below |
    | of few contacts, CHORD iterations have come no nearer, or nowhere near | no | likewise | likewise |

    What comes no nearer agrees at `enough`: near rest velocities have to agree better, but less is a solution, too.
    Where the exact solution of the first iteration is excessive, sweeps take its place (`rough`), and iterations go on.
    Impulses that are excessive in the end, or not converged, are replaced (`solve_gently`). The lock is last.

    Args:
        slow, fast, pull: see `..contacts.interval.speeds`.  owed: energy >= 0 that the island has to lose at least.
        interval: out, the columns of the contacts in their last solution.
    """
    isle, groups, ROWS, motion, C, m, n, _, h, few = interval
    fill_unjointed(groups, C, ROWS, isle.IM, isle.II, m)
    rates(ROWS, isle.V, m)
    SLIP, limited, top_speed, manner = take_slips(ROWS, m), False, fast + pull * h, manner_of(A, interval)
    elastic, exactly = manner.elastic, manner.exactly
    scale, agree, enough, fine = aims(pull * h, slow, fast, elastic)
    # While many contacts have not converged, joints need not be exact before the last step of the components.
    J.PROGRESS.near = 0.0 if exactly or slow < pull * h else joints.JOINTS_NEAR
    # off: difference between the velocities of contacts and components, best: its smallest value since contacts last
    # gained energy (in iteration `better`), reached: of all; worst, rough: see `solve_laws`; bent: error of the arms;
    # limited: friction is limited by energy; filled: columns are those of the motion with which iterations end.
    VELOCITIES, k = np.empty((2 * len(isle.IM), 3)), len(isle.IM)
    PREVIOUS, FORESEEN, UNKNOWN = VELOCITIES[:k], VELOCITIES[k:], VELOCITIES[:0]
    converged, best, worst, LEAST, USED, agreed, filled = False, np.inf, 0.0, L.copy(), L.copy(), False, False
    better, bent, rough, reached, B = 0, 0.0, False, np.inf, make_bounded(J, groups, few)
    NOW = np.empty(len(B.OF))
    problem = JointedProblem(ROWS, C, B, m)
    free, begun = is_free(isle, groups, n, J), J.PROGRESS.effort
    before = begun
    for outer in range(manner.rounds):
        # Few contacts are solved gently without work, many at least once, but in long intervals.
        taken, before = J.PROGRESS.effort - before, J.PROGRESS.effort
        if before + taken >= J.PROGRESS.share and (few or outer > 0 or J.PROGRESS.length == LONG):
            if not converged and gives_up(J, taken):
                J.PROGRESS.near = 0.0
                return GIVEN_UP
            break
        J.PROGRESS.effort += joints.CONTACT_WORK * (m + 2)
        build = outer % joints.CHORD == 0
        advance(A, J, interval, L, B, build, FORESEEN if outer > 0 else UNKNOWN)
        payable = RESOLUTION * (J.PROGRESS.effort - begun) <= J.PROGRESS.budget  # many shorter intervals
        if J.PROGRESS.length == LONG and (exactly or payable) and some_refused(J, groups):
            J.PROGRESS.near = 0.0
            return GIVEN_UP
        bent = align(interval) if free else 0.0
        if outer > 0:
            off = farthest_apart(motion.MEAN, FORESEEN, isle.EXTENT, n)
            reached = min(reached, off)
            stalls = off > joints.OUTER_PROGRESS * best
            if (off <= agree and not (rough and worst > fine)) or (off <= enough and stalls):
                # Velocities agree, but contacts may gain energy by them: no more than the lock may take at the end.
                error = work_error(interval, L, slow, pull, joints.PRESS_WORK_ROUND_OFF)
                more = owed - lost(interval, L)
                pays = elastic or more <= error
                if exactly and not pays:
                    pays = scale_of_loss(interval, L, B, more)[1] <= joints.LOCK_SHIFT * scale
                if pays or (stalls and limited):
                    converged, agreed = True, True
                    break
                give_slips(ROWS, m, SLIP)
                limited, best = True, np.inf
            if not exactly and off <= worst:
                # The residual of the laws is larger: further iterations would agree less.
                agreed = True
                break
            if off < best:
                best, better = off, outer
                copy(LEAST, L)
            if exactly and outer >= joints.CHORD and (off > scale or outer - better > joints.CHORD):
                break  # new columns have not helped either
        if not build and not fit_columns(interval, B, L, USED, NOW, PREVIOUS):
            advance(A, J, interval, L, B, True, FORESEEN)
            build = True
        if build and free:
            fill_unjointed(groups, C, ROWS, isle.IM, isle.II, m)
        if outer == 0:
            EFFECT, most_pull = accelerations(interval, L, B)
            if most_pull * h > joints.GUESS_SPEED * top_speed and L.any():
                L[:] = 0.0
                # The guess is bad: the bodies do not move as the columns say.
                advance(A, J, interval, L, B, True, UNKNOWN)
                EFFECT, most_pull = accelerations(interval, L, B)
            # Springs and motors accelerate bodies, too.
            pull = max(pull, most_pull)
        if few and J.PROGRESS.effort > J.PROGRESS.share:
            converged, filled = False, outer == 0
            break
        set_effective_masses(groups, C, ROWS, m)
        if outer == 0:
            scale, agree, enough, fine = aims(pull * h, slow, fast, elastic)
            target(ROWS, m, EFFECT, EXPECTED, pull, h)
        copy(PREVIOUS, motion.MEAN)
        copy(USED, L)
        for i in range(B.USED[0]):
            NOW[i] = B.ROWS[i].now
        sweeps = joints.COLUMN_SWEEPS if build else 0
        worst, rough = solve_laws(
            A, J, interval, problem, manner, L, FORESEEN, scale, fine, top_speed, sweeps, outer == 0
        )  # fmt: skip
        converged = worst <= 10.0 * enough
        if farthest_apart(motion.MEAN, FORESEEN, isle.EXTENT, n) <= 1e-3 * agree:
            # The motion is that of USED: others have the same effect by the columns, but perhaps not in a step.
            copy(L, USED)
            agreed = True
            break
    give_slips(ROWS, m, SLIP)
    near, J.PROGRESS.near = J.PROGRESS.near, 0.0
    # What is not solved is solved gently, or given up: the motion does not count.
    gentle = not (agreed or converged) and (few or gives_up(J, 0.0))
    if not gentle and (not agreed or near > 0.0):
        bent = np.inf if free else 0.0
        advance(A, J, interval, L, B, False, UNKNOWN)
    if not gentle and not agreed:
        off = farthest_apart(motion.MEAN, FORESEEN, isle.EXTENT, n)
        if not off <= best:
            copy(L, LEAST)
            advance(A, J, interval, L, B, False, UNKNOWN)
        converged = converged and min(off, best) <= enough
    if not converged and gives_up(J, 0.0):
        return GIVEN_UP
    # Impulses that are no solution may let walls do any work.
    top_speed = fast + pull * h
    if excessive(L, m, isle.IM, n, top_speed) or (not converged and few):
        if gives_up(J, work_of_columns(J, groups, ROWS, m)):
            return GIVEN_UP
        solve_gently(A, J, interval, L, B, free, top_speed, filled)
        converged, bent = False, np.inf if free else 0.0
    if bent > joints.ARM_ERROR:
        bent = advance_aligned(A, J, interval, L, B, free)
        if bent > joints.ARM_LEFT and J.PROGRESS.length == LONG:
            return GIVEN_UP  # contacts move less in a shorter interval
    # If joints pull hard, velocities, and so works, are only as exact as they agree.
    known = joints.PRESS_WORK_ROUND_OFF
    if some_give(J, groups) or some_taut(J, groups):
        known = max(known, min(2.0 * reached / (slow + pull * h), joints.PRESS_WORK_TAUT))
    copy(FORESEEN, motion.MEAN)
    lock_jointed(A, J, interval, L, B, free, elastic, owed, work_error(interval, L, slow, pull, known))
    J.PROGRESS.tolerance = joints.AGREE * scale
    agreed = farthest_apart(motion.MEAN, FORESEEN, isle.EXTENT, n) <= joints.LOCK_SHIFT * scale
    return SOLVED if converged and agreed and bent <= joints.ARM_LEFT else UNSOLVED

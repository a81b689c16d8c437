"""Contacts of an island with joints in one bounded solve; joints are exact.

    M (v+ - v) = h M a + F_s + J^T Lam + G^T lam + T^T beta,    J, F_s the discrete rows of the joints,

contact rows at the predicted middle, as in `..contacts.gathering`. The impulses of contacts act on components as
constant forces over the interval. So joints, springs, limits and motors satisfy `..joints` to round-off even if the
contacts' solve is truncated, and a contact loses exactly -lam . (way of its row)/h. Impulses follow from Newton's
method in the space of contacts: components are stepped under the present impulses, their columns linearise them, and
the contacts' laws are solved with the columns, until the velocities of both agree.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..contacts.targets import target
from ..model.contacts import Bounded
from ..model.joint_steps import LONG, Agreement
from ..model.joints import Joints
from ..model.parameters import joints
from ..model.scene import Scene
from ..newton.effort import pays_for_many
from ..rows.build import rates
from ..rows.inplace import copy
from ..rows.laws import give_slips
from .advance import Interval, advance, align, farthest_apart
from .broyden import update_columns
from .columns import fill_unjointed, set_effective_masses
from .contact_laws import set_aims, solve_laws
from .gathered import some_refused
from .iterates import Iterates, begin_agreement, begin_iterates, difference, gives_up
from .losses import lost, scale_of_loss, without_contacts, work_error
from .settling import GIVEN_UP, settle


@kernel
def accelerations(interval: Interval, L: FloatArray, B: Bounded) -> tuple[FloatArray, float]:
    """Accelerations (k, 3) of the bodies without contacts: those of the motion, less the effect of its impulses L by
    the columns; and the largest of any point."""
    EFFECT = (without_contacts(interval, L, B) - interval.isle.V) / interval.h
    return EFFECT, farthest_apart(EFFECT, np.zeros_like(EFFECT), interval.isle.EXTENT, interval.n)


@kernel
def accelerations_of_joints(A: Scene, J: Joints, interval: Interval, X: Iterates, S: Agreement) -> FloatArray:
    """`accelerations` after the first motion: springs and motors accelerate bodies, too. The guess is dropped if bodies
    would, by the columns, be faster than GUESS_SPEED times `top_speed` without it."""
    EFFECT, most = accelerations(interval, X.L, X.B)
    if most * interval.h > joints.GUESS_SPEED * S.top_speed and X.L.any():
        X.L[:] = 0.0
        advance(A, J, interval, X.L, X.B, True, X.UNKNOWN)
        EFFECT, most = accelerations(interval, X.L, X.B)
    S.pull = max(S.pull, most)
    return EFFECT


@kernel
def end_iterations(interval: Interval, X: Iterates, S: Agreement, outer: int) -> bool:
    """Whether iterations end at motion number `outer` > 0, by the difference from FORESEEN; see `solve_contacts`."""
    exactly, enough, off = X.manner.exactly, S.enough, difference(interval, X.FORESEEN)
    S.reached = min(S.reached, off)
    stalls = off > joints.OUTER_PROGRESS * S.least
    if (off <= S.agree and not (S.rough > 0 and S.residual > S.fine)) or (off <= enough and stalls):
        # Velocities agree, but contacts may gain energy by them: no more than the lock may take at the end.
        error = work_error(interval, X.L, S.slow, S.pull, joints.LOSS_ROUND_OFF)
        more = S.owed - lost(interval, X.L)
        pays = X.manner.elastic or more <= error
        if exactly and not pays:
            pays = scale_of_loss(interval, X.L, X.B, more)[1] <= joints.LOCK_SHIFT * S.scale
        if pays or (stalls and S.limited > 0):
            S.converged = S.agreed = 1
            return True
        give_slips(interval.ROWS, interval.m, X.SLIP)
        S.limited, S.least = 1, np.inf
    if not exactly and off <= S.residual:
        S.agreed = 1  # further iterations would agree less
        return True
    if off < S.least:
        S.least, S.of_least = off, outer
        copy(X.BEST, X.L)
    # New columns have not helped either.
    return exactly and outer >= joints.CHORD and (off > S.scale or outer - S.of_least > joints.CHORD)


@kernel
def iterate(A: Scene, J: Joints, interval: Interval, X: Iterates, S: Agreement, EXPECTED: FloatArray) -> bool:
    """Iterate until contacts and components agree, or as `solve_contacts` says; False if the interval is given up."""
    isle, groups, ROWS, motion, C, m, _, _, h, few = interval
    begun = before = J.PROGRESS.effort
    for outer in range(X.manner.rounds):
        # Few contacts are solved gently without work, many at least once, but in long intervals.
        taken, before = J.PROGRESS.effort - before, J.PROGRESS.effort
        if before + taken >= J.PROGRESS.share and (few or outer > 0 or J.PROGRESS.attempt == LONG):
            return S.converged > 0 or not gives_up(J, taken)
        J.PROGRESS.effort += joints.CONTACT_WORK * (m + 2)
        build = outer % joints.CHORD == 0
        advance(A, J, interval, X.L, X.B, build, X.FORESEEN if outer > 0 else X.UNKNOWN)
        shortens = X.manner.exactly or pays_for_many(J.PROGRESS, begun)
        if J.PROGRESS.attempt == LONG and shortens and some_refused(J, groups):
            return False
        S.bent = align(interval) if X.free else 0.0
        if outer > 0 and end_iterations(interval, X, S, outer):
            return True
        if not build and not update_columns(interval, X.B, X.L, X.USED, X.NOW, X.BEFORE):
            advance(A, J, interval, X.L, X.B, True, X.FORESEEN)
            build = True
        if build and X.free:
            fill_unjointed(groups, C, ROWS, isle.IM, isle.II, m)
        if outer == 0:
            EFFECT = accelerations_of_joints(A, J, interval, X, S)
        if few and J.PROGRESS.effort > J.PROGRESS.share:
            S.converged, S.filled = 0, int(outer == 0)
            return True
        set_effective_masses(groups, C, ROWS, m)
        if outer == 0:
            set_aims(S, h, X.manner.elastic)
            target(ROWS, m, EFFECT, EXPECTED, S.pull, h)
        copy(X.BEFORE, motion.EVEN)
        copy(X.USED, X.L)
        for i in range(X.B.NUMBER[0]):
            X.NOW[i] = X.B.ROWS[i].now
        sweeps = joints.COLUMN_SWEEPS if build else 0
        solve_laws(A, J, interval, X.B, X.manner, X.L, X.FORESEEN, S, sweeps, outer == 0)
        if difference(interval, X.FORESEEN) <= joints.OUTER_STANDS * S.agree:
            # The motion is that of USED: others have the same effect by the columns, but perhaps not in a step.
            copy(X.L, X.USED)
            S.agreed = 1
            return True
    return True


@kernel
def solve_contacts(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, EXPECTED: FloatArray, slow: float, fast: float, pull: float,
    owed: float,
) -> int:  # fmt: skip
    """Impulses L (in: guesses) of the m contacts of an island, and the motion under them. Returns SOLVED if they have
    converged, else UNSOLVED, or GIVEN_UP without a result.

    Each iteration steps the components under L, and ends if their velocities agree with FORESEEN, those that the
    contacts' laws gave before; else it solves these laws with the columns, for L and FORESEEN. Columns are computed
    again in every CHORD-th iteration, else updated (`broyden`). Solutions are *exact* if contacts are few or elastic
    (`Manner`). A long interval (PROGRESS.attempt) is given up where a component gives way or is not stepped as a whole,
    if solutions are not exact only if the step has work for many shorter intervals; and where contacts have not
    converged when its work is spent, or is for what replaces their impulses. Iterations end in six ways:

    | because | `agreed` | `converged` | impulses |
    |---|---|---|---|
    | contacts and components agree, and the lock can take what contacts gain | yes | yes | L |
    | the same, but contacts gain more, friction is limited already, and the difference stalls | yes | yes | L |
    | not exact: the laws' residual is larger than the difference | yes | as the laws' last solution | L |
    | the laws' last solution gives the present motion | yes | as that solution | USED, those of this motion |
    | work or iterations are used up, or exact ones come no nearer | no | as that solution, if it agrees | L or BEST |
    | few contacts: work is used up by the step of the components | no | no | those of `solve_gently` |

    Exact ones come no nearer after CHORD iterations that have not, or that are more than `scale` apart. BEST takes the
    place of L if it agreed better. What comes no nearer agrees at `enough`: near rest velocities have to agree better,
    but less is a solution, too. Where the exact solution of the first iteration is excessive, sweeps take its place
    (`rough`), and iterations go on. Impulses that are excessive in the end are replaced (`solve_gently`), and those of
    few contacts that have not converged; those of many are kept. The lock is last.

    Args:
        slow, fast, pull: see `..contacts.interval.speeds`.  owed: energy >= 0 that the island has to lose at least.
        interval: out, the columns of the contacts in their last solution.
    """
    isle, S = interval.isle, J.AGREEMENT
    fill_unjointed(interval.groups, interval.C, interval.ROWS, isle.IM, isle.II, interval.m)
    rates(interval.ROWS, isle.V, interval.m)
    X = begin_iterates(A, J, interval, L)
    begin_agreement(S, slow, fast, pull, owed, interval.h)
    set_aims(S, interval.h, X.manner.elastic)
    # While many contacts have not converged, joints need not be exact before the last step of the components.
    J.PROGRESS.near = 0.0 if X.manner.exactly or slow < pull * interval.h else joints.JOINTS_NEAR
    if iterate(A, J, interval, X, S, EXPECTED):
        give_slips(interval.ROWS, interval.m, X.SLIP)
        return settle(A, J, interval, X, S)
    J.PROGRESS.near = 0.0
    return GIVEN_UP

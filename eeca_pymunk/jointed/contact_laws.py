"""How the contacts of an island with joints are solved, and one solution of their laws, with the columns of components
(`iteration` alternates between these and steps of the components)."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..contacts.correction import stop_at_walls
from ..islands.candidates import before_end, sweeps_of
from ..model.contacts import Bounded, JointedProblem, Row
from ..model.joint_steps import Agreement
from ..model.joints import Joints
from ..model.parameters import joints
from ..model.parameters.impulses import WEDGED
from ..model.scene import Scene
from ..rows.build import conserves, normal_rate, rubs
from ..rows.columns import push_column
from ..rows.conjugate import sweep_conjugate
from ..rows.gentle import excessive
from ..rows.inplace import copy
from ..rows.laws import solve_columns, solve_wedged
from ..rows.sweeps import sweep
from .advance import Interval
from .bounded_rows import with_bounded
from .columns import count_operations


class Manner(NamedTuple):
    """How contacts are solved: `exactly`, to round-off, or roughly. Few (`Interval.few`) are solved by homotopies,
    exactly; others by sweeps, exactly if they are `elastic`, as none of them loses energy.

    rounds: steps of the components, at most.  sweeps: of one solution of the laws, at most.
    """

    elastic: bool
    exactly: bool
    rounds: int
    sweeps: int


@nonallocating
def few_act(ROWS: Rows[Row], V: FloatArray, m: int, h: float, pull: float) -> bool:
    """Whether at most COLUMN_CONTACTS of m contacts may act: gaps that would close in h, g + h (u_n - |a| h) <= 0, from
    velocities V (k, 3) with an acceleration `pull`, |a|. Homotopies take no pivots for the others."""
    number = 0
    for i in range(m):
        if ROWS[i].gap + h * (normal_rate(ROWS[i], V) - pull * h) <= 0.0:
            number += 1
    return number <= joints.COLUMN_CONTACTS


@nonallocating
def manner_of(A: Scene, interval: Interval) -> Manner:
    """How the contacts of an interval are solved."""
    elastic = conserves(interval.ROWS, interval.m)
    if elastic:
        return Manner(True, True, joints.OUTER, joints.LAWS_SWEEPS_ELASTIC)
    if interval.few:
        return Manner(False, True, joints.OUTER, joints.LAWS_SWEEPS_FEW)
    rounds = joints.OUTER_PART if before_end(A, interval.t + interval.h) else joints.OUTER_MANY
    return Manner(False, False, rounds, sweeps_of(interval.n, interval.t))


@nonallocating
def set_aims(S: Agreement, h: float, elastic: bool) -> None:
    """Set `scale` |a| h + speed, and the tolerances in it: `agree`, the difference between the velocities of contacts
    and components at which iterations end; `enough`, that at which contacts count as solved where iterations come no
    nearer; `fine`, the residual of the contacts' laws.

    Contacts that lose energy are measured by the mean speed, elastic ones, whose energy is exact, by the largest. Near
    rest, where the mean speed is a small part of what motors and springs alone would make of it, they are finer: what
    is left of velocities there is no motion."""
    change = S.pull * h
    if elastic:
        S.scale, agree, enough, fine = change + S.fast, joints.AGREE_ELASTIC, joints.OUTER_FLOOR, 1e-15
    elif S.slow < joints.NEAR_REST * change:
        S.scale, agree, enough, fine = change + S.slow, joints.AGREE_REST, joints.AGREE, joints.LAWS_RESIDUAL_REST
    else:
        S.scale, agree, enough, fine = change + S.slow, joints.AGREE, joints.AGREE, joints.LAWS_RESIDUAL
    S.agree, S.enough, S.fine = agree * S.scale, enough * S.scale, fine * S.scale


@kernel
def begin_laws(interval: Interval, problem: JointedProblem, L: FloatArray, FORESEEN: FloatArray) -> FloatArray:
    """The impulses with which a solution of the laws begins: L, without contacts that are left out, and those of the
    bounded rows. FORESEEN becomes the velocities by the columns under these."""
    copy(FORESEEN, interval.motion.EVEN)
    for i in range(interval.m):
        if interval.C.LEFT_OUT[i] != 0:
            push_column(interval.C, i, -L[i, 0], -L[i, 1], FORESEEN)
            L[i, 0] = L[i, 1] = 0.0
    return with_bounded(problem.B, L, interval.m)


@kernel
def solve_laws(
    A: Scene, J: Joints, interval: Interval, B: Bounded, manner: Manner, L: FloatArray, FORESEEN: FloatArray,
    S: Agreement, sweeps: int, first: bool,
) -> None:  # fmt: skip
    """Solve the laws of the contacts with the columns, from impulses L, which are replaced. FORESEEN: out, the
    velocities by the columns. If contacts are wedged (`solve_wedged`), their rows have no friction from then on, in
    this interval. Of S are set `residual`, that of the laws or the change of velocities in the last sweep; `converged`;
    and `rough`: whether the solution is by sweeps, as the exact one of the `first` motion has excessive impulses.

    Args:
        B: bounded rows.  sweeps: of few contacts before the first homotopy.
        first: whether this is the first solution of the interval.
    """
    m, C, USED, problem = interval.m, interval.C, L.copy(), JointedProblem(interval.ROWS, interval.C, B, interval.m)
    BOTH = begin_laws(interval, problem, L, FORESEEN)
    work = J.PROGRESS.share - J.PROGRESS.effort
    if interval.few:
        residual = solve_columns(problem, BOTH, FORESEEN, S.fine, sweeps, manner.sweeps, work)
        if residual > WEDGED * S.scale and rubs(interval.ROWS, m):
            residual = solve_wedged(problem, BOTH, FORESEEN, S.fine, manner.sweeps, work)
    else:
        residual = sweep_conjugate(problem, BOTH, FORESEEN, S.fine, manner.sweeps)[1]
    rough = first and manner.exactly and excessive(BOTH, m, interval.isle.IM, interval.n, S.top_speed)
    if rough:
        # Far from the solution laws may contradict one another, by as much as the columns are wrong.
        copy(L, USED)
        BOTH = begin_laws(interval, problem, L, FORESEEN)
        residual = sweep(problem, BOTH, FORESEEN)
        residual = sweep_conjugate(problem, BOTH, FORESEEN, joints.LAWS_ROUGH * residual, manner.sweeps)[1]
    if not manner.exactly:
        stop_at_walls(A, problem, interval.n, C.LEFT_OUT, BOTH, FORESEEN)
    count_operations(J, C)
    for i in range(m):
        L[i, 0], L[i, 1] = BOTH[i, 0], BOTH[i, 1]
    S.residual, S.rough, S.converged = residual, int(rough), int(residual <= joints.LAWS_SOLVED * S.enough)

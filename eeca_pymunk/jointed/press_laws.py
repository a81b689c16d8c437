"""How the contacts of an island with joints are solved, and one solution of their laws, with the columns of components
(`press` alternates between these and steps of the components)."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..contacts.correction import stop_at_walls
from ..islands.candidates import before_end, sweeps_of
from ..model.contacts import JointedProblem, Row
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
    """How contacts are solved: `exactly`, to round-off, if they are `elastic`, as none of them loses energy, or few
    (`few_act`), so that homotopies solve them; else roughly. rounds: steps of the components, at most. sweeps: of one
    solution of the laws, at most."""

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
        return Manner(True, True, joints.OUTER, joints.PRESS_SWEEPS_ELASTIC)
    if interval.few:
        return Manner(False, True, joints.OUTER, joints.PRESS_SWEEPS_FEW)
    rounds = joints.OUTER_PART if before_end(A, interval.t + interval.h) else joints.OUTER_MANY
    return Manner(False, False, rounds, sweeps_of(interval.n, interval.t))


@nonallocating
def aims(change: float, slow: float, fast: float, elastic: bool) -> tuple[float, float, float, float]:
    """Four tolerances of the iterations, each a velocity: the unit of errors; the difference between the velocities of
    contacts and components at which iterations end; that at which contacts count as solved where iterations come no
    nearer; the residual of the contacts' laws. change: |a| h.  slow, fast: speeds of the island."""
    if elastic:
        scale = change + fast
        return scale, joints.AGREE_ELASTIC * scale, joints.OUTER_FLOOR * scale, 1e-15 * scale
    scale, rests = change + slow, slow < change
    return (
        scale,
        (joints.AGREE_REST if rests else joints.AGREE) * scale,
        joints.AGREE * scale,
        (joints.PRESS_RESIDUAL_REST if rests else joints.PRESS_RESIDUAL) * scale,
    )


@kernel
def begin_laws(interval: Interval, problem: JointedProblem, L: FloatArray, FORESEEN: FloatArray) -> FloatArray:
    """The impulses with which a solution of the laws begins: L, without contacts that are left out, and those of the
    bounded rows. FORESEEN becomes the velocities by the columns under these."""
    copy(FORESEEN, interval.motion.MEAN)
    for i in range(interval.m):
        if interval.C.LEFT_OUT[i] != 0:
            push_column(interval.C, i, -L[i, 0], -L[i, 1], FORESEEN)
            L[i, 0] = L[i, 1] = 0.0
    return with_bounded(problem.D, L, interval.m)


@kernel
def solve_laws(
    A: Scene, J: Joints, interval: Interval, problem: JointedProblem, manner: Manner, L: FloatArray,
    FORESEEN: FloatArray, scale: float, fine: float, top_speed: float, sweeps: int, first: bool,
) -> tuple[float, bool]:  # fmt: skip
    """Solve the laws of the contacts with the columns, from impulses L, which are replaced. FORESEEN: out, the
    velocities by the columns.

    Args:
        scale, fine: see `aims`.  top_speed: the largest that contacts may explain.  sweeps: before the first homotopy.
        first: whether this is the first solution of the interval.

    Returns:
        the velocity by which laws are broken, or of a change in the last sweep; and whether the solution is rough, by
        sweeps, as the exact one of the `first` has excessive impulses.
    """
    m, C, USED = interval.m, interval.C, L.copy()
    BOTH = begin_laws(interval, problem, L, FORESEEN)
    work = J.PROGRESS.share - J.PROGRESS.effort
    if interval.few:
        worst = solve_columns(problem, BOTH, FORESEEN, fine, sweeps, manner.sweeps, work)
        if worst > WEDGED * scale and rubs(interval.ROWS, m):
            worst = solve_wedged(problem, BOTH, FORESEEN, fine, manner.sweeps, work)
    else:
        worst = sweep_conjugate(problem, BOTH, FORESEEN, fine, manner.sweeps)[1]
    rough = first and manner.exactly and excessive(BOTH, m, interval.isle.IM, interval.n, top_speed)
    if rough:
        # Far from the solution laws may contradict one another, by as much as the columns are wrong.
        copy(L, USED)
        BOTH = begin_laws(interval, problem, L, FORESEEN)
        worst = sweep(problem, BOTH, FORESEEN)
        worst = sweep_conjugate(problem, BOTH, FORESEEN, joints.LAWS_ROUGH * worst, manner.sweeps)[1]
    if not manner.exactly:
        stop_at_walls(A, problem, interval.n, C.LEFT_OUT, BOTH, FORESEEN)
    count_operations(J, C)
    for i in range(m):
        L[i, 0], L[i, 1] = BOTH[i, 0], BOTH[i, 1]
    return worst, rough

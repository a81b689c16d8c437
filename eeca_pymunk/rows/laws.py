"""The laws of few contacts to round-off: sweeps, and homotopies (`homotopy.py`) in turn.

Friction is that of Coulomb's law alone: with friction limited by energy (`coulomb.py`), which each contact applies by
itself, several contacts whose slips reverse more often have no solution together.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.contacts import JointedProblem, Problem, Row, Solved
from ..model.parameters import joints
from ..model.parameters.intervals import LARGE_ISLAND
from .active_set import divide_friction
from .bounded import inside_discs
from .columns import as_columns, breach
from .conjugate import sweep_conjugate
from .coulomb import drop_friction
from .homotopy import follow_homotopy
from .sweeps import push, restore_impulses, sweep, velocities


@nonallocating
def solved_exactly(n: int, m: int) -> bool:
    """Whether an interval of n bodies without joints has so few contacts, m, that homotopies may solve it."""
    return n < LARGE_ISLAND and m <= joints.COLUMN_CONTACTS


@kernel
def solve_columns(
    problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float, sweeps: int, most: int, work: float
) -> float:
    """Impulses L (m contacts, then the bounded rows) and velocities V: by homotopies and sweeps in turn, of which the
    best is kept, then by sweeps alone.

    Args:
        tolerance: velocity by which laws may be broken, or contacts change in a sweep.  sweeps: before a homotopy.
        most: sweeps where homotopies fail.  work: `Columns.WORK` from which on no homotopy begins.

    Returns:
        the largest velocity by which a law is broken, or of a change in the last sweep if that came last.
    """
    worst = sweep_conjugate(problem, L, V, tolerance, sweeps)[1] if sweeps > 0 else breach(problem, L, V)
    best, L0, V0, before, earlier = worst, L.copy(), V.copy(), np.inf, np.inf
    within = inside_discs(problem.B, L, problem.m)  # as long as impulses stay inside, discs are linear rows
    for _ in range(joints.COLUMN_HOMOTOPIES):
        if worst <= tolerance:
            return worst
        if problem.C.WORK[0] > work:
            break
        FREE = V.copy()
        push(problem, L, -1.0, FREE)
        divide_friction(problem.ROWS, L, problem.m)  # points that slip against each other have no common motion
        follows = follow_homotopy(problem, L, V, FREE, False, within)
        if within and not inside_discs(problem.B, L, problem.m):
            within = False
            restore_impulses(L, V, L0, V0)
            continue
        if not follows:
            L[:] = 0.0
            velocities(problem, L, FREE, V)
            if not follow_homotopy(problem, L, V, FREE, True, within):
                break
        # Homotopies have no rims of discs: sweeps, in turn with these.
        worst, done = breach(problem, L, V), 0
        while done < joints.COLUMN_SWEEPS_AFTER and worst > tolerance:
            worst = sweep(problem, L, V)
            done += 1
        if worst < best:
            best = worst
            restore_impulses(L0, V0, L, V)
        # Where laws have no solution, homotopies end in the same state again, or alternate between two.
        if min(abs(worst - before), abs(worst - earlier)) <= joints.COLUMN_REPEATED * worst:
            break
        before, earlier = worst, before
    if worst > tolerance:
        restore_impulses(L, V, L0, V0)
        before = breach(problem, L, V)
        _, worst = sweep_conjugate(problem, L, V, tolerance, most)
        if not breach(problem, L, V) <= joints.COLUMN_DIVERGES * before:
            # Sweeps diverge where friction could open contacts.
            restore_impulses(L, V, L0, V0)
            worst = before
    return worst


@kernel
def solve_wedged(
    problem: JointedProblem, L: FloatArray, V: FloatArray, tolerance: float, most: int, work: float
) -> float:
    """`solve_columns` without friction, from no impulses of contacts."""
    drop_friction(problem.ROWS, problem.m)
    push(problem, L, -1.0, V)
    L[: problem.m] = 0.0
    push(problem, L, 1.0, V)
    return solve_columns(problem, L, V, tolerance, joints.COLUMN_SWEEPS, most, work)


@kernel
def take_slips(ROWS: Rows[Row], m: int) -> FloatArray:
    """The slips (m,) of contacts before the interval, which are 0 in the rows from now on: friction is then Coulomb's
    alone, without the limit that each contact's own loss sets (`coulomb.py`)."""
    SLIP = np.empty(m)
    for i in range(m):
        SLIP[i] = ROWS[i].ut
        ROWS[i].ut = 0.0
    return SLIP


@nonallocating
def give_slips(ROWS: Rows[Row], m: int, SLIP: FloatArray) -> None:
    """Put the slips back that `take_slips` has taken."""
    for i in range(m):
        ROWS[i].ut = SLIP[i]


@kernel
def solve_few(problem: Problem, L: FloatArray, V: FloatArray, tolerance: float, out: Solved) -> float:
    """`solve_columns` of contacts of bodies without joints, whose sweeps and direct solutions have not converged, with
    Coulomb's law alone; the energy lock removes the energy that this may give."""
    SLIP, columns = take_slips(problem.ROWS, problem.m), as_columns(problem)
    worst = solve_columns(columns, L, V, tolerance, 0, joints.COLUMN_SWEEPS_AFTER, np.inf)
    out.operations += columns.C.WORK[0]
    give_slips(problem.ROWS, problem.m, SLIP)
    return worst

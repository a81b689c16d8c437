"""Simultaneous impacts: contacts that act at one instant because they share bodies or touch.

With b = -e u_n- where a contact approaches and -u_n- where it opens,

    0 <= lam  _|_  u_n+ - b >= 0,   friction as in `coulomb.py`,

so that without friction sum D = (1/2) sum lam (1 - e)(-u_n-) >= 0, and 0 for e = 1. Blocks without friction are
solved to round-off, as a truncated solve dissipates energy in large elastic islands; one scale of all impulses removes
the remaining error of the energy (`energy.lock`).
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.contacts import AnyProblem, Solved
from ..model.parameters import impulses
from ..model.parameters.impulses import DRIFT_SLIPS, DRIFT_STEADY
from ..model.parameters.intervals import DIRECT_MOVING, INTERVAL_RESIDUAL_SPEED, SMALL_SWEEPS
from .build import aim, conserves, largest_terms, normal_rate, rates, rubs
from .conjugate import sweep_conjugate
from .coulomb import drop_friction
from .direct import refine, refine_and_sweep
from .energy import lock, losses
from .sweeps import push, restore_impulses, sweep, velocities

CONVERGED, TRUNCATED = 0, 1  # statuses


@nonallocating
def sweeps_left(problem: AnyProblem, L: FloatArray, L0: FloatArray) -> float:
    """How many times D = L - L0 can be added to L (m, 2) until a contact opens, or one that sticks begins to slip;
    infinite if none does."""
    ROWS, left = problem.ROWS, math.inf
    for i in range(problem.m):
        lam, more, mu = L[i, 0], L[i, 0] - L0[i, 0], ROWS[i].friction
        if more < 0.0:
            left = min(left, -lam / more)
        for side in range(2 if mu > 0.0 else 0):
            sign = 1.0 - 2.0 * side
            room, change = mu * lam - sign * L[i, 1], mu * more - sign * (L[i, 1] - L0[i, 1])
            if change < 0.0 and room > DRIFT_SLIPS * mu * lam:
                left = min(left, -room / change)
    return left


@kernel
def skip_drift(problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, worst: float) -> float:
    """The end of a drift. Where rows of contacts depend on each other, sweeps may come to change the impulses by the
    same D each time, and the velocities not at all: every sweep leaves the same residual, until an impulse has come to
    0 or to its limit of friction, after s = |L| / |D| sweeps. These are taken at once, and a direct solve with the
    contacts that are left is exact.

    One sweep; if its residual is about that of the sweep before, `worst`, then s (`sweeps_left`) times its change D
    and another sweep, undone if that has a larger residual: D then was no drift. Returns the change of velocity in the
    last sweep."""
    L0 = L.copy()
    now = sweep(problem, L, V)
    if abs(now - worst) > DRIFT_STEADY * worst:
        return now
    left = sweeps_left(problem, L, L0)
    if not 1.0 < left < math.inf:
        return now
    L1, V1 = L.copy(), V.copy()
    for i in range(problem.m):
        L[i, 0] = max(L[i, 0] + left * (L[i, 0] - L0[i, 0]), 0.0)
        L[i, 1] += left * (L[i, 1] - L0[i, 1])
    velocities(problem, L, FREE, V)
    after = sweep(problem, L, V)
    if after > now:
        restore_impulses(L, V, L1, V1)
        return now
    return after


@nonallocating
def clear_report(out: Solved) -> None:
    """Reset the report of a solve."""
    out.restitution = out.friction = out.residual = out.tolerance = out.operations = 0.0
    out.sweeps = out.direct = out.at_rest = 0
    out.lock = 1.0


@kernel
def resolve(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, first: int, rounds: int, last: int,
    drifts: int, tolerance: float, OUT: Rows[Solved],
) -> float:  # fmt: skip
    """Impulses L (m, 2) and velocities V (k, 3) for given targets: up to `first` sweeps, `rounds` rounds of a direct
    solve and sweeps, `last` sweeps, and `drifts` times the end of a drift (`skip_drift`), a direct solve and `last`
    sweeps, until a sweep changes no velocity by more than `tolerance`. With `drifts` a round begins with the end of a
    drift too. Rounds also end after BLOCK_STALLS of them without progress. FREE (k, 3): velocities
    without impulses. Returns the change of velocity in the last sweep; OUT: numbers of sweeps and direct solves."""
    taken, worst = sweep_conjugate(problem, L, V, tolerance, first)
    OUT[0].sweeps = taken
    if worst <= tolerance:
        return worst
    least = worst
    stalled = 0
    log_R = impulses.AUGMENTATION
    for _ in range(rounds):
        if drifts > 0:
            worst = skip_drift(problem, L, V, FREE, worst)
            OUT[0].sweeps += 1
        log_R, worst, taken = refine_and_sweep(
            problem, L, V, FREE, log_R, impulses.REFINEMENTS_SPARSE, tolerance, worst, impulses.BLOCK_SWEEPS_AFTER
        )
        OUT[0].sweeps += taken
        OUT[0].direct += 1
        if worst <= tolerance:
            return worst
        if worst < impulses.BLOCK_PROGRESS * least:
            least = worst
            stalled = 0
        else:
            stalled += 1
            if stalled >= impulses.BLOCK_STALLS:
                break
    if last > 0:
        taken, worst = sweep_conjugate(problem, L, V, tolerance, last)
        OUT[0].sweeps += taken
    for _ in range(drifts):
        if worst <= tolerance:
            break
        worst = skip_drift(problem, L, V, FREE, worst)
        log_R, worst = refine(
            problem,
            L,
            V,
            FREE,
            impulses.AUGMENTATION,
            impulses.REFINEMENTS_SPARSE,
            impulses.DIRECT_RESIDUAL * tolerance,
            worst,
        )
        taken, worst = sweep_conjugate(problem, L, V, tolerance, last)
        OUT[0].sweeps += taken + 1
        OUT[0].direct += 1
    return worst


@nonallocating
def close_block(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, owed: float, exact: bool, OUT: Rows[Solved]
) -> None:  # fmt: skip
    """Lock the energy of impulses L, and report what they lose; V is computed from them again, without the round-off
    of many sweeps."""
    velocities(problem, L, FREE, V)
    OUT[0].lock = lock(problem, L, V, FREE, owed, exact)
    OUT[0].restitution, OUT[0].friction = losses(problem, L, V)


@kernel
def solve_block(problem: AnyProblem, L: FloatArray, V: FloatArray, owed: float, coarse: bool, OUT: Rows[Solved]) -> int:
    """Impulses of m contacts at one instant; V (k, 3) becomes the velocities after the impact.

    Args:
        problem: u_n, u_t and the targets of its rows are set here, from V and the elasticities; POSE is used for the
            order of elimination only.
        L: (m, 2) in: initial impulses (0 for none); out: the impulses.
        owed: energy >= 0 that the block has to lose at least.
        coarse: whether a large lossy block may be solved as coarsely as the intervals before and after it: a hit on a
            pile, or on many contacts of components, whose rows have an entry for each body.
        OUT: (1,) the report, out.

    Returns:
        CONVERGED (residual <= BLOCK_RESIDUAL of the largest b - u_n; with friction BLOCK_RESIDUAL_FRICTION; in large
            lossy islands INTERVAL_RESIDUAL_SPEED; or the round-off of the speeds, if that is more) or TRUNCATED. The
            energy balance holds in both cases.
    """
    ROWS, m = problem.ROWS, problem.m
    clear_report(OUT[0])
    rates(ROWS, V, m)
    speed = aim(ROWS, m)
    if not speed > 0.0:
        L[:] = 0.0
        return CONVERGED
    FREE = V.copy()
    push(problem, L, 1.0, V)
    rough = rubs(ROWS, m)
    floor = impulses.RATE_ROUND_OFF * largest_terms(ROWS, FREE, m)
    tolerance = max(speed * (impulses.BLOCK_RESIDUAL_FRICTION if rough else impulses.BLOCK_RESIDUAL), floor)
    exact = conserves(ROWS, m)
    # Direct solves help where contacts stick; where many slip only sweeps converge, so there are more of them.
    first, rounds = impulses.BLOCK_SWEEPS_FRICTION, impulses.BLOCK_DIRECT_FRICTION
    last, drifts = impulses.BLOCK_LAST_SWEEPS_FRICTION, impulses.DRIFTS
    if coarse and m > impulses.DENSE_CONTACTS and not exact:
        tolerance = max(INTERVAL_RESIDUAL_SPEED * speed, floor)
        first, rounds, last, drifts = SMALL_SWEEPS, DIRECT_MOVING, 0, 0
    elif not rough:
        first, rounds, last, drifts = impulses.BLOCK_SWEEPS, impulses.BLOCK_DIRECT, impulses.BLOCK_LAST_SWEEPS, 0
        if m <= impulses.SMALL_BLOCK:
            first = 4 * impulses.BLOCK_SWEEPS
    worst = resolve(problem, L, V, FREE, first, rounds, last, drifts, tolerance, OUT)
    OUT[0].residual, OUT[0].tolerance = worst, tolerance
    close_block(problem, L, V, FREE, owed, exact, OUT)
    return CONVERGED if worst <= tolerance else TRUNCATED


@kernel
def solve_frictionless(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, owed: float, status: int, coarse: bool,
    OUT: Rows[Solved],
) -> int:  # fmt: skip
    """`solve_block` again, without friction, where `solve_block` has left contacts with friction wedged (WEDGED):
    sweeps may end between two states without impulses, or the energy lock may leave none, so that what approaches would
    meet again at the same instant, without end. FREE (k, 3): velocities without impulses. Returns the status; L, V and
    OUT are those of the solution, OUT with the sweeps and direct solves of both. coarse: as of `solve_block`.
    """
    ROWS, m = problem.ROWS, problem.m
    if status == CONVERGED or not rubs(ROWS, m):
        return status
    worst = OUT[0].residual
    for i in range(m):
        worst = max(worst, ROWS[i].target - normal_rate(ROWS[i], V))
    if not worst > impulses.WEDGED * aim(ROWS, m):
        return status
    drop_friction(ROWS, m)
    L[:] = 0.0
    velocities(problem, L, FREE, V)
    sweeps, direct = OUT[0].sweeps, OUT[0].direct
    status = solve_block(problem, L, V, owed, coarse, OUT)
    OUT[0].sweeps += sweeps
    OUT[0].direct += direct
    return status

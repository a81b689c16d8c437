"""One round of a direct solve on the active contacts, and which part of its step is taken."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import Choice, kernel
from ..model.contacts import AnyProblem, JointedProblem
from ..model.parameters import impulses
from ..model.parameters.joints import COLUMN_CONTACTS
from .active_set import segment
from .dense import solve_dense
from .sparse import solve_sparse
from .sweeps import restore_impulses, sweep


@kernel
def solve_jointed(
    problem: JointedProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, R: float, passes: int, tolerance: float
) -> tuple[float, int]:
    """As `solve_sparse`: with response columns nothing is sparse, so the dense solve is used, whose work is that of the
    cube of the number of contacts: more than COLUMN_CONTACTS are left to sweeps, as in intervals."""
    if problem.m > COLUMN_CONTACTS:
        return np.inf, 0
    return solve_dense(problem, L, V, FREE, passes, tolerance, False)


solve_active = Choice(solve_sparse, solve_jointed)


@kernel
def refine(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, log_R: float, passes: int, tolerance: float,
    worst: float,
) -> tuple[float, float]:  # fmt: skip
    """Move L and V towards the direct solution on L's active contacts, by the part of the way that reduces the error.

    Args:
        FREE: (k, 3) velocities without impulses.  passes: refinements of the sparse solve at most.
        log_R: log10 of the augmentation of `solve_sparse`.  tolerance: velocity.  worst: change of velocity in the last
            sweep.

    Returns:
        log_R for the next round, and the change of velocity in a sweep after this one.
    """
    m = problem.m
    L0, V0 = L.copy(), V.copy()
    reached, clamped = np.inf, 0
    if m <= impulses.DENSE_CONTACTS:
        for attempt in range(2):
            # Friction that energy limits: first each contact by itself, then with the other contact of its face.
            if reached > impulses.DIRECT_SINGLE * worst:
                restore_impulses(L, V, L0, V0)
                reached, clamped = solve_dense(problem, L, V, FREE, impulses.REFINEMENTS, tolerance, attempt == 1)
    else:
        reached, clamped = solve_active(problem, L, V, FREE, 10.0**log_R, passes, tolerance)
    part = 1.0
    if not reached <= impulses.DIRECT_LOST * worst + tolerance:
        restore_impulses(L, V, L0, V0)
        part = 0.0
    elif clamped > 0:
        # With slip the solution minimises no energy: the residual of a sweep decides; without, `segment`.
        if m <= impulses.DENSE_CONTACTS:
            L1, V1 = L.copy(), V.copy()
            after = sweep(problem, L, V)
            if after < worst:
                return log_R, after
            restore_impulses(L, V, L1, V1)
        part = segment(problem, L, V, L0, V0)
    if part > impulses.AUGMENTATION_MORE:
        log_R = min(log_R + impulses.AUGMENTATION_STEP, impulses.AUGMENTATION)
    elif part < impulses.AUGMENTATION_LESS:
        log_R = max(log_R - impulses.AUGMENTATION_STEP, impulses.AUGMENTATION_LEAST)
    return log_R, sweep(problem, L, V)


@kernel
def refine_and_sweep(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, log_R: float, passes: int, tolerance: float,
    worst: float, most: int,
) -> tuple[float, float, int]:  # fmt: skip
    """A round of a solve: `refine`, and up to `most` sweeps until one changes no velocity by more than `tolerance`.
    Returns log_R for the next round, the change of velocity in the last sweep, and the number of sweeps, with that of
    `refine`."""
    log_R, worst = refine(problem, L, V, FREE, log_R, passes, impulses.DIRECT_RESIDUAL * tolerance, worst)
    sweeps = 1
    while sweeps <= most and worst > tolerance:
        worst = sweep(problem, L, V)
        sweeps += 1
    return log_R, worst, sweeps

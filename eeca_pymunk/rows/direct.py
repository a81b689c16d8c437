"""One round of a direct solution on the active contacts, and how far to go along it."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import Choice, kernel
from ..model.contacts import AnyProblem, JointedProblem
from ..model.parameters.impulses import AUGMENTATION, DENSE_CONTACTS, REFINEMENTS
from .dense import newton
from .polish import polish_free, segment
from .sweeps import keep, rows_of, sweep


@kernel
def polish_jointed(
    problem: JointedProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, R: float, passes: int, tolerance: float
) -> tuple[float, int]:
    """As `polish_free`: columns leave nothing sparse."""
    return newton(problem, L, V, FREE, passes, tolerance, False)


polish = Choice(polish_free, polish_jointed)


@kernel
def refine(
    problem: AnyProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, log_R: float, passes: int, tolerance: float,
    worst: float,
) -> tuple[float, float]:  # fmt: skip
    """Replace L and V by a direct solution on L's active contacts, the part of the way to it that is sensible.

    Args:
        log_R: log10 of the augmentation of `polish`.  tolerance: velocity.  worst: what the last sweep changed.
    Returns:
        log_R for the next round, and what a sweep after this one changed.
    """
    m = problem.m
    rows = rows_of(problem)
    L0 = np.empty((rows, 2))
    V0 = np.empty_like(V)
    keep(L, V, rows, L0, V0)
    reached = np.inf
    clamped = 0
    if m <= DENSE_CONTACTS:
        for attempt in range(2):
            # Friction that its energy limits: on its own, then together with other contacts of its face.
            if reached > 1e-3 * worst:
                keep(L0, V0, rows, L, V)
                reached, clamped = newton(problem, L, V, FREE, REFINEMENTS, tolerance, attempt == 1)
    else:
        reached, clamped = polish(problem, L, V, FREE, 10.0**log_R, passes, tolerance)
    part = 1.0
    if not reached <= 1e3 * worst + tolerance:
        keep(L0, V0, rows, L, V)
        part = 0.0
    elif clamped > 0:
        # Slip has no energy that is least at the answer: what a sweep leaves decides there, the energy elsewhere.
        if m <= DENSE_CONTACTS:
            L1 = np.empty((rows, 2))
            V1 = np.empty_like(V)
            keep(L, V, rows, L1, V1)
            after = sweep(problem, L, V)
            if after < worst:
                return log_R, after
            keep(L1, V1, rows, L, V)
        part = segment(problem, L, V, L0, V0)
    if part > 0.9:
        log_R = min(log_R + 2.0, AUGMENTATION)
    elif part < 0.3:
        log_R = max(log_R - 2.0, 2.0)
    return log_R, sweep(problem, L, V)

"""One round of a direct solution on the active contacts, and how far to go along it."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from .dense import newton
from .polish import polish, segment
from .sweeps import sweep

SMALL = 20  # contacts up to which an island's matrix is dense


@kernel
def refine(
    A: IntArray,
    B: IntArray,
    ROWS: FloatArray,
    L: FloatArray,
    V: FloatArray,
    FREE: FloatArray,
    IM: FloatArray,
    II: FloatArray,
    POSE: FloatArray,
    n: int,
    m: int,
    log_R: float,
    passes: int,
    tolerance: float,
    worst: float,
) -> tuple[float, float]:
    """Replace L and V by a direct solution on L's active contacts, the part of the way to it that is sensible.

    Args:
        log_R: log10 of the augmentation of `polish`.  tolerance: velocity.  worst: what the last sweep changed.
    Returns:
        log_R for the next round, and what a sweep after this one changed.
    """
    L0 = L[:m].copy()
    V0 = V.copy()
    if m <= SMALL:
        reached, clamped = newton(A, B, ROWS, L, V, FREE, IM, II, m, 4, tolerance, False)
        if reached > 1e-3 * worst:
            # Held by two contacts at different velocities, or by none.
            L[:m] = L0
            V[:] = V0
            reached, clamped = newton(A, B, ROWS, L, V, FREE, IM, II, m, 4, tolerance, True)
    else:
        reached, clamped = polish(A, B, ROWS, L, V, FREE, IM, II, POSE, n, m, 10.0**log_R, passes, tolerance)
    part = 1.0
    if not reached <= 1e3 * worst + tolerance:
        L[:m] = L0
        V[:] = V0
        part = 0.0
    elif clamped > 0:
        # Slip has no energy that is least at the answer: what a sweep leaves decides there, the energy elsewhere.
        if m <= SMALL:
            L1 = L[:m].copy()
            V1 = V.copy()
            after = sweep(A, B, ROWS, L, V, IM, II, m)
            if after < worst:
                return log_R, after
            L[:m] = L1
            V[:] = V1
        part = segment(A, B, ROWS, L, V, L0, V0, m)
    if part > 0.9:
        log_R = min(log_R + 2.0, 8.0)
    elif part < 0.3:
        log_R = max(log_R - 2.0, 2.0)
    return log_R, sweep(A, B, ROWS, L, V, IM, II, m)

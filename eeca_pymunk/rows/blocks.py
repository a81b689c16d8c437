"""Simultaneous impacts: contacts that act at one instant because they share bodies or touch.

With b = -e u_n- where a contact approaches and -u_n- where it opens,

    0 <= lam  _|_  u_n+ - b >= 0,   friction as in `sweeps.py`,

so that without friction sum D = (1/2) sum lam (1 - e)(-u_n-) >= 0, and 0 for e = 1. Solved to round-off, as the energy
of elastic crowds melts away otherwise; what is left of it is taken out by one scale of all impulses (`lock`).
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.impulses import (
    BLOCK_DIRECT,
    BLOCK_DIRECT_FRICTION,
    BLOCK_LAST_SWEEPS,
    BLOCK_LAST_SWEEPS_FRICTION,
    BLOCK_RESIDUAL,
    BLOCK_RESIDUAL_FRICTION,
    BLOCK_SWEEPS,
    BLOCK_SWEEPS_AFTER,
    BLOCK_SWEEPS_FRICTION,
    LARGE_BLOCK,
    LARGE_BLOCK_RESIDUAL,
    LARGE_BLOCK_SWEEPS,
    SMALL_BLOCK,
)
from .build import aim, conserves, rates, rubs
from .conjugate import iterate
from .direct import refine
from .energy import lock, works
from .sweeps import push, sweep, velocities

CONVERGED, TRUNCATED = 0, 1  # statuses
D_NORMAL, D_TANGENTIAL, SCALE_LOCK, OWED, RESIDUAL, SWEEPS, POLISHES, TOLERANCE = 0, 1, 2, 3, 4, 5, 6, 7  # of OUT
OUT_SIZE = 8


@kernel
def resolve(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, FREE: FloatArray, IM: FloatArray,
    II: FloatArray, POSE: FloatArray, n: int, m: int, rough: bool, tolerance: float, OUT: FloatArray,
) -> float:  # fmt: skip
    """Impulses for given targets; returns the change of velocity that a last sweep made.

    With friction direct solutions help where contacts stick; where many slip only sweeps converge: more of them.
    """
    most = BLOCK_SWEEPS_FRICTION if rough else (4 * BLOCK_SWEEPS if m <= SMALL_BLOCK else BLOCK_SWEEPS)
    taken, worst = iterate(A, B, ROWS, L, V, IM, II, m, tolerance, most)
    OUT[SWEEPS] = taken
    OUT[POLISHES] = 0.0
    if worst <= tolerance:
        return worst
    least = worst
    stalled = 0
    log_R = 8.0
    for _ in range(BLOCK_DIRECT_FRICTION if rough else BLOCK_DIRECT):
        log_R, worst = refine(A, B, ROWS, L, V, FREE, IM, II, POSE, n, m, log_R, 8, 0.1 * tolerance, worst)
        OUT[POLISHES] += 1.0
        for _ in range(BLOCK_SWEEPS_AFTER):
            OUT[SWEEPS] += 1.0
            if worst <= tolerance:
                return worst
            worst = sweep(A, B, ROWS, L, V, IM, II, m)
        if worst < 0.5 * least:
            least = worst
            stalled = 0
        else:
            stalled += 1
            if stalled >= 8:
                break
    taken, worst = iterate(
        A, B, ROWS, L, V, IM, II, m, tolerance, BLOCK_LAST_SWEEPS_FRICTION if rough else BLOCK_LAST_SWEEPS
    )
    OUT[SWEEPS] += taken
    return worst


@kernel
def solve_block(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray,
    POSE: FloatArray, n: int, m: int, owed: float, hasty: bool, LOSS: FloatArray, OUT: FloatArray,
) -> int:  # fmt: skip
    """Impulses of m contacts at one instant; V (k, 3) becomes the velocities after.

    Args:
        ROWS: (m, 16) of `place_row`; u_n, u_t and the targets are set here, from V and the elasticities.
        L: (m, 2) first guess of the impulses in (0 for none), the impulses out.
        POSE: (k, 3), for the order of elimination alone.  n: bodies that impulses move, the first of k.
        owed: energy >= 0 that the block has to take out beyond its own losses' sign: its loss is at least that.
        hasty: whether a lossy crowd may be solved roughly: a hit on a pile.
        LOSS: (m, 2) out, D_n and D_t of each contact.
        OUT: (8,) out: sums of D_n and D_t, the lock's scale, energy still owed, residual (velocity), sweeps,
            polishes, tolerance of the residual.
    Returns:
        CONVERGED (residual <= 1e-14 of the largest b - u_n, with friction 1e-10, in lossy crowds 1e-4) or TRUNCATED.
        Energy is right in both.
    """
    for i in range(len(OUT)):
        OUT[i] = 0.0
    OUT[SCALE_LOCK] = 1.0
    OUT[OWED] = owed
    for i in range(m):
        LOSS[i, 0] = 0.0
        LOSS[i, 1] = 0.0
    rates(A, B, ROWS, V, m)
    speed = aim(ROWS, m)
    if not speed > 0.0:
        for i in range(m):
            L[i, 0] = 0.0
            L[i, 1] = 0.0
        return CONVERGED
    FREE = V.copy()
    push(A, B, ROWS, L, V, IM, II, m)
    rough = rubs(ROWS, m)
    tolerance = speed * (BLOCK_RESIDUAL_FRICTION if rough else BLOCK_RESIDUAL)
    exact = conserves(ROWS, m)
    if hasty and m > LARGE_BLOCK and not exact:
        # A hit on a pile, which loses energy anyway: what follows it matters more than its last digits.
        tolerance = LARGE_BLOCK_RESIDUAL * speed
        taken, worst = iterate(A, B, ROWS, L, V, IM, II, m, tolerance, LARGE_BLOCK_SWEEPS)
        OUT[SWEEPS] = taken
    else:
        worst = resolve(A, B, ROWS, L, V, FREE, IM, II, POSE, n, m, rough, tolerance, OUT)
    # Sums over many sweeps have their own round-off: the velocities are those of the impulses.
    velocities(A, B, ROWS, L, FREE, IM, II, m, V)
    scale, left = lock(A, B, ROWS, L, V, FREE, IM, II, m, owed, exact)
    normal, tangential = works(A, B, ROWS, L, V, m, LOSS)
    OUT[0] = normal
    OUT[1] = tangential
    OUT[SCALE_LOCK] = scale
    OUT[OWED] = left
    OUT[RESIDUAL], OUT[TOLERANCE] = worst, tolerance
    return CONVERGED if worst <= tolerance else TRUNCATED

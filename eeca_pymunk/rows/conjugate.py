"""Nonlinear conjugate gradients on top of sweeps (Silcowitz, Niebe, Erleben 2009).

The change of the impulses in a sweep, d = L - L0, counts as minus the gradient. With the direction p of Fletcher and
Reeves, b = |d|^2 / |d of the sweep before|^2 and p <- d + b p, the next sweep begins at L + b p (p that before); where
b > 1, and at first, it begins at L, with p = d. The velocities V, which are linear in L, are moved likewise.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import AnyProblem
from .sweeps import sweep


@nonallocating
def accelerate(
    L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray, PL: FloatArray, PV: FloatArray, before: float,
    last: bool,
) -> float:  # fmt: skip
    """After a sweep from (L0, V0) to (L, V): continue along the direction (PL, PV), and update it; (L0, V0) becomes the
    start of the next sweep. All are flat.

    Args:
        before: sum of squares of the changes of impulses in the sweep before, which is returned for this one; not
            positive for the first.
        last: whether the next sweep is the last, which starts from the present (L, V).
    """
    change = 0.0
    for i in range(len(L0)):
        change += (L[i] - L0[i]) * (L[i] - L0[i])
    ratio = change / before if before > 0.0 else 2.0
    if ratio > 1.0:
        restart_direction(L, L0, PL)
        restart_direction(V, V0, PV)
    elif not last:
        extend_direction(L, L0, PL, ratio)
        extend_direction(V, V0, PV, ratio)
    return change


@nonallocating
def restart_direction(X: FloatArray, X0: FloatArray, P: FloatArray) -> None:
    """Restart the direction P as the change from X0 to X, which becomes the next start X0."""
    for i in range(len(X0)):
        x = X[i]
        P[i] = x - X0[i]
        X0[i] = x


@nonallocating
def extend_direction(X: FloatArray, X0: FloatArray, P: FloatArray, ratio: float) -> None:
    """Move X by `ratio` times the direction P, which becomes that plus the change from X0 to X; X becomes the next
    start X0."""
    for i in range(len(X0)):
        x, step = X[i], ratio * P[i]
        P[i] = step + (x - X0[i])
        x += step
        X[i] = x
        X0[i] = x


@kernel
def sweep_conjugate(
    problem: AnyProblem, L: FloatArray, V: FloatArray, tolerance: float, most: int
) -> tuple[int, float]:
    """Accelerated sweeps, until one changes no contact's velocity by more than `tolerance`, at most `most`. The last is
    plain. Returns the number of sweeps, and the change in the last."""
    # Loops over flat arrays are vectorised.
    FLAT, FAST = L.reshape(L.size), V.reshape(V.size)
    L0, V0, PL, PV = FLAT.copy(), FAST.copy(), np.zeros(L.size), np.zeros(V.size)
    change, done, worst = -1.0, 0, np.inf
    while done < most:
        worst = sweep(problem, L, V)
        done += 1
        if worst <= tolerance or done >= most:
            break
        change = accelerate(FLAT, FAST, L0, V0, PL, PV, change, done >= most - 1)
    return done, worst

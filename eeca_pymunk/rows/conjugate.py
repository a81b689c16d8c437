"""Nonlinear conjugate gradients on top of sweeps (Silcowitz, Niebe, Erleben 2009).

A sweep's change is the gradient; the directions of Fletcher and Reeves, forgotten where the change grows.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, uncounted
from ..model.contacts import AnyProblem
from .sweeps import rows_of, sweep


@uncounted
def accelerate(
    L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray, PL: FloatArray, PV: FloatArray, before: float,
    last: bool,
) -> float:  # fmt: skip
    """After a sweep from (L0, V0) to (L, V): go on along the direction (PL, PV), and renew it; (L0, V0) is what the
    next sweep starts from. All are flat.

    Args:
        before: the square of the change of the impulses by the sweep before, which is returned for this one; not
            positive for the first.  last: whether the next sweep is the last, which is a plain one.
    """
    change = 0.0
    for i in range(len(L0)):
        change += (L[i] - L0[i]) * (L[i] - L0[i])
    ratio = change / before if before > 0.0 else 2.0
    if ratio > 1.0:
        renew(L, L0, PL)
        renew(V, V0, PV)
    elif not last:
        go_on(L, L0, PL, ratio)
        go_on(V, V0, PV, ratio)
    return change


@uncounted
def renew(X: FloatArray, X0: FloatArray, P: FloatArray) -> None:
    """The direction P from X0 to X, which is the next start."""
    for i in range(len(X0)):
        x = X[i]
        P[i] = x - X0[i]
        X0[i] = x


@uncounted
def go_on(X: FloatArray, X0: FloatArray, P: FloatArray, ratio: float) -> None:
    """X goes on along `ratio` times the direction P, which becomes that and the way from X0 to X; X is the next
    start."""
    for i in range(len(X0)):
        x, way = X[i], ratio * P[i]
        P[i] = way + (x - X0[i])
        x += way
        X[i] = x
        X0[i] = x


@kernel
def iterate(problem: AnyProblem, L: FloatArray, V: FloatArray, tolerance: float, most: int) -> tuple[int, float]:
    """Sweeps, accelerated, until one changes no contact's velocity by > tolerance. The last is plain.

    Returns the sweeps taken (<= most) and the change of the last.
    """
    # One after the other in memory: loops over flat arrays take several numbers at once.
    FLAT, FAST = L.reshape(L.size), V.reshape(V.size)
    size = 2 * rows_of(problem)
    L0, V0, PL, PV = FLAT[:size].copy(), FAST.copy(), np.zeros(size), np.zeros(V.size)
    change, done, worst = -1.0, 0, np.inf
    while done < most:
        worst = sweep(problem, L, V)
        done += 1
        if worst <= tolerance or done >= most:
            break
        change = accelerate(FLAT, FAST, L0, V0, PL, PV, change, done >= most - 1)
    return done, worst

"""Nonlinear conjugate gradients on top of sweeps (Silcowitz, Niebe, Erleben 2009).

A sweep's change is the gradient; the directions of Fletcher and Reeves, forgotten where the change grows.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from .sweeps import keep, sweep


@uncounted
def accelerate(
    L: FloatArray, V: FloatArray, L0: FloatArray, V0: FloatArray, PL: FloatArray, PV: FloatArray, m: int,
    before: float, last: bool,
) -> float:  # fmt: skip
    """After a sweep from (L0, V0) to (L, V): go on along the direction (PL, PV), and renew it.

    Args:
        before: the square of the change of the m impulses by the sweep before, which is returned for this one; not
            positive for the first.  last: whether the next sweep is the last, which is a plain one.
    """
    change = 0.0
    for i in range(m):
        change += (L[i, 0] - L0[i, 0]) ** 2 + (L[i, 1] - L0[i, 1]) ** 2
    ratio = change / before if before > 0.0 else 2.0
    if ratio > 1.0:
        for i in range(m):
            for j in range(2):
                PL[i, j] = L[i, j] - L0[i, j]
        for i in range(len(V)):
            for j in range(3):
                PV[i, j] = V[i, j] - V0[i, j]
    elif not last:
        for i in range(m):
            for j in range(2):
                step = L[i, j] - L0[i, j]
                L[i, j] += ratio * PL[i, j]
                PL[i, j] = ratio * PL[i, j] + step
        for i in range(len(V)):
            for j in range(3):
                step = V[i, j] - V0[i, j]
                V[i, j] += ratio * PV[i, j]
                PV[i, j] = ratio * PV[i, j] + step
    return change


@kernel
def iterate(
    A: IntArray, B: IntArray, ROWS: FloatArray, L: FloatArray, V: FloatArray, IM: FloatArray, II: FloatArray, m: int,
    tolerance: float, most: int,
) -> tuple[int, float]:  # fmt: skip
    """Sweeps, accelerated, until one changes no contact's velocity by > tolerance. The last is plain.

    Returns the sweeps taken (<= most) and the change of the last.
    """
    L0, V0, PL, PV = np.empty((m, 2)), np.empty_like(V), np.zeros((m, 2)), np.zeros_like(V)
    change, done, worst = -1.0, 0, np.inf
    while done < most:
        keep(L, V, m, L0, V0)
        worst = sweep(A, B, ROWS, L, V, IM, II, m)
        done += 1
        if worst <= tolerance or done >= most:
            break
        change = accelerate(L, V, L0, V0, PL, PV, m, change, done >= most - 1)
    return done, worst

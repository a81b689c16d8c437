"""Impulses where there is no solution, or one that makes no sense: they gain nothing however far they are from solved.

Rows that contradict one another (what is jammed between walls), or answers that are no longer those of the components,
let impulses grow without bound; the work of what they lean on is then without bound too. Sweeps from no impulses are
descents of (1/2) lam.A lam + lam.(u - b), so that what is left of them is between nothing and the solution.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded, JointedProblem
from ..model.joints import Joints
from ..model.parameters.joints import EXCESSIVE_IMPULSE, GENTLE_SWEEPS
from ..model.scene import Scene
from ..rows.sweeps import sweep
from .advance import Interval, advance, align
from .bounded import with_bounded
from .columns import fill_free, weigh


@nonallocating
def excessive(interval: Interval, L: FloatArray, speed: float) -> bool:
    """Whether impulses L are beyond all that bodies of such a speed need: larger by EXCESSIVE_IMPULSE than their
    momenta; not finite ones are, too."""
    mass, largest = 0.0, 0.0
    for q in range(interval.n):
        mass += 1.0 / interval.isle.IM[q]
    for i in range(interval.m):
        largest = max(largest, abs(L[i, 0]) + abs(L[i, 1]))
    return not largest <= EXCESSIVE_IMPULSE * mass * speed


@kernel
def solve_gently(A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool) -> None:
    """Impulses L (m, 2) by sweeps from none, about the motion without any; and the motion under them."""
    isle, groups, P, Q, ROWS, _, C, m, _, _, _ = interval
    for k in range(m):
        L[k, 0] = L[k, 1] = 0.0
    advance(A, J, interval, L, B, True, np.empty((0, 3)))
    if free:
        align(isle, P, Q, ROWS, m, interval.motion, True)
    fill_free(groups, C, Q, ROWS, isle.IM, isle.II, m)
    weigh(groups, C, P, Q, ROWS, m)
    V, BOTH = interval.motion.MEAN.copy(), with_bounded(B, L, m)
    problem = JointedProblem(P, Q, ROWS, C, B, m)
    for _ in range(GENTLE_SWEEPS):
        sweep(problem, BOTH, V)
    for i in range(m):
        L[i, 0], L[i, 1] = BOTH[i, 0], BOTH[i, 1]
    advance(A, J, interval, L, B, False, np.empty((0, 3)))

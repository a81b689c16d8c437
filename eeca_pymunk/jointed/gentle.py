"""Gentle impulses (`..rows.gentle`) of contacts of jointed bodies, and the motion under them."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.contacts import Bounded, JointedProblem
from ..model.joints import Joints
from ..model.scene import Scene
from ..rows.gentle import excessive, sweep_gently
from .advance import Interval, advance, align
from .bounded_rows import with_bounded
from .columns import count_operations, fill_free, set_effective_masses


@kernel
def solve_gently(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool, quick: float
) -> None:  # fmt: skip
    """Impulses L (m, 2) by sweeps that begin at 0, about the motion without impulses; none if these are excessive for
    bodies of the speed `quick`; and the motion under them."""
    isle, groups, ROWS, _, C, m, n, _, _ = interval
    L[:m] = 0.0
    advance(A, J, interval, L, B, True, np.empty((0, 3)))
    if free:
        align(interval)
    fill_free(groups, C, ROWS, isle.IM, isle.II, m)
    set_effective_masses(groups, C, ROWS, m)
    V, BOTH = interval.motion.MEAN.copy(), with_bounded(B, L, m)
    problem = JointedProblem(ROWS, C, B, m)
    sweep_gently(problem, BOTH, V)
    count_operations(J, C)
    for i in range(m):
        L[i, 0], L[i, 1] = BOTH[i, 0], BOTH[i, 1]
    advance(A, J, interval, L, B, False, np.empty((0, 3)))
    if excessive(L, m, isle.IM, n, quick):
        L[:] = 0.0
        advance(A, J, interval, L, B, False, np.empty((0, 3)))

"""Contacts with bodies that no impulse moves, after a solve of many contacts, which may not have converged.

Its residuals let light bodies under heavy ones sink: by a part of the depth that each interval allows, and in the end
through a floor. Where contacts are deeper than an interval allows, further impulses of the wall alone bring them to
their law at its end. They act on no other body: heavy bodies then go into light ones instead.
"""

from __future__ import annotations

from math import inf

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..geometry.sides import depth_limit
from ..model.contacts import AnyProblem
from ..model.scene import Scene
from ..rows.lifting import keep_walls
from .memory import shapes_of


@kernel
def stop_at_walls(A: Scene, problem: AnyProblem, n: int, LEFT_OUT: IntArray, L: FloatArray, V: FloatArray) -> None:
    """Bring contacts with bodies without mobility, those from number n on, to u_n >= b at velocities V (k, 3), where
    they are deeper than an interval allows. Normal impulses L only grow, so that frictions remain within their limits.
    LEFT_OUT (m,): not 0 for contacts that no impulse moves."""
    LACK = np.full(problem.m, inf)
    for i in range(problem.m):
        row = problem.ROWS[i]
        if max(row.a, row.b) >= n and row.wake == inf and LEFT_OUT[i] == 0:
            a, b = shapes_of(A, row)
            LACK[i] = -row.target if row.gap < -depth_limit(A, a, b) else inf
    keep_walls(problem, n, LACK, np.zeros(problem.m), L[:, 0], V)

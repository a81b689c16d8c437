"""Contacts with bodies that no impulse moves, after a solve of many contacts, which may have come to no end.

What such a solve leaves lets light bodies under heavy ones sink: in each interval by a part of what it allows, and in
the end through a floor. Where they are deeper than an interval allows, impulses of the wall alone bring their contacts
to their law at the end of it. These act on no other body, and heavy ones go into light ones instead.
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
def stop_at_walls(A: Scene, problem: AnyProblem, n: int, OUT: IntArray, L: FloatArray, V: FloatArray) -> None:
    """Let no contact with a body without mobility, one of those from number n on, close at velocities V (k, 3) faster
    than its law says, if it is deeper than an interval allows. Adds normal impulses to L, so that frictions remain
    within their limits. OUT (m,): not 0 for contacts that no impulse moves."""
    LACK = np.full(problem.m, inf)
    for i in range(problem.m):
        row = problem.ROWS[i]
        if max(row.a, row.b) >= n and row.wake == inf and OUT[i] == 0:
            a, b = shapes_of(A, row)
            LACK[i] = -row.target if row.gap < -depth_limit(A, a, b) else inf
    keep_walls(problem, n, LACK, np.zeros(problem.m), L[:, 0], V)

"""Contacts with bodies that no impulse moves, after a solve of many contacts, which may have come to no end.

What such a solve leaves lets light bodies under heavy ones sink: in each interval by a part of what it allows, and in
the end through a floor. Where they are deeper than an interval allows, impulses of the wall alone bring their contacts
to their law at the end of it. These act on no other body, and heavy ones go into light ones instead.
"""

from __future__ import annotations

from math import inf

from ..arrays import FloatArray
from ..compiled import Choice, inlined, nonallocating
from ..geometry.sides import depth_limit
from ..model.contacts import AnyProblem, JointedProblem, Problem
from ..model.parameters.intervals import WALL_SWEEPS
from ..model.scene import Scene
from ..rows.build import normal_rate
from ..rows.lifting import meet_gap
from .memory import shapes_of


@inlined
def is_out_free(problem: Problem, i: int) -> bool:
    """Whether no impulse moves contact i."""
    return False


@inlined
def is_out_jointed(problem: JointedProblem, i: int) -> bool:
    """Whether no impulse moves contact i."""
    return bool(problem.C.OUT[i] != 0)


is_out = Choice(is_out_free, is_out_jointed)


@nonallocating
def stop_at_walls(A: Scene, problem: AnyProblem, n: int, L: FloatArray, V: FloatArray) -> None:
    """Let no contact with a body without mobility, one of those from number n on, close at velocities V (k, 3) faster
    than its law says, if it is deeper than an interval allows. Adds normal impulses to L, so that frictions remain
    within their limits."""
    for _ in range(WALL_SWEEPS):
        met = True
        for i in range(problem.m):
            row = problem.ROWS[i]
            if max(row.a, row.b) < n or row.wake < inf or is_out(problem, i):
                continue
            a, b = shapes_of(A, row)
            if row.gap < -depth_limit(A, a, b) and normal_rate(row, V) < row.target:
                met = meet_gap(problem, -row.target, L[:, 0], V, i) == 0.0 and met
        if met:
            break

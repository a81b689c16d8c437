"""EECA: the energy-conserving stepper. Detect the active contacts, close the balance, lock the energy, move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pymunk

from .arrays import ArrayStepper, Motion, Start, near_pairs, touching
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .closures import Closure, Midstep, Problem, Solution
from .complementarity import restrict
from .contacts import Contacts, Geometry, Pairs, length
from .detection import MarginTwin
from .stepper import StepReport

_STRUCK = 10.0  # ratio of displacements from which a body is looked after again: detection costs as much as a solution


class EECA(ArrayStepper):
    """Conserves energy, linear and angular momentum through every contact, at any dt (paper; design section 2).

    Args:
        space: a pymunk space.
        closure: what chooses psi2; `Midstep()` if None.
        sync: see `ArrayStepper`.

    A contact is active in a step when it starts closed (gap <= 0) or when the free flight would close it. Contacts
    that the impulses themselves would close join them, in at most `passes` further solves.
    """

    passes = 3

    def __init__(self, space: pymunk.Space, closure: Closure | None = None, *, sync: bool = True) -> None:
        self.closure: Closure = Midstep() if closure is None else closure
        super().__init__(space, sync=sync)

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        velocity = start.velocity + start.dt * start.acceleration
        displacement = start.free_displacement
        free = StepReport.without_contacts(self.time + start.dt, bodies.items)
        pairs, before = near_pairs(twin, start, displacement)
        tolerance = touching(pairs, start.position)
        active = (before.gap <= tolerance) | closing(pairs, before, tolerance, start, displacement)
        if not active.any():
            return Motion(velocity, displacement, free)
        guess = np.zeros(len(pairs))
        for left in range(self.passes, -1, -1):
            which = np.flatnonzero(active)
            chosen = pairs.take(which)
            problem, rows = self._problem(bodies, start, chosen, before.take(which), guess[which], draft=left > 0)
            solution = self.closure.solve(problem)
            if left == 0:
                break
            trial = displacement.copy()
            trial[rows] = solution.displacement
            if left == self.passes and (struck := length(trial) > _STRUCK * length(displacement)).any():
                # Bodies that hardly moved until now reach pairs that were not near.
                known = pairs.key[active]
                pairs, before = near_pairs(twin, start, displacement, struck * length(trial - displacement))
                tolerance = touching(pairs, start.position)
                active = np.isin(pairs.key, known)
                guess, which = np.zeros(len(pairs)), np.flatnonzero(active)
            joining = closing(pairs, before, tolerance, start, trial) & ~active
            if not joining.any():
                break
            active |= joining
            guess[which] = solution.impulse
        if solution.draft:
            solution = self.closure.solve(replace(problem, guess=solution.impulse, draft=False))
        velocity[rows], displacement[rows] = solution.velocity, solution.displacement
        at = solution.geometry
        contacts = Contacts(
            bodies.items, chosen.row_a, chosen.row_b, at.normal, at.point, before.gap[which], solution.time
        )
        return Motion(velocity, displacement, self._report(free.time, contacts, solution))

    def _problem(
        self, bodies: Bodies, start: Start, chosen: Pairs, before: Geometry, guess: FloatArray, *, draft: bool
    ) -> tuple[Problem, IntArray]:
        """The problem of the `chosen` contacts on the bodies they touch, and the rows of these bodies."""
        rows, row_a, row_b = restrict(chosen.row_a, chosen.row_b, len(bodies))
        facing = before.normal

        def geometry_at(time: FloatArray) -> Geometry:
            at = chosen.between(*self.flight(start, chosen, time))
            # A centre that has crossed a wall by then is still pushed back to the side it came from.
            behind = at.normal[:, 0] * facing[:, 0] + at.normal[:, 1] * facing[:, 1] < 0
            if behind.any():
                at.normal[behind] = facing[behind]
            return at

        problem = Problem(
            start.dt, start.velocity[rows], start.acceleration[rows], bodies.mass[rows], bodies.inverse_mass[rows],
            row_a, row_b, before.gap, chosen.elasticity, guess, geometry_at, draft,
        )  # fmt: skip
        return problem, rows

    @staticmethod
    def _report(time: float, contacts: Contacts, solution: Solution) -> StepReport:
        return StepReport(
            time, contacts, solution.impulse, solution.psi1, solution.psi2, solution.gap_increment,
            iterations=solution.iterations, lock=solution.lock, converged=solution.converged,
        )  # fmt: skip


def closing(pairs: Pairs, before: Geometry, tolerance: FloatArray, start: Start, displacement: FloatArray) -> BoolArray:
    """(m,) whether a displacement of the bodies closes the pair: overlap at its end, or sides exchanged on the way."""
    after = pairs.at(start.position + displacement)
    closed: BoolArray = after.gap < -tolerance
    crossed = before.normal[:, 0] * after.normal[:, 0] + before.normal[:, 1] * after.normal[:, 1] < 0
    if crossed.any():
        middle = pairs.at(start.position + 0.5 * displacement)
        closed |= crossed & (middle.gap < 0)
    return closed

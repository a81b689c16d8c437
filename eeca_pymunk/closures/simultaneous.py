"""Simultaneous closures: one impulse per contact and step, all active contacts solved at once (design section 4)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .._rounds.contacts import Pairs, touching
from .._rounds.features import length
from .._rounds.geometry import Geometry
from ..arrays import BoolArray, FloatArray, IntArray
from ..energy.delassus import Delassus
from ..energy.graph import restrict
from ..report import Contacts, Details, StepReport
from ..space.bodies import Bodies
from ..space.twin import MarginTwin
from .motion import Motion, Start, flight, near_pairs

_STRUCK = 10.0  # ratio of displacements from which a body is looked after again: detection costs as much as a solution


@dataclass(frozen=True)
class Problem:
    """Active contacts of a step, on the R bodies they touch.

    Attributes:
        dt: time.  velocity: (R, 2) at n.  acceleration: (R, 2) of external forces.  mass, inverse_mass: (R,).
        row_a, row_b, gap, elasticity: (m,) of the contacts.  guess: (m,) of the impulses, 0 where unknown.
        draft: whether the contacts may change after this solution, so that a rough one does.
        geometry_at: (m,) instants in the step, or one for all, to the geometry on the free flight at these instants.
    """

    dt: float
    velocity: FloatArray
    acceleration: FloatArray
    mass: FloatArray
    inverse_mass: FloatArray
    row_a: IntArray
    row_b: IntArray
    gap: FloatArray
    elasticity: FloatArray
    guess: FloatArray
    geometry_at: Callable[[FloatArray | float], Geometry]
    draft: bool = False

    def operator(self, geometry: Geometry) -> Delassus:
        """The contacts as an operator, with the normals of `geometry`."""
        return Delassus(self.row_a, self.row_b, geometry.normal, self.inverse_mass)

    @property
    def external(self) -> FloatArray:
        """(R, 2) momentum from external forces, dt f_ext; 0 for bodies that do not move."""
        return self.dt * np.where(self.inverse_mass > 0, self.mass, 0.0)[:, None] * self.acceleration

    @property
    def larger_mass(self) -> FloatArray:
        """(m,) M of Eq. 29: the larger of the two masses that move."""
        mass = np.where(self.inverse_mass > 0, self.mass, 0.0)
        return np.maximum(mass[self.row_a], mass[self.row_b])


@dataclass(frozen=True)
class Solution:
    """Impulses and motion of a step.

    Attributes:
        velocity: (R, 2) at n+1.  displacement: (R, 2) over the step.
        impulse, psi1, psi2, gap_increment, time: (m,).
        geometry: normals and points where the impulses act.
        draft: whether the solution is rough and has to be solved for again.
        iterations: of the closure.  lock: the scale of the energy lock that lies farthest from 1.
    """

    velocity: FloatArray
    displacement: FloatArray
    impulse: FloatArray
    psi1: FloatArray
    psi2: FloatArray
    gap_increment: FloatArray
    time: FloatArray
    geometry: Geometry
    iterations: int
    lock: float
    converged: bool
    draft: bool = False


class Simultaneous(ABC):
    """A closure that gives every active contact one impulse, at an instant that psi2 tells.

    A contact is active in a step when it starts closed (gap <= 0) or when the free flight would close it. Contacts
    that the impulses themselves would close join them, in at most `passes` further solves.
    """

    passes = 3

    @abstractmethod
    def solve(self, problem: Problem) -> Solution:
        """The motion of the bodies of `problem`, energy and momentum exact."""

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        velocity = start.free_velocity
        displacement = start.free_displacement
        free = StepReport.without_contacts(start.time, bodies.items)
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
            solution = self.solve(problem)
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
            # Elsewhere the displacement is the free one, which closes nothing else.
            changed = np.zeros(len(bodies), bool)
            changed[rows] = True
            may = np.flatnonzero((changed[pairs.row_a] | changed[pairs.row_b]) & ~active)
            joining = may[closing(pairs.take(may), before.take(may), tolerance[may], start, trial)]
            if len(joining) == 0:
                break
            active[joining] = True
            guess[which] = solution.impulse
        if solution.draft:
            solution = self.solve(replace(problem, guess=solution.impulse, draft=False))
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

        def geometry_at(time: FloatArray | float) -> Geometry:
            at = chosen.at(start.at(time)) if isinstance(time, float) else chosen.between(*flight(start, chosen, time))
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
        details = Details(contacts, solution.impulse, solution.psi1, solution.psi2, solution.gap_increment)
        return StepReport(
            time, details, iterations=solution.iterations, lock=solution.lock, converged=solution.converged,
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

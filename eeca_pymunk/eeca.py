"""EECA: the energy-conserving stepper. Detect the active contacts, close the balance, lock the energy, move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pymunk

from .arrays import ArrayStepper, Motion, Start
from .bodies import Bodies, BoolArray, FloatArray
from .closures import Closure, Midstep, Problem, Solution
from .complementarity import restrict
from .contacts import Contacts, Geometry, Pairs
from .detection import MarginTwin
from .stepper import StepReport

_TOUCHING = 1e-12  # gaps below this many length units of the pair's extent are round-off: exactly touching


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
        reach = np.sqrt(np.einsum("ij,ij->i", displacement, displacement))
        # The path of a thrown body can be longer than its chord.
        reach += (0.125 * start.dt**2) * np.sqrt(np.einsum("ij,ij->i", start.acceleration, start.acceleration))
        pairs = twin.candidates(start.position, reach)
        free = StepReport.without_contacts(self.time + start.dt, bodies.items)
        if len(pairs) == 0:
            return Motion(velocity, displacement, free)
        before = pairs.at(start.position)
        active = (before.gap <= touching(pairs, start)) | closing(pairs, before, start, displacement)
        if not active.any():
            return Motion(velocity, displacement, free)
        for _ in range(1 + self.passes):
            which = np.flatnonzero(active)
            chosen = pairs.take(which)
            solution, rows = self._solve(bodies, start, chosen, before, which)
            moved = displacement.copy()
            moved[rows] = solution.displacement
            joining = closing(pairs, before, start, moved) & ~active
            if not joining.any():
                break
            active |= joining
        velocity[rows] = solution.velocity
        contacts = self.contacts(bodies, start, chosen, before.gap[which], solution.time)
        contacts = replace(contacts, normal=solution.normal)
        return Motion(velocity, moved, self._report(free.time, contacts, solution))

    def _solve(
        self, bodies: Bodies, start: Start, chosen: Pairs, before: Geometry, which: FloatArray
    ) -> tuple[Solution, FloatArray]:
        rows, row_a, row_b = restrict(chosen.row_a, chosen.row_b)
        facing = before.normal[which]

        def normal_at(time: FloatArray) -> FloatArray:
            normal = chosen.between(*self.flight(start, chosen, time)).normal
            # A centre that has crossed a wall by then is still pushed back to the side it came from.
            behind = np.einsum("ij,ij->i", normal, facing) < 0
            normal[behind] = facing[behind]
            return normal

        problem = Problem(
            start.dt, start.velocity[rows], start.force[rows], bodies.mass[rows], bodies.inverse_mass[rows],
            row_a, row_b, before.gap[which], chosen.elasticity, normal_at,
        )  # fmt: skip
        return self.closure.solve(problem), rows

    @staticmethod
    def _report(time: float, contacts: Contacts, solution: Solution) -> StepReport:
        return StepReport(
            time, contacts, solution.impulse, solution.psi1, solution.psi2, solution.gap_increment,
            iterations=solution.iterations, lock=solution.lock, converged=solution.converged,
        )  # fmt: skip


def touching(pairs: Pairs, start: Start) -> FloatArray:
    """(m,) length below which a gap is round-off of positions and radii."""
    extent = np.abs(start.position[pairs.row_a]).max(axis=1, initial=0.0) + pairs.radius_a + pairs.radius_b
    return _TOUCHING * extent


def closing(pairs: Pairs, before: Geometry, start: Start, displacement: FloatArray) -> BoolArray:
    """(m,) whether a displacement of the bodies closes the pair: overlap at its end, or the sides exchanged on the way."""
    after = pairs.at(start.position + displacement)
    closed: BoolArray = after.gap < -touching(pairs, start)
    crossed = np.einsum("ij,ij->i", before.normal, after.normal) < 0
    if crossed.any():
        middle = pairs.at(start.position + 0.5 * displacement)
        closed |= crossed & (middle.gap < 0)
    return closed

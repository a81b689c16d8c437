"""A step of disks with one impulse per contact, all active contacts solved at once.

A contact is active in a step if it starts closed (gap <= 0) or if the free flight would close it. Contacts that the
impulses themselves would close become active too, in at most `_PASSES` further solves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..energy.delassus import Delassus, restrict
from ..report import Details
from .motion import DiskMotion, Disks, Geometry, Pairs, Start

_PASSES = 3
_STRUCK = 10.0  # ratio of displacements from which on pairs are searched again, which costs as much as a solve


@dataclass(frozen=True)
class ActiveContacts:
    """Active contacts of a step, on the R bodies they touch.

    Attributes:
        dt: time.  velocity: (R, 2) at n.  acceleration: (R, 2) of external forces.  inverse_mass: (R,).
        row_a, row_b, gap, elasticity: (m,) of the contacts.  guess: (m,) of the impulses, 0 where unknown.
        geometry_at: (m,) instants in the step, or one for all, to the geometry on the free flight at these instants.
    """

    dt: float
    velocity: FloatArray
    acceleration: FloatArray
    inverse_mass: FloatArray
    row_a: IntArray
    row_b: IntArray
    gap: FloatArray
    elasticity: FloatArray
    guess: FloatArray
    geometry_at: Callable[[FloatArray | float], Geometry]

    def operator(self, geometry: Geometry) -> Delassus:
        """The contacts as an operator, with the normals of `geometry`."""
        return Delassus(self.row_a, self.row_b, geometry.normal, self.inverse_mass)

    @property
    def external(self) -> FloatArray:
        """(R, 2) momentum from external forces, dt f_ext; 0 for bodies that do not move."""
        return self.dt * self.mass[:, None] * self.acceleration

    @property
    def mass(self) -> FloatArray:
        """(R,) of the bodies that move, 0 of the others."""
        moves = self.inverse_mass > 0
        return np.divide(1.0, self.inverse_mass, out=np.zeros_like(self.inverse_mass), where=moves)

    @property
    def larger_mass(self) -> FloatArray:
        """(m,) M of Eq. 29: the larger of the two masses that move."""
        return np.maximum(self.mass[self.row_a], self.mass[self.row_b])


@dataclass(frozen=True)
class Solution:
    """Impulses and motion of a step.

    Attributes:
        velocity: (R, 2) at n+1.  displacement: (R, 2) over the step.
        impulse, psi1, psi2, gap_increment, time: (m,).
        geometry: normals and points where the impulses act.
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


def move_disks(solve: Callable[[ActiveContacts], Solution], disks: Disks, start: Start) -> DiskMotion:
    """The motion of all disks over a step, with the impulses of `solve`, which conserve energy and momentum."""
    velocity = start.free_velocity
    displacement = start.free_displacement
    pairs, before, tolerance = disks.near(start, displacement)
    active = (before.gap <= tolerance) | closing(pairs, before, tolerance, start, displacement)
    if not active.any():
        return DiskMotion(velocity, displacement)
    guess = np.zeros(len(pairs))
    for left in range(_PASSES, -1, -1):
        which = np.flatnonzero(active)
        chosen = pairs.take(which)
        problem, rows = active_contacts(start, chosen, before.take(which), guess[which])
        solution = solve(problem)
        if left == 0:
            break
        trial = displacement.copy()
        trial[rows] = solution.displacement
        if left == _PASSES and (struck := _length(trial) > _STRUCK * _length(displacement)).any():
            # Bodies that were slow before may reach pairs that were not near.
            known = pairs.key[active]
            pairs, before, tolerance = disks.near(start, displacement, struck * _length(trial - displacement))
            active = np.isin(pairs.key, known)
            guess, which = np.zeros(len(pairs)), np.flatnonzero(active)
        # Bodies without impulses have their free displacement, which was tested.
        changed = np.zeros(len(velocity), bool)
        changed[rows] = True
        may = np.flatnonzero((changed[pairs.row_a] | changed[pairs.row_b]) & ~active)
        joining = may[closing(pairs.take(may), before.take(may), tolerance[may], start, trial)]
        if len(joining) == 0:
            break
        active[joining] = True
        guess[which] = solution.impulse
    velocity[rows], displacement[rows] = solution.velocity, solution.displacement
    at = solution.geometry
    contacts = chosen.contacts(at, before.gap[which], solution.time)
    details = Details(contacts, solution.impulse, solution.psi1, solution.psi2, solution.gap_increment)
    return DiskMotion(velocity, displacement, details, solution.lock, solution.converged, solution.iterations)


def active_contacts(
    start: Start, chosen: Pairs, before: Geometry, guess: FloatArray
) -> tuple[ActiveContacts, IntArray]:  # fmt: skip
    """The problem of the `chosen` contacts on the bodies they touch, and the rows of these bodies."""
    rows, row_a, row_b = restrict(chosen.row_a, chosen.row_b, len(start.position))
    facing = before.normal

    def geometry_at(time: FloatArray | float) -> Geometry:
        at = chosen.between(start.at(chosen.row_a, time), start.at(chosen.row_b, time))
        # A centre that has crossed a wall by then is still pushed back to the side it came from.
        behind = at.normal[:, 0] * facing[:, 0] + at.normal[:, 1] * facing[:, 1] < 0
        if behind.any():
            at.normal[behind] = facing[behind]
        return at

    problem = ActiveContacts(
        start.dt, start.velocity[rows], start.acceleration[rows], start.inverse_mass[rows], row_a, row_b,
        before.gap, chosen.elasticity, guess, geometry_at,
    )  # fmt: skip
    return problem, rows


def _length(vectors: FloatArray) -> FloatArray:
    """(n,) of (n, 2) vectors."""
    result: FloatArray = np.hypot(vectors[:, 0], vectors[:, 1])
    return result


def closing(pairs: Pairs, before: Geometry, tolerance: FloatArray, start: Start, displacement: FloatArray) -> BoolArray:
    """(m,) whether a displacement of the bodies closes the pair: overlap at its end, or sides exchanged on the way."""
    after = pairs.at(start.position + displacement)
    closed: BoolArray = after.gap < -tolerance
    crossed = before.normal[:, 0] * after.normal[:, 0] + before.normal[:, 1] * after.normal[:, 1] < 0
    if crossed.any():
        middle = pairs.at(start.position + 0.5 * displacement)
        closed |= crossed & (middle.gap < 0)
    return closed

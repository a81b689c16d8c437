"""Energy-momentum penalty stepping, the scheme that EECA enhances: psi1 = psi2 = 0 (paper Eqs. 9, 12 and Fig. 1)."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from ..closures.dashpot import check_stiffness
from ..closures.motion import DiskMotion, Disks, Geometry, Pairs, Start
from ..energy.complementarity import solve
from ..energy.delassus import Delassus, restrict
from ..packed_stepper import PackedStepper
from ..report import Details

if TYPE_CHECKING:
    import pymunk

    from ..space.world import World


class PenaltyStepper(PackedStepper):
    """Moves single disks between static shapes; contacts are springs of stiffness K > 0 (mass/time²). Subclasses give
    the rule in time (`load`)."""

    max_iterations = 30
    tolerance = 1e-12  # of the change of impulses between iterations, relative to the largest

    def __init__(self, space: pymunk.Space, stiffness: float, *, sync: bool = True) -> None:
        check_stiffness(stiffness)
        self.stiffness = float(stiffness)
        super().__init__(space, sync=sync)

    def make_method(self, world: World) -> Disks:
        world.load()
        return Disks(world, type(self).__name__, self._move)

    def _move(self, disks: Disks, start: Start) -> DiskMotion:
        velocity = start.free_velocity
        displacement = start.free_displacement
        pairs, before, _ = disks.near(start, displacement)
        if len(pairs) == 0:
            return DiskMotion(velocity, displacement)
        springs = Springs(start, pairs, before)
        impulse, iterations, converged = self.load(springs)
        velocity[springs.rows], displacement[springs.rows] = springs.velocity, springs.displacement
        on = np.flatnonzero(impulse > 0)
        at = springs.after.take(on)
        contacts = pairs.take(on).contacts(at, before.gap[on], np.full(len(on), start.dt / 2))
        psi, increment = np.zeros(len(on)), at.gap - before.gap[on]
        details = Details(contacts, impulse[on], psi, psi, increment)
        return DiskMotion(velocity, displacement, details, converged=converged, iterations=iterations)

    @abstractmethod
    def load(self, springs: Springs) -> tuple[FloatArray, int, bool]:
        """Solve for the impulses (m,) of the springs, and call `springs.move` with the motion. Returns the impulses,
        the number of iterations, and whether they converged."""


class Springs:
    """The m near pairs of a step on the R bodies they touch, and the trial motion of these bodies.

    Attributes:
        rows: (R,) of the bodies.  row_a, row_b: (m,) places of the bodies of each pair in `rows`.
        before, after: geometry (m,) of the pairs at the start, and at the end of the trial motion.
        displacement, velocity: (R, 2) of the trial motion, and at its end.
    """

    def __init__(self, start: Start, pairs: Pairs, before: Geometry) -> None:
        self.dt, self.pairs, self.before = start.dt, pairs, before
        self.rows, self.row_a, self.row_b = restrict(pairs.row_a, pairs.row_b, len(start.position))
        rows = self.rows
        self.inverse_mass = start.inverse_mass[rows]
        self.start_position, self.start_velocity = start.position[rows], start.velocity[rows]
        self.acceleration = start.acceleration[rows]
        self.move(start.free_displacement[rows], self.start_velocity + start.dt * self.acceleration)

    def move(self, displacement: FloatArray, velocity: FloatArray) -> None:
        """Set the trial displacement and the velocity at its end (R, 2), and compute the gaps there."""
        self.displacement, self.velocity = displacement, velocity
        position = self.start_position + displacement
        after = self.pairs.between(position[self.row_a], position[self.row_b])
        # Behind a static shape the gap continues to fall, and the normal remains that of the side of the start: there
        # the distance of the cores counts as negative, gap = -distance - extent.
        through = self.pairs.walls & ((after.normal * self.before.normal).sum(axis=1) < 0)
        if through.any():
            middle = self.start_position + 0.5 * displacement
            through &= self.pairs.between(middle[self.row_a], middle[self.row_b]).gap < 0
        normal = np.where(through[:, None], -after.normal, after.normal)
        gap = np.where(through, -after.gap - 2.0 * self.pairs.extent, after.gap)
        self.after = Geometry(gap, normal, after.point)

    def operator(self, normal: FloatArray) -> Delassus:
        return Delassus(self.row_a, self.row_b, normal, self.inverse_mass)

    def solve(
        self, A: Delassus, on: IntArray, q: FloatArray, compliance: FloatArray | float, guess: FloatArray
    ) -> FloatArray:
        """(m,) solution of the complementarity problem of the contacts `on`; q, compliance and guess are theirs."""
        result = np.zeros(A.size)
        if len(on):
            part = A.take(on)
            # Inner solves may be inexact: the outer iteration continues from them.
            result[on] = solve(part, q, compliance, guess, 1e-14, max_iterations=100).lam
        return result

    def discrete_normal(self) -> FloatArray:
        """(m, 2) discrete derivative of the gap (Gonzalez, the paper's reference [8]): n . (Delta q_b - Delta q_a) =
        Delta g.

        The mean of the vectors between centres at both ends over their mean length; shorter than 1 if they have
        rotated.
        """
        d_n, d_np1 = self.before.gap + self.pairs.extent, self.after.gap + self.pairs.extent
        total = np.abs(d_n) + np.abs(d_np1)
        weighted = d_n[:, None] * self.before.normal + d_np1[:, None] * self.after.normal
        return np.where((total > 0)[:, None], weighted / np.where(total > 0, total, 1.0)[:, None], self.before.normal)


class PenaltyEnergyMomentum(PenaltyStepper):
    """Gonzalez's discrete derivative of the penalty potential, midpoint kinematics (paper Eqs. 9, 12).

    Conserves the energy of bodies and springs together, linear and angular momentum; the bodies' energy dips while a
    spring is loaded (paper Fig. 1). Elasticity is taken as 1.
    """

    def load(self, springs: Springs) -> tuple[FloatArray, int, bool]:
        dt, K = springs.dt, self.stiffness
        g_n = springs.before.gap
        lam = np.zeros(len(g_n))
        iteration, converged = 0, False
        while not converged and iteration < self.max_iterations:
            iteration += 1
            A = springs.operator(springs.discrete_normal())
            force, slope = discrete_force(g_n, springs.after.gap, K)
            # Newton: the force is linear in g_np1 about the trial, lam = dt (force - slope (g_np1 - g_np1 of the
            # trial)). Where slope > 0 this is a complementarity problem with compliance.
            loaded = np.flatnonzero(slope > 0)
            increment = springs.after.gap - g_n
            u_mean = A.relative(springs.start_velocity + 0.5 * dt * springs.acceleration)
            q = 2.0 * (u_mean - increment / dt)
            stiff = slope[loaded]
            q_on = q[loaded] - 2.0 * force[loaded] / (dt * stiff)
            new = springs.solve(A, loaded, q_on, 2.0 / (dt * dt * stiff), lam[loaded])
            change, lam = np.max(np.abs(new - lam)), new
            velocity = springs.start_velocity + dt * springs.acceleration + A.change(lam)
            springs.move(0.5 * dt * (springs.start_velocity + velocity), velocity)
            converged = bool(change <= self.tolerance * np.max(lam))
        return lam, iteration, converged


def discrete_force(g_n: FloatArray, g_np1: FloatArray, K: float) -> tuple[FloatArray, FloatArray]:
    """-(V_np1 - V_n) / (g_np1 - g_n) of V = K min(g, 0)^2 / 2, and its slope -d/dg_np1 >= 0; both (m,).

    For two closed ends the force is -K (g_n + g_np1) / 2 (Eq. 12) and the slope K / 2; for two open ends both are 0.
    """
    c_n, c_np1 = np.minimum(g_n, 0.0), np.minimum(g_np1, 0.0)
    crossing = (g_n < 0) != (g_np1 < 0)
    increment = np.where(crossing, g_np1 - g_n, 1.0)
    force = np.where(crossing, -0.5 * K * (c_np1 + c_n) * (c_np1 - c_n) / increment, -0.5 * K * (c_n + c_np1))
    slope = np.where(crossing, (force + K * c_np1) / increment, np.where(g_np1 < 0, 0.5 * K, 0.0))
    return force, slope

"""Newmark's rules on penalty springs (paper section 6, Table I): the baselines that gain or lose energy at contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from .penalty import PenaltyStepper, Springs

if TYPE_CHECKING:
    import pymunk


class Newmark(PenaltyStepper):
    """Newmark-beta stepping of bodies on unilateral springs, implicit in the contact: a spring acts where g_np1 < 0.

        q_np1 = q_n + dt v_n + dt² ((1/2 - beta) a_n + beta a_np1)
        v_np1 = v_n + dt ((1 - gamma) a_n + gamma a_np1),     a = M^-1 (f_ext + K max(-g, 0) n)

    Elasticity is taken as 1.

    Args:
        space: a pymunk space.
        stiffness: K > 0, mass/time².
        beta: 0 < beta <= 1/2.
        gamma: 0 <= gamma <= 1.
        sync: as of `EECA`.
    """

    tolerance = 1e-8

    def __init__(self, space: pymunk.Space, stiffness: float, beta: float, gamma: float, *, sync: bool = True) -> None:
        if not 0.0 < beta <= 0.5:
            raise ValueError(f"beta = {beta}: give a number in (0, 1/2]")
        if not 0.0 <= gamma <= 1.0:
            raise ValueError(f"gamma = {gamma}: give a number in [0, 1]")
        self.beta, self.gamma = float(beta), float(gamma)
        super().__init__(space, stiffness, sync=sync)

    @classmethod
    def trapezoidal(cls, space: pymunk.Space, stiffness: float, *, sync: bool = True) -> Newmark:
        """beta = 1/4, gamma = 1/2: no numerical damping; gains energy at impacts."""
        return cls(space, stiffness, 0.25, 0.5, sync=sync)

    @classmethod
    def max_dissipation(cls, space: pymunk.Space, stiffness: float, *, sync: bool = True) -> Newmark:
        """beta = .49, gamma = 1: the largest numerical damping of the family; loses energy at impacts."""
        return cls(space, stiffness, 0.49, 1.0, sync=sync)

    def load(self, springs: Springs) -> tuple[FloatArray, int, bool]:
        dt, K, beta, gamma = springs.dt, self.stiffness, self.beta, self.gamma
        before = springs.operator(springs.before.normal)
        f_n = K * np.maximum(-springs.before.gap, 0.0)
        a_n = springs.acceleration + before.change(f_n)
        free = dt * springs.start_velocity + dt * dt * ((0.5 - beta) * a_n + beta * springs.acceleration)
        f = np.zeros_like(f_n)
        springs.move(free, springs.start_velocity)
        iteration, converged = 0, False
        while not converged and iteration < self.max_iterations:
            iteration += 1
            # f = -K g_np1 where closed, with g_np1 linear in f about the trial: a problem with compliance.
            A = springs.operator(springs.after.normal)
            on = np.flatnonzero((springs.after.gap < 0) | (f > 0))
            q = springs.after.gap / (beta * dt * dt) - A @ f
            new = springs.solve(A, on, q[on], 1.0 / (K * beta * dt * dt), f[on])
            change, f = np.max(np.abs(new - f)), new
            a_np1 = springs.acceleration + A.change(f)
            velocity = springs.start_velocity + dt * ((1.0 - gamma) * a_n + gamma * a_np1)
            springs.move(free + beta * dt * dt * (a_np1 - springs.acceleration), velocity)
            converged = bool(change <= self.tolerance * np.max(f))
        return dt * ((1.0 - gamma) * f_n + gamma * f), iteration, converged

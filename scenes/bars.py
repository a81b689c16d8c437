"""Bars on pivots in a row, by their angles alone: the equations that textbooks have, by Runge and Kutta's fourth order.

Joints cannot come apart there, so that it is a reference that shares nothing with constraints and their solvers.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .scene import FloatArray


class Bars:
    """N bars that hang on each other, the first on the ground at (0, 0).

    Bar i has its centre of mass `near[i]` from its upper pivot, and carries the next one at `far[i]` from it.

    Args:
        mass, moment, near, far: (N,) SI units, moments about centres of mass.
        angle: (N,) from the x axis, at rest.  gravity: m/s², along -y.
    """

    def __init__(
        self, mass: FloatArray, moment: FloatArray, near: FloatArray, far: FloatArray, angle: FloatArray, gravity: float
    ) -> None:
        count = len(mass)
        # (N, N) how far angle k moves the centre of bar i.
        self.lever: FloatArray = np.tril(np.broadcast_to(far, (count, count)), -1) + np.diag(near)
        self._coupling = self.lever.T @ (mass[:, None] * self.lever)
        self._moment = np.diag(moment)
        self._weight = gravity * (mass @ self.lever)
        self.angle: FloatArray = np.array(angle, np.float64)
        self.rate: FloatArray = np.zeros(count)

    def acceleration(self, angle: FloatArray, rate: FloatArray) -> FloatArray:
        """(N,) rad/s²: C cos(a_k - a_j) a_j'' + C sin(a_k - a_j) a_j'^2 + J a_k'' = -w_k cos a_k."""
        apart = angle[:, None] - angle[None]
        pull = -self._weight * np.cos(angle) - (self._coupling * np.sin(apart)) @ rate**2
        return np.asarray(np.linalg.solve(self._coupling * np.cos(apart) + self._moment, pull), np.float64)

    def run(self, duration: float, steps: int) -> None:
        """Go on for `duration` (s) in so many steps."""
        h = duration / steps
        for _ in range(steps):
            a, w = self.angle, self.rate
            k1 = self.acceleration(a, w)
            k2 = self.acceleration(a + 0.5 * h * w, w + 0.5 * h * k1)
            k3 = self.acceleration(a + 0.5 * h * w + 0.25 * h * h * k1, w + 0.5 * h * k2)
            k4 = self.acceleration(a + h * w + 0.5 * h * h * k2, w + h * k3)
            self.angle = a + h * w + h * h / 6.0 * (k1 + k2 + k3)
            self.rate = w + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)

    def places(self) -> FloatArray:
        """(N, 2) centres of mass."""
        return np.column_stack((self.lever @ np.cos(self.angle), self.lever @ np.sin(self.angle)))


def exact(make: Callable[[], Bars], step: float = 1e-3) -> Callable[[float], FloatArray]:
    """Places of bars at any time t >= 0, in steps of at most `step` (s) from the last time that was asked for."""
    bars, now = make(), 0.0

    def at(t: float) -> FloatArray:
        nonlocal bars, now
        if t < now:
            bars, now = make(), 0.0
        if t > now:
            bars.run(t - now, math.ceil((t - now) / step))
            now = t
        return bars.places()

    return at

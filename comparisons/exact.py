"""Exact solutions by events, one after the other: the reference that the steppers' trajectories are measured against.

Written for clarity and independence, not for speed: it shares no code with the package.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


@dataclass
class Gas:
    """N elastic, frictionless disks in the box [0, side]², without gravity.

    `position`, `velocity` (N, 2); `radius`, `mass` (N,); `events` counts the impacts so far.
    """

    position: FloatArray
    velocity: FloatArray
    radius: FloatArray
    mass: FloatArray
    side: float = 1.0
    events: int = 0

    def run(self, duration: float) -> None:
        """Move to the time `duration` from now, impact by impact."""
        left = duration
        pair, wall = self._pair_times(np.arange(len(self.radius))), self._wall_times()
        while True:
            i, j = divmod(int(np.argmin(pair)), len(self.radius))
            k, axis = divmod(int(np.argmin(wall)), 2)
            step = min(pair[i, j], wall[k, axis])
            if step > left:
                self.position += left * self.velocity
                return
            self.position += step * self.velocity
            left -= step
            pair -= step
            wall -= step
            self.events += 1
            if pair[i, j] <= wall[k, axis]:
                self._reflect(i, j)
                changed = np.array([i, j])
            else:
                self.velocity[k, axis] *= -1.0
                changed = np.array([k])
            times = self._pair_times(changed)
            pair[changed, :] = times
            pair[:, changed] = times.T
            wall[changed] = self._wall_times()[changed]

    def _reflect(self, i: int, j: int) -> None:
        d = self.position[j] - self.position[i]
        n = d / math.hypot(*d)
        u = float(n @ (self.velocity[j] - self.velocity[i]))
        impulse = -2.0 * u / (1.0 / self.mass[i] + 1.0 / self.mass[j]) * n
        self.velocity[i] -= impulse / self.mass[i]
        self.velocity[j] += impulse / self.mass[j]

    def _pair_times(self, rows: npt.NDArray[np.intp]) -> FloatArray:
        """(len(rows), N) time until disk `rows[i]` meets disk j, infinity if it does not."""
        d = self.position[None] - self.position[rows, None]
        u = self.velocity[None] - self.velocity[rows, None]
        s = self.radius[None] + self.radius[rows, None]
        b = (d * u).sum(axis=2)
        uu = (u * u).sum(axis=2)
        cross = d[..., 0] * u[..., 1] - d[..., 1] * u[..., 0]
        D = uu * s * s - cross * cross
        c = (d * d).sum(axis=2) - s * s
        with np.errstate(invalid="ignore", divide="ignore"):
            time = c / (np.sqrt(D) - b)
        return np.where((b < 0.0) & (D > 0.0), np.maximum(time, 0.0), np.inf)

    def _wall_times(self) -> FloatArray:
        """(N, 2) time until each disk meets a wall across x and across y."""
        r, v = self.radius[:, None], self.velocity
        with np.errstate(divide="ignore", invalid="ignore"):
            time = np.where(v > 0.0, (self.side - r - self.position) / v, (r - self.position) / v)
        return np.where(v != 0.0, np.maximum(time, 0.0), np.inf)

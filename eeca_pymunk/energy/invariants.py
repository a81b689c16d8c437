"""Energy and momenta of a space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray


@dataclass(frozen=True)
class Invariants:
    """Sums over the dynamic bodies; angular momentum about the origin, potential energy zero at the origin.

    `kinetic`, `potential` energy; `linear_momentum` (2,) mass length/time; `angular_momentum` mass length²/time.
    """

    kinetic: float
    potential: float
    linear_momentum: FloatArray
    angular_momentum: float

    @property
    def energy(self) -> float:
        """Kinetic plus potential energy."""
        return self.kinetic + self.potential


def sums(
    mass: FloatArray,
    moment: FloatArray,
    center: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    gravity: tuple[float, float],
) -> Invariants:
    """Of n bodies with masses and moments (n,), centres of mass (n, 2), velocities (n, 2) and spins (n,) rad/time."""
    # A body of infinite moment keeps its spin whatever happens: what is constant, and infinite, is not counted.
    turning = np.multiply(moment, spin, out=np.zeros_like(spin), where=np.isfinite(moment))
    kinetic = 0.5 * float(np.sum(mass * np.sum(velocity * velocity, axis=1)) + np.sum(turning * spin))
    potential = -float(np.sum(mass * (center @ np.asarray(gravity, float))))
    p = mass[:, None] * velocity
    angular = float(np.sum(center[:, 0] * p[:, 1] - center[:, 1] * p[:, 0]) + np.sum(turning))
    return Invariants(kinetic, potential, p.sum(axis=0), angular)

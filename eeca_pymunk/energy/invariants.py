"""Energy and momenta of a space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray


@dataclass(frozen=True)
class Invariants:
    """Sums over the dynamic bodies at one moment; angular momentum about the origin, potential energy zero at the
    origin.

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


def traces(
    mass: FloatArray, moment: FloatArray, center: FloatArray, velocity: FloatArray, spin: FloatArray,
    gravity: tuple[float, float],
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """Kinetic and potential energy (T,), linear momentum (T, 2) and angular momentum (T,) at T instants, as of
    `Invariants`, of n bodies with masses and moments (n,), centres of mass and velocities (T, n, 2) and spins (T, n)
    rad/time."""
    # The spin of a body of infinite moment is constant: its infinite energy is left out.
    inertia = np.where(np.isfinite(moment), moment, 0.0)
    # Sums run over contiguous rows, so that the sums of one moment do not depend on T, bit by bit.
    x, y, vx, vy = (np.ascontiguousarray(a[..., k]) for a in (center, velocity) for k in (0, 1))
    spin = np.ascontiguousarray(spin)
    px, py, turning = mass * vx, mass * vy, inertia * spin
    kinetic = 0.5 * (np.sum(px * vx + py * vy, axis=-1) + np.sum(turning * spin, axis=-1))
    potential = -np.sum(mass * (x * gravity[0] + y * gravity[1]), axis=-1)
    linear = np.stack((np.sum(px, axis=-1), np.sum(py, axis=-1)), axis=-1)
    angular = np.sum(x * py - y * px, axis=-1) + np.sum(turning, axis=-1)
    return kinetic, potential, linear, angular

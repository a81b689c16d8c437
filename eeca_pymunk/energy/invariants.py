"""Energy and momenta of a space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from ..arrays import FloatArray

Number = TypeVar("Number", float, FloatArray)


@dataclass(frozen=True)
class Sums(Generic[Number]):
    """Sums over the dynamic bodies; angular momentum about the origin, potential energy zero at the origin.

    `kinetic`, `potential` energy; `linear_momentum` (..., 2) mass length/time; `angular_momentum` mass length²/time.
    """

    kinetic: Number
    potential: Number
    linear_momentum: FloatArray
    angular_momentum: Number

    @property
    def energy(self) -> Number:
        """Kinetic plus potential energy."""
        return self.kinetic + self.potential


class Invariants(Sums[float]):
    """The sums of one moment: numbers, and linear momentum (2,)."""


class Traces(Sums[FloatArray]):
    """The sums of T moments: energies and angular momentum (T,), linear momentum (T, 2)."""


def traces(
    mass: FloatArray, moment: FloatArray, center: FloatArray, velocity: FloatArray, spin: FloatArray,
    gravity: tuple[float, float],
) -> Traces:  # fmt: skip
    """Of n bodies with masses and moments (n,), centres of mass and velocities (T, n, 2) and spins (T, n) rad/time."""
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
    return Traces(kinetic, potential, linear, angular)


def sums(
    mass: FloatArray, moment: FloatArray, center: FloatArray, velocity: FloatArray, spin: FloatArray,
    gravity: tuple[float, float],
) -> Invariants:  # fmt: skip
    """Of one moment: centres of mass and velocities (n, 2), spins (n,)."""
    one = traces(mass, moment, center[None], velocity[None], spin[None], gravity)
    return Invariants(
        float(one.kinetic[0]), float(one.potential[0]), one.linear_momentum[0], float(one.angular_momentum[0])
    )

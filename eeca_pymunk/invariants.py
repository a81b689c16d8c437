"""Energy and momenta of a space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymunk

from .bodies import ANGULAR_VELOCITY, VELOCITY, Bodies, FloatArray


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


def measure(space: pymunk.Space) -> Invariants:
    """Energy and momenta of the space now."""
    bodies = Bodies(space)
    state = bodies.gather()
    assert state is not None  # read from these very bodies
    return invariants(bodies, state, space.gravity)


def invariants(bodies: Bodies, state: FloatArray, gravity: tuple[float, float]) -> Invariants:
    """Energy and momenta of an (N, 9) state of `bodies`."""
    d = bodies.dynamic
    m, inertia = bodies.mass[d], bodies.moment[d]
    v, omega = state[d, VELOCITY], state[d, ANGULAR_VELOCITY]
    center = bodies.poses(state, bool(bodies.center_of_gravity.any()))[d, :2]
    # A body of infinite moment does not turn; 0 * inf must not become NaN.
    spin = np.multiply(inertia, omega, out=np.zeros_like(omega), where=omega != 0)
    kinetic = 0.5 * float(np.sum(m * np.sum(v * v, axis=1)) + np.sum(spin * omega))
    potential = -float(np.sum(m * (center @ np.asarray(gravity, float))))
    p = m[:, None] * v
    angular = float(np.sum(center[:, 0] * p[:, 1] - center[:, 1] * p[:, 0]) + np.sum(spin))
    return Invariants(kinetic, potential, p.sum(axis=0), angular)

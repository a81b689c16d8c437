"""Measure: energy and momenta of a space in its present state."""

from __future__ import annotations

import pymunk

from ..arrays import FloatArray
from ..energy.invariants import Invariants, sums
from .bodies import ANGULAR_VELOCITY, VELOCITY, Bodies


def measure(space: pymunk.Space) -> Invariants:
    """Energy and momenta of the space now."""
    bodies = Bodies(space)
    return invariants(bodies, bodies.start, space.gravity)


def invariants(bodies: Bodies, state: FloatArray, gravity: tuple[float, float]) -> Invariants:
    """Energy and momenta of an (N, 9) state of `bodies`."""
    d = bodies.dynamic
    center = bodies.centers(state)[d]
    return sums(bodies.mass[d], bodies.moment[d], center, state[d, VELOCITY], state[d, ANGULAR_VELOCITY], gravity)

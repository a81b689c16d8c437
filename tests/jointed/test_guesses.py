"""What iterations between contacts and components begin with does not decide where they end."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray


def slid(factor: float) -> FloatArray:
    """Velocities (3, 3) of three boxes on pivots that slide on a floor, after a step that begins with `factor` times
    the contact forces of the one before."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    floor.friction = 0.5
    space.add(floor)
    bodies: list[pymunk.Body] = []
    for i in range(3):
        body = pymunk.Body(1.0, 0.1)
        body.position, body.velocity = (float(i), 0.25), (0.5, 0.0)
        box = pymunk.Poly.create_box(body, (0.8, 0.5))
        box.friction = 0.5
        space.add(body, box)
        if bodies:
            space.add(pymunk.PivotJoint(bodies[-1], body, (i - 0.5, 0.25)))
        bodies.append(body)
    stepper = ep.EECA(space)
    for _ in range(3):
        assert stepper.step(1 / 60).converged
    forces = stepper.event_loop.scene.FORCES
    for i in range(len(forces)):
        forces[i].normal *= factor
        forces[i].tangential *= factor
    assert stepper.step(1 / 60).converged
    return np.array([(*b.velocity, b.angular_velocity) for b in bodies])


@pytest.mark.parametrize("factor", [1e2, 1e6, 1e10])
def test_impulses_do_not_depend_on_those_guessed(factor: float) -> None:
    assert np.abs(slid(factor) - slid(1.0)).max() <= 1e-8

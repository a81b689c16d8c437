"""The penetration correction is paid from the losses of contacts before it is work of what moves by itself."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.kernels import prepare

DT = 1 / 240
THROWS = 10 if not prepare().entries else 60  # kernels as plain Python


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_a_plate_that_moves_does_no_more_than_its_impulses(unit: float) -> None:
    """Triangles that spin fall on a plate that creeps, and turn into it within an interval, as its rows are linear.
    What lifts them has been lost before. |J| |v| bounds the work of a plate that was in nobody at the start."""
    for throw in range(THROWS):
        rng = np.random.default_rng(throw)
        space = pymunk.Space()
        space.gravity = 0.0, -1e4 * unit  # 0.17 of the size in a step
        plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        plate.velocity = tuple(unit * rng.uniform(-1.0, 1.0, 2))
        wall = pymunk.Segment(plate, (-20.0 * unit, 0.0), (20.0 * unit, 0.0), 0.1 * unit)
        space.add(plate, wall)
        corners = [(0.55 * unit * math.cos(x), 0.55 * unit * math.sin(x)) for x in (0.0, 2.1, 4.2)]
        for k in range(2):
            body = pymunk.Body(1.0, 0.12 * unit**2)
            body.position, body.angle = (unit * rng.uniform(-0.2, 0.2), unit * (0.9 + 1.1 * k)), rng.uniform(-3.0, 3.0)
            body.velocity = unit * rng.uniform(-100.0, 100.0), unit * rng.uniform(-100.0, 0.0)
            body.angular_velocity = rng.uniform(-300.0, 300.0)
            space.add(body, pymunk.Poly(body, corners))
        for shape in space.shapes:
            shape.elasticity = 0.5
        stepper, overlap = ep.EECA(space), 0.0
        for _ in range(12):
            report = stepper.step(DT)
            assert report.ledger is not None
            most = np.abs(report.impulse).sum() * plate.velocity.length
            most += overlap * 2.0 * -space.gravity[1]  # what is deep already may be lifted
            assert report.ledger.external <= most * (1.0 + 1e-9)
            assert report.ledger.restitution >= -1e-7 * unit**2  # 1e-11 of the energy at the start
            overlap = max(0.0, -report.contacts.gap.min(initial=0.0))

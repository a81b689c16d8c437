"""Redundant rows under loads that are thousands of times heavier than the bodies which hold them."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.joint_steps import EXACT

from .driving import Driven, error


@pytest.mark.parametrize("load", [100.0, 8552.0, 1e5])
def test_a_heavy_load_on_welds_that_are_redundant_is_solved_in_whole_steps(load: float) -> None:
    # Terms on the diagonal as large as the error left the light bodies' rows so soft that Newton's method hardly went
    # on: steps were taken in parts, or elastically (random scene 22003835).
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    ground, near, far = space.static_body, pymunk.Body(1.0, 0.056), pymunk.Body(11.2, 0.274)
    near.position, far.position = (-1.0, -3.0), (-3.0, -1.0)
    swing, plate = pymunk.Body(load, math.inf), pymunk.Body(1892.0, math.inf)
    swing.position, swing.velocity, plate.position = (-0.08, -4.475), (-4.56, -2.05), (3.0, 1.0)
    space.add(near, far, swing, plate)
    space.add(pymunk.PivotJoint(ground, near, (-1, -3)), pymunk.GearJoint(ground, near, 0, 1))
    space.add(pymunk.PivotJoint(near, far, (-3, -1)), pymunk.GearJoint(near, far, 0, 1))
    space.add(pymunk.GearJoint(far, near, 0, 2), pymunk.PivotJoint(plate, far, (3, 1)))
    space.add(pymunk.PinJoint(near, swing, (0.055, 0.06), (-0.122, -0.233)))
    stepper = Driven(space, 2)
    energies = []
    for _ in range(20):
        stepper.step(0.1)
        assert stepper.status == EXACT
        energies.append(ep.measure(space).energy)
    assert error(space) < 3e-11  # round-off of 1e-14 of momenta, times the load's mass over that of a light body
    assert max(energies) - min(energies) < 1e-11 * load * 9.81 * 5.0

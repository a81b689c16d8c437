"""Redundant rows under loads that are thousands of times heavier than the bodies which hold them."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.joint_steps import EXACT
from scenes.linkages import body, empty

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


@pytest.mark.parametrize("off", [1e-13, 1e-12, 1e-11])
def test_knots_in_line_that_are_apart_by_round_off_are_solved_in_whole_steps(off: float) -> None:
    """A knot between two ends of a rod, on pins that are too short together: no motion closes them, and each iteration
    makes the error only a little smaller."""
    space = empty(0.0)
    rod, knot = body(space, 2.0, 1.0, (0.0, 0.0), 0.0), body(space, 1.0, 0.3, (0.0, 0.0), 0.0)
    for one in (rod, knot):
        one.velocity, one.angular_velocity = (1.0, 2.0), 1.0
    for x in (-1.0, 1.0):
        pin = pymunk.PinJoint(rod, knot, (x, 0.0), (0.0, 0.0))
        pin.distance = 1.0 - off
        space.add(pin)
    driven = Driven(space, 2)
    for _ in range(3):
        driven.step(1 / 60)
        assert driven.status == EXACT
    assert error(space) <= off + 1e-15

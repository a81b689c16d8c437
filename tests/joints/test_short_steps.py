"""Steps that are short beside those before."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep


@pytest.mark.parametrize("short", [1e-4, 1e-5, 1e-6, 1e-7])
def test_joints_give_no_energy_in_short_steps(short: float) -> None:
    """A long step leaves a velocity along the pin, of second order, which a short one stops by the larger a force; it
    works by the round-off of places."""
    space = pymunk.Space()
    body = pymunk.Body(1.0, 0.3)
    body.position, body.velocity, body.angular_velocity = (3.0, 4.0), (40.0, -30.0), 15.0
    space.add(body, pymunk.PinJoint(body, space.static_body, (-1.1, -0.4), (0.3, -0.1)))
    stepper = ep.EECA(space)
    for k in range(200):
        moved = ep.measure(space).kinetic
        ledger = stepper.step(0.1 if k % 2 == 0 else short * (1.0 + 0.01 * k)).ledger
        assert ledger is not None
        assert ledger.external <= 3e-12 * moved

"""Steps that are short beside those before."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.joints import GIVES_WAY


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


def test_joints_that_close_in_a_short_step_lift_nothing() -> None:
    """A weight at rest hangs too low by 1e-8, on a pivot that gives way since an earlier step. To close it within 3e-10
    s takes 33 m/s, an energy that is taken back; the weight is lifted by that as well, at the cost of a 2e-10th."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    body = pymunk.Body(1.0, 0.3)
    body.position = 0.0, -1.0
    space.add(body, pymunk.PivotJoint(space.static_body, body, (0.0, 0.0)))
    stepper = ep.EECA(space)
    stepper.step(1 / 60)
    assert stepper.event_loop is not None
    pivot = stepper.event_loop.joints.JOINT[0]
    pivot.anchor_a[1], pivot.touched = 1e-8, GIVES_WAY
    for _ in range(3):
        ledger = stepper.step(3e-10).ledger
        assert ledger is not None
        assert ledger.external <= 1e-15
        assert body.position.y <= -1.0 + 1e-15

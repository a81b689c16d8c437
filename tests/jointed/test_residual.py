"""`report.unmet` of contacts that have no solution beside joints: velocities, with bounds that kinematics sets."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.unmet import Unmet

WAY = 0.1  # that a driven body goes towards walls, as long as the radius of the disk between


def driven(velocity: tuple[float, float]) -> pymunk.Body:
    partner = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    partner.position, partner.velocity = (1.0, 1.5), velocity
    return partner


def pressed(partner: pymunk.Body, weld: bool, walls: int, dt: float) -> list[Unmet]:
    """What contacts leave as a partner moves towards walls by WAY, and a weld or a pin joins it to a disk of radius WAY
    that touches them."""
    space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
    for end in ((9.0, 0.0), (0.0, 9.0))[:walls]:
        space.add(pymunk.Segment(space.static_body, (-end[0], -end[1]), end, 0.0))
    body.position, body.velocity = (WAY, WAY), partner.velocity
    space.add(body, pymunk.Circle(body, WAY), partner, pymunk.PinJoint(partner, body))
    if weld:
        held = pymunk.PivotJoint(partner, body, tuple(body.position))
        space.add(held, pymunk.GearJoint(partner, body, 0.0, 1.0))
    stepper, unmet = ep.EECA(space), list[Unmet]()
    for _ in range(math.ceil(WAY / (partner.velocity.length * dt))):
        unmet += [one for one in stepper.step(dt).unmet if one.name == "contacts"]
    assert unmet
    assert all(body in one.bodies for one in unmet)
    return unmet


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 1.0])
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_disk_that_a_weld_presses_into_a_floor_leaves_its_speed(dt: float, speed: float) -> None:
    for one in pressed(driven((0.3, -speed)), True, 1, dt):
        assert one.value == pytest.approx(speed, rel=1e-12)
        assert one.value > one.limit >= 0.0


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 1.0])
def test_a_disk_that_a_pin_presses_into_a_corner_leaves_what_the_pin_asks_for(dt: float) -> None:
    """A pin along d asks for d.u = d.v, so that max(-u_x, -u_y) >= (|d_x v_x| + |d_y v_y|)/(|d_x| + |d_y|)."""
    for one in pressed(driven((-0.3, -0.6)), False, 2, dt):
        assert 0.3 <= one.value < math.inf
        assert one.value > one.limit >= 0.0

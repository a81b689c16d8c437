"""Joints that lead a body through a wall: the oracle, and what the step says of it."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

from .led import led_out

DT, HALF, SIZE = 1 / 60, 1.0, 0.1


def hung(moment: float, far: float = 0.7) -> tuple[pymunk.Space, pymunk.Body, pymunk.Body]:
    """A box that turns, and a disk on a pivot of the box's centre, `far` from the disk's own: where the disk cannot
    turn, that leads it around in the frame of the box, whose corners are beyond its reach, on a circle."""
    space = pymunk.Space()
    box = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    box.angular_velocity = 1.0
    corners = [(HALF, HALF), (-HALF, HALF), (-HALF, -HALF), (HALF, -HALF)]
    walls = [pymunk.Segment(box, p, q, 0.0) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    body = pymunk.Body(1.0, moment)
    body.position = 0.7, 0.7
    disk = pymunk.Circle(body, SIZE)
    joint = pymunk.PivotJoint(box, body, (0.7 - far, 0.7 - far))
    joint.collide_bodies = True
    space.add(box, *walls, body, disk, joint)
    return space, box, body


@pytest.mark.parametrize("moment", [0.01, math.inf])
def test_a_body_without_freedom_is_led_through_a_wall_and_one_that_turns_is_not(moment: float) -> None:
    """A contact that joints lead deep is not met; before, steps said that they had converged."""
    space, box, body = hung(moment)
    stepper, led, unmet = ep.EECA(space), False, False
    for _ in range(120):
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-12
        out = max(map(abs, box.world_to_local(body.position))) - HALF
        deep = out > -0.5 * SIZE
        if deep:
            led = led or led_out(space, box, body, 1.0)
        unmet = unmet or any(one.name == "contacts" for one in report.unmet)
    print(led, unmet, deep, out)
    assert led == unmet == math.isinf(moment)

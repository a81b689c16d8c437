"""Joints that lead a body through a wall: the oracle, and what the step says of it."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

from .led import kept_out, led_out

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


@pytest.mark.parametrize("unit", [1e-3, 1.0, 50.0])
@pytest.mark.parametrize(("short", "kept"), [(0.05, True), (-0.05, False)])
def test_a_linkage_before_its_dead_centre_keeps_a_body_out_though_it_may_move_inward(
    short: float, kept: bool, unit: float
) -> None:
    """A rod turns about a point of the box, and leads a body that cannot turn: its other end is on an arm of length 1,
    and .2 at the least, but for `short`, below the place where the body would be at the wall."""
    space, half = pymunk.Space(), 5.0 * unit
    box, body = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, math.inf)
    rod = pymunk.Body(1.0, unit * unit)
    middle = pymunk.Vec2d(0.0, 4.2 + short) * unit
    rod.position, rod.angle = middle, -0.5 * math.pi + 0.1
    body.position = rod.local_to_world((0.2 * unit, 0.0)) + pymunk.Vec2d(0.0, unit)
    loose = pymunk.SlideJoint(box, body, (0.0, 0.0), (0.0, 0.0), 0.0, 99.0 * unit)
    space.add(box, body, rod, pymunk.PivotJoint(box, rod, middle), loose)
    space.add(pymunk.PivotJoint(rod, body, (0.2 * unit, 0.0), (0.0, -unit)))
    assert not led_out(space, box, body, unit)
    assert kept_out(space, box, body, unit, half) == kept
    assert not kept_out(space, box, rod, unit, half)

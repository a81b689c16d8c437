"""Velocities that are made to fit joints at the end of an interval do not lead contacts deeper."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

BELOW, HEAVY, STEPS = 0.3, 100.0, 60


def rolling(dt: float, driven: bool) -> float:
    """How deep a disk of radius 1 sinks into the floor on which a heavy body that hangs off its centre rocks it, until
    this throws it up."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-1e3, 0.0), (1e3, 0.0), 0.0)
    disk, bob = pymunk.Body(1.0, 0.5), pymunk.Body(HEAVY, math.inf)
    disk.position, bob.position = (0.0, 1.0), (BELOW, 1.0)
    space.add(floor, disk, bob, pymunk.Circle(disk, 1.0), pymunk.PivotJoint(disk, bob, (BELOW, 1.0)))
    if driven:
        motor = pymunk.SimpleMotor(disk, bob, 0.1)
        motor.max_force = 1e-3
        space.add(motor)
    stepper, deepest = ep.EECA(space), 0.0
    for step in range(STEPS):
        assert stepper.step(dt).converged
        if disk.position.y > 1.0 + 1e-6:
            assert step > 10
            break  # where it lands within an interval, it may sink by INTERVAL_DEPTH
        deepest = max(deepest, 1.0 - disk.position.y)
    return deepest


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("dt", [0.1, 0.3, 1.0])
def test_a_disk_that_rocks_does_not_sink_into_the_floor(dt: float, driven: bool) -> None:
    """The floor's impulses go through its centre, wherever it has rolled within the interval; a motor, whose force is
    bounded, takes no part in an impact."""
    assert rolling(dt, driven) < 1e-6


def pressed_down(unit: float, count: int, gap: float, dt: float) -> float:
    """The least velocity upward, over that of a free fall in a step, of the corners of a light box on a floor, after a
    step in which a column of heavy ones closes its gaps; a spring joins the lowest two."""
    space, shift = pymunk.Space(), 0.3
    space.gravity = 0.0, -100.0 * unit
    space.add(pymunk.Segment(space.static_body, (-9.0 * unit, 0.0), (9.0 * unit, 0.0), 0.0))
    boxes = []
    for k in range(count + 1):
        mass = 2000.0 if k else 1.0
        body = pymunk.Body(mass, 0.1 * mass * unit * unit)
        body.position = shift * unit * (k and (-1) ** k), (0.25 + k * (0.5 + gap)) * unit
        space.add(body, pymunk.Poly.create_box(body, (unit, 0.5 * unit)))
        boxes.append(body)
    stiff = 2e4 * unit * unit
    space.add(pymunk.DampedRotarySpring(boxes[0], boxes[1], 0.0, stiff, 0.1 * stiff))
    ep.EECA(space).step(dt)
    corners = ((x * unit, y * unit) for x in (-0.5, 0.5) for y in (-0.25, 0.25))
    return min(boxes[0].velocity_at_local_point(corner).y for corner in corners) / (100.0 * unit * dt)


@pytest.mark.parametrize("gap", [1e-3, 1e-2, 3e-2])
@pytest.mark.parametrize("count", [3, 5, 9])
@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_a_light_box_under_a_column_that_closes_does_not_enter_the_floor(unit: float, count: int, gap: float) -> None:
    """What keeps contacts from closing comes to no end among masses of 1 : 2000."""
    assert pressed_down(unit, count, gap, 0.1) > -1e-6

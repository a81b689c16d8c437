"""Velocities that are made to fit joints at the end of an interval do not lead contacts deeper."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

BELOW, HEAVY, STEPS = 0.3, 100.0, 60


def rolling(dt: float, driven: bool) -> float:
    """How deep a disk of radius 1 sinks into the floor on which a heavy body that hangs off its centre rocks it."""
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
    for _ in range(STEPS):
        assert stepper.step(dt).converged
        deepest = max(deepest, 1.0 - disk.position.y)
    return deepest


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("dt", [0.1, 0.3, 1.0])
def test_a_disk_that_rocks_does_not_sink_into_the_floor(dt: float, driven: bool) -> None:
    """The floor's impulses go through its centre, wherever it has rolled within the interval; a motor, whose force is
    bounded, takes no part in an impact."""
    assert rolling(dt, driven) < 1e-6

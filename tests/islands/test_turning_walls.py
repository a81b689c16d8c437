"""Bodies that a turning wall carries along: how often their contacts are solved."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep

SPIN, G, DT, LIMIT = 1.0, 9.81, 0.1, 1e-4  # rad/s, lengths/s², s, depth in parts of a rod that an interval may reach


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e2])
def test_an_interval_is_as_long_as_the_poses_at_its_end_allow(unit: float) -> None:
    """Rods without width slide on a wall without width. Along the normal of the middle of an interval h one of speed s
    seems to close at s SPIN h / 2 at its start, where its way is along the wall. By the rows alone there would be 17
    intervals in the third step in the place of 9."""
    space = pymunk.Space()
    space.gravity = 0.0, -G * unit
    axis = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    axis.angular_velocity = SPIN
    space.add(axis, pymunk.Segment(axis, (-5.0 * unit, 0.0), (5.0 * unit, 0.0), 0.0))
    rods = []
    for x in (-2.0, 0.5, 2.0):
        rod = pymunk.Body(1.0, unit * unit / 3.0)
        rod.position = x * unit, 0.0
        rod.velocity, rod.angular_velocity = axis.velocity_at_world_point(rod.position), SPIN
        space.add(rod, pymunk.Segment(rod, (-0.5 * unit, 0.0), (0.5 * unit, 0.0), 0.0))
        rods.append(rod)
    stepper = ep.EECA(space)
    for _ in range(3):
        report = stepper.step(DT)
        assert report.converged
        assert min(axis.world_to_local(rod.position).y for rod in rods) >= -1.5 * LIMIT * unit
        assert len(report.contacts) <= 24  # of two points in each interval

"""Intervals of islands with joints that are brought to an instant: their paths lead through nobody."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.jointed.ends import shorten
from eeca_pymunk.jointed.meet import end_before, passes
from eeca_pymunk.jointed.solve import open_span
from eeca_pymunk.model.joint_steps import LINEAR
from eeca_pymunk.model.joints import Joints
from eeca_pymunk.model.scene import Scene

G, SPEED, RADIUS = 10.0, 20.0, 0.2


def falling(h: float, high: float) -> tuple[Scene, Joints]:
    """A disk on a long rope, its row is 0, that has begun an interval h in which it falls on a floor `high` below."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    body = pymunk.Body(2.0, 1.0)
    body.position, body.velocity = (0.0, high), (0.0, -SPEED)
    disk = pymunk.Circle(body, RADIUS)
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    disk.elasticity = floor.elasticity = 1.0
    space.add(body, disk, floor, pymunk.SlideJoint(space.static_body, body, (0, high), (0, 0), 0.0, 99.0))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = h
    A.BODY[0].since, A.BODY[0].y, A.BODY[0].vy = 0.0, high, -SPEED
    assert open_span(A, J, 0, 0.0, h, True)[0] == 0
    return A, J


@pytest.mark.parametrize("h", [0.01, 0.06, 0.1, 0.5, 5.0])
def test_a_path_through_a_wall_is_seen_wherever_it_ends(h: float) -> None:
    """In the wall, just behind it, where its other side is near, or far away."""
    A, _ = falling(h, 1.0)
    assert passes(A, 0, h) == (SPEED * h + 0.5 * G * h * h > 1.0 - RADIUS)


@pytest.mark.parametrize("h", [0.01, 0.1, 0.5, 1.0])
def test_an_interval_that_would_lead_through_a_wall_ends_before(h: float) -> None:
    """Its body stays on its side, with the energy that it had, until the instant that it is brought to."""
    A, J = falling(2.0 * h, 1.0)
    shorten(A, J, 0, h)
    assert end_before(A, J, 0, h, False) == (h > 0.01)
    assert (J.TALLY.worst == LINEAR) == (h > 0.01)
    body = A.BODY[0]
    assert (body.since, A.MEMBER[0].open) == (h, 0)
    assert RADIUS <= body.y <= 1.0
    assert 0.5 * body.vy**2 + G * body.y == pytest.approx(0.5 * SPEED**2 + G, rel=1e-12)
    if h == 0.01:
        assert body.y == pytest.approx(1.0 - SPEED * h - 0.5 * G * h * h, rel=1e-12)

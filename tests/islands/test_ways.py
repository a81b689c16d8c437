"""How far bodies move in an interval: what counts of a rotation."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.islands.hits import stays_shallow
from eeca_pymunk.model.parameters.intervals import INTERVAL_DEPTH_WIDTH


@pytest.mark.parametrize("wall", ["segment", "box", "circle"])
def test_a_disk_may_spin_on_any_wall(wall: str) -> None:
    """What rotates is the same disk: one interval, one solve in each step."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    ground = space.static_body
    shape = {
        "segment": pymunk.Segment(ground, (-50.0, 0.0), (50.0, 0.0), 0.0),
        "box": pymunk.Poly(ground, [(-50.0, -1.0), (50.0, -1.0), (50.0, 0.0), (-50.0, 0.0)]),
        "circle": pymunk.Circle(ground, 1000.0, (0.0, -1000.0)),
    }[wall]
    disk = pymunk.Body(1.0, 0.5)
    disk.position, disk.angular_velocity = (0.0, 1.0), 300.0
    rim = pymunk.Circle(disk, 1.0)
    shape.friction, rim.friction = 1.0, 0.1
    space.add(shape, disk, rim)
    stepper = ep.EECA(space)
    for _ in range(5):
        stepper.step(1 / 60)
        loop = stepper.event_loop
        assert loop is not None
        assert loop.scene.COUNT.solves == 1
    assert disk.velocity.x == pytest.approx(-0.1 * 10.0 * 5 / 60, rel=1e-3 if wall == "circle" else 1e-12)


def test_how_deep_shapes_may_get_is_bounded_from_the_instant_of_their_impact() -> None:
    """A body that has fallen since the start of the step closes with the speed that it has by now."""
    space, dt = pymunk.Space(), 1.0
    body, plate = pymunk.Body(1.0, 1.0), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    plate.position = 0.0, -300.0
    for one in (body, plate):
        shape = pymunk.Circle(one, 1.0)
        shape.elasticity = 0.5
        space.add(one, shape)
    loop = ep.EECA(space).event_loop
    assert loop is not None
    A = loop.scene
    A.PAR.pulled = g = 20.0 * INTERVAL_DEPTH_WIDTH * 2.0 / dt**2
    A.BODY[0].ay, A.BODY[0].since, A.BODY[1].since = -g, 0.0, 0.0
    # The way in what is left is (.9 .1 + .1^2 / 2) g dt^2 = 1.9 times the limit; from rest it would be a tenth of it.
    assert not stays_shallow(A, 0, 1, 0.9 * dt, 0.1 * dt)
    assert stays_shallow(A, 0, 1, 0.0, 0.1 * dt)

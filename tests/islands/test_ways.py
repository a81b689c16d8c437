"""How far bodies move in an interval: what counts of a rotation."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep


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

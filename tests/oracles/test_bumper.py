"""A product of elasticities above 1 throws lone disks back faster than they came; the ledger books what it makes."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize(("bumper", "ball"), [(1.5, 0.95), (1.5, 1.0), (1.5, 0.5)])
def test_a_bumper_throws_a_disk_back_with_the_product(bumper: float, ball: float, friction: float) -> None:
    space = pymunk.Space()
    round_bumper = pymunk.Circle(space.static_body, 1.0)
    body = pymunk.Body(1.0, 0.1)
    body.position, body.velocity = (3.0, 0.0), (-5.0, 0.0)
    disk = pymunk.Circle(body, 0.2)
    round_bumper.elasticity, disk.elasticity = bumper, ball
    round_bumper.friction = disk.friction = friction
    space.add(round_bumper, body, disk)
    stepper = ep.EECA(space)
    made = 0.0
    for _ in range(60):
        book = stepper.step(1.0 / 60.0).ledger
        assert book is not None
        assert abs(book.residual) < 1e-13
        made -= book.restitution + book.friction
    e = bumper * ball
    assert tuple(body.velocity) == pytest.approx((5.0 * e, 0.0), rel=1e-12)
    assert made == pytest.approx(12.5 * (e * e - 1.0), rel=1e-12)


def test_other_shapes_come_back_with_1() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.1)
    body = pymunk.Body(1.0, 0.1)
    body.position, body.angle = (0.0, 1.0), 0.3
    box = pymunk.Poly.create_box(body, (0.5, 0.5))
    floor.elasticity, box.elasticity = 1.2, 1.0
    space.add(floor, body, box)
    stepper = ep.EECA(space)
    before = ep.measure(space)
    for _ in range(60):
        stepper.step(1.0 / 60.0)
    after = ep.measure(space)
    gained = after.kinetic + after.potential - before.kinetic - before.potential
    assert abs(gained) < 1e-12 * before.potential

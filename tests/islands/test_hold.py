"""What is put to rest is held by the impulses that it reports, whatever else moves in the scene."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep

G, DT = 10.0, 1 / 60


@pytest.mark.parametrize("push", [0.0, 1e4])
def test_a_heap_at_rest_reports_its_weight_while_something_else_is_pushed_hard(push: float) -> None:
    """Boxes that are slow, and elsewhere a body pushed with 1000 times its weight, by which the largest acceleration of
    the scene is that much larger than the boxes'."""
    rng, space = np.random.default_rng(1), pymunk.Space()
    space.gravity = 0.0, -G
    floor = pymunk.Segment(space.static_body, (-500, 0), (500, 0), 0.5)
    floor.friction = 1.0
    space.add(floor)
    boxes = 0
    for row in range(6):
        for column in range(9 - row):
            body = pymunk.Body(1.0, 1 / 6)
            body.position = 1.02 * (column - 4 + 0.5 * row), 1.0 + row
            body.velocity = tuple(rng.normal(0.0, 0.02, 2))
            shape = pymunk.Poly.create_box(body, (1, 1))
            shape.friction = 0.5
            space.add(body, shape)
            boxes += 1
    pushed = pymunk.Body(1.0, 1.0)
    pushed.position = 0.0, 1e3
    space.add(pushed, pymunk.Circle(pushed, 0.5))
    stepper, rests = ep.EECA(space), 0
    for _ in range(30):
        pushed.force = push, 0.0
        report = stepper.step(DT)
        loop = stepper.event_loop
        assert loop is not None
        if (loop.scene.MEMBER["rest"] == 1).sum() >= boxes:
            rests += 1
            on_floor = report.contacts.point[:, 1] < 0.75
            assert report.impulse[on_floor].sum() == pytest.approx(boxes * G * DT, rel=1e-9)
    assert rests > 10

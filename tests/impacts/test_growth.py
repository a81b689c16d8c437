"""Steps whose tables grow on the way go on where they were."""

from __future__ import annotations

import random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.impacts import scene_memory


def path(monkeypatch: pytest.MonkeyPatch, seed: int, joints: bool, rows: int) -> list[tuple[float, ...]]:
    """The states of a heap whose tables of contacts begin with so many rows."""
    monkeypatch.setattr(scene_memory, "_CONTACTS", rows)
    monkeypatch.setattr(scene_memory, "_CONTACTS_OF_A_BODY", 0)
    R, space = random.Random(seed), pymunk.Space()
    space.gravity = 0.0, -900.0
    for p, q in (((-150, 0), (150, 0)), ((-150, 0), (-150, 600)), ((150, 0), (150, 600))):
        space.add(pymunk.Segment(space.static_body, p, q, 3.0))
    bodies = []
    for i in range(25):
        body, size = pymunk.Body(1.0, 100.0), R.uniform(8.0, 20.0)
        body.position = 50.0 * (i % 5) - 100.0 + R.uniform(-5.0, 5.0), 40.0 + 45.0 * (i // 5)
        shape = pymunk.Circle(body, 0.5 * size) if R.random() < 0.3 else pymunk.Poly.create_box(body, (size, size))
        shape.friction, shape.elasticity = 0.4, R.choice((0.0, 0.3))
        space.add(body, shape)
        bodies.append(body)
    for one, other in zip(bodies[:8:2], bodies[1:8:2], strict=True):
        if joints:
            space.add(pymunk.PinJoint(one, other))
    stepper, states = ep.EECA(space), []
    for _ in range(80):
        stepper.step(1 / 60)
        states += [(*body.position, body.angle, *body.velocity, body.angular_velocity) for body in bodies]
    return states


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_tables_that_grow_change_nothing(monkeypatch: pytest.MonkeyPatch, seed: int, joints: bool) -> None:
    assert path(monkeypatch, seed, joints, 16) == path(monkeypatch, seed, joints, 1 << 12)

"""On which side of each other thin shapes are, as predictions note it."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.geometry.sides import forget_pair, near_side, note_side, side_of
from eeca_pymunk.prediction.sides import begin_side


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("turn", [-0.4, 0.4])
def test_the_remembered_side_turns_with_the_shapes(turn: float, unit: float) -> None:
    """A plank and a rod that once touched end to end lie side by side, nearer than predictions tell sides, and turn."""
    space = pymunk.Space()
    plank, rod = pymunk.Body(1.0, unit * unit), pymunk.Body(1.0, unit * unit)
    half = 0.025 * unit
    space.add(plank, pymunk.Poly.create_box(plank, (2.0 * unit, 2.0 * half)))
    space.add(rod, pymunk.Segment(rod, (-unit, 0.0), (unit, 0.0), 0.0))
    rod.position = 0.0, 2.0 * half
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    loop = stepper.event_loop
    assert loop is not None
    scene, a, b = loop.scene, 0, 1
    apart = 0.5 * near_side(scene, a, b)
    note_side(scene, a, b, math.cos(0.3), math.sin(0.3), True)
    for k in range(20):
        angle = turn * k
        for i in (scene.LINK[a].owner, scene.LINK[b].owner):
            scene.BODY[i].angle = angle
        row = scene.BODY[scene.LINK[b].owner]
        row.x, row.y = -(half + apart) * math.sin(angle), (half + apart) * math.cos(angle)
        begin_side(scene, a, b, 0.0, 0.1)
        assert gap(scene, a, b, 0.0)[0] == pytest.approx(apart, rel=1e-6)


def test_the_memory_of_sides_has_room_again_for_what_was_forgotten() -> None:
    """Pairs that were forgotten leave their rows to others, which had replaced each other before."""
    space = pymunk.Space()
    for k in range(40):
        body = pymunk.Body(1.0, 1.0)
        body.position = 0.0, 10.0 * k
        space.add(body, pymunk.Segment(body, (-1.0, 0.0), (1.0, 0.0), 0.0))
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    loop = stepper.event_loop
    assert loop is not None
    scene = loop.scene
    pairs = [(a, b) for a in range(40) for b in range(a + 1, 40)]
    for _ in range(5):
        for a, b in pairs:
            note_side(scene, a, b, 1.0, 0.0, False)
        for a, b in pairs:
            forget_pair(scene, a, b)
    some = pairs[::7]
    for a, b in some:
        note_side(scene, a, b, 0.0, 1.0, False)
    assert all(side_of(scene, a, b) == (0.0, 1.0) for a, b in some)

"""On which side of each other thin shapes are, as predictions note it."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.geometry.sides import near_side, note_side
from eeca_pymunk.prediction.turning import begin_side


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
        begin_side(scene, a, b, 0.0, 0.1, 1e-12 * unit)
        assert gap(scene, a, b, 0.0)[0] == pytest.approx(apart, rel=1e-6)

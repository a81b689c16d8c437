"""Which bodies take part in a simultaneous impact."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.impacts.simultaneous import takes_part


@pytest.mark.parametrize(("begins", "part"), [(0.0, True), (0.25, True), (0.5, False)])
def test_a_body_takes_no_part_before_its_path_begins(begins: float, part: bool) -> None:
    """Two disks that touch at the instant .25 s on their paths, of which one begins earlier, then, or later: continued
    backwards it would touch too, where the body has not been."""
    space = pymunk.Space()
    for x in (0.0, 2.0):
        body = pymunk.Body(1.0, 0.5)
        body.position = x, 0.0
        space.add(body, pymunk.Circle(body, 1.0))
    stepper = ep.EECA(space)
    stepper.step(1e-3)
    assert stepper.event_loop is not None
    scene = stepper.event_loop.scene
    scene.BODY[1].since = begins
    assert bool(takes_part(scene, 0, 1, 0.25)) is part

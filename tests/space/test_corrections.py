"""Leftover corrections of overlaps, where native steps and ours are mixed: bodies are where our step puts them."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep


def overlapping(handler: bool) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Two disks that overlap, at rest; native pushes them apart in the step after the next."""
    space = pymunk.Space()
    bodies = []
    for x in (-0.1, 0.1):
        body = pymunk.Body(1.0, 1.0)
        body.position = x, 0.0
        space.add(body, pymunk.Circle(body, 0.5))
        bodies.append(body)
    if handler:
        space.on_collision(post_solve=lambda *_: None)
    return space, bodies


@pytest.mark.parametrize("handler", [False, True])
@pytest.mark.parametrize("known", [False, True])
def test_ours_after_a_native_step_moves_nothing_more(known: bool, handler: bool) -> None:
    """Elastic disks at rest stay where they are: nothing that our step does moves them."""
    space, bodies = overlapping(handler)
    for body in bodies:
        for shape in body.shapes:
            shape.elasticity = 1.0
    stepper = ep.EECA(space)
    if known:
        stepper.step(1 / 60)
    space.step(1 / 60)
    before = [(*b.position, b.angle) for b in bodies]
    stepper.step(1 / 60)
    stepper.step(1 / 60)
    assert [(*b.position, b.angle) for b in bodies] == before


def test_a_native_step_after_one_with_handlers_starts_from_where_it_ended() -> None:
    """The step that handlers see is pymunk's, and leaves corrections."""
    space, bodies = overlapping(True)
    stepper = ep.EECA(space)
    for body in bodies:
        for shape in body.shapes:
            shape.elasticity = 1.0
    stepper.step(1 / 60)
    before = [b.position for b in bodies]
    velocities = [b.velocity for b in bodies]
    space.step(1e-9)
    for body, place, velocity in zip(bodies, before, velocities, strict=True):
        assert body.position == pytest.approx(place + velocity * 1e-9, abs=1e-12)

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


def test_native_after_ours_pushes_with_no_impulse_of_an_earlier_native_step() -> None:
    """pymunk begins a step with the impulses of its last one, times the ratio of their dt: 0.1 s after 1e-5 s would
    make impulses of 10 000 weights, which a native step pushes with."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.1)
    space.add(floor)
    bodies = []
    for k, mass in enumerate((1e-3, 1.0, 1e-3, 10.0)):
        body = pymunk.Body(mass, mass / 6.0)
        body.position = 0.0, 0.6 + k
        space.add(body, pymunk.Poly.create_box(body, (1.0, 1.0)))
        bodies.append(body)
    stepper = ep.EECA(space)
    short, long = 1e-5, 0.1
    for _ in range(3):
        for _ in range(3):
            space.step(short)
        for _ in range(3):
            stepper.step(long)
        before = [body.velocity for body in bodies]
        space.step(short)
        kicks = [(body.velocity - old).length for body, old in zip(bodies, before, strict=True)]
        assert max(kicks) <= 9.81 * short * (1.0 + 1e-9)

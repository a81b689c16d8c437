"""Thin shapes that part are on the side where they are, however far they turn until they come near again."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep


def spinner() -> tuple[pymunk.Space, pymunk.Body]:
    """A plank with a wedge, which strikes the end of a segment without width, turns by two radians around it, and
    strikes it with the wedge, from the other side."""
    space = pymunk.Space()
    wall = pymunk.Segment(space.static_body, (-0.42, 0.0), (0.42, 0.0), 0.0)
    body = pymunk.Body(7.0, 0.35)
    body.position, body.angle = (-0.798, 0.134), 3.955
    body.velocity, body.angular_velocity = (39.13, -45.94), -64.52
    plank = pymunk.Poly.create_box(body, (0.7, 0.0175))
    wedge = pymunk.Poly(body, [(0.0, -0.47), (0.52, -0.47), (0.26, 0.05)])
    for shape in (wall, plank, wedge):
        shape.elasticity = 1.0
    space.add(wall, body, plank, wedge)
    return space, body


def spin_on(steps: int) -> tuple[float, ...]:
    """Pose and velocity after .08 s in so many steps, and the number of impacts."""
    space, body = spinner()
    stepper, impulses = ep.EECA(space), 0
    for _ in range(steps):
        report = stepper.step(0.08 / steps)
        assert report.converged
        impulses += len(report.impulse)
    return *body.position, body.angle, *body.velocity, body.angular_velocity, impulses


@pytest.mark.parametrize("steps", [1, 2, 20])
def test_what_turns_around_the_end_of_a_thin_shape_goes_the_same_way_in_long_steps(steps: int) -> None:
    """In 400 steps the plank is farther from the wall at the start of each step than where sides are remembered."""
    reference = spin_on(400)
    assert reference[-1] == 2
    assert spin_on(steps) == pytest.approx(reference, rel=1e-9)


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_what_a_program_moves_by_less_than_its_width_stays_on_its_side(unit: float) -> None:
    """A plank on a wall without width, put deeper twice by .9 of half its width: its middle is beyond the wall then,
    but as it has not been farther from where it was than half its width at any time, it comes from above."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81 * unit
    space.add(pymunk.Segment(space.static_body, (-5.0 * unit, 0.0), (5.0 * unit, 0.0), 0.0))
    half, body = 0.02 * unit, pymunk.Body(1.0, unit * unit / 3.0)
    body.position = 0.0, half
    space.add(body, pymunk.Poly.create_box(body, (2.0 * unit, 2.0 * half)))
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(1 / 60)
    for _ in range(2):
        body.position = body.position.x, body.position.y - 0.9 * half
        space.reindex_shapes_for_body(body)
        stepper.step(1 / 60)
    for _ in range(30):
        stepper.step(1 / 60)
    assert body.position.y == pytest.approx(-0.8 * half, rel=1e-9)

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

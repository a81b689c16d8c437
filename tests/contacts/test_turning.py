"""What a container without mobility carries along as it turns by up to 1 rad in a step."""

from __future__ import annotations

from itertools import pairwise

import pymunk
import pytest

import eeca_pymunk as ep

SPIN, HALF = 10.0, 5.0  # rad/s; half the side of the container, in lengths of its bodies
Placed = tuple[float, float, float, float]  # height, x, y, mass


def turning(
    placed: tuple[Placed, ...], unit: float, friction: float, centre: tuple[float, float] = (0.0, 0.0)
) -> tuple[pymunk.Space, pymunk.Body, list[pymunk.Body]]:
    """A container that turns about a point `centre` away from its middle, and boxes of length 1 that turn with it."""
    space, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(box)
    box.position, box.angular_velocity = (-centre[0] * unit, -centre[1] * unit), SPIN
    corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF), (-HALF, -HALF)]
    ends = [((x + centre[0]) * unit, (y + centre[1]) * unit) for x, y in corners]
    space.add(*(pymunk.Segment(box, p, q, 0.0) for p, q in pairwise(ends)))
    bodies = []
    for height, x, y, mass in placed:
        body = pymunk.Body(mass, mass * (1.0 + height * height) / 12.0 * unit * unit)
        body.position = x * unit, y * unit
        body.velocity, body.angular_velocity = box.velocity_at_world_point(body.position), SPIN
        space.add(body, pymunk.Poly.create_box(body, (unit, height * unit)))
        bodies.append(body)
    for shape in space.shapes:
        shape.friction = friction
    return space, box, bodies


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("angle", [0.1, 0.3, 0.8])
def test_a_turning_wall_does_no_work_on_what_it_carries(angle: float, unit: float) -> None:
    """A box on the middle of a wall: it stays there, at one speed. Along the tangents of the middles of intervals it
    would be lifted out of the wall in each step, by work from outside of a third of its energy in 40 steps of .8 rad.
    """
    space, box, (body,) = turning(((0.5, 0.0, 0.25 - HALF, 1.0),), unit, 1.0)
    stepper, work, energy = ep.EECA(space), 0.0, ep.measure(space).energy
    for _ in range(40):
        report = stepper.step(angle / SPIN)
        assert report.converged
        assert report.ledger is not None
        work += report.ledger.external
    x, y = box.world_to_local(body.position)
    assert abs(work) <= 1e-3 * energy
    assert abs(x) <= 0.02 * unit
    assert y == pytest.approx((0.25 - HALF) * unit, abs=1e-5 * unit)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(
    "placed",
    [
        ((0.05, 3.0, -3.0, 10.0),),
        ((0.5, 0.0, -3.0, 1.0), (0.5, -3.0, 0.0, 10.0), (0.05, 0.0, 0.0, 10.0)),
    ],
)
def test_what_a_container_presses_into_its_corners_stays_inside(placed: tuple[Placed, ...], unit: float) -> None:
    """A radian a step about a point outside: walls press with 65 times what turns the bodies, and these sank deeper in
    each step than corrections lift them."""
    space, box, bodies = turning(placed, unit, 0.5, (8.0, 0.0))
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(1.0 / SPIN)
        for body in bodies:
            x, y = box.world_to_local(body.position)
            assert max(abs(x - 8.0 * unit), abs(y)) <= HALF * unit

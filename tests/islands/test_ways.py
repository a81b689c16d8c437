"""How far bodies move in an interval: what counts of a rotation."""

from __future__ import annotations

from random import Random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.islands.hits import stays_shallow
from eeca_pymunk.model.parameters.intervals import INTERVAL_DEPTH_WIDTH


@pytest.mark.parametrize("wall", ["segment", "box", "circle"])
def test_a_disk_may_spin_on_any_wall(wall: str) -> None:
    """What rotates is the same disk: one interval, one solve in each step."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    ground = space.static_body
    shape = {
        "segment": pymunk.Segment(ground, (-50.0, 0.0), (50.0, 0.0), 0.0),
        "box": pymunk.Poly(ground, [(-50.0, -1.0), (50.0, -1.0), (50.0, 0.0), (-50.0, 0.0)]),
        "circle": pymunk.Circle(ground, 1000.0, (0.0, -1000.0)),
    }[wall]
    disk = pymunk.Body(1.0, 0.5)
    disk.position, disk.angular_velocity = (0.0, 1.0), 300.0
    rim = pymunk.Circle(disk, 1.0)
    shape.friction, rim.friction = 1.0, 0.1
    space.add(shape, disk, rim)
    stepper = ep.EECA(space)
    for _ in range(5):
        stepper.step(1 / 60)
        loop = stepper.event_loop
        assert loop is not None
        assert loop.scene.COUNT.solves == 1
    assert disk.velocity.x == pytest.approx(-0.1 * 10.0 * 5 / 60, rel=1e-3 if wall == "circle" else 1e-12)


def test_how_deep_shapes_may_get_is_bounded_from_the_instant_of_their_impact() -> None:
    """A body that has fallen since the start of the step closes with the speed that it has by now."""
    space, dt = pymunk.Space(), 1.0
    body, plate = pymunk.Body(1.0, 1.0), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    plate.position = 0.0, -300.0
    for one in (body, plate):
        shape = pymunk.Circle(one, 1.0)
        shape.elasticity = 0.5
        space.add(one, shape)
    loop = ep.EECA(space).event_loop
    assert loop is not None
    A = loop.scene
    A.PAR.pulled = g = 20.0 * INTERVAL_DEPTH_WIDTH * 2.0 / dt**2
    A.BODY[0].ay, A.BODY[0].since, A.BODY[1].since = -g, 0.0, 0.0
    # The way in what is left is (.9 .1 + .1^2 / 2) g dt^2 = 1.9 times the limit; from rest it would be a tenth of it.
    assert not stays_shallow(A, 0, 1, 0.9 * dt, 0.1 * dt)
    assert stays_shallow(A, 0, 1, 0.0, 0.1 * dt)


@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_a_circle_off_the_centre_of_mass_stays_in_its_room(radius: float) -> None:
    """It moves as its body turns, by more than its size in a step. A third of such circles had left the room."""
    for seed in range(5):
        rng, space = Random(seed), pymunk.Space()
        space.gravity = 0.0, -10.0
        corners = [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)]
        for k in range(4):
            wall = pymunk.Segment(space.static_body, corners[k], corners[(k + 1) % 4], radius)
            wall.friction = 0.5
            space.add(wall)
        body = pymunk.Body(1.0, 0.01)
        body.position = rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5)
        body.velocity, body.angular_velocity = (rng.uniform(-30, 30), rng.uniform(-30, 30)), rng.uniform(-5.0, 5.0)
        circle = pymunk.Circle(body, 0.1, (0.6, 0.0))
        circle.friction = 0.5
        space.add(body, circle)
        stepper = ep.EECA(space)
        for _ in range(120):
            stepper.step(1 / 60)
            x, y = body.local_to_world((0.6, 0.0))
            assert max(abs(x), abs(y)) < 3.0, seed


@pytest.mark.parametrize("radius", [0.0, 1e-5, 1e-3])
def test_a_peg_at_the_origin_is_as_any_other(radius: float) -> None:
    """A plank slides over it: the size of a static shape is not its distance from the origin."""

    def end(x: float) -> list[float]:
        space = pymunk.Space()
        space.gravity = 0.0, -10.0
        floor = pymunk.Segment(space.static_body, (x - 9.0, -0.5), (x + 9.0, -0.5), 0.0)
        peg = pymunk.Circle(space.static_body, radius, (x, 0.0))
        plank = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (3.0, 0.2)))
        plank.position, plank.velocity = (x + 0.2, 0.1 + radius), (2.0, 0.0)
        shape = pymunk.Poly.create_box(plank, (3.0, 0.2))
        floor.friction, peg.friction, shape.friction = 1.0, 1.0, 0.4
        space.add(floor, peg, plank, shape)
        stepper = ep.EECA(space)
        for _ in range(30):
            assert stepper.step(1 / 60).converged
        return [plank.position.x - x, plank.position.y, plank.angle]

    assert end(0.0) == pytest.approx(end(64.0), abs=1e-9)

"""Intervals end where slip does: what slides to and fro on a wall is exact, and sinks into none."""

from __future__ import annotations

import math
from itertools import product

import pymunk
import pytest

import eeca_pymunk as ep

G = 10.0  # m/s^2


def incline(space: pymunk.Space, origin: pymunk.Vec2d, degrees: float, laws: tuple[float, float]) -> pymunk.Vec2d:
    """A wall that falls by an angle to the right, through a point; the direction down it. laws: elasticity, friction.
    Walls are straight within some metres."""
    down = pymunk.Vec2d(1.0, 0.0).rotated_degrees(-degrees)
    wall = pymunk.Segment(space.static_body, origin - 60.0 * down, origin + 60.0 * down, 0.0)
    wall.elasticity, wall.friction = laws
    space.add(wall)
    return down


def disk(space: pymunk.Space, place: pymunk.Vec2d, radius: float, moment: float) -> pymunk.Body:
    """A disk of mass 1, whose elasticity and friction are 1."""
    body = pymunk.Body(1.0, moment)
    body.position = place
    shape = pymunk.Circle(body, radius)
    shape.elasticity = shape.friction = 1.0
    space.add(body, shape)
    return body


@pytest.mark.parametrize("dt", [0.01, 0.07, 0.3])
@pytest.mark.parametrize("elasticity", [0.0, 1.0])
def test_what_slides_up_an_incline_and_down_again_is_exact(elasticity: float, dt: float) -> None:
    """A disk that cannot turn comes as far as v^2 / 2 a with a = g (sin + mu cos), and goes back with g (sin - mu
    cos)."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    down, mu, v = incline(space, pymunk.Vec2d(0.0, 0.0), 30.0, (elasticity, 0.2)), 0.2, 1.0
    start = 0.1 * down.perpendicular()
    body = disk(space, start, 0.1, math.inf)
    body.velocity = -v * down
    stepper, steps = ep.EECA(space), math.ceil(0.4 / dt)
    for _ in range(steps):
        stepper.step(dt)
    sine, cosine = 0.5, math.sqrt(0.75)
    up, back = G * (sine + mu * cosine), G * (sine - mu * cosine)
    after = steps * dt - v / up
    way = body.position - start
    assert way.dot(down) == pytest.approx(0.5 * back * after**2 - 0.5 * v * v / up, rel=1e-11)
    assert way.dot(down.perpendicular()) == pytest.approx(0.0, abs=1e-12)
    assert body.velocity.dot(down) == pytest.approx(back * after, rel=1e-11)


@pytest.mark.parametrize("spin", [0.0, 10.0])
@pytest.mark.parametrize("together", [1, 24])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 10, 1 / 2])
def test_a_disk_that_slides_on_a_wall_and_bounces_on_another_passes_neither(
    dt: float, together: int, spin: float
) -> None:
    """Friction has given energy where the bounces cut its interval; with all impulses scaled, for that, disks sank by a
    tenth of their radius. Where friction takes all energy of the bounces, they end: impacts that were passed over led
    through the other wall. Energy never rises. As single scenes, or many at once, which exceed the work of exact
    intervals."""
    cases = list(product((10.0, 30.0, 60.0), (60.0, 90.0), (0.1, 0.5), (0.1, 0.3), (0.2, 2.0)))
    for first in range(0, len(cases), together):
        space, disks = pymunk.Space(), []
        space.gravity = 0.0, -G
        for k, (degrees, wedge, radius, mu, speed) in enumerate(cases[first : first + together]):
            corner = pymunk.Vec2d(0.0, 300.0 * k)
            down = incline(space, corner, degrees, (1.0, mu))
            other = incline(space, corner, degrees + wedge, (1.0, mu))
            walls = down.perpendicular(), -other.perpendicular()
            place = radius * walls[0] - radius * (1.0 / math.tan(math.radians(0.5 * wedge)) + 0.02) * down
            body = disk(space, corner + place, radius, 0.5 * radius * radius)
            body.velocity, body.angular_velocity = speed * down, spin
            disks.append((body, corner, walls, radius))
        stepper, energy = ep.EECA(space), ep.measure(space).energy
        scale = abs(energy) + len(disks)
        for _ in range(20):
            stepper.step(dt)
            now = ep.measure(space).energy
            assert now <= energy + 1e-13 * scale
            energy = now
            for body, corner, walls, radius in disks:
                for normal in walls:
                    assert (body.position - corner).dot(normal) >= (1.0 - 2e-3) * radius


def test_what_persists_after_a_cut_persists_into_the_next_step() -> None:
    """A disk that slides without friction hits a wall, which cuts its interval. In the next step it leaves the floor by
    less than an elastic contact that carried a force may: it is held on, without an impact."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    incline(space, pymunk.Vec2d(0.0, 0.0), 0.0, (1.0, 0.0))
    incline(space, pymunk.Vec2d(1.0, 0.0), 90.0, (1.0, 0.0))
    body = disk(space, pymunk.Vec2d(0.8, 0.1), 0.1, 1.0)
    body.velocity = 1.0, 0.0
    stepper = ep.EECA(space)
    contacts = stepper.step(0.15).contacts
    assert min(contacts.duration) == 0.0, "it hits the wall"
    body.velocity = -1.0, 1e-5
    contacts = stepper.step(0.15).contacts
    assert min(contacts.duration) > 0.0
    assert body.position.y == pytest.approx(0.1, abs=1e-12)

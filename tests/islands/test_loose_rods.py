"""Rods without width on the floor of a room without width, under disks and boxes: nothing gets out in steps of any
length."""

from __future__ import annotations

import math
import random

import pymunk
import pytest

import eeca_pymunk as ep

HEIGHT, OUT = 5.0, 0.1  # half of the room's; distance beyond a wall


def room(R: random.Random) -> tuple[pymunk.Space, float]:
    """A random scene, and half the width of the room."""
    space = pymunk.Space()
    space.gravity = R.choice([(0, -9.81), (0, -9.81), (0, -100), (0, 0)])
    wide = R.uniform(1.5, 4)
    e, mu = R.choice([0.0, 0.3, 0.8, 1.0]), R.choice([0.0, 0.5, 1.0])
    corners = [(-wide, -HEIGHT), (wide, -HEIGHT), (wide, HEIGHT), (-wide, HEIGHT)]
    for k in range(4):
        wall = pymunk.Segment(space.static_body, corners[k], corners[(k + 1) % 4], 0.0)
        wall.elasticity, wall.friction = e, mu
        space.add(wall)
    y, most, rods = 0.2 - HEIGHT, R.randint(1, 4), 0
    for k in range(R.randint(3, 14)):
        if (k % 3 == 0 and rods < most) or R.random() < 0.15:
            length, mass = R.uniform(0.5, 1.9 * wide), R.choice([0.01, 0.1, 1.0, 10.0])
            x = R.uniform(-wide + length / 2 + 0.01, wide - length / 2 - 0.01)
            angle = R.choice([0.0, R.uniform(-0.2, 0.2)])
            half = length / 2 * abs(math.sin(angle)) + 0.05
            body = pymunk.Body(mass, mass * length * length / 12)
            body.position, body.angle = (x, y + half), angle
            y += 2.0 * half
            shape: pymunk.Shape = pymunk.Segment(body, (-length / 2, 0), (length / 2, 0), 0.0)
            rods += 1
        else:
            mass, r = R.choice([0.1, 1.0, 10.0]), R.uniform(0.1, 0.35)
            if R.random() < 0.8:
                body = pymunk.Body(mass, mass * r * r / 2)
                shape = pymunk.Circle(body, r)
            else:
                body = pymunk.Body(mass, mass * r * r * 2 / 3)
                shape = pymunk.Poly.create_box(body, (2 * r, 2 * r))
            body.position = R.uniform(-wide + 0.5, wide - 0.5), y + 1.42 * r
            body.velocity = R.uniform(-3, 3), R.uniform(-3, 3)
            y += 2.84 * r
        shape.elasticity, shape.friction = R.choice([e, e, 0.0, 1.0]), mu
        space.add(body, shape)
        if y > HEIGHT - 1:
            break
    return space, wide


@pytest.mark.parametrize(
    ("seed", "dt"), [(76, 10.0), (523, 10.0), (546, 10.0), (318, 3.0), *((s, 10.0) for s in range(6))]
)
def test_nothing_gets_out_of_a_room_with_loose_rods(seed: int, dt: float) -> None:
    space, wide = room(random.Random(seed))
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(dt)
        for body in space.bodies:
            assert abs(body.position.x) < wide + OUT
            assert abs(body.position.y) < HEIGHT + OUT


@pytest.mark.parametrize("speed", [0.1, 1.0, 1.4])
@pytest.mark.parametrize("dt", [0.1, 1.0, 10.0])
def test_a_disk_that_overlaps_a_wall_comes_no_deeper(speed: float, dt: float) -> None:
    """One that leaves it too slowly to come out meets it when it is as deep again, after 2 u / g, however long the
    step."""
    space, radius, deep, g = pymunk.Space(), 0.2, 0.05, 20.0
    space.gravity = 0.0, -g
    wall, disk = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0), pymunk.Body(1.0, 0.02)
    disk.position = 0.0, radius
    shape = pymunk.Circle(disk, radius)
    wall.elasticity = shape.elasticity = 1.0
    space.add(disk, shape, wall)
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    disk.position, disk.velocity = (0.0, radius - deep), (0.0, speed)
    for _ in range(3):
        stepper.step(dt)
        assert disk.position.y > radius - 1.3 * deep

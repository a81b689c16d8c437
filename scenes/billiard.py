"""Billiard with spin, seen from above: a cue ball with side-spin breaks a triangle of 15 between four cushions."""

from __future__ import annotations

import math

import pymunk

from .scene import Scene, add_disk, add_walls

RADIUS, LENGTH, WIDTH, ROWS = 0.0286, 2.54, 1.27, 5  # m: a table of nine feet


def build(
    speed: float = 6.0, spin: float = 80.0, elasticity: float = 0.95, friction: float = 0.1, dt: float = 1 / 240,
    duration: float = 1.5,
) -> Scene:  # fmt: skip
    """Balls of .17 kg as disks on a table without cloth: nothing slows them but hits. `speed` m/s, `spin` rad/s.

    Elasticity and friction are those of a contact, of balls and of cushions; moments are those of balls, 2/5 m r².
    """
    if not (0.0 <= elasticity <= 1.0 and friction >= 0.0):
        raise ValueError(f"elasticity = {elasticity}, friction = {friction}: give 0 <= elasticity <= 1, friction >= 0")
    space = pymunk.Space()
    corners = [(0.0, 0.0), (LENGTH, 0.0), (LENGTH, WIDTH), (0.0, WIDTH)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    pitch = 2.002 * RADIUS  # a hair apart
    places = [
        (0.75 * LENGTH + row * pitch * math.sqrt(0.75), 0.5 * WIDTH + (i - 0.5 * row) * pitch)
        for row in range(ROWS)
        for i in range(row + 1)
    ]
    bodies = [add_disk(space, (0.25 * LENGTH, 0.5 * WIDTH + 0.2 * RADIUS), RADIUS, 0.17, (speed, 0.0))]
    bodies += [add_disk(space, place, RADIUS, 0.17) for place in places]
    bodies[0].angular_velocity = spin
    for body in bodies:
        body.moment = 0.4 * body.mass * RADIUS**2
    for shape in space.shapes:
        shape.elasticity, shape.friction = math.sqrt(elasticity), math.sqrt(friction)
    parameters = {"speed": speed, "spin": spin, "elasticity": elasticity, "friction": friction, "dt": dt}
    return Scene("billiard", space, bodies, dt, duration, 1e6, parameters=parameters)

"""A breakout-like scene: a ball whose speed a velocity function keeps, bricks that a collision handler removes."""

from __future__ import annotations

import math

import pymunk

from .scene import Scene, add_disk, add_walls

BALL, BRICK = 1, 2
WIDTH, HEIGHT, SPEED = 6.0, 4.0, 5.0


def build(dt: float = 1 / 60, columns: int = 10, rows: int = 4, duration: float = 10.0) -> Scene:
    """A ball of r = .1 m at 5 m/s in a closed field of 6 x 4 m under `columns` x `rows` bricks, and a paddle that moves
    to and fro. A brick is gone when the ball leaves it; `scene.parameters["hit"]` lists those that were hit."""
    if columns < 1 or rows < 0:
        raise ValueError(f"columns = {columns}, rows = {rows}: give columns >= 1 and rows >= 0")
    space = pymunk.Space()
    corners = [(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    ball = add_disk(space, (3.1, 1.0), 0.1, velocity=(0.6 * SPEED, 0.8 * SPEED))
    ball.velocity_func = _keep_speed
    next(iter(ball.shapes)).collision_type = BALL
    pitch = WIDTH / columns
    for row in range(rows):
        for column in range(columns):
            x, y = (column + 0.5) * pitch, HEIGHT - 0.4 - 0.25 * row
            brick = pymunk.Poly(
                space.static_body, [(x + sx * 0.45 * pitch, y + sy * 0.1) for sx, sy in _CORNERS], radius=0.005
            )
            brick.elasticity, brick.collision_type = 1.0, BRICK
            space.add(brick)
    paddle = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    paddle.position = (3.0, 0.3)
    paddle.velocity_func = _to_and_fro
    face = pymunk.Segment(paddle, (-0.6, 0.0), (0.6, 0.0), 0.05)
    face.elasticity = 1.0
    space.add(paddle, face)
    hit: list[pymunk.Shape] = []

    def remove(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        brick = arbiter.shapes[1]
        if brick not in hit:
            hit.append(brick)
            space.remove(brick)

    space.on_collision(BALL, BRICK, separate=remove)
    return Scene("breakout", space, [ball], dt, duration, 1e6, parameters={"dt": dt, "hit": hit})


_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def _keep_speed(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    body.velocity = body.velocity.normalized() * SPEED


def _to_and_fro(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    body.velocity = (2.0 * math.copysign(1.0, math.sin(body.position.x + 0.5 * math.pi)), 0.0)

"""Mixed shapes: disks, boxes, capsules and compound bodies in a box, or under gravity in a bowl."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import Scene, add_walls

SIDE, SIZE, GRAVITY, BOWL = 4.0, 0.25, 9.81, 24
KINDS = ("box", "capsule", "compound", "disk")


def build(count: int = 20, seed: int = 0, bowl: bool = False, dt: float = 1e-2, duration: float = 1.0) -> Scene:
    """`count` elastic bodies of 1 to 3 kg and about half a metre, in turn of each of `KINDS`, in a box of side 4 m.

    They start on a grid, clear of each other, with normal velocities (m/s) and spins (rad/s). With `bowl` they start at
    rest under gravity over a half circle of straight pieces.
    """
    if not 1 <= count <= 36:
        raise ValueError(f"count = {count}: give a number from 1 to 36")
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    columns = math.ceil(math.sqrt(count))
    pitch = SIDE / columns
    bodies = []
    for i, cell in enumerate(rng.permutation(columns * columns)[:count]):
        x, y = (cell % columns + 0.5) * pitch, (cell // columns + 0.5) * pitch
        body = _add_body(space, KINDS[i % len(KINDS)], float(rng.uniform(1.0, 3.0)), 0.8 * SIZE)
        body.angle = float(rng.uniform(-math.pi, math.pi))
        body.position = (x, y)
        if not bowl:
            body.velocity = (float(rng.normal()), float(rng.normal()))
            body.angular_velocity = float(rng.normal())
        bodies.append(body)
    half = SIDE / 2
    if bowl:
        space.gravity = (0.0, -GRAVITY)
        angles = np.linspace(-math.pi, 0.0, BOWL + 1)
        rim = [(half + 1.5 * SIDE * math.cos(a), half + 1.5 * SIDE * math.sin(a)) for a in angles]
        high = [(rim[0][0], 4 * SIDE), *rim, (rim[-1][0], 4 * SIDE)]
        add_walls(space, zip(high, [*high[1:], high[0]], strict=True))
    else:
        corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
        add_walls(space, zip(corners, corners[1:] + corners[:1], strict=True))
    return Scene("mixed", space, bodies, dt, duration, 1e6, parameters={"count": count, "seed": seed, "bowl": bowl})


def _add_body(space: pymunk.Space, kind: str, mass: float, size: float) -> pymunk.Body:
    """A body of shapes that reach `size` (m) from its centre at most, its mass spread over their areas."""
    body = pymunk.Body()
    a = size / math.sqrt(2.0)
    shapes: list[pymunk.Shape]
    if kind == "box":
        shapes = [pymunk.Poly.create_box(body, (2 * a, 1.4 * a))]
    elif kind == "capsule":
        shapes = [pymunk.Segment(body, (-0.6 * size, 0.0), (0.6 * size, 0.0), 0.4 * size)]
    elif kind == "compound":
        # Two arms of unequal length, so that the centre of mass lies off the origin.
        shapes = [
            pymunk.Poly.create_box(body, (1.6 * a, 0.4 * a)),
            pymunk.Circle(body, 0.4 * a, (0.6 * a, 0.0)),
            pymunk.Poly(body, [(-0.8 * a, 0.2 * a), (-0.4 * a, 0.2 * a), (-0.6 * a, 0.8 * a)], radius=0.05 * a),
        ]
    else:
        shapes = [pymunk.Circle(body, 0.8 * size)]
    area = sum(shape.area for shape in shapes)
    for shape in shapes:
        shape.density, shape.elasticity, shape.friction = mass / area, 1.0, 0.0
    space.add(body, *shapes)
    return body

"""Balls and lines: elastic balls fall onto sloping lines, on which some of them roll without friction."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import Scene, add_disk, add_walls

RADIUS, GRAVITY, ELASTICITY = 0.1, 9.81, 0.95


def build(count: int = 20, seed: int = 0, dt: float = 1 / 60, duration: float = 4.0) -> Scene:
    """`count` balls of r = .1 m above three lines in a box of 6 x 8 m, elasticity .95 for each shape."""
    if not 1 <= count <= 100:
        raise ValueError(f"count = {count}: give a number from 1 to 100")
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    add_walls(space, [((0.5, 3.5), (3.0, 2.5)), ((3.0, 1.8), (5.5, 2.6)), ((1.0, 1.2), (3.5, 0.8))])
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 8.0), (0.0, 8.0)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    bodies = []
    for k in range(count):
        x = 0.5 + 0.5 * (k % 10) + float(rng.uniform(-0.1, 0.1))
        bodies.append(add_disk(space, (x, 4.2 + 0.35 * (k // 10)), RADIUS))
    for shape in space.shapes:
        shape.elasticity = ELASTICITY
    return Scene(
        "balls_and_lines", space, bodies, dt, duration, 1e6, parameters={"count": count, "seed": seed, "dt": dt}
    )

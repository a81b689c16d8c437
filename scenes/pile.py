"""Disks and boxes that fall between two walls, lose energy to bounces and friction, and come to rest."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import Scene, add_box, add_disk, add_walls

GRAVITY, HALF = 9.81, 0.5  # m/s²; m, radius of disks and half the side of boxes


def build(
    count: int = 40, elasticity: float = 0.3, friction: float = 0.5, seed: int = 0, dt: float = 1 / 60,
    duration: float = 4.0,
) -> Scene:  # fmt: skip
    """`count` bodies of 1 kg, disks and boxes in turn, in rows of six; elasticity and friction are of contacts."""
    if count < 1 or not (0.0 <= elasticity <= 1.0 and friction >= 0.0):
        raise ValueError(
            f"count = {count}, elasticity = {elasticity}, friction = {friction}: give count >= 1, 0 <= elasticity <= 1 "
            "and friction >= 0"
        )
    rng = np.random.default_rng(seed)
    space, columns = pymunk.Space(), 6
    space.gravity = (0.0, -GRAVITY)
    width = 1.5 * columns
    add_walls(space, [((0.0, 0.0), (width, 0.0)), ((0.0, 0.0), (0.0, 40.0)), ((width, 0.0), (width, 40.0))])
    bodies = []
    for i in range(count):
        place = (0.75 + 1.5 * (i % columns) + 0.05 * float(rng.uniform(-1.0, 1.0)), 0.8 + 1.5 * (i // columns))
        bodies.append(add_box(space, place, 2 * HALF, 2 * HALF) if i % 2 else add_disk(space, place, HALF))
        if i % 2:
            bodies[-1].angle = float(rng.uniform(-0.4, 0.4))
    for shape in space.shapes:
        # pymunk takes the product of the two shapes.
        shape.elasticity, shape.friction = math.sqrt(elasticity), math.sqrt(friction)
    parameters = {"count": count, "elasticity": elasticity, "friction": friction, "seed": seed, "dt": dt}
    return Scene("pile", space, bodies, dt, duration, 1e6, parameters=parameters)

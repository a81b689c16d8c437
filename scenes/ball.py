"""Bouncing ball: one disk falls on a floor under gravity, exact by parabolas between mirror-like bounces."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_disk, add_walls

RADIUS, GRAVITY = 0.2, 9.81


def build(height: float = 2.0, speed: float = 0.0, dt: float = 1 / 60, duration: float = 5.0) -> Scene:
    """Unit mass, radius .2 m, lowest point `height` (m) above the floor y = 0, thrown up at `speed` (m/s)."""
    if not height >= 0.0:
        raise ValueError(f"height = {height}: give a length >= 0")
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    disk = add_disk(space, (0.0, RADIUS + height), RADIUS, velocity=(0.0, speed))
    add_walls(space, [((-5.0, 0.0), (5.0, 0.0))])

    def exact(t: float) -> FloatArray:
        return np.array([[0.0, RADIUS + bounce(height, speed, GRAVITY, t)]])

    return Scene("ball", space, [disk], dt, duration, 1e6, exact, {"height": height, "speed": speed, "dt": dt})


def bounce(height: float, speed: float, gravity: float, t: float) -> float:
    """Height above the floor at time t of an elastic ball; height >= 0, speed (upwards), gravity > 0 at the start."""
    at_floor = math.sqrt(speed * speed + 2.0 * gravity * height)
    first = (speed + at_floor) / gravity
    if t <= first:
        return height + speed * t - 0.5 * gravity * t * t
    s = math.fmod(t - first, 2.0 * at_floor / gravity)
    return at_floor * s - 0.5 * gravity * s * s

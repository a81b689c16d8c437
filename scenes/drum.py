"""Elastic boxes that bounce in a turning drum, a kinematic body: its work is what their energy gains."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk

from .scene import Scene

RADIUS, SPIN, GRAVITY, SIDES = 5.0, 0.5, 9.81, 12


def build(count: int = 10, dt: float = 1 / 60, duration: float = 4.0) -> Scene:
    """`count` boxes of .6 x .4 m and 1 kg in a drum of 12 walls and radius 5 m at .5 rad/s, g = 9.81 m/s²."""
    if not 1 <= count <= 30:
        raise ValueError(f"count = {count}: give a number from 1 to 30")
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    drum = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drum.angular_velocity = SPIN
    rim = [(RADIUS * math.cos(a), RADIUS * math.sin(a)) for a in np.linspace(0.0, 2 * math.pi, SIDES + 1)]
    walls = [pymunk.Segment(drum, p, q, 0.1) for p, q in pairwise(rim)]
    for wall in walls:
        wall.elasticity = 1.0
    space.add(drum, *walls)
    bodies = []
    for k in range(count):
        body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.6, 0.4)))
        body.position, body.angle = (-2.0 + k % 6 * 0.8, -1.0 + k // 6 * 0.8), 0.1 * k
        box = pymunk.Poly.create_box(body, (0.6, 0.4))
        box.elasticity = 1.0
        space.add(body, box)
        bodies.append(body)
    return Scene("drum", space, bodies, dt, duration, 1e6, parameters={"count": count, "dt": dt})

"""Floors that move: belts (surface velocity), plates and drums (kinematic), and the work they do."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk

from comparisons import runs
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, G, case, go, heavy, matter


def belt(speed: float, mu: float) -> tuple[pymunk.Space, pymunk.Body]:
    """A block at rest on a belt."""
    space = heavy()
    add_walls(space, [((-50.0, 0.0), (50.0, 0.0))])
    # The velocity of the skin against its body; pymunk moves things the other way round.
    next(iter(space.shapes)).surface_velocity = (-speed, 0.0)
    body = add_box(space, (0.0, 0.5), 1.0, 1.0)
    matter(space, mu)
    return space, body


@case("block on a belt", "speed, or place / (mu g dt²), off", 0.1251)
def on_a_belt(make: runs.Make) -> float:
    """Speed V from t = V/(mu g) on; friction takes as much as the block gets."""
    worst = 0.0
    for mu, speed in ((0.25, 1.5), (0.5, 4.0)):
        space, body = belt(speed, mu)
        go(space, make, 120)
        v = abs(body.velocity.x)
        x = speed * 2.0 - speed * speed / (2.0 * mu * G)
        worst = max(worst, abs(v / speed - 1.0) * 1e9, abs(abs(body.position.x) - x) / (mu * G * DT * DT))
    return worst


@case("box on a plate that comes up", "velocity off", 1e-12)
def plate(make: runs.Make) -> float:
    space = heavy()
    floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor.velocity = (0.7, 0.3)
    space.add(floor, pymunk.Segment(floor, (-9.0, 0.0), (9.0, 0.0), 0.0))
    body = add_box(space, (0.0, 0.5), 1.0, 1.0)
    matter(space, 0.5)
    go(space, make, 120)
    return max(abs(body.velocity.x - 0.7), abs(body.velocity.y - 0.3), abs(body.angular_velocity))


def drum(spin: float = 1.0, gravity: float = G, elasticity: float = 0.3) -> pymunk.Space:
    """Twelve disks and boxes in a drum of radius 3 that turns."""
    space = heavy(gravity)
    wheel = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wheel.angular_velocity = spin
    rim = [(3.0 * math.cos(a), 3.0 * math.sin(a)) for a in np.linspace(0.0, 2 * math.pi, 25)]
    space.add(wheel, *(pymunk.Segment(wheel, p, q, 0.05) for p, q in pairwise(rim)))
    for k in range(12):
        where = (-1.2 + 0.8 * (k % 4), -0.8 + 0.8 * (k // 4))
        if k % 2:
            add_disk(space, where, 0.3, 1.0, (0.3 * k, 0.0))
        else:
            add_box(space, where, 0.5, 0.4, 1.0, (0.0, 0.2 * k))
    matter(space, 0.6, elasticity)
    return space


@case("drum of disks and boxes, 8 s", "outside", 0.0)
def in_a_drum(make: runs.Make) -> float:
    space = drum()
    go(space, make, 480)
    out = 0
    for body in space.bodies:
        r = body.position.length
        out += body.body_type == pymunk.Body.DYNAMIC and not r < 3.0
    return out

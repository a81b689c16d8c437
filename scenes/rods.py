"""Newton's cradle on rods, and heaps in which bodies are joined: jointed scenes that collide."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .pendulum import period, swing
from .scene import FloatArray, Scene, add_box, add_disk

GRAVITY, RADIUS = 9.81, 0.1
GAP = 1e-6  # m: impacts pass from ball to ball; balls that touch would share them


def cradle(
    count: int = 5, length: float = 1.0, degrees: float = 40.0, gap: float = GAP, dt: float = 1 / 60,
    duration: float = 10.0,
) -> Scene:  # fmt: skip
    """`count` elastic balls of 1 kg on rods, `gap` (m) apart; the left one is let go `degrees` away.

    Balls exchange velocities: exact for gap -> 0 are the outer balls that swing in turn, and the others that hang.
    """
    if count < 2 or not gap > 0.0:
        raise ValueError(f"count = {count}, gap = {gap}: give count >= 2 and gap > 0")
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    pitch, amplitude = 2.0 * RADIUS + gap, math.radians(degrees)
    hung = [pitch * (i - 0.5 * (count - 1)) for i in range(count)]
    bodies = []
    for i, x in enumerate(hung):
        angle = 0.0 if i else amplitude
        bodies.append(add_disk(space, (x - length * math.sin(angle), length * (1.0 - math.cos(angle))), RADIUS))
        space.add(pymunk.PinJoint(space.static_body, bodies[-1], (x, length), (0.0, 0.0)))
    quarter = 0.25 * period(amplitude, length)

    def exact(t: float) -> FloatArray:
        places = np.array([(x, 0.0) for x in hung])
        angle = -swing(amplitude, length, t)
        i = (count - 1) * (int((t + quarter) // (2.0 * quarter)) % 2)
        places[i] = hung[i] + length * math.sin(angle), length * (1.0 - math.cos(angle))
        return places

    return Scene("rods", space, bodies, dt, duration, 1e6, exact, {"count": count, "gap": gap, "dt": dt})


def heap(groups: int = 40, dt: float = 1 / 60, duration: float = 5.0, seed: int = 0) -> Scene:
    """Bodies that fall between two walls: of each five, three hang together by a pivot and a pin, and every second
    group has its other two on a rope: 200 bodies with 100 joints if there are 40 groups."""
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    bodies: list[pymunk.Body] = []

    def body(x: float, y: float) -> pymunk.Body:
        bodies.append(add_box(space, (x, y), 0.38, 0.3) if rng.random() < 0.5 else add_disk(space, (x, y), 0.19))
        return bodies[-1]

    for k in range(groups):
        x, y = -3.6 + 2.0 * (k % 4) + 0.1 * (k // 4 % 2), 0.6 + 1.1 * (k // 4)
        a, b, c = (body(x + 0.45 * i, y) for i in range(3))
        space.add(pymunk.PivotJoint(a, b, (0.225, 0.0), (-0.225, 0.0)), pymunk.PinJoint(b, c, (0.0, 0.0), (0.0, 0.0)))
        loose = body(x, y + 0.5), body(x + 0.7, y + 0.5)
        if k % 2:
            space.add(pymunk.SlideJoint(*loose, (0.0, 0.0), (0.0, 0.0), 0.0, 0.9))
    for start, end in (((-9.0, 0.0), (9.0, 0.0)), ((-4.5, 0.0), (-4.5, 40.0)), ((4.5, 0.0), (4.5, 40.0))):
        space.add(pymunk.Segment(space.static_body, start, end, 0.0))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.0, math.sqrt(0.5)
    return Scene("heap", space, bodies, dt, duration, 1e6, parameters={"groups": groups, "seed": seed, "dt": dt})

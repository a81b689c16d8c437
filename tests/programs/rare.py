"""Random compositions of `varied.py` with bodies that these rarely have: each of KINDS in a share of the scenes.

They are what was found outside of `varied.py` to break laws, drawn by a generator of their own; the laws are the same.
"""

from __future__ import annotations

import math
from random import Random

import pymunk

from .varied import Varied

KINDS: dict[str, float] = {
    "thrown": 0.5,  # bodies up to 100 times heavier fly at a thin one near a wall, at up to 500 lengths/s
    "flat": 0.3,  # up to 20 flat polygons of up to 100 corners
    "posts": 0.3,  # planks on pivots without slack between two kinematic bodies at rest, where joints are
}
SWINGS = 0.3  # share, of the containers that move, of those that their own velocity function accelerates
STRENGTH = 9.0  # 1/s^2: acceleration of such a container for its way from where it began


def swing(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    """A velocity function of a kinematic body: it oscillates about the origin and the angle 0."""
    body.velocity -= STRENGTH * dt * body.position
    body.angular_velocity -= STRENGTH * dt * body.angle


class Rare(Varied):
    """The composition of a seed, with some of KINDS."""

    def _vary(self) -> None:
        super()._vary()
        C = Random(f"rare {self.drawn[0]}")
        self.has |= {name for name, share in KINDS.items() if C.random() < share}
        if "thrown" in self.has:
            self._throw(C)
        if "flat" in self.has:
            self._flatten(C)
        if "posts" in self.has and self.space.constraints and not self.turns:
            self._span(C)
        if self.turns and C.random() < SWINGS:
            self.has.add("swings")
            super().drive(0)
            self.box.velocity_func = swing

    def drive(self, k: int) -> None:
        if "swings" not in self.has:
            super().drive(k)

    def _keep(self, body: pymunk.Body, shape: pymunk.Shape, least: float) -> pymunk.Body:
        """Add a body of this least size."""
        shape.elasticity, shape.friction = self.matter
        self.space.add(body, shape)
        self.bodies.append(body)
        self.sizes.append(max(least, 0.1 * self.length))
        return body

    def _throw(self, C: Random) -> None:
        L, edge = self.length, self.half - 0.12 * self.length
        if not self._free(edge - 0.4 * L, 0.0, 0.6 * L):
            return
        angle, mass = 0.5 * math.pi + C.uniform(-0.1, 0.1), L * L
        plank = pymunk.Body(mass, 0.07 * mass * L * L)
        plank.position, plank.angle = (edge, C.uniform(-0.5, 0.5) * L), angle
        shape: pymunk.Shape = pymunk.Segment(plank, (-0.45 * L, 0.0), (0.45 * L, 0.0), 0.0)
        if width := C.choice((0.0, 0.002, 0.01, 0.05)) * L:
            shape = pymunk.Poly.create_box(plank, (0.9 * L, width))
        self._keep(plank, shape, width)
        for k in range(C.randint(1, 3)):
            x, y = edge - C.uniform(1.2, 2.0) * L, (1.2 * k - 1.2) * L
            if not self._free(x, y, 0.5 * L):
                continue
            body = pymunk.Body(mass * 10.0 ** C.uniform(1.0, 2.0), 0.0)
            body.moment = C.uniform(0.05, 0.2) * body.mass * L * L
            body.position = x, y
            body.velocity = C.uniform(100.0, 500.0) * L, C.uniform(-1.0, 1.0) * 200.0 * L
            body.angular_velocity = C.uniform(-5.0, 5.0)
            n, size = C.randint(3, 9), 0.5 * L
            corners = [(size * math.cos(2 * math.pi * j / n), size * math.sin(2 * math.pi * j / n)) for j in range(n)]
            round_one = C.random() < 0.3
            self._keep(body, pymunk.Circle(body, size) if round_one else pymunk.Poly(body, corners), size)

    def _flatten(self, C: Random) -> None:
        L = self.length
        for _ in range(C.randint(3, 20)):
            n, long, flat = C.randint(24, 100), C.uniform(0.2, 0.4) * L, C.uniform(0.02, 0.1) * L
            x, y = C.uniform(-0.8, 0.8) * self.half, C.uniform(-0.8, 0.8) * self.half
            if not self._free(x, y, long):
                continue
            body = pymunk.Body(L * L, 0.1 * L**4)
            body.position = x, y
            body.angle = C.uniform(-3.0, 3.0)
            turns = (2.0 * math.pi * k / n for k in range(n))
            self._keep(body, pymunk.Poly(body, [(long * math.cos(t), flat * math.sin(t)) for t in turns]), flat)

    def _span(self, C: Random) -> None:
        L, n, y = self.length, C.randint(3, 12), C.uniform(-0.5, 0.5) * self.half
        if not all(self._free(x * L, y, 0.5 * L) for x in range(-4, 5)):
            return
        wide = 1.6 * self.half / n
        ends = []
        for x in (-0.8 * self.half, 0.8 * self.half):
            post = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            post.position = x, y
            self.space.add(post, pymunk.Circle(post, 0.05 * L))
            ends.append(post)
        last = ends[0]
        for k in range(n + 1):
            if k < n:
                body = pymunk.Body(L * L, L * L * wide * wide / 12.0)
                body.position = ends[0].position.x + (k + 0.5) * wide, y
                here = self._keep(body, pymunk.Poly.create_box(body, (wide, 0.1 * L)), 0.1 * L)
            else:
                here = ends[1]
            pivot = pymunk.PivotJoint(last, here, (ends[0].position.x + k * wide, y))
            pivot.collide_bodies = False
            self.space.add(pivot)
            last = here

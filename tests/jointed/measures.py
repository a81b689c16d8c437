"""What scenes with joints are measured by."""

from __future__ import annotations

import numpy as np
import pymunk

from eeca_pymunk.arrays import FloatArray


def moving(space: pymunk.Space) -> list[pymunk.Body]:
    return [b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC]


def kinetic(body: pymunk.Body) -> float:
    """Kinetic energy; pymunk's is twice that."""
    return 0.5 * (body.mass * body.velocity.dot(body.velocity) + body.moment * body.angular_velocity**2)


def energy(space: pymunk.Space) -> float:
    """Kinetic energy, -m g.x, and what linear springs hold."""
    total = 0.0
    for body in moving(space):
        total += kinetic(body) - body.mass * space.gravity.dot(body.local_to_world(body.center_of_gravity))
    for c in space.constraints:
        if isinstance(c, pymunk.DampedSpring):
            length = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
            total += 0.5 * c.stiffness * (length - c.rest_length) ** 2
        elif isinstance(c, pymunk.DampedRotarySpring):
            total += 0.5 * c.stiffness * (c.a.angle - c.b.angle - c.rest_angle) ** 2
    return total


def momentum(space: pymunk.Space) -> FloatArray:
    return np.sum([b.mass * np.array(b.velocity) for b in moving(space)], axis=0)


def angular_momentum(space: pymunk.Space) -> float:
    return sum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in moving(space))


def apart(space: pymunk.Space) -> float:
    """How far pivots and pins are from what they hold, length."""
    worst = 0.0
    for c in space.constraints:
        if isinstance(c, (pymunk.PivotJoint, pymunk.PinJoint)):
            length = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
            worst = max(worst, abs(length - (c.distance if isinstance(c, pymunk.PinJoint) else 0.0)))
    return worst

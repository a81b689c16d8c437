"""A ground of static segments, and putting a scene's bodies back to where they started."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import pymunk

from .scene import Point

RADIUS = 0.05  # of the segments, m


def add_ground(space: pymunk.Space, tops: Sequence[Point], friction: float) -> None:
    """Add segments whose upper side goes through these points, inelastic."""
    for a, b in pairwise(tops):
        segment = pymunk.Segment(space.static_body, (a[0], a[1] - RADIUS), (b[0], b[1] - RADIUS), RADIUS)
        segment.friction, segment.elasticity = friction, 0.0
        space.add(segment)


def remember(bodies: Sequence[pymunk.Body]) -> Callable[[], None]:
    """A function that puts the bodies back to where they are now, with the velocities they have now."""
    start = [(b.position, b.angle, b.velocity, b.angular_velocity) for b in bodies]

    def reset() -> None:
        for body, (position, angle, velocity, spin) in zip(bodies, start, strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = position, angle, velocity, spin
            body.force, body.torque = (0.0, 0.0), 0.0
        if bodies and bodies[0].space is not None:
            for body in bodies:
                bodies[0].space.reindex_shapes_for_body(body)

    return reset

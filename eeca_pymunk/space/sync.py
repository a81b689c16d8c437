"""Sync: pymunk's own shapes and broad phase where a step has put the bodies, for its queries and drawing."""

from __future__ import annotations

import pymunk


def rest_step(space: pymunk.Space, dt: float) -> None:
    """Let pymunk see the new positions: its own step with everything at rest moves nothing.

    With the real dt, so that `space.current_time_step` is right and a native step may follow: at rest pymunk
    caches no impulse that it would scale by the ratio of the two steps. All bodies must have velocity 0.
    """
    gravity, iterations, bias = space.gravity, space.iterations, space.collision_bias
    try:
        space.gravity, space.iterations, space.collision_bias = (0.0, 0.0), 1, 1.0
        space.step(dt)
    finally:
        space.gravity, space.iterations, space.collision_bias = gravity, iterations, bias

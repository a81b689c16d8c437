"""Sync: pymunk's own shapes and broad phase where a step has put the bodies, for its queries and drawing.

Two ways. A *rest step*, pymunk's own step with everything at rest, moves nothing, renews the broad phase, forgets old
contacts, and notes dt. *Reindexing* moves the shapes of one body after the other; it costs less for a few bodies, and
leaves all the rest as it is. In a spatial hash it leaves handles behind, which the next rest step clears, so there is
one every so many steps. Post-step callbacks come after either, when bodies have their velocities.
"""

from __future__ import annotations

from collections.abc import Callable

import pymunk

from . import private
from .bodies import Bodies

FEW = (
    12  # moving shapes up to which reindexing costs less than a rest step (measured: up to 20 in a tree, 10 in a hash)
)
_RENEW = 32  # steps after which reindexing gives way to a rest step


def rest_step(space: pymunk.Space, dt: float) -> None:
    """Let pymunk see the new positions: its own step with everything at rest moves nothing.

    With the real dt, so that `space.current_time_step` is right and a native step may follow: at rest pymunk
    caches no impulse that it would scale by the ratio of the two steps. All bodies must have velocity 0.
    """
    gravity, iterations, bias = space.gravity, space.iterations, space.collision_bias
    try:
        space.gravity, space.iterations, space.collision_bias = (0.0, 0.0), 1, 1.0
        private.step_alone(space, dt)
    finally:
        space.gravity, space.iterations, space.collision_bias = gravity, iterations, bias


class Sync:
    """Which of the two ways a step takes."""

    def __init__(self, space: pymunk.Space, bodies: Bodies) -> None:
        self.space = space
        moving = [b for b in bodies.items if b.body_type != pymunk.Body.STATIC and b.shapes]
        self._moving = moving if sum(len(b.shapes) for b in moving) <= FEW else None
        self._timestamp: Callable[[], int] = private.timestamp(space)
        self._renewed, self._dt, self._left = -1, 0.0, 0
        self._touched = False

    def reindexes(self, dt: float, contacts: bool) -> bool:
        """Whether reindexing does for this step: pymunk took no step since our last rest step, which knows this dt, and
        nothing touched in either, so that `each_arbiter` has nothing to tell."""
        if self._moving is None or dt != self._dt or self._left == 0 or contacts or self._touched:
            return False
        return self._timestamp() == self._renewed

    def reindex(self) -> None:
        """Move the shapes to where their bodies are."""
        self._left -= 1
        move = self.space.reindex_shapes_for_body
        for body in self._moving or ():
            move(body)

    def call_back(self) -> None:
        """Do what waits for the end of a step: post-step callbacks."""
        if private.waits(self.space):
            private.finish_step(self.space)

    def rest(self, dt: float) -> None:
        """A rest step; all bodies must have velocity 0."""
        rest_step(self.space, dt)
        self._renewed, self._dt, self._left = self._timestamp(), dt, _RENEW
        if self._moving is not None:
            self._touched = bool(private.arbiters(self.space))

"""Lets tests say `space.on_collision` and `arbiter.process_collision` under pymunk 6 too, whose functions answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pymunk

PHASES = ("begin", "pre_solve", "post_solve", "separate")


def on_collision(space: Any, a: int | None = None, b: int | None = None, data: Any = None, **functions: Any) -> None:
    """`Space.on_collision` of pymunk 7, by the handlers of pymunk 6."""
    if a is None:
        handler = space.add_default_collision_handler()
    else:
        handler = space.add_wildcard_collision_handler(a) if b is None else space.add_collision_handler(a, b)
    assert set(functions) <= set(PHASES)
    for phase, function in functions.items():
        setattr(handler, phase, answering(function, data))


def answering(function: Callable[..., Any], data: Any) -> Callable[..., bool]:
    def call(arbiter: Any, space: pymunk.Space, handlers_data: Any) -> bool:
        function(arbiter, space, data)
        return bool(getattr(arbiter, "process_collision", True))

    return call


if not hasattr(pymunk.Space, "on_collision"):
    pymunk.Space.on_collision = on_collision  # type: ignore[method-assign]
    pymunk.Arbiter.bodies = property(lambda arbiter: tuple(s.body for s in arbiter.shapes))  # type: ignore[method-assign, assignment]

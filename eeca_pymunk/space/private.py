"""Private names of pymunk: all that this package uses of them, one function each.

Each has a test of its own in `tests/space/test_private.py`, and all are looked up when the package is imported, so that
a pymunk which has renamed one is refused at once and by name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pymunk

try:
    from pymunk._chipmunk_cffi import lib
except ImportError as error:  # pragma: no cover - needs another pymunk
    raise ImportError(f"pymunk {pymunk.version} has no pymunk._chipmunk_cffi: pip install 'pymunk>=7.0,<8'") from error

# Functions of a handler, in the order in which pymunk calls them.
PHASES = ("_begin", "_pre_solve", "_post_solve", "_separate")

_OF_LIBRARY = ("cpSpaceStep", "cpHastySpaceStep")
_OF_SPACE = (
    "_space", "_handlers", "_get_arbiters", "_locked", "_add_later", "_remove_later", "_removed_shapes",
    "_post_step_callbacks",
)  # fmt: skip
_OF_BODY = ("_velocity_func", "_position_func")


def missing() -> list[str]:
    """Names that this package needs and that the installed pymunk lacks."""
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    space.on_collision(begin=lambda arbiter, space, data: None)
    owners: list[tuple[str, Any, Iterable[str]]] = [
        ("pymunk._chipmunk_cffi.lib", lib, _OF_LIBRARY),
        ("pymunk.Space", space, _OF_SPACE),
        ("pymunk.Body", body, _OF_BODY),
        *(("pymunk.CollisionHandler", one, PHASES) for one in getattr(space, "_handlers", {}).values()),
    ]
    return [f"{name}.{one}" for name, owner, names in owners for one in names if not hasattr(owner, one)]


def check() -> None:
    """ImportError unless the installed pymunk has all private names."""
    if absent := missing():
        raise ImportError(
            f"pymunk {pymunk.version} lacks {', '.join(absent)}, which eeca_pymunk needs: pip install 'pymunk>=7.0,<8'"
        )


def handlers(space: pymunk.Space) -> list[Any]:
    """The collision handlers of a space; pymunk offers no public way to ask for them."""
    return list(space._handlers.values())


def arbiters(space: pymunk.Space) -> list[pymunk.Arbiter]:
    """All arbiters of the space's last step."""
    return [pymunk.Arbiter(one, space) for one in space._get_arbiters()]


def velocity_function(body: pymunk.Body) -> Callable[..., None] | None:
    """The body's own velocity function, None if it has pymunk's; the public property tells no difference."""
    return body._velocity_func


def position_function(body: pymunk.Body) -> Callable[..., None] | None:
    """The body's own position function, None if it has pymunk's."""
    return body._position_func


def replace_functions(
    body: pymunk.Body, velocity: Callable[..., None] | None, position: Callable[..., None] | None
) -> None:
    """Let pymunk call these functions in the place of the body's own, where that has one; None leaves it.

    The public setters would also tell Chipmunk, which then no longer asks the body.
    """
    if velocity is not None:
        body._velocity_func = velocity
    if position is not None:
        body._position_func = position


def step_alone(space: pymunk.Space, dt: float) -> None:
    """pymunk's step without what it does afterwards: additions, removals and callbacks wait for `finish_step`."""
    space._locked = True
    try:
        (lib.cpHastySpaceStep if space.threaded else lib.cpSpaceStep)(space._space, dt)
        space._removed_shapes.clear()
    finally:
        space._locked = False


def finish_step(space: pymunk.Space) -> None:
    """Add and remove what callbacks of the last step asked for, and call its post-step callbacks."""
    added, removed = list(space._add_later), list(space._remove_later)
    space._add_later.clear()
    space._remove_later.clear()
    space.add(*added)
    for thing in reversed(removed):
        space.remove(thing)
    callbacks = dict(space._post_step_callbacks)
    for callback in callbacks.values():
        callback(space)
    space._post_step_callbacks.clear()


check()

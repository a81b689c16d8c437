"""What differs between pymunk 6.9, 6.11, 7.0 and 7.3: no other file depends on which one is installed.

| | pymunk 6 | pymunk 7 |
|---|---|---|
| functions of collisions | set on a `CollisionHandler` | given to `space.on_collision` |
| to reject a collision | `begin` or `pre_solve` returns False | they set `arbiter.process_collision` |
| a rejected `begin` | holds until the shapes separate | the same |
| bodies of an arbiter | by its shapes | `arbiter.bodies` |
| pymunk's default as `velocity_func` | the body's function stays, and is called no more | since 7.3 none is left |
| shapes removed twice from callbacks | an error | later than 7.0.0 removed once |

Names are looked up once, where they are used, rather than a number of a version compared.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import pymunk

REQUIRED = "pymunk>=6.9,<8"
ANSWERS = not hasattr(pymunk.Arbiter, "process_collision")  # whether functions of handlers return what they decide

# What bodies have that have no function of their own.
DEFAULTS = {"velocity_func": pymunk.Body.update_velocity, "position_func": pymunk.Body.update_position}

# `enum cpArbiterState` of Chipmunk 7.0.3, which pymunk 6 has.
_IGNORED, _CACHED = 2, 3


def processed(arbiter: pymunk.Arbiter) -> bool:
    """Whether a collision of pymunk's last step takes place, False if a handler has rejected it or made a sensor of a
    shape.

    pymunk 6 keeps no record of it. A collision that `begin` rejected has a state of its own until the shapes separate;
    one that `pre_solve` rejected has lost its contacts, though the shapes touch.
    """
    if not ANSWERS:
        return bool(arbiter.process_collision) and not any(shape.sensor for shape in arbiter.shapes)
    held = arbiter._arbiter
    return bool(held.state != _IGNORED and (held.count > 0 or held.state == _CACHED))


def decide(held: Any, takes_place: bool) -> None:
    """Have the collision of an arbiter of Chipmunk's take place, or not unless pymunk calls `begin` when the shapes
    touch. pymunk 6 calls `pre_solve` again in each step, and its pickles contain what `begin` has rejected."""
    if not ANSWERS:
        held.processCollision = int(takes_place)


def decision(held: Any, sensor: Callable[[Any], bool]) -> tuple[Any, ...]:
    """What functions may decide of a collision, whose arbiter Chipmunk has: whether it takes place, whether shapes are
    sensors, restitution, friction, surface velocity."""
    surface, takes_place = held.surface_vr, True if ANSWERS else held.processCollision
    return takes_place, sensor(held.a), sensor(held.b), held.e, held.u, surface.x, surface.y


def is_odd(
    held: Any, sensor: Callable[[Any], bool], elasticity: Callable[[Any], float], friction: Callable[[Any], float]
) -> bool:  # fmt: skip
    """Whether values of an arbiter of Chipmunk's may differ from those of its shapes, which the functions return."""
    a, b, surface = held.a, held.b, held.surface_vr
    if ANSWERS or not held.processCollision or sensor(a) or sensor(b):
        return True
    plain = held.e == elasticity(a) * elasticity(b) and held.u == friction(a) * friction(b)
    return not plain or surface.x != 0.0 or surface.y != 0.0


def bodies(arbiter: pymunk.Arbiter) -> tuple[pymunk.Body, pymunk.Body]:
    """The two bodies of an arbiter."""
    one, two = (shape.body for shape in arbiter.shapes)
    assert one is not None
    assert two is not None
    return one, two


def answer(found: Any, function: Callable[..., Any], phase: str) -> bool | None:
    """What a handler's function that returned `found` means to pymunk.

    pymunk 7 takes no answer. pymunk 6 takes a bool of `begin` and `pre_solve`; anything else is a warning, and the
    collision takes place.
    """
    if not ANSWERS or phase not in ("_begin", "_pre_solve"):
        return None
    if isinstance(found, bool):
        return found
    code = getattr(function, "__code__", None)
    name = getattr(function, "__name__", repr(function))
    warnings.warn_explicit(
        f"Function '{name}' should return a bool to indicate if the collision should be processed or not when used as "
        "'begin' or 'pre_solve' collision callback.",
        UserWarning,
        filename=getattr(code, "co_filename", "<unknown>"),
        lineno=getattr(code, "co_firstlineno", 0),
        module=getattr(function, "__module__", None),
    )
    return True


def add_handler(space: pymunk.Space) -> Any:
    """A collision handler of a space, for pairs of all types."""
    if ANSWERS:
        return space.add_default_collision_handler()  # type: ignore[attr-defined]
    space.on_collision(begin=lambda arbiter, space, data: None)
    return next(iter(space._handlers.values()))


def handled(space: pymunk.Space) -> list[tuple[int | None, int | None]]:
    """The pairs of collision types for which a space has handlers, None for all types. Keys of pymunk 7 are pairs,
    those of pymunk 6 also None for all, or one type."""
    return [key if isinstance(key, tuple) else (key, None) for key in space._handlers]


def forget_function(body: pymunk.Body, name: str, function: Callable[..., None]) -> None:
    """What pymunk before 7.3 leaves undone when its default is set again: the body's own function is none any more."""
    if function is DEFAULTS[name]:
        setattr(body, f"_{name}", None)


def remover(space: pymunk.Space) -> Callable[..., None]:
    """The function that removes one thing, and leaves to the caller what `separate` removes meanwhile."""
    remove: Callable[..., None] = getattr(space, "_remove", space.remove)
    return remove

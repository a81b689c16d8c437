"""What differs between pymunk 6.9, 6.11, 7.0 and 7.3: no other file depends on which one is installed.

| | pymunk 6 | pymunk 7 |
|---|---|---|
| functions of collisions | set on a `CollisionHandler` | given to `space.on_collision` |
| to reject a collision | `begin` or `pre_solve` returns False | they set `arbiter.process_collision` |
| a rejected `begin` | holds until the shapes separate | the same |
| bodies of an arbiter | by its shapes | `arbiter.bodies` |
| pymunk's default as `velocity_func` | the body's function stays, and is called no more | since 7.3 none is left |
| shapes removed twice from callbacks | an error | later than 7.0.0 removed once |

The code looks for names that a version has or lacks; it does not compare version numbers.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import lib

REQUIRED = "pymunk>=6.9,<8"
# Whether functions of handlers decide by their return values.
BY_RETURN = not hasattr(pymunk.Arbiter, "process_collision")

# Values of these properties of bodies for which the program has set no function.
DEFAULTS = {"velocity_func": pymunk.Body.update_velocity, "position_func": pymunk.Body.update_position}

# `enum cpArbiterState` of Chipmunk 7.0.3, which pymunk 6 has.
_IGNORED, _CACHED = 2, 3


def processed(arbiter: pymunk.Arbiter) -> bool:
    """Whether a collision of pymunk's last step takes place, False if a handler has rejected it or made a sensor of a
    shape.

    pymunk 6 keeps no record of it. A collision that `begin` rejected has a state of its own until the shapes separate;
    one that `pre_solve` rejected has lost its contacts, though the shapes touch.
    """
    if not BY_RETURN:
        return bool(arbiter.process_collision) and not any(shape.sensor for shape in arbiter.shapes)
    raw = arbiter._arbiter
    return bool(raw.state != _IGNORED and (raw.count > 0 or raw.state == _CACHED))


def decide(raw: Any, takes_place: bool) -> None:
    """Set whether the collision of a Chipmunk arbiter takes place. pymunk 7 overwrites this only if it calls `begin`,
    when shapes begin to touch. Under pymunk 6 there is nothing to set: it calls `pre_solve` again in each step, and its
    pickles contain the collisions that `begin` has rejected."""
    if not BY_RETURN:
        raw.processCollision = int(takes_place)


def decision(arbiter: pymunk.Arbiter) -> tuple[Any, ...]:
    """The values of an arbiter that functions may change, for comparison: whether the collision takes place, whether
    shapes are sensors, restitution, friction, surface velocity."""
    raw, sensor = arbiter._arbiter, lib.cpShapeGetSensor
    takes_place, surface = True if BY_RETURN else raw.processCollision, raw.surface_vr
    return takes_place, sensor(raw.a), sensor(raw.b), raw.e, raw.u, surface.x, surface.y


def may_differ(raw: Any) -> bool:
    """Whether values of a Chipmunk arbiter may differ from those that follow from its shapes. Always true under
    pymunk 6, whose arbiters lack `processCollision`."""
    a, b, surface, elasticity, friction = raw.a, raw.b, raw.surface_vr, lib.cpShapeGetElasticity, lib.cpShapeGetFriction
    if BY_RETURN or not raw.processCollision or lib.cpShapeGetSensor(a) or lib.cpShapeGetSensor(b):
        return True
    products = raw.e == elasticity(a) * elasticity(b) and raw.u == friction(a) * friction(b)
    return not products or surface.x != 0.0 or surface.y != 0.0


def to_return(value: Any, function: Callable[..., Any]) -> bool | None:
    """What a wrapper of a handler's `begin` or `pre_solve` returns to pymunk, if the function has returned `value`.

    pymunk 7 ignores return values. pymunk 6 expects a bool; for other values it warns, and the collision takes place.
    """
    if not BY_RETURN:
        return None
    if isinstance(value, bool):
        return value
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


def add_handler(space: pymunk.Space, a: int | None = None, b: int | None = None) -> Any:
    """The first collision handler of a space, for pairs of these two types, or of all."""
    if BY_RETURN:
        older: Any = space
        return older.add_default_collision_handler() if a is None else older.add_collision_handler(a, b)
    space.on_collision(a, b, begin=lambda arbiter, space, data: None)
    return next(iter(space._handlers.values()))


def handled(space: pymunk.Space) -> list[tuple[int | None, int | None]]:
    """The pairs of collision types for which a space has handlers, None for all types. Keys of pymunk 7 are pairs,
    those of pymunk 6 also None for all, or one type."""
    return [key if isinstance(key, tuple) else (key, None) for key in space._handlers]


def forget_function(body: pymunk.Body, name: str, function: Callable[..., None]) -> None:
    """If pymunk's default was set again, remove the function that the body had, which pymunk before 7.3 does not do.
    `name`: of the property."""
    if function is DEFAULTS[name]:
        setattr(body, f"_{name}", None)


# The method by which a space removes objects at once; what `separate` removes meanwhile is left to its caller.
REMOVE = "_remove" if hasattr(pymunk.Space, "_remove") else "remove"

"""Private names of pymunk for calling functions of bodies, and for steps without them; see `private`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

OF_LIBRARY = (
    "cpBodyGetVelocity", "cpBodySetVelocity", "cpBodyGetAngularVelocity", "cpBodySetAngularVelocity",
    "cpBodySetVelocityUpdateFunc", "cpBodySetPositionUpdateFunc", "cpBodyUpdateVelocity", "ext_cpBodyVelocityFunc",
    "ext_cpBodyPositionFunc",
)  # fmt: skip
_ACCELERATE, _MOVE = ffi.addressof(lib, "cpBodyUpdateVelocity"), ffi.addressof(lib, "cpBodyUpdatePosition")


def velocity_changes(
    bodies: Sequence[pymunk.Body], gravity: pymunk.Vec2d, damping: float, dt: float
) -> list[tuple[float, float, float]]:
    """Changes of velocity and spin by the velocity functions of bodies; the bodies are restored.

    The public properties take four times as long.
    """
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    put_velocity, put_spin = lib.cpBodySetVelocity, lib.cpBodySetAngularVelocity
    found: list[tuple[float, float, float]] = []
    for body in bodies:
        c: Any = body._body
        before, turned = velocity(c), spin(c)
        try:
            body._velocity_func(body, gravity, damping, dt)  # type: ignore[misc]
            after = velocity(c)
            found.append((after.x - before.x, after.y - before.y, spin(c) - turned))
        finally:
            put_velocity(c, before)
            put_spin(c, turned)
    return found


@contextmanager
def without(velocity: Sequence[pymunk.Body], position: Sequence[pymunk.Body]) -> Iterator[None]:
    """Within this block pymunk's steps use its own functions in the place of these velocity functions and position
    functions of bodies."""
    set_velocity, set_position = lib.cpBodySetVelocityUpdateFunc, lib.cpBodySetPositionUpdateFunc
    try:
        for body in velocity:
            set_velocity(body._body, _ACCELERATE)
        for body in position:
            set_position(body._body, _MOVE)
        yield
    finally:
        # Functions that were called meanwhile may have removed them.
        own, moved = lib.ext_cpBodyVelocityFunc, lib.ext_cpBodyPositionFunc
        for body in velocity:
            if body._velocity_func is not None:
                set_velocity(body._body, own)
        for body in position:
            if body._position_func is not None:
                set_position(body._body, moved)

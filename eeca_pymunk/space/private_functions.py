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


def accelerations(
    bodies: Sequence[pymunk.Body], gravity: pymunk.Vec2d, damping: float, dt: float
) -> list[tuple[float, float, float]]:
    """Changes of velocity and spin by the velocity functions of bodies; the bodies are restored.

    The public properties take four times as long.
    """
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    found: list[tuple[float, float, float]] = []
    for body in bodies:
        c: Any = body._body
        before, turned = velocity(c), spin(c)
        try:
            body._velocity_func(body, gravity, damping, dt)  # type: ignore[misc]
            after = velocity(c)
            found.append((after.x - before.x, after.y - before.y, spin(c) - turned))
        finally:
            lib.cpBodySetVelocity(c, before)
            lib.cpBodySetAngularVelocity(c, turned)
    return found


@contextmanager
def without(velocity: Sequence[pymunk.Body], position: Sequence[pymunk.Body]) -> Iterator[None]:
    """Within this block pymunk's steps use its own functions in the place of these velocity functions and position
    functions of bodies."""
    accelerate, move = ffi.addressof(lib, "cpBodyUpdateVelocity"), ffi.addressof(lib, "cpBodyUpdatePosition")
    try:
        for body in velocity:
            lib.cpBodySetVelocityUpdateFunc(body._body, accelerate)
        for body in position:
            lib.cpBodySetPositionUpdateFunc(body._body, move)
        yield
    finally:
        # Functions that were called meanwhile may have removed them.
        for body in velocity:
            if body._velocity_func is not None:
                lib.cpBodySetVelocityUpdateFunc(body._body, lib.ext_cpBodyVelocityFunc)
        for body in position:
            if body._position_func is not None:
                lib.cpBodySetPositionUpdateFunc(body._body, lib.ext_cpBodyPositionFunc)

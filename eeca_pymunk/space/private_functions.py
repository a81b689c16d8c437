"""Private names of pymunk behind functions of bodies, called one after the other and left out; see `private`."""

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
    """What the velocity functions of bodies, which have one, add to velocity and spin; these stay what they were.

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
    """Within, pymunk's steps call neither the velocity functions of bodies nor the position functions of others, which
    all have one, but do what they do without."""
    accelerate, move = ffi.addressof(lib, "cpBodyUpdateVelocity"), ffi.addressof(lib, "cpBodyUpdatePosition")
    try:
        for body in velocity:
            lib.cpBodySetVelocityUpdateFunc(body._body, accelerate)
        for body in position:
            lib.cpBodySetPositionUpdateFunc(body._body, move)
        yield
    finally:
        # Functions that were called meanwhile may have taken theirs away.
        for body in velocity:
            if body._velocity_func is not None:
                lib.cpBodySetVelocityUpdateFunc(body._body, lib.ext_cpBodyVelocityFunc)
        for body in position:
            if body._position_func is not None:
                lib.cpBodySetPositionUpdateFunc(body._body, lib.ext_cpBodyPositionFunc)

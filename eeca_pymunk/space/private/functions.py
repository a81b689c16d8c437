"""Private names of pymunk for calling functions of bodies, and for steps without them; see `spaces`."""

from __future__ import annotations

from collections.abc import Sequence
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


class Without:
    """Within this block, which may be entered again later, pymunk's steps use its own functions in the place of these
    velocity functions and position functions of bodies. A class as `reentry.FunctionsCalled`."""

    __slots__ = ("_position", "_velocity")

    def __init__(self, velocity: Sequence[pymunk.Body], position: Sequence[pymunk.Body]) -> None:
        self._velocity, self._position = velocity, position

    def __enter__(self) -> None:
        for body in self._velocity:
            lib.cpBodySetVelocityUpdateFunc(body._body, _ACCELERATE)
        for body in self._position:
            lib.cpBodySetPositionUpdateFunc(body._body, _MOVE)

    def __exit__(self, *_: object) -> None:
        # Functions that were called meanwhile may have removed them.
        for body in self._velocity:
            if body._velocity_func is not None:
                lib.cpBodySetVelocityUpdateFunc(body._body, lib.ext_cpBodyVelocityFunc)
        for body in self._position:
            if body._position_func is not None:
                lib.cpBodySetPositionUpdateFunc(body._body, lib.ext_cpBodyPositionFunc)

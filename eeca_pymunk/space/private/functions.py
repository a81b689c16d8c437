"""Private names of pymunk for calling functions of bodies, and for steps without them; see `spaces`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

OF_LIBRARY = (
    "cpBodyGetVelocity", "cpBodySetVelocity", "cpBodyGetAngularVelocity", "cpBodySetAngularVelocity",
    "cpBodySetVelocityUpdateFunc", "cpBodySetPositionUpdateFunc", "cpBodyUpdateVelocity", "cpBodyUpdatePosition",
    "ext_cpBodyVelocityFunc", "ext_cpBodyPositionFunc",
)  # fmt: skip
# Chipmunk's own velocity and position functions.
_ACCELERATE, _MOVE = ffi.addressof(lib, "cpBodyUpdateVelocity"), ffi.addressof(lib, "cpBodyUpdatePosition")


def velocity_changes(
    bodies: Sequence[pymunk.Body], gravity: pymunk.Vec2d, damping: float, dt: float
) -> list[tuple[float, float, float]]:
    """Changes of velocity (x, y) and spin by one call of each body's velocity function; the bodies are restored.

    `damping`: factor on velocities over dt, as velocity functions receive it. The public properties take four times as
    long.
    """
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    put_velocity, put_spin = lib.cpBodySetVelocity, lib.cpBodySetAngularVelocity
    found: list[tuple[float, float, float]] = []
    for body in bodies:
        c: Any = body._body
        old_velocity, old_spin = velocity(c), spin(c)
        try:
            # Another function may have taken it away.
            (body._velocity_func or pymunk.Body.update_velocity)(body, gravity, damping, dt)
            new = velocity(c)
            found.append((new.x - old_velocity.x, new.y - old_velocity.y, spin(c) - old_spin))
        finally:
            put_velocity(c, old_velocity)
            put_spin(c, old_spin)
    return found


class WithoutFunctions:
    """Within this block pymunk's steps use Chipmunk's own functions instead of the velocity functions and position
    functions of these bodies. The block may be entered again later. A class, which is faster than a generator with
    `contextmanager`."""

    __slots__ = ("_position", "_velocity")

    def __init__(self, velocity: Sequence[pymunk.Body], position: Sequence[pymunk.Body]) -> None:
        self._velocity, self._position = velocity, position

    def __enter__(self) -> None:
        for body in self._velocity:
            lib.cpBodySetVelocityUpdateFunc(body._body, _ACCELERATE)
        for body in self._position:
            lib.cpBodySetPositionUpdateFunc(body._body, _MOVE)

    def __exit__(self, *_: object) -> None:
        # Collision handlers that were called within the block may have reset a function to None.
        for body in self._velocity:
            if body._velocity_func is not None:
                lib.cpBodySetVelocityUpdateFunc(body._body, lib.ext_cpBodyVelocityFunc)
        for body in self._position:
            if body._position_func is not None:
                lib.cpBodySetPositionUpdateFunc(body._body, lib.ext_cpBodyPositionFunc)

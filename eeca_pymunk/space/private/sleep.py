"""Private names of pymunk for sleeping bodies: the public properties take five times as long."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import lib

OF_LIBRARY = (
    "cpBodyIsSleeping", "cpBodyGetPosition", "cpBodyGetAngle", "cpBodyGetVelocity", "cpBodyGetAngularVelocity",
    "cpBodySetVelocity", "cpBodySetAngularVelocity",
)  # fmt: skip


def sleeping(bodies: Iterable[pymunk.Body]) -> list[bool]:
    """Which of these bodies sleep."""
    sleeps = lib.cpBodyIsSleeping
    return [bool(sleeps(body._body)) for body in bodies]


def asleep(space: pymunk.Space) -> list[pymunk.Body]:
    """The bodies of a space that sleep."""
    sleeps = lib.cpBodyIsSleeping
    return [body for body in space.bodies if sleeps(body._body)]


def stop_woken(bodies: Iterable[pymunk.Body]) -> Callable[[], None]:
    """A function that sets velocity and spin to 0 of those of these bodies that no longer sleep."""
    pointers, sleeps, zero = [body._body for body in bodies], lib.cpBodyIsSleeping, (0.0, 0.0)

    def stop() -> None:
        for pointer in pointers:
            if not sleeps(pointer):
                lib.cpBodySetVelocity(pointer, zero)
                lib.cpBodySetAngularVelocity(pointer, 0.0)

    return stop


def unmoved(bodies: Iterable[pymunk.Body]) -> Callable[[], bool]:
    """A function that returns whether all of these bodies still have their present poses, and velocity and spin 0."""
    pointers = [body._body for body in bodies]
    position, angle = lib.cpBodyGetPosition, lib.cpBodyGetAngle
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity

    def pose(pointer: Any) -> tuple[float, float, float]:
        p = position(pointer)
        return p.x, p.y, angle(pointer)

    known = [(pointer, *pose(pointer)) for pointer in pointers]

    def none_moved() -> bool:
        for pointer, x, y, phi in known:
            v = velocity(pointer)
            if pose(pointer) != (x, y, phi) or v.x != 0.0 or v.y != 0.0 or spin(pointer) != 0.0:
                return False
        return True

    return none_moved

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


def stop_woken(bodies: Iterable[pymunk.Body]) -> Callable[[], None]:
    """A function that takes the velocity of those of these bodies that sleep no more."""
    pointers, sleeps, still = [body._body for body in bodies], lib.cpBodyIsSleeping, (0.0, 0.0)

    def stop() -> None:
        for pointer in pointers:
            if not sleeps(pointer):
                lib.cpBodySetVelocity(pointer, still)
                lib.cpBodySetAngularVelocity(pointer, 0.0)

    return stop


def unmoved(bodies: Iterable[pymunk.Body]) -> Callable[[], bool]:
    """A function that returns whether all of these bodies still have their present poses, and velocity 0."""
    pointers = [body._body for body in bodies]
    place, angle, velocity, spin = (
        lib.cpBodyGetPosition, lib.cpBodyGetAngle, lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity,
    )  # fmt: skip

    def pose(pointer: Any) -> tuple[float, float, float]:
        p = place(pointer)
        return p.x, p.y, angle(pointer)

    known = [(pointer, *pose(pointer)) for pointer in pointers]

    def all_there() -> bool:
        for pointer, x, y, phi in known:
            v = velocity(pointer)
            if pose(pointer) != (x, y, phi) or v.x != 0.0 or v.y != 0.0 or spin(pointer) != 0.0:
                return False
        return True

    return all_there

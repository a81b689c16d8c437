"""Private names of pymunk for the rest step (`sync.py`); see `spaces`, which looks them up."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import lib

from . import spaces as private


def rest(space: pymunk.Space, dt: float, keep_gravity: bool) -> None:
    """`step_without_end` with one iteration, without correction of overlaps and, unless `keep_gravity`, without
    gravity. The public properties take five times as long."""
    c, zero = space._space, (0.0, 0.0)
    gravity, iterations, bias = lib.cpSpaceGetGravity(c), lib.cpSpaceGetIterations(c), lib.cpSpaceGetCollisionBias(c)
    try:
        if not keep_gravity:
            lib.cpSpaceSetGravity(c, zero)
        lib.cpSpaceSetIterations(c, 1)
        lib.cpSpaceSetCollisionBias(c, 1.0)  # the part of an overlap that remains after one second: all
        if space._handlers:
            with without_handlers(space):
                private.step_without_end(space, dt)
        else:  # most spaces; a context would cost more
            private.step_without_end(space, dt)
    finally:
        if not keep_gravity:
            lib.cpSpaceSetGravity(c, gravity)
        lib.cpSpaceSetIterations(c, iterations)
        lib.cpSpaceSetCollisionBias(c, bias)


@contextmanager
def without_handlers(space: pymunk.Space) -> Iterator[None]:
    """Within this block steps of pymunk call no function of the space's collision handlers, and collisions take place:
    such a step belongs to an earlier one, and the program may have added handlers since."""
    held = private.functions(space)
    try:
        for handler, *functions in held:
            for phase, function in zip(private.PHASES, functions, strict=True):
                if function is not None:
                    setattr(handler, phase, _take_place)
        yield
    finally:
        for handler, *functions in held:
            for phase, function in zip(private.PHASES, functions, strict=True):
                setattr(handler, phase, function)


def _take_place(*_: object) -> bool:
    return True


def stopper(space: pymunk.Space) -> tuple[Callable[[], None], Callable[[], None]]:
    """Two functions: one stores velocities and forces of the bodies that do not sleep, and sets them to 0; the other
    restores them. Sleeping bodies are not woken."""
    held: list[tuple[Any, ...]] = []

    def stop() -> None:
        static, sleeps, kind = lib.CP_BODY_TYPE_STATIC, lib.cpBodyIsSleeping, lib.cpBodyGetType
        for body in space.bodies:
            c = body._body
            if kind(c) != static and not sleeps(c):
                held.append((c, *_motion(c)))
        for c, v, spin, f, torque in held:
            if v.x != 0.0 or v.y != 0.0 or spin != 0.0 or f.x != 0.0 or f.y != 0.0 or torque != 0.0:
                _set_motion(c, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0)

    def go_on() -> None:
        for motion in held:
            _set_motion(*motion)

    return stop, go_on


def _motion(c: Any) -> tuple[Any, float, Any, float]:
    return lib.cpBodyGetVelocity(c), lib.cpBodyGetAngularVelocity(c), lib.cpBodyGetForce(c), lib.cpBodyGetTorque(c)


def _set_motion(c: Any, velocity: Any, spin: float, force: Any, torque: float) -> None:
    lib.cpBodySetVelocity(c, velocity)
    lib.cpBodySetAngularVelocity(c, spin)
    lib.cpBodySetForce(c, force)
    lib.cpBodySetTorque(c, torque)

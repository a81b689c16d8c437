"""Private names of pymunk's constraints, one function each; see `spaces`, which looks them up."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

OF_LIBRARY = (
    "cpBodyIsSleeping", "cpConstraintGetBodyA", "cpConstraintGetBodyB",
    "cpBodyGetPosition", "cpBodyGetCenterOfGravity", "cpBodyGetType", "CP_BODY_TYPE_KINEMATIC", "cpBodyGetAngle",
    "cpSpaceGetCurrentTimeStep", "cpSpaceSetCurrentTimeStep",
    "cpConstraintGetMaxForce", "cpConstraintSetMaxForce", "cpConstraintGetPreSolveFunc", "cpConstraintSetPreSolveFunc",
    "cpConstraintGetPostSolveFunc", "cpConstraintSetPostSolveFunc",
)  # fmt: skip
BEFORE, AFTER, FORCE, TORQUE = "_pre_solve_func", "_post_solve_func", "_force_func", "_torque_func"
OF_CONSTRAINT = ("_constraint", BEFORE, AFTER)
# pymunk 7.0.0 has `_force_func` only if it was set: the setter is looked up.
OF_SPRINGS = ((pymunk.DampedSpring, FORCE[1:]), (pymunk.DampedRotarySpring, TORQUE[1:]))


class TimeStep:
    """Within this block, for calls of functions of the program, `space.current_time_step` is dt. Afterwards it is that
    of pymunk's last step again, with which pymunk scales its stored impulses. A class as `reentry.FunctionsCalled`."""

    __slots__ = ("_before", "_dt", "_space")

    def __init__(self, space: pymunk.Space, dt: float) -> None:
        self._space, self._dt = space._space, dt

    def __enter__(self) -> None:
        self._before = lib.cpSpaceGetCurrentTimeStep(self._space)
        lib.cpSpaceSetCurrentTimeStep(self._space, self._dt)

    def __exit__(self, *_: object) -> None:
        lib.cpSpaceSetCurrentTimeStep(self._space, self._before)


def replace_functions(
    constraint: pymunk.Constraint, before: Callable[..., Any] | None, after: Callable[..., Any] | None
) -> None:
    """Let pymunk call these functions in the place of the constraint's `pre_solve` and `post_solve`.

    The public setters would also change Chipmunk, and count as edits.
    """
    constraint.__dict__[BEFORE], constraint.__dict__[AFTER] = before, after


def law_of(spring: Any) -> Callable[[Any, float], float] | None:
    """The force or torque function of a spring, None if none was ever set."""
    law: Callable[[Any, float], float] | None = getattr(
        spring, FORCE if isinstance(spring, pymunk.DampedSpring) else TORQUE, None
    )
    return law


def pose_and_motion(body: pymunk.Body) -> tuple[float, ...]:
    """Position, angle, velocity, spin and centre of gravity of a body; velocities are 0 unless it is kinematic. The
    public properties take three times as long."""
    c = body._body
    place, centre = lib.cpBodyGetPosition(c), lib.cpBodyGetCenterOfGravity(c)
    if lib.cpBodyGetType(c) != lib.CP_BODY_TYPE_KINEMATIC:
        return place.x, place.y, lib.cpBodyGetAngle(c), 0.0, 0.0, 0.0, centre.x, centre.y
    v = lib.cpBodyGetVelocity(c)
    spin = lib.cpBodyGetAngularVelocity(c)
    return place.x, place.y, lib.cpBodyGetAngle(c), v.x, v.y, spin, centre.x, centre.y


def motions(bodies: Iterable[pymunk.Body]) -> list[tuple[Any, Any, float]]:
    """Velocities and spins of the bodies, as `restore_motions` takes them."""
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    return [(c := body._body, velocity(c), spin(c)) for body in bodies]


def restore_motions(kept: Iterable[tuple[Any, Any, float]]) -> None:
    """Restore velocities and spins of bodies."""
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    for c, before, turned in kept:
        now = velocity(c)
        # Reading is cheaper than writing, which would wake bodies.
        if now.x != before.x or now.y != before.y or spin(c) != turned:
            lib.cpBodySetVelocity(c, before)
            lib.cpBodySetAngularVelocity(c, turned)


def awake(constraints: Sequence[pymunk.Constraint]) -> list[pymunk.Constraint]:
    """The constraints neither of whose bodies sleeps. The public properties take five times as long."""
    sleeps, a, b = lib.cpBodyIsSleeping, lib.cpConstraintGetBodyA, lib.cpConstraintGetBodyB
    return [c for c in constraints if not (sleeps(a(c._constraint)) or sleeps(b(c._constraint)))]


def weaken(constraints: Iterable[Any]) -> list[tuple[Any, float]]:
    """Set the force bound of constraints to 0, so that they exert no force in pymunk's steps, which then forget their
    impulses. Returns the argument of `strengthen`."""
    limit, read = lib.cpConstraintSetMaxForce, lib.cpConstraintGetMaxForce
    held = [(c := one._constraint, read(c)) for one in constraints]
    for c, _ in held:
        limit(c, 0.0)
    return held


def strengthen(held: Iterable[tuple[Any, float]]) -> None:
    """Restore the force bounds before `weaken`."""
    for c, most in held:
        lib.cpConstraintSetMaxForce(c, most)


@contextmanager
def silent(constraints: Iterable[Any]) -> Iterator[None]:
    """Within this block pymunk calls neither `pre_solve` nor `post_solve` of these constraints."""
    functions: list[tuple[Any, Any, Any]] = []
    try:
        for one in constraints:
            c = one._constraint
            functions.append((c, lib.cpConstraintGetPreSolveFunc(c), lib.cpConstraintGetPostSolveFunc(c)))
            lib.cpConstraintSetPreSolveFunc(c, ffi.NULL)
            lib.cpConstraintSetPostSolveFunc(c, ffi.NULL)
        yield
    finally:
        for c, before, after in functions:
            lib.cpConstraintSetPreSolveFunc(c, before)
            lib.cpConstraintSetPostSolveFunc(c, after)


@contextmanager
def with_laws(springs: Sequence[Any], laws: Sequence[Callable[[Any, float], float]]) -> Iterator[None]:
    """Within this block these springs use the given laws in the place of their force or torque functions."""
    names = [FORCE if isinstance(one, pymunk.DampedSpring) else TORQUE for one in springs]
    own = [one.__dict__[name] for one, name in zip(springs, names, strict=True)]
    try:
        for one, name, law in zip(springs, names, laws, strict=True):
            one.__dict__[name] = law
        yield
    finally:
        for one, name, function in zip(springs, names, own, strict=True):
            one.__dict__[name] = function

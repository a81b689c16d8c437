"""Private names of pymunk's constraints, one function each; see `spaces`, which looks them up."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

OF_LIBRARY = (
    "cpBodyIsSleeping", "cpConstraintGetBodyA", "cpConstraintGetBodyB",
    "cpBodyGetCenterOfGravity", "cpBodyGetType", "CP_BODY_TYPE_KINEMATIC", "CP_BODY_TYPE_STATIC",
    "cpSpaceGetCurrentTimeStep", "cpSpaceSetCurrentTimeStep",
    "cpConstraintGetMaxForce", "cpConstraintSetMaxForce", "cpConstraintGetErrorBias", "cpConstraintGetMaxBias",
    "cpConstraintGetPreSolveFunc", "cpConstraintSetPreSolveFunc",
    "cpConstraintGetPostSolveFunc", "cpConstraintSetPostSolveFunc",
)  # fmt: skip
PRE_SOLVE, POST_SOLVE = "_pre_solve_func", "_post_solve_func"
FORCE_FUNCTION, TORQUE_FUNCTION = "_force_func", "_torque_func"
OF_CONSTRAINT = ("_constraint", PRE_SOLVE, POST_SOLVE)
# pymunk 7.0.0 has `_force_func` only if it was set: the setter is looked up.
OF_SPRINGS = ((pymunk.DampedSpring, FORCE_FUNCTION[1:]), (pymunk.DampedRotarySpring, TORQUE_FUNCTION[1:]))


class TimeStep:
    """Within this block, for calls of functions of the program, `space.current_time_step` is dt. Afterwards it is that
    of pymunk's last step again, with which pymunk scales its stored impulses. A class, which is faster than a generator
    with `contextmanager`."""

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
    """Let pymunk call these functions instead of the constraint's `pre_solve` and `post_solve`.

    The public setters would also change Chipmunk's constraint, and would be recorded as edits.
    """
    constraint.__dict__[PRE_SOLVE], constraint.__dict__[POST_SOLVE] = before, after


def restore_functions(constraint: pymunk.Constraint, put: tuple[Any, Any], old: tuple[Any, Any]) -> None:
    """Undo `replace_functions` by `put`, but for what a function has set meanwhile."""
    for name, mine, before in zip((PRE_SOLVE, POST_SOLVE), put, old, strict=True):
        if constraint.__dict__[name] is mine:
            constraint.__dict__[name] = before


def law_of(spring: Any) -> Callable[[Any, float], float] | None:
    """The force or torque function of a spring, None if none was ever set, and for other constraints."""
    for kind, name in ((pymunk.DampedSpring, FORCE_FUNCTION), (pymunk.DampedRotarySpring, TORQUE_FUNCTION)):
        if isinstance(spring, kind):
            law: Callable[[Any, float], float] | None = getattr(spring, name, None)
            return law
    return None


def centre_and_kind(body: pymunk.Body) -> tuple[float, float, float]:
    """Centre of gravity of a body, and 1 for a kinematic, -1 for a static one, else 0. The public properties take three
    times as long."""
    c = body._body
    centre, kind = lib.cpBodyGetCenterOfGravity(c), lib.cpBodyGetType(c)
    return centre.x, centre.y, 1.0 if kind == lib.CP_BODY_TYPE_KINEMATIC else -float(kind == lib.CP_BODY_TYPE_STATIC)


def bounds(constraint: Any) -> tuple[float, float, float]:
    """`max_force`, `error_bias` and `max_bias` of a constraint. The public properties take three times as long."""
    c = constraint._constraint
    return lib.cpConstraintGetMaxForce(c), lib.cpConstraintGetErrorBias(c), lib.cpConstraintGetMaxBias(c)


def motions(pointers: Iterable[Any]) -> list[tuple[Any, Any, float]]:
    """Velocities and spins of bodies, given as `pointers`, as `restore_motions` takes them."""
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    return [(c, velocity(c), spin(c)) for c in pointers]


def motions_of_ends(constraints: Iterable[Any]) -> list[tuple[Any, Any, float]]:
    """The same of the bodies of constraints."""
    a, b, pointers = lib.cpConstraintGetBodyA, lib.cpConstraintGetBodyB, [one._constraint for one in constraints]
    return motions({*map(a, pointers), *map(b, pointers)})


def restore_motions(kept: Iterable[tuple[Any, Any, float]]) -> None:
    """Restore the result of `motions`. Unchanged bodies are not written, since a write wakes a sleeping body."""
    velocity, spin = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity
    for c, old_velocity, old_spin in kept:
        now = velocity(c)
        if now.x != old_velocity.x or now.y != old_velocity.y or spin(c) != old_spin:
            lib.cpBodySetVelocity(c, old_velocity)
            lib.cpBodySetAngularVelocity(c, old_spin)


def awake(constraints: Sequence[pymunk.Constraint]) -> list[pymunk.Constraint]:
    """The constraints neither of whose bodies sleeps. The public properties take five times as long."""
    sleeps, a, b = lib.cpBodyIsSleeping, lib.cpConstraintGetBodyA, lib.cpConstraintGetBodyB
    return [c for c in constraints if not (sleeps(a(c._constraint)) or sleeps(b(c._constraint)))]


def clear_max_forces(constraints: Iterable[Any]) -> list[tuple[Any, float]]:
    """Set `max_force` of constraints to 0: in pymunk's steps they then exert no force, and their stored impulses become
    0. Returns the argument of `restore_max_forces`."""
    write, read = lib.cpConstraintSetMaxForce, lib.cpConstraintGetMaxForce
    before = [(c := one._constraint, read(c)) for one in constraints]
    for c, _ in before:
        write(c, 0.0)
    return before


def restore_max_forces(before: Iterable[tuple[Any, float]]) -> None:
    """Undo `clear_max_forces`."""
    for c, max_force in before:
        lib.cpConstraintSetMaxForce(c, max_force)


def has_functions(constraint: Any) -> bool:
    """Whether pymunk calls a `pre_solve` or `post_solve` of a constraint."""
    c, null = constraint._constraint, ffi.NULL
    return bool(lib.cpConstraintGetPreSolveFunc(c) != null or lib.cpConstraintGetPostSolveFunc(c) != null)


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
    """Within this block these springs use the given laws instead of their force or torque functions."""
    names = [FORCE_FUNCTION if isinstance(one, pymunk.DampedSpring) else TORQUE_FUNCTION for one in springs]
    functions = [one.__dict__[name] for one, name in zip(springs, names, strict=True)]
    try:
        for one, name, law in zip(springs, names, laws, strict=True):
            one.__dict__[name] = law
        yield
    finally:
        for one, name, function in zip(springs, names, functions, strict=True):
            one.__dict__[name] = function

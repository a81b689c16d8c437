"""Private names of pymunk's spaces, bodies and handlers, one function each; the check of all of them at import.

Each has a test in `tests/space/test_private.py` or `test_private_joints.py`. Those of the whole room are looked up when
the package is imported, so that a pymunk that has renamed one raises ImportError with the name.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from . import arbiters as private_arbiters
from . import batch as private_batch
from . import functions as private_functions
from . import joints as private_joints
from . import shapes as private_shapes
from . import sleep as private_sleep
from . import versions as private_versions
from .versions import REQUIRED

# Functions of a handler, in the order in which pymunk calls them.
PHASES = ("_begin", "_pre_solve", "_post_solve", "_separate")

_OF_LIBRARY = (
    "cpSpaceStep", "cpHastySpaceStep", "cpSpaceGetGravity", "cpSpaceSetGravity",
    "cpSpaceGetIterations", "cpSpaceSetIterations", "cpSpaceGetCollisionBias",
    "cpSpaceSetCollisionBias", "cpBodyGetForce", "cpBodySetForce", "cpBodyGetTorque", "cpBodySetTorque",
    "cpBodyGetMass", "cpBodyGetMoment", "cpShapeGetSensor", "cpSpaceGetSleepTimeThreshold",
    "cpSpaceSetSleepTimeThreshold", "cpSpaceGetTimestamp",
    *private_joints.OF_LIBRARY, *private_sleep.OF_LIBRARY, *private_arbiters.OF_LIBRARY, *private_functions.OF_LIBRARY,
    *private_batch.OF_LIBRARY, *private_shapes.OF_LIBRARY,
)  # fmt: skip
# By these methods pymunk adds and removes one thing after the other, also those that wait for the end of a step.
CONTENTS = "_add_shape", "_add_body", "_remove_shape", "_remove_body"
LINKS = "_add_constraint", "_remove_constraint"
_OF_SPACE = (
    "_space", "_bodies", "_handlers", "_get_arbiters", "_locked", "_add_later", "_remove_later", "_removed_shapes",
    "_post_step_callbacks", *CONTENTS, *LINKS,
)  # fmt: skip
_OF_BODY = ("_body", "_velocity_func", "_position_func")
_TYPES = (*private_batch.TYPES, *private_arbiters.TYPES)


def missing() -> list[str]:
    """Names that this package needs and that the installed pymunk lacks."""
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    handler = private_versions.add_handler(space)
    owners: list[tuple[str, Any, Iterable[str]]] = [
        ("pymunk._chipmunk_cffi.lib", lib, _OF_LIBRARY),
        ("pymunk.Space", space, _OF_SPACE),
        ("pymunk.Body", body, _OF_BODY),
        ("pymunk.Constraint", pymunk.PinJoint(body, space.static_body), private_joints.OF_CONSTRAINT),
        *((f"pymunk.{kind.__name__}", kind, (function,)) for kind, function in private_joints.OF_SPRINGS),
        ("pymunk.CollisionHandler", handler, PHASES),
    ]
    absent = [f"{name}.{one}" for name, owner, names in owners for one in names if not hasattr(owner, one)]
    for kind in _TYPES:
        try:
            ffi.new(kind)
        except (TypeError, ffi.error):
            absent.append(f"pymunk._chipmunk_cffi.ffi: {kind}")
    return absent


def check() -> None:
    """ImportError unless the installed pymunk has all private names."""
    if absent := missing():
        raise ImportError(
            f"pymunk {pymunk.version} lacks {', '.join(absent)}, which eeca_pymunk needs: pip install '{REQUIRED}'"
        )


def handlers(space: pymunk.Space) -> list[Any]:
    """The collision handlers of a space; pymunk has no public access to them."""
    return list(space._handlers.values())


def functions(space: pymunk.Space) -> list[tuple[Any, ...]]:
    """The collision handlers of a space, each with its functions in the order of `PHASES`, None for none."""
    return [(h, h._begin, h._pre_solve, h._post_solve, h._separate) for h in space._handlers.values()]


def arbiters(space: pymunk.Space) -> list[pymunk.Arbiter]:
    """All arbiters that pymunk keeps: of its last step, and of `collision_persistence` steps before."""
    return [pymunk.Arbiter(one, space) for one in space._get_arbiters()]


def differing_arbiters(space: pymunk.Space) -> list[pymunk.Arbiter]:
    """Those of `arbiters` whose values may differ from those that follow from their shapes."""
    return [pymunk.Arbiter(one, space) for one in space._get_arbiters() if private_versions.may_differ(one)]


def pointers(bodies: Iterable[pymunk.Body]) -> list[Any]:
    """Pointers to the Chipmunk bodies."""
    return [body._body for body in bodies]


def raw_arbiters(space: pymunk.Space) -> list[Any]:
    """Pointers to the arbiters of Chipmunk."""
    return list(space._get_arbiters())


def velocity_function(body: pymunk.Body) -> Callable[..., None] | None:
    """The velocity function of the program, None if it is pymunk's; the public property does not distinguish."""
    return body._velocity_func


def body_values(body: pymunk.Body) -> tuple[int, float, float, float, float, bool, bool]:
    """Type, mass, moment and centre of gravity (2) of a body, and whether it has a velocity and a position function of
    the program. The public properties take three times as long."""
    c = body._body
    centre = lib.cpBodyGetCenterOfGravity(c)
    steered, moved = velocity_function(body) is not None, position_function(body) is not None
    return lib.cpBodyGetType(c), lib.cpBodyGetMass(c), lib.cpBodyGetMoment(c), centre.x, centre.y, steered, moved


def position_function(body: pymunk.Body) -> Callable[..., None] | None:
    """The position function of the program, None if it is pymunk's."""
    return body._position_func


def may_rest(body: pymunk.Body) -> bool:
    """Whether a body is kinematic, and moved by its velocity alone."""
    kinematic = lib.cpBodyGetType(body._body) == lib.CP_BODY_TYPE_KINEMATIC
    return kinematic and velocity_function(body) is None and position_function(body) is None


@contextmanager
def locked(space: pymunk.Space) -> Iterator[None]:
    """Within this block additions and removals wait for `finish_step` or the end of pymunk's next step."""
    space._locked = True
    try:
        yield
    finally:
        space._locked = False


def step_without_end(space: pymunk.Space, dt: float) -> None:
    """pymunk's step without its end: additions, removals and callbacks wait for `finish_step`.

    No body falls asleep in it, because the threshold is the largest finite number meanwhile. An infinite one would
    switch sleeping off: sleeping bodies that are touched would not wake, and pymunk would have the contact twice.
    """
    c, threshold = space._space, lib.cpSpaceGetSleepTimeThreshold(space._space)
    space._locked = True
    try:
        if threshold != math.inf:
            lib.cpSpaceSetSleepTimeThreshold(c, sys.float_info.max)
        (lib.cpHastySpaceStep if space.threaded else lib.cpSpaceStep)(c, dt)
        space._removed_shapes.clear()
    finally:
        space._locked = False
        if threshold != math.inf:
            lib.cpSpaceSetSleepTimeThreshold(c, threshold)


def finish_step(space: pymunk.Space) -> None:
    """Do the additions and removals by callbacks of the last step, and call its post-step callbacks."""
    added = list(space._add_later)
    space._add_later.clear()
    space.add(*added)
    # Removing a touching shape calls `separate`, which may remove further objects, also the same ones.
    remove, gone = getattr(space, private_versions.REMOVE), set()
    while space._remove_later:
        things = list(space._remove_later)
        space._remove_later.clear()
        for thing in reversed(things):
            if thing not in gone:
                gone.add(thing)
                remove(thing)
    callbacks = list(space._post_step_callbacks.values())
    space._post_step_callbacks.clear()
    for callback in callbacks:
        callback(space)


def forget_removed(space: pymunk.Space) -> None:
    """Let the shapes be freed that were removed since pymunk's last step, which keeps them for callbacks."""
    space._removed_shapes.clear()


def watch(space: pymunk.Space, edits: list[int], known: list[int]) -> Callable[[], bool]:
    """A function that returns whether the settings and contents of the space are still as they are now.

    Args:
        edits: `edits.counts` of the space.  known: a list of one number, the value of edits[0] that counts as
            unchanged; the caller sets it after a patch.
    """
    handlers, changes = space._handlers, edits[2]
    count = len(handlers)

    def unchanged() -> bool:
        return edits[0] == known[0] and edits[2] == changes and len(handlers) == count

    return unchanged


def timestamp(space: pymunk.Space) -> Callable[[], int]:
    """A function that returns the number of steps that pymunk itself has taken in this space."""
    return partial(lib.cpSpaceGetTimestamp, space._space)


def set_time_step(space: pymunk.Space, dt: float) -> None:
    """Set `space.current_time_step`, which is that of pymunk's last step, and with which its next one scales what it
    has stored of impulses."""
    lib.cpSpaceSetCurrentTimeStep(space._space, dt)


def waiting(space: pymunk.Space) -> list[Any]:
    """Copies of the callbacks, additions and removals that wait, for `let_wait`."""
    return [kept.copy() for kept in (space._post_step_callbacks, space._add_later, space._remove_later)]


def let_wait(space: pymunk.Space, kept: list[Any]) -> None:
    """Let these wait, and what has come since no longer."""
    space._post_step_callbacks, space._add_later, space._remove_later = kept


def waits(space: pymunk.Space) -> bool:
    """Whether additions, removals or callbacks wait for the end of a step."""
    return bool(space._post_step_callbacks or space._add_later or space._remove_later)


check()

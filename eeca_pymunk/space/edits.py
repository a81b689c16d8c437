"""In-place edits of shapes and bodies are recorded when they are made, by wrapped setters of pymunk's classes.

pymunk's setters write into Chipmunk at once without notification, and reading all shapes again takes longer than most
steps. So the setters of properties that a `World` reads once are wrapped when the first space is watched. Each acts as
before, and then adds one to the count of its space, or that of its shape or body, if that is watched and the value has
changed. So do the methods by which pymunk adds and removes things. Getters, and properties that a `World` does not read
(positions, velocities, forces, colours), are not changed. Calls of `Body.sleep` and `sleep_with_group`, which
`sleep_groups.py` wraps, are counted.
"""

from __future__ import annotations

import threading
import weakref
from collections import deque
from collections.abc import Callable
from functools import wraps
from itertools import islice
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import pymunk

from .private import spaces as private
from .private import versions as private_versions

_SURFACE = ("filter", "elasticity", "friction", "surface_velocity")  # these change neither masses nor outlines
_PROPERTIES: tuple[tuple[type, tuple[str, ...]], ...] = (
    (pymunk.Shape, ("mass", "density", "sensor", *_SURFACE, "body", "collision_type")),
    (pymunk.Body, ("mass", "moment", "center_of_gravity", "body_type", "velocity_func", "position_func")),
    (pymunk.Space, ("gravity", "damping", "sleep_time_threshold")),
)
_METHODS: tuple[tuple[type, tuple[str, ...]], ...] = (
    (pymunk.Circle, ("unsafe_set_radius", "unsafe_set_offset")),
    (pymunk.Segment, ("unsafe_set_radius", "unsafe_set_endpoints")),
    (pymunk.Poly, ("unsafe_set_radius", "unsafe_set_vertices")),
    (pymunk.Space, (*private.CONTENTS, *private.LINKS)),
)
_VALUES = (*_SURFACE, "mass", "moment")  # these do not change sizes
_OF_MASS = "mass", "density"
SLEEP = ("sleep", "sleep_with_group")
_KEPT = 4096  # number of edits that are kept, the last ones
_wrapped = False
_clock = _type_changes = 0
# The last edits, in any space or outside: the shape or body, and the property or method.
_edited: deque[tuple[weakref.ref[Any], str]] = deque(maxlen=_KEPT)
_lock = threading.Lock()  # of both: other threads may edit spaces of their own


class Counts(list[int]):
    """Four counts of a space: [0] edits of its shapes and bodies, and bodies put to sleep; [1] bodies put to sleep
    alone; [2] changes of its settings, additions and removals, also of constraints; [3] additions and removals of
    shapes and bodies alone. A list, which `private.spaces.watch` compares fastest."""

    def __init__(self) -> None:
        super().__init__((0, 0, 0, 0))

    @property
    def in_place(self) -> int:
        """Number of edits of shapes and bodies, without bodies put to sleep."""
        return self[0] - self[1]


_counts: WeakKeyDictionary[pymunk.Space, Counts] = WeakKeyDictionary()


def counts(space: pymunk.Space) -> Counts:
    """The counts of a space. The first call for a space begins to count; the very first one wraps the setters."""
    global _wrapped
    if not _wrapped:
        _wrapped = True
        for owner, names in _PROPERTIES:
            for name in names:
                setattr(owner, name, _property(name, vars(owner)[name]))
        for owner, names in _METHODS:
            for name in names:
                setattr(owner, name, _method(vars(owner)[name]))
    return _counts.setdefault(space, Counts())


def clock() -> int:
    """Number of edits of shapes and bodies so far, in any space or outside."""
    return _clock


def type_changes() -> int:
    """Number of changes of collision types so far, in any space or outside. They do not count as edits, because rows do
    not contain collision types."""
    return _type_changes


class Edited(NamedTuple):
    """What was edited: shapes and bodies, without those put to sleep; objects that no longer exist are None.

    Attributes:
        things: all.  reshaped: those of which more than `_SURFACE` may have changed, and the bodies of such shapes,
            whose mass and moment may follow.  values: whether only `_VALUES` have changed.
    """

    things: set[Any]
    reshaped: set[Any]
    values: bool


def edited_since(time: int) -> Edited | None:
    """What was edited since `clock` was `time`; None if there were more edits than `_KEPT`."""
    if _clock == time:
        return Edited(set(), set(), True)
    if _clock - time > len(_edited):
        return None
    reshaped, others, values = set[Any](), set[Any](), True
    with _lock:
        recent = list(islice(reversed(_edited), _clock - time))
    for thing, name in recent:
        values = values and name in _VALUES
        if name not in SLEEP:
            (others if name in _SURFACE else reshaped).add(thing())
    if reshaped:
        reshaped.update([thing.body for thing in reshaped if isinstance(thing, pymunk.Shape)])
        others |= reshaped
    return Edited(others, reshaped, values)


def record(thing: Any, name: str) -> None:
    """Count an edit of a shape, body or space by the property or method `name`."""
    global _clock, _type_changes
    if name == "collision_type":
        _type_changes += 1
        return
    if isinstance(thing, pymunk.Space):
        if (count := _counts.get(thing)) is not None:
            count[2] += 1
            count[3] += name in private.CONTENTS
        return
    with _lock:
        _clock += 1
        _edited.append((weakref.ref(thing), name))
    space = thing.space
    count = None if space is None else _counts.get(space)
    if count is None:
        return
    count[0] += 1
    count[1] += name in SLEEP


def _property(name: str, native: Any) -> property:
    read, write, kept = native.fget, native.fset, name in private_versions.DEFAULTS

    def set_and_record(self: Any, value: Any) -> None:
        before = None if read is None else read(self)
        write(self, value)
        if kept:
            private_versions.forget_function(self, name, value)
        # A mass of a shape that is set again counts, too: pymunk computes that of its body anew.
        if read is None or read(self) != before or (name in _OF_MASS and isinstance(self, pymunk.Shape)):
            record(self, name)

    return property(read, set_and_record, native.fdel, native.__doc__)


def _method(native: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(native)
    def call_and_record(self: Any, *args: Any, **kwargs: Any) -> Any:
        # A shape with a mass changes that of the body that it has, and may have another one afterwards.
        heavy = args[0] if args and isinstance(args[0], pymunk.Shape) and args[0].mass > 0.0 else None
        body = None if heavy is None else heavy.body
        try:
            return native(self, *args, **kwargs)
        finally:
            record(self, native.__name__)
            if body is not None:
                record(body, "mass")

    return call_and_record

"""Contents of pymunk's arbiters after an EECA step: the impulses of the step, and the pairs that touched in it.

pymunk's solver does not compute an EECA step. Its arbiters are those of the rest step, of shapes that touch at the end,
without impulses, or those of a rehearsal. Therefore `Body.each_arbiter` and `batch.get_space_arbiters` are replaced.
While they run, the contacts of pymunk's arbiters have the impulses of the step, and pairs that touched only within the
step have arbiters of their own; afterwards pymunk's arbiters are restored. All this is done when arbiters are read, not
in the step. Pairs of sleeping bodies keep the impulses of the step in which these fell asleep, as pymunk's do.

The impulse of an arbiter is the sum over the step. Its points are pymunk's, or those of the last touch. `total_ke`
follows Chipmunk's formula for its total kinetic energy, the sum over points of (1 - e)/(1 + e) j_n^2 / m_n + j_t^2 /
m_t with the effective masses m.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import pymunk
from pymunk import batch

from ..compiled.records import Rows
from ..model.contacts import Impulse
from .late_shapes import last_sync, make_arbiters, move_late
from .private import arbiters as private_arbiters
from .private import sleep as private_sleep
from .private import spaces as private


class Touch(NamedTuple):
    """A pair of shapes in a step: the sum of its impulses on `b` (mass length/time), normal (unit, from a to b) and
    points (length, one or two) of its last touch."""

    a: pymunk.Shape
    b: pymunk.Shape
    impulse: tuple[float, float]
    normal: tuple[float, float]
    points: list[tuple[float, float]]


class Touches:
    """The pairs of a step, which are made of its impulses when they are first read.

    Args:
        EVENT: (m,) the impulses, kept.  shapes: by row, at least all of the impulses.
    """

    def __init__(self, EVENT: Rows[Impulse], shapes: Mapping[int, pymunk.Shape]) -> None:
        self._made_of = EVENT, shapes

    @cached_property
    def _row(self) -> dict[pymunk.Shape, int]:
        return {shape: row for row, shape in self._made_of[1].items()}

    def alone(self, bodies: Iterable[pymunk.Body]) -> Touches:
        """The pairs of these bodies, which keep neither the impulses nor the shapes of others."""
        EVENT, shapes = self._made_of
        mine = np.zeros(max(shapes, default=-1) + 1, bool)
        mine[[self._row[shape] for body in bodies for shape in body.shapes if shape in self._row]] = True
        first, second = (EVENT[name].astype(np.int64) for name in ("first", "second"))
        kept = mine[first] | mine[second]
        rows = {*first[kept].tolist(), *second[kept].tolist()}
        return Touches(EVENT[kept], {row: shapes[row] for row in rows})

    @cached_property
    def all(self) -> dict[frozenset[int], Touch]:
        """The pairs, by the addresses of both shapes in Chipmunk."""
        key = private_arbiters.shape_key
        return {frozenset((key(touch.a), key(touch.b))): touch for touch in touches_of(*self._made_of)}

    @cached_property
    def _of(self) -> dict[int, dict[frozenset[int], Touch]]:
        """By the id of the body: a body that is gone must not be kept."""
        found: dict[int, dict[frozenset[int], Touch]] = {}
        for key, touch in self.all.items():
            for body in (touch.a.body, touch.b.body):
                if body is not None:
                    found.setdefault(body.id, {})[key] = touch
        return found

    def of(self, body: pymunk.Body) -> dict[frozenset[int], Touch]:
        """The pairs of a body."""
        return self._of.get(body.id, {})


ReadTouches = Callable[[], "Touches | None"]
_asleep: WeakKeyDictionary[pymunk.Body, Touches] = WeakKeyDictionary()  # of the step in which they fell asleep
_native_each: Any = pymunk.Body.each_arbiter
_native_batch: Any = batch.get_space_arbiters
_native_draw: Any = pymunk.Space.debug_draw


def show_contacts() -> None:
    """Let arbiters of a space have the contents that `Sync.touches` of its last step returns; if it returns None, those
    of pymunk."""
    if pymunk.Body.each_arbiter is not _each_arbiter:  # setting any attribute of a class clears Python's caches of it
        pymunk.Body.each_arbiter = _each_arbiter  # type: ignore[method-assign]
        pymunk.Space.debug_draw = _debug_draw  # type: ignore[method-assign]
        batch.get_space_arbiters = _get_space_arbiters


def touches_of(EVENT: Rows[Impulse], shapes: Mapping[int, pymunk.Shape]) -> list[Touch]:
    """The pairs of the (m,) impulses of a step, in which a pair may come in either order; `shapes` by row."""
    found: dict[tuple[int, int], list[tuple[Any, float]]] = {}
    for e in EVENT:
        pair = int(e["first"]), int(e["second"])
        if pair[::-1] in found:
            found[pair[::-1]].append((e, -1.0))
        else:
            found.setdefault(pair, []).append((e, 1.0))
    result = []
    for (a, b), events in found.items():
        x = sum(sign * (e["normal"] * e["nx"] - e["tangential"] * e["ny"]) for e, sign in events)
        y = sum(sign * (e["normal"] * e["ny"] + e["tangential"] * e["nx"]) for e, sign in events)
        last = max(e["when"] for e, _ in events)
        late = [(e, sign) for e, sign in events if e["when"] == last][:2]
        points = [(float(e["px"]), float(e["py"])) for e, _ in late]
        one, sign = late[0]
        normal = sign * float(one["nx"]), sign * float(one["ny"])
        result.append(Touch(shapes[a], shapes[b], (float(x), float(y)), normal, points))
    return result


def keep_sleeping(space: pymunk.Space, bodies: Iterable[pymunk.Body]) -> None:
    """Keep the pairs of the last step of bodies that have just fallen asleep, until they wake; none if that was
    pymunk's own."""
    last, bodies = _last(space), list(bodies)
    kept = None if last is None else last.alone(bodies)
    for body in bodies:
        if kept is None:
            _asleep.pop(body, None)
        else:
            _asleep[body] = kept


def _last(space: pymunk.Space) -> Touches | None:
    sync = last_sync(space)
    read = None if sync is None else sync.touches()
    return None if read is None else read()


def _of_sleeper(body: pymunk.Body) -> dict[frozenset[int], Touch]:
    touches = _asleep.get(body)
    return {} if touches is None else touches.of(body)


def _kept(body: pymunk.Body, space: pymunk.Space) -> dict[frozenset[int], Touch]:
    """The pairs of a body that sleeps, or of one that is not dynamic with those that do."""
    if body.is_sleeping:
        return _of_sleeper(body)
    if body.body_type == pymunk.Body.DYNAMIC:
        return {}
    found = (pair for one in private_sleep.asleep(space) for pair in _of_sleeper(one).items())
    return {key: touch for key, touch in found if body in (touch.a.body, touch.b.body)}


def _touches_of(body: pymunk.Body, space: pymunk.Space) -> tuple[bool, dict[frozenset[int], Touch]]:
    """Whether the last step of a space was not pymunk's own; and the pairs of a body in that step, and as it sleeps."""
    last = _last(space)
    return last is not None, {**_kept(body, space), **({} if last is None else last.of(body))}


@contextmanager
def _with_impulses(arbiters: Sequence[Any], ours: bool, found: dict[frozenset[int], Touch]) -> Iterator[list[Any]]:
    """Within this block pymunk's arbiters have the impulses of these pairs, and if the step is `ours` those of other
    pairs that are awake have none; yields arbiters for pairs that pymunk has not."""
    kept, missing = [], dict(found)
    try:
        for arbiter in arbiters:
            if arbiter.count == 0:
                continue
            touch = missing.pop(private_arbiters.arbiter_key(arbiter), None)
            if touch is None and (not ours or private_arbiters.asleep(arbiter)):
                continue
            impulse = None
            if touch is not None:  # the shapes of the arbiter may be in the other order
                sign = 1.0 if private_arbiters.second_is(arbiter, touch.b) else -1.0
                impulse = sign * touch.impulse[0], sign * touch.impulse[1]
            kept.append((arbiter, private_arbiters.set_impulse(arbiter, impulse)))
        there = [t for t in missing.values() if t.a.space is not None and t.b.space is not None]
        yield [private_arbiters.make_arbiter(t.a, t.b, t.normal, t.points, t.impulse) for t in there]
    finally:
        for arbiter, old in kept:
            private_arbiters.restore_impulse(arbiter, old)


def _each_arbiter(self: pymunk.Body, func: Callable[..., None], *args: Any, **kwargs: Any) -> None:
    space = self.space
    ours, found = (False, {}) if space is None else _touches_of(self, space)
    if space is None or not (ours or found):
        _native_each(self, func, *args, **kwargs)
        return
    arbiters: list[Any] = []
    _native_each(self, lambda arbiter: arbiters.append(private_arbiters.raw(arbiter)))
    with _with_impulses(arbiters, ours, found) as more:
        _native_each(self, func, *args, **kwargs)
        for arbiter in more:
            private_arbiters.turn_to(arbiter, self)
            func(pymunk.Arbiter(arbiter, space), *args, **kwargs)


def _get_space_arbiters(space: pymunk.Space, fields: batch.ArbiterFields, buffers: batch.Buffer) -> None:
    last = _last(space)  # pymunk's lists no pairs that sleep
    if last is None:
        _native_batch(space, fields, buffers)
        return
    with _with_impulses(private.raw_arbiters(space), True, last.all) as more:
        _native_batch(space, fields, buffers)
        private_arbiters.batch_arbiters(more, fields, buffers)


def _debug_draw(self: pymunk.Space, options: pymunk.SpaceDebugDrawOptions) -> None:
    if options.flags & pymunk.SpaceDebugDrawOptions.DRAW_COLLISION_POINTS:
        make_arbiters(self)
    move_late(self)
    _native_draw(self, options)


_debug_draw.__doc__ = _native_draw.__doc__
_each_arbiter.__doc__ = _native_each.__doc__
_get_space_arbiters.__doc__ = _native_batch.__doc__

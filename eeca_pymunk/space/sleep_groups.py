"""Groups of bodies that sleep together, by contacts and joints.

`Body.sleep` and `sleep_with_group` are wrapped when this module is imported: their calls are counted, and groups of
sleeping bodies are recorded, because Chipmunk does not show them. Before a body falls asleep arbiters are made, as it
keeps its own until it wakes.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Sequence
from functools import wraps

import numpy as np
import pymunk

from ..arrays import IntArray
from ..report import Contacts
from ..sleepers import connect
from .arbiters import keep_sleeping
from .bodies import Bodies
from .edits import SLEEP, record
from .late_shapes import make_arbiters
from .private import batch as private_batch
from .private import sleep as private_sleep

_leaders: weakref.WeakKeyDictionary[pymunk.Body, weakref.ref[pymunk.Body]] = weakref.WeakKeyDictionary()


def touching(space: pymunk.Space, ids: IntArray) -> IntArray:
    """(n, 2) which of the bodies with these ids (N,), all that are known, touch according to pymunk."""
    make_arbiters(space)
    pairs, order = private_batch.touching(space), np.argsort(ids)
    found = order[np.searchsorted(ids, pairs, sorter=order) % len(ids)]
    known: IntArray = found[(ids[found] == pairs).all(axis=1)]
    return known


def resting_groups(
    space: pymunk.Space, bodies: Bodies, ids: IntArray, ready: IntArray, contacts: Contacts,
    jointed: Iterable[tuple[pymunk.Body, pymunk.Body]],
) -> list[list[pymunk.Body]]:  # fmt: skip
    """The groups of bodies that touch or are jointed, all of which may fall asleep.

    Args:
        ids: (N,) of the bodies.  ready: (N,) 1 for those that have been at rest for long enough.
        contacts: of the last step.  jointed: the bodies of each constraint.
    """
    row = bodies.row
    joined = np.array([(row[a], row[b]) for a, b in jointed if a in row and b in row], np.int64).reshape(-1, 2)
    # pymunk's contacts count too: it keeps one with a sleeping body forever, so that both bodies must sleep or neither.
    pairs = np.concatenate((np.column_stack((contacts.body_a, contacts.body_b)), joined, touching(space, ids)))
    group = np.zeros(len(bodies), np.int64)
    connect(pairs, bodies.VALUES["kind"].astype(np.int64), ready, group)
    resting: dict[int, list[pymunk.Body]] = {}
    for body, number in zip(bodies.items, group.tolist(), strict=True):
        if number >= 0:
            resting.setdefault(number, []).append(body)
    return list(resting.values())


def leader(body: pymunk.Body) -> pymunk.Body:
    """The body by whose call of `sleep` the group of this sleeping body was made; `body` itself if that one is unknown,
    awake or in another space."""
    reference = _leaders.get(body)
    found = None if reference is None else reference()
    return found if found is not None and found.space is body.space and found.is_sleeping else body


def sleeping_groups(bodies: Sequence[pymunk.Body]) -> IntArray:
    """(N,) for each body the index of the first body of its sleeping group (`leader`), -1 if it is awake."""
    place = {body: i for i, body in enumerate(bodies)}
    asleep = private_sleep.sleeping(bodies)
    groups = [place.get(leader(body), i) if asleep[i] else -1 for body, i in place.items()]
    return np.array(groups, np.int64)


def put_to_sleep(bodies: Sequence[pymunk.Body], groups: IntArray) -> None:
    """Put awake bodies to sleep in groups; `groups` (N,): equal numbers for the bodies of a group, -1 for bodies that
    stay awake."""
    members: dict[int, list[pymunk.Body]] = {}
    for body, group in zip(bodies, groups.tolist(), strict=True):
        members.setdefault(group, []).append(body)
    members.pop(-1, None)
    for group in members.values():
        sleep_together(group)


def sleep_together(group: Sequence[pymunk.Body]) -> None:
    """Put the awake bodies of a group to sleep; what the wrapped methods do for each is done once."""
    first = group[0]
    assert first.space is not None
    make_arbiters(first.space)
    sleep, join = (_native[name] for name in SLEEP)
    lead = weakref.ref(first)
    for body in group:
        sleep(body) if body is first else join(body, first)
        _leaders[body] = lead
        record(body, SLEEP[body is not first])
    keep_sleeping(first.space, group)


def wake_neighbours(space: pymunk.Space) -> None:
    """Wake sleeping bodies that are jointed to an awake body of the space that is not static, or touch one according to
    pymunk; then the neighbours of these, and so on. Bodies outside the space that joints hold to it count as asleep
    under pymunk, forever."""
    if not private_sleep.asleep(space):
        return
    known = [*space.bodies, space.static_body]
    touch = touching(space, np.array([body.id for body in known], np.int64))
    pairs = [*((c.a, c.b) for c in space.constraints), *((known[i], known[j]) for i, j in touch.tolist())]
    bodies = {body for pair in pairs for body in pair}
    again = True
    while again:
        again = False
        asleep = {body for body in bodies if body.is_sleeping and body.space is space}
        for first, second in pairs:
            if (first in asleep) == (second in asleep):
                continue
            one, other = (first, second) if first in asleep else (second, first)
            if other.body_type != pymunk.Body.STATIC and other.space is space:
                one.activate()
                again = True


def _sleep(native: Callable[..., None]) -> Callable[..., None]:
    @wraps(native)
    def sleep_and_record(self: pymunk.Body, *group: pymunk.Body) -> None:
        lead = leader(group[0]) if group else self
        if self.space is not None:
            make_arbiters(self.space)
        native(self, *group)
        _leaders[self] = weakref.ref(lead)
        record(self, native.__name__)
        if self.space is not None:
            keep_sleeping(self.space, (self,))

    return sleep_and_record


_native: dict[str, Callable[..., None]] = {name: vars(pymunk.Body)[name] for name in SLEEP}
for _name in SLEEP:
    setattr(pymunk.Body, _name, _sleep(_native[_name]))

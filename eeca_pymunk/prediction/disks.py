"""Forecasts of lone disks that are in no island: those that most events of a gas are about.

What a forecast says stays good while neither path changes: past the start of a step, and past the disk's leaving its
margin circle, for which whom it meets if it goes straight on (LATER) is kept.
"""

from __future__ import annotations

import math

from ..compiled import uncounted
from ..geometry.flight import norm
from ..model.bodies import CHECK, LEAVE, NOTHING
from ..model.parameters.events import AHEAD, FARTHEST_MARGIN, SAME_INSTANT
from ..model.scene import Scene
from ..model.shapes import BATCH
from ..pairs.grid import renew
from ..pairs.rules import barred
from .heap import push
from .impact_times import meet, misses, one_pull
from .next_event import has_left, leaves


@uncounted
def carrier(A: Scene, s: int) -> int:
    """Row of the body of shape s: lone disks have the same number as their shapes."""
    return s if s < A.COUNT.disks else int(A.LINK[s].owner)


@uncounted
def first_chosen(A: Scene, i: int, chosen: int, best: float, other: int) -> tuple[float, int]:
    """As `first_meeting`, among so many lone disks in GRID.chosen, which one acceleration pulls."""
    for k in range(chosen):
        o = A.GRID.chosen[k]
        t = one_pull(A.BODY, i, o, best)
        if t < best or (t == best and other >= 0 and o < other):
            best, other = t, o
    return best, other


@uncounted
def first_meeting(
    A: Scene, i: int, known: int, best: float, other: int, end: float, several: bool
) -> tuple[float, int]:  # fmt: skip
    """Instant and shape of the first meeting of lone disk i with those of its list from place `known` on, or what comes
    before that, `best` and `other`; CHECK for a shape if it is not certain.

    Args:
        several: whether bodies that have a PLACE are forecast together, see `next_event.predict`.
    """
    BODY, POOL, FLAG, CHOSEN = A.BODY, A.POOL, A.FLAG, A.GRID.chosen
    disks, chosen = A.COUNT.disks, 0
    even = A.COUNT.even > 0
    flagged = not even or A.COUNT.unmet > 0
    ax, ay = BODY[i].ax, BODY[i].ay
    start, ruled = A.LIST[i].start, A.RULE.shape[0] > 0
    for q in range(start + known, start + A.LIST[i].number):
        if flagged and FLAG[q] != 0:
            continue
        o = int(POOL[q])
        if several:
            j = carrier(A, o)
            if A.PLACE[j] >= 0 and j < i:
                continue
        if ruled and barred(A.RULE, i, o):
            continue
        if o < disks and even:
            CHOSEN[chosen] = o
            chosen += 0 if misses(BODY, i, o, ax, ay, best) else 1
            if chosen == BATCH:
                best, other = first_chosen(A, i, chosen, best, other)
                chosen = 0
            continue
        t, certain = meet(A, i, o, end)
        if t < best or (t == best and other >= 0 and o < other):
            best, other = t, (o if certain else CHECK)
    return first_chosen(A, i, chosen, best, other)


@uncounted
def expect(A: Scene, i: int, best: float, other: int, now: float, end: float) -> None:
    """Take it that lone disk i meets shape `other` next, at instant `best`, or leaves its margin circle before; put
    what is due in this step on the heap."""
    out = leaves(A, i, i, now)
    if other >= 0:
        A.STATE[i].known = A.STATE[carrier(A, other)].version
    if out <= best and out < math.inf:
        A.LIST[i].later = other
        best, other = out, LEAVE
    best = max(best, now)
    A.BODY[i].due, A.STATE[i].own, A.STATE[i].other = best, i, other
    if best < end:
        A.COUNT.heap = push(A.HEAP_TIME, A.HEAP_BODY, A.COUNT.heap, best, i)


@uncounted
def predict_disk(A: Scene, i: int, now: float, end: float, several: bool) -> None:
    """As `next_event.predict`, of a lone disk that is in no island."""
    best, other = first_meeting(A, i, 0, math.inf, NOTHING, end, several)
    expect(A, i, best, other, now, end)


@uncounted
def go_on(A: Scene, i: int, now: float, end: float) -> bool:
    """Lone disk i, in no island, leaves its margin circle and goes straight on: only what has come into its list is new
    in its forecast. False if the pool is full."""
    BODY = A.BODY
    best, other, later, known = math.inf, NOTHING, A.LIST[i].later, A.LIST[i].number
    ahead = AHEAD
    if later >= 0 and A.STATE[carrier(A, later)].version == A.STATE[i].known:
        best, certain = meet(A, i, later, end)
        other = later if certain else CHECK
    if has_left(A, i, now):
        h = now - BODY[i].since
        if later == NOTHING or other >= 0:
            # Its course changes where it meets somebody: its circle is to be about there.
            way = norm(BODY[i].vx + BODY[i].ax * h, BODY[i].vy + BODY[i].ay * h) * (best - now)
            ahead = min(way / A.MARK[i].margin, FARTHEST_MARGIN)
        known = renew(A, i, now, ahead)
        if known < 0:
            return False
    if later != NOTHING and other < 0:
        known = 0
    best, other = first_meeting(A, i, known, best, other, end, False)
    expect(A, i, best, other, now, end)
    return True


@uncounted
def holds(A: Scene, i: int, end: float) -> bool:
    """Whether the forecast that lone disk i, in no island, was given in an earlier step is still good, as its path and
    that of whom it meets are the same; puts it on the heap. The instant is computed again, from the paths as they are
    described in this step, so that no bit depends on how long ago the forecast was made."""
    other, due = A.STATE[i].other, A.BODY[i].due
    if due <= 0.0:
        return False
    if other >= 0:
        if A.STATE[carrier(A, other)].version != A.STATE[i].known:
            return False
        t, certain = meet(A, i, other, end)
        if not (certain and abs(t - due) <= SAME_INSTANT * end):
            return False
        A.BODY[i].due = due = t
    elif other != LEAVE:
        return False
    if due < end:
        A.COUNT.heap = push(A.HEAP_TIME, A.HEAP_BODY, A.COUNT.heap, due, i)
    return True

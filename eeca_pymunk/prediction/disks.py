"""Predictions for single disks, which are in no island: most events of a gas.

A prediction remains valid while neither path changes, also across the start of a step and after the disk has left its
margin circle. `List.later` keeps the next impact across the renewal of the list.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..geometry.flight import norm
from ..model.bodies import CHECK, LEAVE, NOTHING
from ..model.parameters.events import AHEAD, FARTHEST_MARGIN, SAME_INSTANT
from ..model.scene import Scene
from ..model.shapes import BATCH
from ..pairs.grid import renew_circle
from ..pairs.rules import barred
from .heap import push_event
from .impact_times import meet_in_free_fall, misses, time_of_impact
from .next_event import inside_until, margin_used


@nonallocating
def body_of(A: Scene, s: int) -> int:
    """Row of the body of shape s: single disks have the same number as their shapes."""
    return s if s < A.COUNT.disks else int(A.LINK[s].owner)


@nonallocating
def first_chosen(A: Scene, i: int, chosen: int, best: float, other: int) -> tuple[float, int]:
    """As `first_impact`, among the first `chosen` disks in GRID.chosen, all of equal acceleration."""
    for k in range(chosen):
        o = A.GRID.chosen[k]
        t = meet_in_free_fall(A.BODY, i, o, best)
        if t < best or (t == best and other >= 0 and o < other):
            best, other = t, o
    return best, other


@nonallocating
def first_impact(A: Scene, i: int, known: int, best: float, other: int, several: bool) -> tuple[float, int]:
    """Instant and shape of the first meeting of single disk i with shapes of its list from index `known` on; the given
    `best` and `other` if these come first. CHECK in the place of the shape for a lower bound.

    Args:
        several: whether bodies that have a PLACE are predicted together, see `next_event.predict`.
    """
    BODY, POOL, FLAG, CHOSEN = A.BODY, A.POOL, A.FLAG, A.GRID.chosen
    disks, chosen = A.COUNT.disks, 0
    even = A.COUNT.even > 0
    # Only contacts of islands, and pairs whose impact was left out in this step, have a flag.
    flagged = not even or A.COUNT.unmet > 0
    ax, ay = BODY[i].ax, BODY[i].ay
    start, ruled = A.LIST[i].start, A.RULE.shape[0] > 0
    for q in range(start + known, start + A.LIST[i].number):
        if flagged and FLAG[q] != 0:
            continue
        o = int(POOL[q])
        if several:
            j = body_of(A, o)
            if A.PLACE[j] >= 0 and j < i:
                continue
        if ruled and barred(A, i, o):
            continue
        if o < disks and even:
            CHOSEN[chosen] = o
            chosen += 0 if misses(BODY, i, o, ax, ay, best) else 1
            if chosen == BATCH:
                best, other = first_chosen(A, i, chosen, best, other)
                chosen = 0
            continue
        t, certain = time_of_impact(A, i, o, A.PAR.dt, best)
        if t < best or (t == best and other >= 0 and o < other):
            best, other = t, (o if certain else CHECK)
    return first_chosen(A, i, chosen, best, other)


@nonallocating
def set_next_event(A: Scene, i: int, best: float, other: int, now: float) -> None:
    """Set the next event of single disk i: meeting shape `other` at instant `best`, or leaving its margin circle
    before. An event that is due in this step goes on the heap."""
    out = inside_until(A, i, i, now)
    if other >= 0:
        A.STATE[i].known = A.STATE[body_of(A, other)].version
    if out <= best and out < math.inf:
        A.LIST[i].later = other
        best, other = out, LEAVE
    best = max(best, now)
    A.BODY[i].due, A.STATE[i].own, A.STATE[i].other = best, i, other
    if best < A.PAR.dt:
        A.COUNT.heap = push_event(A.HEAP_TIME, A.HEAP_BODY, A.COUNT.heap, best, i)


@nonallocating
def continue_path(A: Scene, i: int, now: float) -> bool:
    """Single disk i leaves its margin circle with an unchanged path: renew its list and predict its next event, for
    which only the new entries are tested. False if the pool is full."""
    BODY = A.BODY
    best, other, later, known = math.inf, NOTHING, A.LIST[i].later, A.LIST[i].number
    ahead = AHEAD
    if later >= 0 and A.STATE[body_of(A, later)].version == A.STATE[i].known:
        best, certain = time_of_impact(A, i, later, A.PAR.dt, math.inf)
        other = later if certain else CHECK
    if margin_used(A, i, now):
        h = now - BODY[i].since
        if later == NOTHING or other >= 0:
            # Its path changes at its next impact, so the new circle is centred near that place.
            way = norm(BODY[i].vx + BODY[i].ax * h, BODY[i].vy + BODY[i].ay * h) * (best - now)
            ahead = min(way / A.MARK[i].margin, FARTHEST_MARGIN)
        known = renew_circle(A, i, now, ahead)
        if known < 0:
            return False
    if later != NOTHING and other < 0:
        # The kept impact is void, or only a lower bound: the old entries are tested too.
        known = 0
    best, other = first_impact(A, i, known, best, other, False)
    set_next_event(A, i, best, other, now)
    return True


@nonallocating
def still_valid(A: Scene, i: int) -> bool:
    """Whether the prediction of an earlier step for single disk i is still valid, because neither path has changed; if
    so, it goes on the heap. The instant is computed again from the paths as this step describes them, so that no bit
    depends on the age of the prediction."""
    other, due, end = A.STATE[i].other, A.BODY[i].due, A.PAR.dt
    if due <= 0.0:
        return False
    if other >= 0:
        if A.STATE[body_of(A, other)].version != A.STATE[i].known:
            return False
        t, certain = time_of_impact(A, i, other, end, math.inf)
        if not (certain and abs(t - due) <= SAME_INSTANT * end):
            return False
        A.BODY[i].due = due = t
    elif other != LEAVE:
        return False
    if due < end:
        A.COUNT.heap = push_event(A.HEAP_TIME, A.HEAP_BODY, A.COUNT.heap, due, i)
    return True

"""Islands at the start of a step: contacts that lasted to the end of the last step are examined again, and bodies that
touch an island join it."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, nonallocating
from ..contacts.forces import table_has_room
from ..geometry.flight import fastest, move_to
from ..geometry.widths import smaller
from ..model.bodies import AT_REST
from ..model.contacts import ENDED, LASTED
from ..model.parameters.events import INITIAL_PENETRATION
from ..model.parameters.intervals import TOUCH, TRAVEL_MARGIN
from ..model.scene import Scene
from ..model.step import DONE, PUSHES_FULL
from ..pairs.rules import barred, far_apart, law
from .accounting import end_rest_or_interval
from .at_rest import disturb, wake_changed
from .intervals import begin_interval
from .local import drop_contacts
from .membership import approach, budget_spent, fixed_support, persists, unite
from .partial_rest import rests_in_part
from .support import support


@nonallocating
def penetrates(A: Scene, s: int, o: int) -> tuple[bool, float, float]:
    """Whether shapes s and o overlap deeply and may be pushed apart (of lossy shapes, not barred); their gap (length)
    and its rate (length/time)."""
    if barred(A, s, o) or law(A, s, o)[0] >= 1.0 or far_apart(A, s, o, 0.0, 0.0):
        return False, 0.0, 0.0
    g, u, _, _, _ = approach(A, s, o, 0.0)
    return g < -INITIAL_PENETRATION * smaller(A, s, o), g, u


@nonallocating
def wake_penetrated(A: Scene) -> None:
    """At the start of a step: let the islands at rest be solved again that bodies without mobility overlap deeply which
    the program has placed."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i].placed == 0 or A.BODY[i].inv_mass > 0.0:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                if A.MEMBER[A.LINK[o].owner].rest == AT_REST and penetrates(A, s, o)[0]:
                    disturb(A, A.LINK[o].owner)


@kernel
def hold_penetrating(A: Scene) -> None:
    """At the start of a step: unite bodies that the program has placed deep into each other, and that neither separate
    within the step nor hit each other; of lossy shapes, without joints. Their contacts need not persist, so that no
    island would correct the overlap. `Member.placed` remains set while the overlap does."""
    BODY, LINK, dt = A.BODY, A.LINK, A.PAR.dt
    A.COUNT.any_placed = 0
    for i in range(BODY.shape[0] - 1):
        placed = A.MEMBER[i].placed
        if placed == 0:
            continue
        A.MEMBER[i].placed = 0
        if A.MEMBER[i].tied >= 0:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                j = LINK[o].owner
                if (BODY[j].inv_mass > 0.0 and A.MEMBER[j].tied >= 0) or (fixed_support(A, i) and fixed_support(A, j)):
                    continue
                deep, g, u = penetrates(A, s, o)
                if not deep or u * dt > -g:
                    continue
                A.MEMBER[i].placed, A.COUNT.any_placed = placed, 1
                if -u <= A.PAR.pulled * dt:
                    a, b = (j, i) if fixed_support(A, i) else (i, j)
                    unite(A, a, a if fixed_support(A, b) else b)


@nonallocating
def join_neighbours(A: Scene, i: int, t: float, FOUND: IntArray) -> int:
    """At instant t, unite body i, which is in an island, with the bodies that touch it; if `busy`, with those that come
    near. Writes those that were in no island to FOUND; returns their number."""
    BODY, STATE, LINK = A.BODY, A.STATE, A.LINK
    dt, pulled = A.PAR.dt, A.PAR.pulled
    h = dt - t
    joined = 0
    for s in range(STATE[i].first_shape, STATE[i].first_shape + STATE[i].shapes):
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            o = int(A.POOL[w])
            j = LINK[o].owner
            if fixed_support(A, j) or STATE[j].island == STATE[i].island or barred(A, s, o):
                continue
            busy = A.MEMBER[i].busy > 0 or A.MEMBER[j].busy > 0
            if law(A, s, o)[0] >= 1.0 and not busy:
                continue
            small = smaller(A, s, o)
            reach = TOUCH * small
            if busy:
                reach += TRAVEL_MARGIN * (fastest(BODY[i]) + fastest(BODY[j]) + pulled * dt) * h
            if far_apart(A, s, o, t, reach + TOUCH * small):
                continue
            other = STATE[j].island
            begun = other >= 0 and A.MEMBER[other].open > 0
            if begun and (A.MEMBER[other].jointed > 0 or budget_spent(A, other)):
                continue  # it is hit at the time of impact
            move_to(BODY, j, t)
            g, u, _, _, _ = approach(A, s, o, t)
            if g > reach:
                continue
            # Shapes that touch and part do not join; those that touch and approach fast hit each other.
            if g <= TOUCH * small and (u > pulled * dt or (-u > pulled * dt and not busy)):
                continue
            if begun:
                end_rest_or_interval(A, other, t)
            if other < 0:
                FOUND[joined] = j
                joined += 1
            unite(A, i, j)
            if busy:
                # The body beside a busy one is busy for a step less: so this does not spread without end.
                A.MEMBER[i].busy = max(A.MEMBER[i].busy, A.MEMBER[j].busy - 1)
                A.MEMBER[j].busy = max(A.MEMBER[j].busy, A.MEMBER[i].busy - 1)
    return joined


@nonallocating
def join_reachable(A: Scene, QUEUE: IntArray, queued: int, t: float) -> int:
    """Call `join_neighbours` for the bodies of QUEUE, `queued` so many, and for those that join; returns their
    number."""
    q = 0
    while q < queued:
        queued += join_neighbours(A, QUEUE[q], t, QUEUE[queued:])
        q += 1
    return queued


@kernel
def build_islands(A: Scene) -> None:
    """Build the islands of the start of a step: those for which something has changed wake, and all that are not at
    rest are dissolved (`wake_changed`); bodies whose contacts lasted and persist are united, components of joints,
    bodies that were placed into each other, and what touches these islands or comes near busy bodies
    (`join_reachable`)."""
    STATE, COUNT, BODY = A.STATE, A.COUNT, A.BODY
    n = BODY.shape[0] - 1
    if COUNT.any_placed > 0:
        wake_penetrated(A)
    wake_changed(A)
    for c in range(COUNT.pushes):
        a, b = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
        if A.PUSHED_BY[c].root != LASTED or barred(A, a, b):
            continue
        before = A.PUSHED_BY[max(c - 1, 0)]
        if c > 0 and before.root == LASTED and a == before.a and b == before.b:
            continue  # the other end of a face
        i, j = A.LINK[a].owner, A.LINK[b].owner
        i, j = (j, j) if fixed_support(A, i) else (i, i if fixed_support(A, j) else j)
        if fixed_support(A, i):
            continue
        if STATE[i].island >= 0 and STATE[i].island == STATE[j].island:
            continue  # together already
        if persists(A, a, b, 0.0):
            unite(A, i, j)
    for i in range(n):
        if A.MEMBER[i].tied >= 0:
            unite(A, i, A.MEMBER[i].tied)
    if COUNT.any_placed > 0:
        hold_penetrating(A)
    QUEUE = np.empty(n, np.int64)
    queued = 0
    for i in range(n):
        if STATE[i].island >= 0 and A.MEMBER[i].rest != AT_REST:
            QUEUE[queued] = i
            queued += 1
    join_reachable(A, QUEUE, queued, 0.0)


@kernel
def begin_islands(A: Scene) -> int:
    """Begin the intervals of the islands without joints at the start of a step. DONE, or, with everything as it was,
    PUSHES_FULL: to be called again with more memory."""
    STATE, COUNT = A.STATE, A.COUNT
    n, moving = A.BODY.shape[0] - 1, 0
    for i in range(n):
        moving += 1 if STATE[i].island >= 0 and A.MEMBER[i].rest != AT_REST else 0
    QUEUE = np.empty(n, np.int64)
    kept, wanted = 0, 0
    for c in range(COUNT.pushes):
        kept += 1 if A.PUSHED_BY[c].root >= 0 else 0
    for i in range(n if moving > 0 else 0):
        if STATE[i].island < 0 or (A.MEMBER[i].rest == AT_REST and COUNT.may_support == 0):
            continue  # islands at rest count only if they may have to be solved as supports
        for s in range(STATE[i].first_shape, STATE[i].first_shape + STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                # Two points for each pair; pairs of two moving shapes are in two lists.
                wanted += 1 if A.POOL[w] < A.LIST.shape[0] else 2
    # An island may be solved once more, as a support, or as it does not rest in part: there is room for that.
    wanted *= 2 if COUNT.may_support > 0 else 1
    if kept + wanted > A.PUSHED.shape[0] or not table_has_room(A, wanted):
        return PUSHES_FULL
    drop_contacts(A, LASTED, ENDED)
    # A solve may make another body the root of its island, which then would be solved again.
    roots = 0
    for i in range(n):
        if STATE[i].island == i and A.MEMBER[i].rest != AT_REST:
            QUEUE[roots] = i
            roots += 1
    for q in range(roots):
        root = QUEUE[q]
        if A.MEMBER[root].jointed == 0 and not rests_in_part(A, root):
            begin_interval(A, root, 0.0)
    support(A)
    return DONE

"""An island in local numbering for its solve: its bodies, the contacts that the solve leaves, its interval."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..contacts.forces import shapes_of, table_has_room
from ..contacts.works import external_work
from ..geometry.flight import pose, rate
from ..model.bodies import AT_REST
from ..model.contacts import ENDED
from ..model.islands import Island, IslandContacts
from ..model.scene import Scene
from ..pairs.rules import mark_pair
from ..rows.build import normal_rate, tangent_rate
from ..rows.inplace import sort
from .candidates import before_end
from .membership import members_of, pressed_island
from .rest import spins_freely


@kernel
def bodies_of(A: Scene, root: int) -> IntArray:
    """The bodies of an island, in the order of their rows."""
    MINE = members_of(A, root)
    sort(MINE, len(MINE))
    return MINE


@kernel
def number_bodies(A: Scene, root: int) -> IntArray:
    """`bodies_of`, with their places in A.PLACE until `clear_places`."""
    MINE = bodies_of(A, root)
    set_places(A, MINE)
    return MINE


@nonallocating
def set_places(A: Scene, MINE: IntArray) -> None:
    """Set A.PLACE, the local numbers, of the bodies MINE."""
    for q in range(len(MINE)):
        A.PLACE[MINE[q]] = q


@nonallocating
def clear_places(A: Scene, MINE: IntArray) -> None:
    """Reset A.PLACE of the bodies MINE."""
    for q in range(len(MINE)):
        A.PLACE[MINE[q]] = -1


@kernel
def take_places(A: Scene) -> IntArray:
    """Reset A.PLACE of all bodies; returns what it was, for `give_places`: an impact gathers its bodies there, and ends
    the intervals of their islands meanwhile."""
    GATHERED = A.PLACE.copy()
    A.PLACE[:] = -1
    return GATHERED


@nonallocating
def give_places(A: Scene, GATHERED: IntArray) -> None:
    """Set A.PLACE as it was before `take_places`."""
    for i in range(len(GATHERED)):
        A.PLACE[i] = GATHERED[i]


@nonallocating
def lacks_rows(A: Scene, p: int) -> bool:
    """Whether the contacts of p more pairs of shapes need more memory (PUSHES_FULL)."""
    return bool(A.COUNT.pushes + 2 * p > A.PUSHED.shape[0] or not table_has_room(A, 2 * p))


@nonallocating
def open_until(A: Scene, root: int, end: float) -> None:
    """Note that an interval of an island has begun, which ends at instant `end`; `until` is infinite if the step ends
    there too, since no event is needed then."""
    A.MEMBER[root].open = 1
    A.RESTING[root].until = end if before_end(A, end) else math.inf


@kernel
def local_island(A: Scene, MINE: IntArray, found: IntArray, t: float) -> Island:
    """The island of the bodies MINE (n,), which are at instant t and have A.PLACE, with its contact candidates `found`
    (p, 2). Fixed bodies of these pairs are the local bodies n to k - 1."""
    BODY, n, p = A.BODY, len(MINE), len(found)
    FIXED, fixed = np.empty(p, np.int64), 0
    for c in range(p):
        j = A.LINK[found[c, 1]].owner
        if A.PLACE[j] < 0:
            A.PLACE[j] = n + fixed
            FIXED[fixed] = j
            fixed += 1
    k = n + fixed
    WHO, STATES, SIZES_OF = np.empty(k, np.int64), np.zeros((3 * k, 3)), np.empty(4 * k)
    POSE, V, ACC = STATES[:k], STATES[k : 2 * k], STATES[2 * k :]
    IMS, IIS, SIZES, LEVER = SIZES_OF[:k], SIZES_OF[k : 2 * k], SIZES_OF[2 * k : 3 * k], SIZES_OF[3 * k :]
    for q in range(k):
        i = MINE[q] if q < n else FIXED[q - n]
        WHO[q] = i
        POSE[q, 0], POSE[q, 1], POSE[q, 2] = pose(BODY, i, t)
        V[q, 0], V[q, 1], V[q, 2] = rate(BODY, i, t)
        IMS[q], IIS[q], SIZES[q] = BODY[i].inv_mass, BODY[i].inv_inertia, BODY[i].extent
        LEVER[q] = 0.0 if spins_freely(A, i) else SIZES[q]
        if q >= n and IMS[q] > 0.0:
            # A body at rest that supports the island is fixed.
            V[q, 2], IMS[q], IIS[q] = 0.0, 0.0, 0.0
        else:
            for c in range(3):
                ACC[q, c] = A.PULL[i, c]
    PAIRS = np.empty((p, 4), np.int64)
    for c in range(p):
        PAIRS[c, 0], PAIRS[c, 1] = found[c, 0], found[c, 1]
        PAIRS[c, 2], PAIRS[c, 3] = A.PLACE[A.LINK[found[c, 0]].owner], A.PLACE[A.LINK[found[c, 1]].owner]
    for q in range(n, k):
        A.PLACE[WHO[q]] = -1
    return Island(WHO, POSE, V, ACC, IMS, IIS, SIZES, LEVER, PAIRS)


@kernel
def open_interval(
    A: Scene, root: int, isle: Island, contacts: IslandContacts, VN: FloatArray, m: int, t: float, h: float
) -> None:
    """Note that an interval of an island has begun at instant t, of length h, with m contacts and velocities VN (k, 3)
    at its end: its contacts, and its end (`open_until`)."""
    write_contacts(A, root, isle, contacts, VN, m, A.COUNT.pushes, t, h)
    open_until(A, root, t + h)


@kernel
def write_contacts(
    A: Scene, root: int, isle: Island, contacts: IslandContacts, VN: FloatArray, m: int, first: int, t: float, h: float
) -> None:
    """Write the m contacts of an island's interval of length h from instant t to PUSHED and PUSHED_BY, from row `first`
    on, and flag their pairs. VN (k, 3): velocities at its end."""
    ROWS, L = contacts.ROWS, contacts.L
    for z in range(m):
        p = ROWS[z].a
        a, b = shapes_of(A, ROWS[z])
        if A.LINK[a].owner != isle.WHO[p]:
            a, b = b, a
        if z == 0 or ROWS[z].key >> 1 != ROWS[z - 1].key >> 1:
            mark_pair(A, a, b, 1)
        c = first + z
        A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, A.PUSHED_BY[c].root = a, b, root
        pushed = A.PUSHED[c]
        pushed.normal, pushed.tangential, pushed.start, pushed.length = L[z, 0], L[z, 1], t, h
        # Rates that do work, without the swing of a turning wall: they are linear in between.
        pushed.un_before, pushed.ut_before = ROWS[z].un, ROWS[z].ut - ROWS[z].swung
        pushed.un_after, pushed.ut_after = normal_rate(ROWS[z], VN), tangent_rate(ROWS[z], VN) + ROWS[z].swung
        pushed.work = external_work(ROWS[z : z + 1], L[z : z + 1], isle.V, VN, isle.IM, isle.II, 1)
        pushed.work_unaccelerated = external_work(ROWS[z : z + 1], L[z : z + 1], isle.V, isle.V, isle.IM, isle.II, 1)
        pushed.held = 0.0
        pushed.nx, pushed.ny = ROWS[z].nx, ROWS[z].ny
        # The point from its arms: r = arm_t n - arm_n t.
        x, y = isle.POSE[p, 0] + 0.5 * h * isle.V[p, 0], isle.POSE[p, 1] + 0.5 * h * isle.V[p, 1]
        pushed.px = x + ROWS[z].arm_ta * ROWS[z].nx + ROWS[z].arm_na * ROWS[z].ny
        pushed.py = y + ROWS[z].arm_ta * ROWS[z].ny - ROWS[z].arm_na * ROWS[z].nx
        pushed.change = L[z, 0] / ROWS[z].k_n
        pushed.gap = ROWS[z].gap if t == 0.0 else math.nan
    A.COUNT.pushes = max(A.COUNT.pushes, first + m)


@nonallocating
def contact_range(A: Scene, root: int) -> tuple[int, int]:
    """First row, and row after the last, of the contacts of an island in PUSHED; (0, 0) if it has none."""
    first, count = 0, 0
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            first, count = c if count == 0 else first, count + 1
    return first, first + count


@nonallocating
def drop_contacts(A: Scene, low: int, high: int) -> None:
    """Remove the contacts from PUSHED whose `Pair.root` is `low` to `high`. The others keep their order: those of an
    island, and of a pair, are next to each other."""
    kept = 0
    for c in range(A.COUNT.pushes):
        if not low <= A.PUSHED_BY[c].root <= high:
            A.PUSHED_BY[kept], A.PUSHED[kept] = A.PUSHED_BY[c], A.PUSHED[c]
            kept += 1
    A.COUNT.pushes = kept


@nonallocating
def is_last_support(A: Scene, c: int, kept: int) -> bool:
    """Whether contact c presses on an island at rest, and none of its pair is among the first `kept` that have ended:
    `loads.renew_support` needs one."""
    a, b, at_rest = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, False
    for shape in (a, b):
        other = pressed_island(A, c, shape)
        at_rest = at_rest or (other >= 0 and A.MEMBER[other].rest == AT_REST)
    for k in range(kept if at_rest else 0):
        if A.PUSHED_BY[k].root == ENDED and A.PUSHED_BY[k].a == a and A.PUSHED_BY[k].b == b:
            return False
    return at_rest


@nonallocating
def drop_ended(A: Scene) -> None:
    """Remove the contacts of intervals that have ended within the step: each event looks through all contacts."""
    kept, supports = 0, A.COUNT.may_support > 0
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root != ENDED or (supports and is_last_support(A, c, kept)):
            A.PUSHED_BY[kept], A.PUSHED[kept] = A.PUSHED_BY[c], A.PUSHED[c]
            kept += 1
    A.COUNT.pushes = kept

"""Partial rest: the slow bodies of a lossy island are at rest, if static forces hold them all, while its others move.

Slow bodies are tested for static forces (`..contacts.statics`) under the contact forces of the others, which are solved
first with the slow ones as fixed. If there are none, the island is solved as a whole, and the next test of these bodies
is postponed.

In large islands a few bodies always vibrate, and residuals of truncated solves move the others; both wake what is at
rest beside them. Therefore every REST_RETRY steps a large island whose bodies are all slow is frozen first: if static
forces hold it, they stop, and these forces are the start of the next solve. The kinetic energy counts as restitution.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..contacts.interval import begin_contacts, find_rest, make_contacts
from ..model.bodies import AT_REST, AWAKE
from ..model.parameters.intervals import IMPACT_SPEED, LARGE_ISLAND
from ..model.parameters.rest import MOVING_SHARE, PARTIAL_REST_FACTORS_STEP, REST_RETRY
from ..model.scene import Scene
from .accounting import end_interval
from .at_rest import put_to_rest, set_awake, stop
from .candidates import pairs_within
from .intervals import begin_interval, set_lifts
from .loads import add_loads
from .local import bodies_of, clear_places, local_island, open_interval, set_places
from .membership import lossy, unite
from .rest import candidate_speed, postpone_test, speed


@nonallocating
def make_island(A: Scene, MINE: IntArray) -> None:
    """Make an island of the bodies MINE; the first one is its root."""
    MEMBER, head, n = A.MEMBER, MINE[0], len(MINE)
    for q in range(n):
        A.STATE[MINE[q]].island = head
        MEMBER[MINE[q]].following = MINE[q + 1] if q + 1 < n else -1
    MEMBER[head].last, MEMBER[head].bodies = MINE[n - 1], n
    MEMBER[head].hits, MEMBER[head].open, MEMBER[head].jointed = 0, 0, 0
    A.RESTING[head].lost = 0.0


@kernel
def test_rest(A: Scene, MINE: IntArray, V0: FloatArray, with_supports: int, freezing: bool) -> bool:
    """Test whether static forces hold an island; if so put it to rest, else postpone its next test. Returns whether
    they do.

    Args:
        MINE: its bodies (n,).  V0: (n, 3) their velocities, which the forces have to end too.
        with_supports: number of bodies by which the threshold of rest is chosen: those of the whole island.
        freezing: True to test without the contacts of other islands; bodies then stop, but remain awake, and may be
            tested for rest at once.
    """
    BODY, COUNT, dt, root, n = A.BODY, A.COUNT, A.PAR.dt, A.STATE[MINE[0]].island, len(MINE)
    set_places(A, MINE)
    near = pairs_within(A, root, 0.0, A.PAR.dt, True, MINE)
    LOAD = np.zeros((n, 3))
    if not freezing:
        add_loads(A, root, A.PAR.dt, LOAD)
    p = len(near)
    isle = local_island(A, MINE, near, 0.0)
    clear_places(A, MINE)
    most = 0.0
    for q in range(n):
        for c in range(3):
            isle.V[q, c] = V0[q, c]
            isle.ACC[q, c] += LOAD[q, c] / dt
        most = max(most, math.sqrt(isle.ACC[q, 0] ** 2 + isle.ACC[q, 1] ** 2))
    if p == 0 or COUNT.pushes + 2 * p > A.PUSHED.shape[0] or not most > 0.0:
        postpone_test(A, MINE)
        return False
    rest_speed = (IMPACT_SPEED if freezing else candidate_speed(with_supports)) * A.PAR.pulled / most
    contacts = make_contacts(p, len(isle.WHO))
    begun = begin_contacts(A, isle, contacts, n, dt, 0.0)
    found = begun.m > 0 and find_rest(A, isle, contacts, n, dt, begun, rest_speed, not freezing)
    COUNT.direct += contacts.OUT[0].direct
    if not found:
        postpone_test(A, MINE)
        return False
    if freezing:
        for q in range(n):
            stop(A, MINE[q])
            A.RESTING[MINE[q]].rest_timer = 1.0
        return True
    open_interval(A, root, isle, contacts, contacts.VN, begun.m, 0.0, dt)
    A.MEMBER[root].with_supports = with_supports
    for q in range(n):
        A.MEMBER[MINE[q]].busy = 0
        body = BODY[MINE[q]]
        body.vx, body.vy, body.spin = V0[q, 0], V0[q, 1], V0[q, 2]
    set_lifts(A, MINE, np.zeros((n, 6)))
    put_to_rest(A, root)
    return True


@kernel
def freeze(A: Scene, MINE: IntArray) -> None:
    """Stop the bodies MINE of a large island if all are slow and static forces hold them. They remain awake."""
    n, V0 = len(MINE), np.empty((len(MINE), 3))
    for q in range(n):
        if speed(A, MINE[q]) > IMPACT_SPEED * A.PAR.pulled * A.PAR.dt:
            return
        body = A.BODY[MINE[q]]
        V0[q, 0], V0[q, 1], V0[q, 2] = body.vx, body.vy, body.spin
    test_rest(A, MINE, V0, n, True)


@nonallocating
def split_slow(A: Scene, MINE: IntArray, STAND: IntArray, MOVE: IntArray) -> int:
    """Split the bodies MINE: slow ones, which may be put to rest, into STAND, the others into MOVE; returns the
    number of the first."""
    stand, limit = 0, candidate_speed(len(MINE)) * A.PAR.pulled * A.PAR.dt
    for q in range(len(MINE)):
        if A.RESTING[MINE[q]].rest_timer >= 1.0 and speed(A, MINE[q]) <= limit:
            STAND[stand] = MINE[q]
            stand += 1
        else:
            MOVE[q - stand] = MINE[q]
    return stand


@kernel
def rests_in_part(A: Scene, root: int) -> bool:
    """At the start of a step: put all slow bodies of a lossy island to rest, if static forces hold them, and solve the
    others with these as fixed; if they do not, solve the whole island. Every REST_RETRY steps a large island is frozen
    before. Returns whether that was tried: the island then has been solved."""
    BODY, STATE, MEMBER = A.BODY, A.STATE, A.MEMBER
    n = MEMBER[root].bodies
    if A.COUNT.may_support == 0 or A.PAR.pulled == 0.0 or MEMBER[root].open > 0 or STATE[root].island != root:
        return False
    if not lossy(A, root):
        return False
    MINE, STAND, MOVE = bodies_of(A, root), np.empty(n, np.int64), np.empty(n, np.int64)
    factors = A.COUNT.direct
    if n >= LARGE_ISLAND and A.PAR.stamp % REST_RETRY == 0.0:
        freeze(A, MINE)
        if A.COUNT.direct > factors + PARTIAL_REST_FACTORS_STEP:
            return False
    V0 = np.empty((n, 3))
    stand = split_slow(A, MINE, STAND, MOVE)
    if stand == 0 or n - stand > max(MOVING_SHARE * n, 1.0):
        return False
    make_island(A, STAND[:stand])
    for q in range(stand):
        i = STAND[q]
        MEMBER[i].rest = AT_REST
        V0[q, 0], V0[q, 1], V0[q, 2] = BODY[i].vx, BODY[i].vy, BODY[i].spin
        BODY[i].vx, BODY[i].vy, BODY[i].spin = 0.0, 0.0, 0.0
    if stand < n:
        make_island(A, MOVE[: n - stand])
        begin_interval(A, MOVE[0], 0.0)
    for q in range(stand):
        MEMBER[STAND[q]].rest = AWAKE
    if test_rest(A, STAND[:stand], V0, n, False):
        return True
    for q in range(stand):
        body = BODY[STAND[q]]
        body.vx, body.vy, body.spin = V0[q, 0], V0[q, 1], V0[q, 2]
    one = STAND[0]
    for q in range(n - stand):
        i = MOVE[q]
        other = STATE[i].island
        if other >= 0:
            if MEMBER[other].rest == AT_REST:  # static forces hold it on the others, but not these
                set_awake(A, other)
            if MEMBER[other].open > 0:
                end_interval(A, other, 0.0)
            one = unite(A, one, i)
    begin_interval(A, STATE[one].island, 0.0)
    return True

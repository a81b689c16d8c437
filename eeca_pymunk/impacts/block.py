"""Blocks: impacts at one instant of all shapes that touch, and of islands that are hit.

Contacts that touch at the instant of an impact take part in it, and so on from body to body: the impulses of a rack of
disks are simultaneous. So do contacts that carry a load in an island. Bodies that impulses do not move carry nothing
on. Islands that take part end their spans, become one with the bodies of the impact, and begin anew.
"""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, uncounted
from ..geometry.flight import pose, rate
from ..geometry.gap import touching
from ..geometry.manifold import face
from ..layout import ANGLE, II, IM, OWNER, SIZE, SPIN, VX, VY, X
from ..pairs.layout import NUMBER, START
from ..pairs.rules import barred, law
from ..rows.blocks import CONVERGED, D_NORMAL, D_TANGENTIAL, OUT_SIZE, SCALE_LOCK, solve_block
from ..rows.build import normal_rate, place_row
from ..rows.layout import ELASTICITY as ELASTIC
from ..rows.layout import K_N, NX, NY, ROW_COLUMNS
from ..sustained.ledger import carried
from .booking import end_span
from .islands import members, remembered, unite
from .layout import (
    BLOCKS,
    DONE,
    DT,
    EVENTS,
    EXTERNAL,
    FIRST_SHAPE,
    FRICTIONAL,
    HITS,
    IMPACTS,
    ISLAND,
    KINKS,
    LEDGER,
    LOCK,
    LOGGED,
    LOST,
    OPEN,
    PENDING,
    RESTITUTION,
    SHAPES,
    STAMP,
    UNMET,
    Scene,
)  # fmt: skip
from .layout import (
    BODIES as SIZE_OF,
)
from .settle import spread
from .spans import solve
from .strike import move_to, note, touches

_FACES = 16.0  # times the tolerance of touching, by which the ends of parallel faces may differ
_ROCKING = 1e-6  # of the size, by which they may where the contact is not elastic: a rocking that is lost anyway ends


@uncounted
def takes_part(A: Scene, disks: int, s: int, o: int, t: float) -> bool:
    """Whether shapes s and o touch at instant t, or are in contact under load."""
    if barred(A.RULE, s, o):
        return False
    if touches(A, disks, s, o, t):
        return True
    i, j = A.LINK[s, OWNER], A.LINK[o, OWNER]
    if A.STATE[i, ISLAND] < 0 or not (A.STATE[j, ISLAND] == A.STATE[i, ISLAND] or A.BODY[j, IM] == 0.0):
        return False
    return remembered(A.KEYS, A.FORCES, A.SHAPE.shape[0], s, o, A.PAR[STAMP])[0] > 0.0


@uncounted
def arrive(A: Scene, i: int, t: float) -> None:
    """Bring body i, with its island, to instant t."""
    root = A.STATE[i, ISLAND]
    if root >= 0 and A.MEMBER[root, OPEN] > 0:
        end_span(A, root, t)
    move_to(A.BODY, i, t)


@kernel
def gather(A: Scene, disks: int, a: int, b: int, t: float) -> tuple[int, int, IntArray]:
    """The block that shapes a and b hit at instant t: its n bodies into A.BLOCK, which move to that instant, and its m
    pairs as numbers a k + b (k shapes) in increasing order. A.PLACE gives the place of each of these bodies."""
    k, BODIES = A.SHAPE.shape[0], A.BLOCK
    PAIRS = np.empty(16, np.int64)
    PAIRS[0] = min(a, b) * k + max(a, b)
    n, m, q = 0, 1, 0
    for s in (a, b):
        i = A.LINK[s, OWNER]
        if A.BODY[i, IM] > 0.0:
            BODIES[n], A.PLACE[i] = i, n
            n += 1
            arrive(A, i, t)
    while q < n:
        i = BODIES[q]
        q += 1
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            start = A.LIST[s, START]
            for p in range(start, start + A.LIST[s, NUMBER]):
                o = int(A.POOL[p])
                j = A.LINK[o, OWNER]
                moves = A.BODY[j, IM] > 0.0
                key = min(s, o) * k + max(s, o)
                # The pairs with bodies that have been looked at before stand there already.
                if key == PAIRS[0] or (moves and 0 <= A.PLACE[j] < q - 1):
                    continue
                if not takes_part(A, disks, s, o, t):
                    continue
                if moves and A.PLACE[j] < 0:
                    BODIES[n], A.PLACE[j] = j, n
                    n += 1
                    arrive(A, j, t)
                if m == PAIRS.shape[0]:
                    more = np.empty(2 * m, np.int64)
                    more[:m] = PAIRS
                    PAIRS = more
                PAIRS[m] = key
                m += 1
    PAIRS = PAIRS[:m]
    PAIRS.sort()
    return n, m, PAIRS


@kernel
def strike(A: Scene, disks: int, a: int, b: int, t: float, rest: bool) -> tuple[int, int]:
    """Impulses of the block of shapes a and b at instant t. Status, and the number of bodies to be forecast anew, in
    A.BLOCK.

    PUSHES_FULL leaves the new span of the island COUNT[PENDING] to be begun.

    Args:
        rest: whether the contact of a and b stays closed from now on.
    """
    BODY, LINK, COUNT, BODIES = A.BODY, A.LINK, A.COUNT, A.BLOCK
    k = A.SHAPE.shape[0]
    n, m, PAIRS = gather(A, disks, a, b, t)
    BODIES[:n].sort()
    for q in range(n):
        A.PLACE[BODIES[q]] = q
    owed, piled = 0.0, False
    for q in range(n):
        root = A.STATE[BODIES[q], ISLAND]
        if root >= 0:
            piled = True
            # What spans that were cut short have given is taken out here.
            owes = max(-A.RESTING[root, LOST], 0.0)
            A.RESTING[root, LOST] += owes
            owed += owes
    hit = min(a, b) * k + max(a, b)
    POSE, V = np.zeros((n + m, 3)), np.zeros((n + m, 3))
    IMS, IIS = np.zeros(n + m), np.zeros(n + m)
    for q in range(n):
        i = BODIES[q]
        POSE[q], V[q] = BODY[i, X : ANGLE + 1], BODY[i, VX : SPIN + 1]
        IMS[q], IIS[q] = BODY[i, IM], BODY[i, II]
    P, Q = np.empty(2 * m, np.int64), np.empty(2 * m, np.int64)
    ROWS, POINTS, OF = np.empty((2 * m, ROW_COLUMNS)), np.empty((2 * m, 2)), np.empty(2 * m, np.int64)
    found = np.empty((2, 5))
    rows, place = 0, n
    for z in range(m):
        sa, sb = PAIRS[z] // k, PAIRS[z] % k
        i, j = LINK[sa, OWNER], LINK[sb, OWNER]
        p, q = A.PLACE[i], A.PLACE[j]
        # What impulses do not move has a row of its own for each contact.
        for side in range(2):
            w = i if side == 0 else j
            if BODY[w, IM] == 0.0:
                xw, yw, qw = pose(BODY, w, t)
                POSE[place, 0], POSE[place, 1], POSE[place, 2] = xw, yw, qw
                xw, yw, qw = rate(BODY, w, t)
                V[place, 0], V[place, 1], V[place, 2] = xw, yw, qw
                if side == 0:
                    p = place
                else:
                    q = place
                place += 1
        e, mu, sx, sy = law(A.SHAPE, A.RULE, sa, sb)
        tolerance = _FACES * touching(BODY, A.SHAPE, LINK, sa, sb, disks)
        small = min(A.SHAPE[sa, SIZE], A.SHAPE[sb, SIZE])
        if e < 1.0:
            tolerance = max(tolerance, _ROCKING * small)
        if rest and PAIRS[z] == hit:
            e = 0.0
        load = remembered(A.KEYS, A.FORCES, A.SHAPE.shape[0], sa, sb, A.PAR[STAMP] - 1.0)[1]
        count = face(
            A.SHAPE, LINK, A.VERTEX, A.WORK, sa, POSE[p, 0], POSE[p, 1], POSE[p, 2],
            sb, POSE[q, 0], POSE[q, 1], POSE[q, 2], tolerance, found,
        )  # fmt: skip
        for c in range(count):
            nx, ny = found[c, 0], found[c, 1]
            place_row(
                P, Q, ROWS, rows, p, q, nx, ny, found[c, 2], found[c, 3], found[c, 4], POSE, IMS, IIS, e, mu,
                nx * sy - ny * sx,
            )  # fmt: skip
            u = normal_rate(P, Q, ROWS, V, rows)
            if e < 1.0 and e * max(-u, 0.0) < 0.5 * load * A.PAR[DT] / ROWS[rows, K_N]:
                # Its bounce would come back within the step.
                ROWS[rows, ELASTIC] = 0.0
            POINTS[rows, 0], POINTS[rows, 1], OF[rows] = found[c, 2], found[c, 3], PAIRS[z]
            rows += 1
    L, LOSS, OUT = np.zeros((rows, 2)), np.zeros((rows, 2)), np.zeros(OUT_SIZE)
    status = solve_block(P, Q, ROWS, L, V, IMS, IIS, POSE, n, rows, owed, piled, LOSS, OUT)
    if status != CONVERGED:
        COUNT[UNMET] += 1
    if abs(OUT[SCALE_LOCK] - 1.0) > abs(A.PAR[LOCK] - 1.0):
        A.PAR[LOCK] = OUT[SCALE_LOCK]
    A.PAR[LEDGER + RESTITUTION] += OUT[D_NORMAL]
    A.PAR[LEDGER + FRICTIONAL] += OUT[D_TANGENTIAL]
    A.PAR[LEDGER + EXTERNAL] += carried(P, Q, ROWS, L, V, IMS, rows)
    for q in range(n):
        i = BODIES[q]
        BODY[i, VX], BODY[i, VY], BODY[i, SPIN] = V[q, 0], V[q, 1], V[q, 2]
        A.STATE[i, KINKS] += 1
        A.STATE[i, EVENTS] += 1
        A.PLACE[i] = -1
    for z in range(rows):
        if L[z, 0] > 0.0 and COUNT[LOGGED] < A.LOG.shape[0]:
            note(
                A.LOG, COUNT[LOGGED], OF[z] // k, OF[z] % k, t, L[z, 0], L[z, 1], ROWS[z, NX], ROWS[z, NY],
                POINTS[z, 0], POINTS[z, 1], L[z, 0] / ROWS[z, K_N],
            )  # fmt: skip
            COUNT[LOGGED] += 1
    COUNT[IMPACTS] += 1
    COUNT[BLOCKS] += 1 if m > 1 else 0
    return rejoin(A, a, b, t, n, rest, OUT[D_NORMAL] + OUT[D_TANGENTIAL] - owed)


@kernel
def rejoin(A: Scene, a: int, b: int, t: float, n: int, rest: bool, lost: float) -> tuple[int, int]:
    """After the impulses of a block of n bodies in A.BLOCK: its islands become one and begin a new span; so do the two
    bodies of shapes a and b if they rest on each other. Status and number of bodies as `strike`."""
    STATE, BODIES = A.STATE, A.BLOCK
    root = -1
    for q in range(n):
        if STATE[BODIES[q], ISLAND] >= 0:
            root = unite(A, BODIES[q], BODIES[q] if root < 0 else root)
    if root < 0 and not rest:
        return DONE, n
    QUEUE = np.empty(A.BODY.shape[0], np.int64)
    queued = 0
    for s in (a, b):
        i = A.LINK[s, OWNER]
        if A.BODY[i, IM] > 0.0:
            if STATE[i, ISLAND] < 0:
                QUEUE[queued] = i
                queued += 1
            root = unite(A, i, i if root < 0 else root)
    spread(A, QUEUE, queued, t)
    root = STATE[root, ISLAND]
    A.RESTING[root, LOST] += lost
    A.MEMBER[root, HITS] += 1
    # The bodies of the block that are in no island are forecast too.
    free = 0
    for q in range(n):
        if STATE[BODIES[q], ISLAND] != root:
            BODIES[free] = BODIES[q]
            free += 1
    MINE = np.empty(A.MEMBER[root, SIZE_OF], np.int64)
    more = members(A, root, MINE)
    for q in range(more):
        BODIES[free + q] = MINE[q]
    status = solve(A, root, t)
    if status != DONE:
        A.COUNT[PENDING] = root
    return status, free + more

"""Islands that stand, and carry what moves.

One disk that rolls on a pile moves nothing else. So what hardly moves may stand while the rest of its island goes on:
what moves takes it for fixed, as the ground, and the statics of what stands, under the forces with which the other
pushes on it, say whether that is so. Where these forces and those of its own contacts balance inside all cones, they
are an answer of the contact problem of all bodies together: nothing that stands has any motion, and momentum goes
through it to what is fixed. Otherwise all of them are solved as one island.

In each step what moves is solved first, then the forces of what carries it are found anew from those of the last step.
The contacts of what moves are of its own island; that of the other body is its carrier, and wakes it when it wakes.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..layout import ELASTICITY, EXTENT, II, IM, OWNER, VX, X, Y
from ..pairs.rules import law
from ..rows.build import place_row
from ..rows.equilibrium import equilibrium
from ..rows.layout import K_N, ROW_COLUMNS
from ..sustained.ledger import LEDGER_SIZE
from ..sustained.memory import find, remember
from ..sustained.statics import STANDS
from ..sustained.step import OUT_SIZE, STOOD, step_island
from .booking import close_span, wake
from .calm import hardly, settled, wait, whirls
from .coming import pairs_of
from .islands import members, unite
from .layout import (
    AFTER_ME,
    BETA,
    BODIES,
    CARRIES,
    DIRECT,
    DT,
    FIRST_SHAPE,
    HITS,
    ISLAND,
    JOINTED,
    LAM,
    LAST_ONE,
    LIFT,
    LOADED,
    LOST,
    OPEN,
    PULLED,
    PUSH_A,
    PUSH_B,
    PUSH_CHANGE,
    PUSH_GAP,
    PUSH_NX,
    PUSH_NY,
    PUSH_X,
    PUSH_Y,
    PUSHES,
    RELAX,
    REMEMBERED,
    ROOT,
    SHAPES,
    SPAN,
    STAMP,
    STILL,
    UNTIL,
    Scene,
)  # fmt: skip
from .spans import dismiss, lay_out_island, open_contacts, solve
from .still import halt

_FACTORS = 12  # to find how a standing island carries what moves, at most
_MOST = 0.5  # of an island's bodies, that may move while the others stand


@uncounted
def load(A: Scene, root: int, LOAD: FloatArray) -> None:
    """Add to LOAD (k, 3) the velocities that contacts of other islands give to the bodies of this one, which have
    A.PLACE, over the whole step, if they go on as they are."""
    BODY = A.BODY
    for c in range(A.COUNT[PUSHES]):
        r = A.PUSHED_BY[c, ROOT]
        if r < 0 or r == root:
            continue
        R = A.PUSHED[c]
        for side in range(2):
            j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
            if BODY[j, IM] == 0.0 or A.STATE[j, ISLAND] != root:
                continue
            q, part = A.PLACE[j], (2.0 * side - 1.0) * A.PAR[DT] / R[SPAN]
            fx = part * (R[LAM] * R[PUSH_NX] - R[BETA] * R[PUSH_NY])
            fy = part * (R[LAM] * R[PUSH_NY] + R[BETA] * R[PUSH_NX])
            LOAD[q, 0] += BODY[j, IM] * fx
            LOAD[q, 1] += BODY[j, IM] * fy
            LOAD[q, 2] += BODY[j, II] * ((R[PUSH_X] - BODY[j, X]) * fy - (R[PUSH_Y] - BODY[j, Y]) * fx)


@kernel
def holds(A: Scene, root: int) -> bool:
    """Whether an island that stands carries what pushes on it now; then its contacts have the forces that do."""
    BODY, dt = A.BODY, A.PAR[DT]
    n = A.MEMBER[root, BODIES]
    MINE = np.empty(n, np.int64)
    members(A, root, MINE)
    # What carries it in its turn, and is fixed, is the last body.
    POSE, IMS, IIS, FELT = np.zeros((n + 1, 3)), np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    START = np.zeros((n + 1, 3))
    for q in range(n):
        i = MINE[q]
        A.PLACE[i] = q
        IMS[q], IIS[q], FELT[q] = BODY[i, IM], BODY[i, II], 0.0 if whirls(A, i) else BODY[i, EXTENT]
        for c in range(3):
            POSE[q, c], START[q, c] = BODY[i, X + c], dt * A.PULL[i, c]
    load(A, root, START)
    room = 0
    for c in range(A.COUNT[PUSHES]):
        room += 1 if A.PUSHED_BY[c, ROOT] == root else 0
    P, Q, OF = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    ROWS, L = np.empty((room, ROW_COLUMNS)), np.empty((room, 2))
    open_to, m = 0.5 * hardly(n) * A.PAR[PULLED] * dt * dt, 0
    for c in range(A.COUNT[PUSHES]):
        R = A.PUSHED[c]
        if A.PUSHED_BY[c, ROOT] != root or not (R[LAM] > 0.0 or R[PUSH_GAP] <= open_to):
            continue
        a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
        p, q = A.PLACE[A.LINK[a, OWNER]], A.PLACE[A.LINK[b, OWNER]]
        e, mu, _, _ = law(A.SHAPE, A.RULE, a, b)
        place_row(
            P, Q, ROWS, m, p if p >= 0 else n, q if q >= 0 else n, R[PUSH_NX], R[PUSH_NY], R[PUSH_X], R[PUSH_Y], 0.0,
            POSE, IMS, IIS, e, mu, 0.0,
        )  # fmt: skip
        L[m, 0], L[m, 1], OF[m] = R[LAM], R[BETA], c
        m += 1
    dismiss(A, MINE, n)
    found, factors = equilibrium(
        P, Q, ROWS, L, START, IMS, IIS, POSE, FELT, n, m, STANDS * A.PAR[PULLED] * dt, _FACTORS, False
    )
    A.COUNT[DIRECT] += factors
    if found:
        for z in range(m):
            R = A.PUSHED[OF[z]]
            R[LAM], R[BETA], R[PUSH_CHANGE] = L[z, 0], L[z, 1], L[z, 0] / ROWS[z, K_N]
            keep_in_mind(A, OF[z])
    return found


@uncounted
def keep_in_mind(A: Scene, c: int) -> None:
    """Let the memory have the forces of contact number c."""
    a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    key = (min(a, b) * A.SHAPE.shape[0] + max(a, b)) << 1
    if c > 0 and A.PUSHED_BY[c - 1, PUSH_A] == a and A.PUSHED_BY[c - 1, PUSH_B] == b:
        key += 1  # the other end of a face
    if find(A.KEYS, key) >= 0 or 2 * (A.COUNT[REMEMBERED] + 1) <= A.KEYS.shape[0]:
        R = A.PUSHED[c]
        force = R[LAM] / R[SPAN]
        remember(
            A.KEYS, A.FORCES, A.COUNT[REMEMBERED:], key, force, R[BETA] / R[SPAN], force, A.PAR[STAMP]
        )  # fmt: skip


@kernel
def support(A: Scene) -> None:
    """At the start of a step, once what moves has been solved: what carries some of it and cannot stand is solved with
    what rests on it."""
    STATE, MEMBER, BODY = A.STATE, A.MEMBER, A.BODY
    more = A.COUNT[CARRIES] > 0
    while more:
        more = False
        for c in range(A.COUNT[PUSHES]):
            root = A.PUSHED_BY[c, ROOT]
            if root < 0 or MEMBER[root, STILL] == 1:
                continue
            for side in range(2):
                j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
                other = STATE[j, ISLAND]
                if BODY[j, IM] > 0.0 and other != root and other >= 0 and MEMBER[other, STILL] == 1:
                    MEMBER[other, LOADED] = 1
        for i in range(BODY.shape[0] - 1):
            if MEMBER[i, LOADED] == 0:
                continue
            MEMBER[i, LOADED] = 0
            if STATE[i, ISLAND] == i and MEMBER[i, STILL] == 1 and not holds(A, i):
                MINE = np.empty(MEMBER[i, BODIES], np.int64)
                wait(A, MINE, members(A, i, MINE))
                solve(A, wake(A, i, 0.0), 0.0)
                more = True


@uncounted
def chain(A: Scene, MINE: IntArray, n: int) -> None:
    """Make an island of n bodies."""
    MEMBER, head = A.MEMBER, MINE[0]
    for q in range(n):
        A.STATE[MINE[q], ISLAND] = head
        MEMBER[MINE[q], AFTER_ME] = MINE[q + 1] if q + 1 < n else -1
    MEMBER[head, LAST_ONE], MEMBER[head, BODIES] = MINE[n - 1], n
    MEMBER[head, HITS], MEMBER[head, OPEN], MEMBER[head, JOINTED] = 0, 0, 0
    A.RESTING[head, LOST] = 0.0


@kernel
def asks(A: Scene, MINE: IntArray, n: int, V0: FloatArray) -> bool:
    """Whether the island of the n bodies MINE comes to a stand from their velocities V0 (n, 3) under what pushes on it;
    if so it does."""
    BODY, COUNT, dt, root = A.BODY, A.COUNT, A.PAR[DT], MINE[0]
    for q in range(n):
        A.PLACE[MINE[q]] = q
    found = pairs_of(A, root, 0.0, True, A.PLACE, MINE, n)
    LOAD = np.zeros((n, 3))
    load(A, root, LOAD)
    p = len(found)
    isle = lay_out_island(A, MINE, n, found, 0.0)
    dismiss(A, MINE, n)
    if p == 0 or COUNT[PUSHES] + 2 * p > A.PUSHED.shape[0]:
        return False
    most = 0.0
    for q in range(n):
        for c in range(3):
            isle.V[q, c] = V0[q, c]
            isle.ACC[q, c] += LOAD[q, c] / dt
        most = max(most, math.sqrt(isle.ACC[q, 0] ** 2 + isle.ACC[q, 1] ** 2))
    if not most > 0.0:
        return False
    k, room = len(isle.WHO), 2 * p + 1
    P, Q, KEY = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    ROWS, L, LOSS = np.empty((room, ROW_COLUMNS)), np.zeros((room, 2)), np.zeros((room, 2))
    VN, JUMP, BOOK, OUT = np.empty((k, 3)), np.zeros((k, 6)), np.zeros(LEDGER_SIZE), np.zeros(OUT_SIZE)
    m = step_island(
        isle.POSE, isle.V, isle.ACC, isle.IM, isle.II, isle.EXTENT, isle.FELT, n, isle.PAIRS, p, A.SHAPE, A.RULE,
        A.LINK, A.VERTEX, A.WORK, dt, 0, 0.0, 0.0, A.KEYS, A.FORCES, COUNT[REMEMBERED:], A.PAR[STAMP],
        A.RESTING[root, RELAX : RELAX + 3], -hardly(n) * A.PAR[PULLED] / most, P, Q, ROWS, KEY, L, LOSS, VN, JUMP,
        BOOK, OUT,
    )  # fmt: skip
    if not OUT[STOOD] > 0.0:
        return False
    first = COUNT[PUSHES]
    open_contacts(A, isle, P, Q, ROWS, KEY, L, VN, m, 0.0, dt, np.zeros(k, np.uint8))
    for z in range(m):
        A.PUSHED_BY[first + z, ROOT] = root
    COUNT[PUSHES] += m
    A.MEMBER[root, OPEN], A.RESTING[root, UNTIL] = 1, math.inf
    for q in range(n):
        for c in range(3):
            BODY[MINE[q], VX + c] = V0[q, c]
        for c in range(6):
            A.RESTING[MINE[q], LIFT + c] = 0.0
    halt(A, root)
    return True


@kernel
def stands_in_part(A: Scene, root: int) -> bool:
    """At the start of a step, before an island is solved: whether those of its bodies that hardly move stand, so that
    the others are solved alone, as they are then."""
    BODY, STATE, MEMBER = A.BODY, A.STATE, A.MEMBER
    n, some, lossy = MEMBER[root, BODIES], 0, False
    if A.COUNT[CARRIES] == 0 or A.PAR[PULLED] == 0.0 or MEMBER[root, OPEN] > 0 or STATE[root, ISLAND] != root:
        return False
    i = root
    while i >= 0:
        some += 1 if settled(A, i) else 0
        for s in range(STATE[i, FIRST_SHAPE], STATE[i, FIRST_SHAPE] + STATE[i, SHAPES]):
            lossy = lossy or A.SHAPE[s, ELASTICITY] < 1.0
        i = MEMBER[i, AFTER_ME]
    if some == n or some < (1.0 - _MOST) * n or not lossy:
        return False
    MINE, OTHERS, V0 = np.empty(some, np.int64), np.empty(n - some, np.int64), np.empty((some, 3))
    stand, move, i = 0, 0, root
    while i >= 0:
        if settled(A, i):
            MINE[stand] = i
            stand += 1
        else:
            OTHERS[move] = i
            move += 1
        i = MEMBER[i, AFTER_ME]
    MINE.sort()
    OTHERS.sort()
    chain(A, MINE, stand)
    chain(A, OTHERS, move)
    for q in range(stand):
        i = MINE[q]
        MEMBER[i, STILL] = 1
        for c in range(3):
            V0[q, c], BODY[i, VX + c] = BODY[i, VX + c], 0.0
    wait(A, MINE, stand)
    solve(A, OTHERS[0], 0.0)
    for q in range(stand):
        MEMBER[MINE[q], STILL] = 0
    if asks(A, MINE, stand, V0):
        return True
    for q in range(stand):
        for c in range(3):
            BODY[MINE[q], VX + c] = V0[q, c]
    for q in range(move):
        i = OTHERS[q]
        if STATE[i, ISLAND] >= 0:
            if MEMBER[STATE[i, ISLAND], OPEN] > 0:
                close_span(A, STATE[i, ISLAND], 0.0)
            unite(A, MINE[0], i)
    solve(A, STATE[MINE[0], ISLAND], 0.0)
    return True

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
from ..layout import EXTENT, II, IM, OWNER, X, Y
from ..pairs.rules import law
from ..rows.build import place_row
from ..rows.equilibrium import bound, equilibrium, fastest
from ..rows.layout import K_N, ROW_COLUMNS
from ..sustained.memory import find, key_of, remember
from ..sustained.statics import STANDS
from .booking import wake
from .calm import SURE, hardly, later, wait, whirls
from .islands import members
from .layout import (
    AMONG,
    ANEW,
    BETA,
    BODIES,
    CALM_FOR,
    CARRIES,
    DIRECT,
    DT,
    ISLAND,
    LAM,
    LOADED,
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
    REMEMBERED,
    ROOT,
    SPAN,
    STAMP,
    STILL,
    Scene,
)  # fmt: skip
from .spans import dismiss, solve

_FACTORS = 4  # to find how a standing island carries what moves, at most: more would cost as much as a solve
_ROUNDS = 8  # in which forces find their way down, from what stands to what carries it
_PART = 1e-2  # of the fastest of a motion that nothing holds, below which a body has no part in it


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
    """Whether an island that stands carries what pushes on it now; then its contacts have the forces that do. If not,
    those of its bodies that are held all the same are asked again soon."""
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
    open_to, m = 0.5 * hardly(A.MEMBER[root, AMONG]) * A.PAR[PULLED] * dt * dt, 0
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
    if not found:
        give_way(A, MINE, n, START, FELT)
    else:
        for z in range(m):
            R = A.PUSHED[OF[z]]
            R[LAM], R[BETA], R[PUSH_CHANGE] = L[z, 0], L[z, 1], L[z, 0] / ROWS[z, K_N]
            keep_in_mind(A, OF[z])
    return found


@uncounted
def give_way(A: Scene, MINE: IntArray, n: int, Y: FloatArray, FELT: FloatArray) -> None:
    """Of the n bodies MINE, of which nothing holds the motion Y (n, 3), those that take part in it are not to be asked
    soon whether they stand."""
    most = fastest(Y, FELT, n)
    if not 0.0 < most < math.inf:
        wait(A, MINE, n)
        return
    for q in range(n):
        if bound(Y[q, 0], Y[q, 1], Y[q, 2], FELT[q]) > _PART * most:
            A.RESTING[MINE[q], CALM_FOR] = later(n)
        else:
            A.RESTING[MINE[q], CALM_FOR] = SURE


@uncounted
def keep_in_mind(A: Scene, c: int) -> None:
    """Let the memory have the forces of contact number c."""
    a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    key = key_of(A.SHAPE.shape[0], a, b)
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
    more, all_moving, asked = A.COUNT[CARRIES] > 0, True, 0
    while more:
        for c in range(A.COUNT[PUSHES]):
            root = A.PUSHED_BY[c, ROOT]
            if root < 0 or not (MEMBER[root, ANEW] == 1 if MEMBER[root, STILL] == 1 else all_moving):
                continue
            for side in range(2):
                j = A.LINK[A.PUSHED_BY[c, PUSH_A + side], OWNER]
                other = STATE[j, ISLAND]
                if BODY[j, IM] > 0.0 and other != root and other >= 0 and MEMBER[other, STILL] == 1:
                    MEMBER[other, LOADED] = 1
        more, all_moving = False, False
        for i in range(BODY.shape[0] - 1):
            MEMBER[i, ANEW] = 0
        for i in range(BODY.shape[0] - 1):
            if MEMBER[i, LOADED] == 0:
                continue
            MEMBER[i, LOADED] = 0
            if STATE[i, ISLAND] != i or MEMBER[i, STILL] != 1:
                continue
            more = True
            # What carries each other in turn is one island.
            if asked < _ROUNDS and holds(A, i):
                MEMBER[i, ANEW] = 1
            else:
                solve(A, wake(A, i, 0.0), 0.0)
                all_moving = True
        asked += 1

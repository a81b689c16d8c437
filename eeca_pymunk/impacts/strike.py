"""Impacts at one instant: of a pair alone by the closed law, of all that touch with it as one block.

Contacts that touch at the instant of an impact take part in it, and so on from body to body: the impulses of a rack of
disks are simultaneous. Bodies that impulses do not move carry nothing on.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..geometry.flight import pose, rate
from ..geometry.gap import gap_at, touching
from ..geometry.manifold import face
from ..layout import (
    ANGLE, AX, AY, BOUND, COUNT as VERTICES, ELASTICITY, EXTENT, FRICTION, II, IM, OWNER, SINCE, SPIN, SURFACE_X,
    SURFACE_Y, TWIST, VX, VY, X, Y,
)  # fmt: skip
from ..pairs.layout import NUMBER, START
from ..pairs.lists import centre
from ..rows.blocks import CONVERGED, D_NORMAL, D_TANGENTIAL, OUT_SIZE, SCALE_LOCK, solve_block
from ..rows.build import place_row
from ..rows.layout import K_N, NX, NY, ROW_COLUMNS
from .forecast import barred
from .layout import (
    BLOCKS, BY, CHANGE, EVENTS, FIRST_SHAPE, FRICTIONAL, IMPACTS, IMPULSE, INSTANT, KINKS, LEDGER, LOCK, LOG_FULL,
    DONE, LOGGED, NORMAL_X, NORMAL_Y, ON, POINT_X, POINT_Y, RESTITUTION, SHAPES, TANGENTIAL, UNMET, Scene,
)  # fmt: skip

_FACES = 16.0  # times the tolerance of touching, by which the ends of parallel faces may differ


@uncounted
def move_to(BODY: FloatArray, i: int, t: float) -> None:
    """Let the path of body i begin at instant t."""
    s = t - BODY[i, SINCE]
    if s != 0.0:
        for c in range(3):
            BODY[i, X + c] += (BODY[i, VX + c] + 0.5 * BODY[i, AX + c] * s) * s
            BODY[i, VX + c] += BODY[i, AX + c] * s
        BODY[i, SINCE] = t


@uncounted
def restitution(SHAPE: FloatArray, RULE: FloatArray, a: int, b: int) -> tuple[float, float, float, float]:
    """Elasticity, friction, and surface velocity (x, y) of b relative to a: pymunk's products, or what a handler set."""
    for r in range(RULE.shape[0]):
        if RULE[r, 0] == min(a, b) and RULE[r, 1] == max(a, b):
            sign = 1.0 if a < b else -1.0
            return RULE[r, 2], RULE[r, 3], sign * RULE[r, 4], sign * RULE[r, 5]
    return (
        SHAPE[a, ELASTICITY] * SHAPE[b, ELASTICITY],
        SHAPE[a, FRICTION] * SHAPE[b, FRICTION],
        SHAPE[b, SURFACE_X] - SHAPE[a, SURFACE_X],
        SHAPE[b, SURFACE_Y] - SHAPE[a, SURFACE_Y],
    )


@uncounted
def touches(A: Scene, disks: int, a: int, b: int, t: float) -> bool:
    """Whether shapes a and b touch at instant t, up to round-off."""
    BODY = A.BODY
    tolerance = touching(BODY, A.SHAPE, A.LINK, a, b, disks)
    if b < A.LIST.shape[0]:
        ax, ay = centre(BODY, A.SHAPE, A.LINK, a, t)
        bx, by = centre(BODY, A.SHAPE, A.LINK, b, t)
        reach = A.SHAPE[a, BOUND] + A.SHAPE[b, BOUND] + tolerance
        if (bx - ax) * (bx - ax) + (by - ay) * (by - ay) > reach * reach:
            return False
        if a < disks and b < disks:
            return True
    i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
    xa, ya, qa = pose(BODY, i, t)
    xb, yb, qb = pose(BODY, j, t)
    return gap_at(A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, xa, ya, qa, b, xb, yb, qb)[0] <= tolerance


@uncounted
def alone(A: Scene, disks: int, i: int, other: int, t: float) -> bool:
    """Whether no shape but `other` touches the shapes of body i at instant t."""
    BODY, POOL = A.BODY, A.POOL
    x, y, _ = pose(BODY, i, t)
    for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
        start = A.LIST[s, START]
        for q in range(start, start + A.LIST[s, NUMBER]):
            o = POOL[q]
            if o == other:
                continue
            if o < disks:
                # Most are plainly apart.
                h = t - BODY[o, SINCE]
                dx = BODY[o, X] + (BODY[o, VX] + 0.5 * BODY[o, AX] * h) * h - x
                dy = BODY[o, Y] + (BODY[o, VY] + 0.5 * BODY[o, AY] * h) * h - y
                far = 1.001 * (BODY[i, EXTENT] + BODY[o, EXTENT]) + 1e-9 * (abs(x) + abs(y))
                if dx * dx + dy * dy > far * far:
                    continue
            if touches(A, disks, s, o, t) and not barred(A.RULE, s, o):
                return False
    return True


@uncounted
def note(
    LOG: FloatArray, n: int, a: int, b: int, t: float, lam: float, beta: float, nx: float, ny: float, px: float,
    py: float, change: float,
) -> None:  # fmt: skip
    """Row n of the log: an impulse between shapes a and b at instant t."""
    LOG[n, BY], LOG[n, ON], LOG[n, INSTANT], LOG[n, IMPULSE], LOG[n, TANGENTIAL] = a, b, t, lam, beta
    LOG[n, NORMAL_X], LOG[n, NORMAL_Y], LOG[n, POINT_X], LOG[n, POINT_Y], LOG[n, CHANGE] = nx, ny, px, py, change


@uncounted
def strike_disk(A: Scene, i: int, o: int, t: float) -> None:
    """Frictionless impact of the lone disk i, with shape o, a lone disk or static: lam = (1 + e) |u| / (1/m_i + 1/m_j)."""
    BODY, LOG = A.BODY, A.LOG
    j = A.LINK[o, OWNER]
    move_to(BODY, i, t)
    x, y = BODY[i, X], BODY[i, Y]
    if A.VERTEX[A.LINK[o, 1], 0] == 0.0 and A.LINK[o, VERTICES] == 1 and BODY[j, IM] > 0.0:
        move_to(BODY, j, t)
        nx, ny = BODY[j, X] - x, BODY[j, Y] - y
        d = math.sqrt(nx * nx + ny * ny)
        nx, ny = nx / d, ny / d
        px, py = x + BODY[i, EXTENT] * nx, y + BODY[i, EXTENT] * ny
    else:
        g, nx, ny, px, py = gap_at(
            A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, x, y, BODY[i, ANGLE], o, BODY[j, X], BODY[j, Y], BODY[j, ANGLE]
        )
    e = restitution(A.SHAPE, A.RULE, i, o)[0]
    u = nx * (BODY[j, VX] - BODY[i, VX]) + ny * (BODY[j, VY] - BODY[i, VY])
    free = BODY[i, IM] + BODY[j, IM]
    lam = (1.0 + e) * max(-u, 0.0) / free
    BODY[i, VX] -= lam * BODY[i, IM] * nx
    BODY[i, VY] -= lam * BODY[i, IM] * ny
    A.STATE[i, KINKS] += 1
    A.STATE[i, EVENTS] += 1
    if BODY[j, IM] > 0.0:
        BODY[j, VX] += lam * BODY[j, IM] * nx
        BODY[j, VY] += lam * BODY[j, IM] * ny
        A.STATE[j, KINKS] += 1
        A.STATE[j, EVENTS] += 1
    A.PAR[LEDGER + RESTITUTION] += 0.5 * lam * (1.0 - e) * max(-u, 0.0)
    note(LOG, A.COUNT[LOGGED], i, o, t, lam, 0.0, nx, ny, px, py, lam * free)
    A.COUNT[LOGGED] += 1
    A.COUNT[IMPACTS] += 1


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
            move_to(A.BODY, i, t)
    while q < n:
        i = BODIES[q]
        q += 1
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            start = A.LIST[s, START]
            for p in range(start, start + A.LIST[s, NUMBER]):
                o = A.POOL[p]
                j = A.LINK[o, OWNER]
                moves = A.BODY[j, IM] > 0.0
                key = min(s, o) * k + max(s, o)
                # The pairs with bodies that have been looked at before stand there already.
                if key == PAIRS[0] or (moves and 0 <= A.PLACE[j] < q - 1):
                    continue
                if barred(A.RULE, s, o) or not touches(A, disks, s, o, t):
                    continue
                if moves and A.PLACE[j] < 0:
                    BODIES[n], A.PLACE[j] = j, n
                    n += 1
                    move_to(A.BODY, j, t)
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
def strike(A: Scene, disks: int, a: int, b: int, t: float) -> tuple[int, int]:
    """Impulses of the block of shapes a and b at instant t. Status, and the number of its bodies, in A.BLOCK.

    LOG_FULL leaves everything as it was, but for the instants from which the paths count.
    """
    BODY, LINK, COUNT, BODIES = A.BODY, A.LINK, A.COUNT, A.BLOCK
    k = A.SHAPE.shape[0]
    n, m, PAIRS = gather(A, disks, a, b, t)
    BODIES[:n].sort()
    for q in range(n):
        A.PLACE[BODIES[q]] = q
    if COUNT[LOGGED] + 2 * m > A.LOG.shape[0]:
        for q in range(n):
            A.PLACE[BODIES[q]] = -1
        return LOG_FULL, n
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
        e, mu, sx, sy = restitution(A.SHAPE, A.RULE, sa, sb)
        tolerance = _FACES * touching(BODY, A.SHAPE, LINK, sa, sb, disks)
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
            POINTS[rows, 0], POINTS[rows, 1], OF[rows] = found[c, 2], found[c, 3], PAIRS[z]
            rows += 1
    L, LOSS, OUT = np.zeros((rows, 2)), np.zeros((rows, 2)), np.zeros(OUT_SIZE)
    status = solve_block(P, Q, ROWS, L, V, IMS, IIS, POSE, n, rows, 0.0, LOSS, OUT)
    if status != CONVERGED:
        COUNT[UNMET] += 1
    if abs(OUT[SCALE_LOCK] - 1.0) > abs(A.PAR[LOCK] - 1.0):
        A.PAR[LOCK] = OUT[SCALE_LOCK]
    A.PAR[LEDGER + RESTITUTION] += OUT[D_NORMAL]
    A.PAR[LEDGER + FRICTIONAL] += OUT[D_TANGENTIAL]
    for q in range(n):
        i = BODIES[q]
        BODY[i, VX], BODY[i, VY], BODY[i, SPIN] = V[q, 0], V[q, 1], V[q, 2]
        A.STATE[i, KINKS] += 1
        A.STATE[i, EVENTS] += 1
        A.PLACE[i] = -1
    for z in range(rows):
        if L[z, 0] > 0.0:
            note(
                A.LOG, COUNT[LOGGED], OF[z] // k, OF[z] % k, t, L[z, 0], L[z, 1], ROWS[z, NX], ROWS[z, NY],
                POINTS[z, 0], POINTS[z, 1], L[z, 0] / ROWS[z, K_N],
            )  # fmt: skip
            COUNT[LOGGED] += 1
    COUNT[IMPACTS] += 1
    COUNT[BLOCKS] += 1 if m > 1 else 0
    return DONE, n

"""Islands of sustained contacts within a step: who belongs to one, its span of time, and what was done in it.

An island is solved from an instant to the end of the step; its bodies then follow parabolas, on which others may hit
it. A hit ends the span: its works are booked up to there (exactly: forces are constant, velocities linear in time),
and a new span begins. Forces of a span that was cut may have given energy (a soft landing pushes before it touches):
that is owed, and taken out by what follows.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..geometry.gap import gap_at
from ..layout import (
    ANGLE,
    AX,
    AY,
    BOUND,
    ELASTICITY,
    EXTENT,
    II,
    IM,
    OWNER,
    ROUNDING,
    SINCE,
    SIZE,
    SPIN,
    TWIST,
    VX,
    VY,
    X,
    Y,
)
from ..layout import COUNT as COUNT_OF
from ..pairs.layout import NUMBER, START
from ..pairs.lists import centre, mark_pair
from ..pairs.rules import barred, law
from ..rows.build import normal_rate, tangent_rate
from ..rows.layout import ARM_NA, ARM_TA, FRICTION, K_N, K_T, NX, NY, ROW_COLUMNS, UN, UT
from ..sustained.ledger import LEDGER_SIZE, carried
from ..sustained.memory import find
from ..sustained.step import LOCK as LOCK_OF
from ..sustained.step import OUT_SIZE, step_island
from ..sustained.step import POLISHES as POLISHES_OF
from ..sustained.step import SWEEPS as SWEEPS_OF
from .layout import (
    AFTER_ME,
    BETA,
    BODIES,
    BUSY,
    DIRECT,
    DONE,
    DT,
    ENDED,
    EXTERNAL,
    FIRST_SHAPE,
    FRICTIONAL,
    HITS,
    ISLAND,
    KINKS,
    LAM,
    LAST_ONE,
    LASTED,
    LEDGER,
    LIFT,
    LOCK,
    LOGGED,
    LOST,
    PULLED,
    PUSH_A,
    PUSH_B,
    PUSH_CHANGE,
    PUSH_NX,
    PUSH_NY,
    PUSH_X,
    PUSH_Y,
    PUSHES,
    PUSHES_FULL,
    RELAX,
    REMEMBERED,
    RESTITUTION,
    ROOT,
    SHAPES,
    SOLVES,
    SPAN,
    SPAN_FROM,
    SPEED,
    STAMP,
    SWEEPS,
    TOGETHER,
    UN_AFTER,
    UN_BEFORE,
    UNTIL,
    UT_AFTER,
    UT_BEFORE,
    WORK_OF,
    Scene,
)  # fmt: skip
from .strike import move_to, note

_TURN = 0.1  # rad
_PARTS = 64.0  # of a step, that a span is at least
_FEW = 12  # contacts
_STICKS = 1e-6  # relative to the friction there can be, and to the slip, below which there is none
TOUCH = 1e-7  # gap relative to the smaller shape, within which shapes are in touch
_STILL, _WAS_STILL = 1e-6, 1e-3  # speed relative to |a| dt, below which elastic contacts rest; if they did before


@uncounted
def unite(A: Scene, i: int, j: int) -> int:
    """Put bodies i and j, with their islands, into one; its root."""
    MEMBER, STATE = A.MEMBER, A.STATE
    for k in (i, j):
        if STATE[k, ISLAND] < 0:
            STATE[k, ISLAND] = k
            MEMBER[k, AFTER_ME], MEMBER[k, LAST_ONE], MEMBER[k, BODIES], MEMBER[k, HITS] = -1, k, 1, 0
            A.RESTING[k, LOST] = 0.0
    a, b = STATE[i, ISLAND], STATE[j, ISLAND]
    if a == b:
        return a
    if MEMBER[a, BODIES] < MEMBER[b, BODIES] or (MEMBER[a, BODIES] == MEMBER[b, BODIES] and b < a):
        a, b = b, a
    k = b
    while k >= 0:
        STATE[k, ISLAND] = a
        k = MEMBER[k, AFTER_ME]
    MEMBER[MEMBER[a, LAST_ONE], AFTER_ME] = b
    MEMBER[a, LAST_ONE] = MEMBER[b, LAST_ONE]
    MEMBER[a, BODIES] += MEMBER[b, BODIES]
    MEMBER[a, HITS] = max(MEMBER[a, HITS], MEMBER[b, HITS])
    A.RESTING[a, LOST] += A.RESTING[b, LOST]
    return a


@uncounted
def remembered(KEYS: IntArray, FORCES: FloatArray, shapes: int, a: int, b: int, since: float) -> tuple[float, float]:
    """Normal force and load of a pair of shapes, of the steps from number `since` on; 0 if there is none."""
    key = (min(a, b) * shapes + max(a, b)) << 1
    force, load = 0.0, 0.0
    for z in range(2):
        row = find(KEYS, key + z)
        if row >= 0 and FORCES[row, 3] >= since:
            force += FORCES[row, 0]
            load += FORCES[row, 2]
    return force, load


@uncounted
def approach(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, WORK: FloatArray, PULL: FloatArray,
    a: int, b: int, t: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Gap of shapes a and b, whose paths begin at instant t or that move evenly; its rate; the acceleration with which
    it closes without contacts; and the mass that it feels."""
    i, j = LINK[a, OWNER], LINK[b, OWNER]
    h = t - BODY[j, SINCE]
    g, nx, ny, px, py = gap_at(
        SHAPE, LINK, VERTEX, WORK, a, BODY[i, X], BODY[i, Y], BODY[i, ANGLE],
        b, BODY[j, X] + BODY[j, VX] * h, BODY[j, Y] + BODY[j, VY] * h, BODY[j, ANGLE] + BODY[j, SPIN] * h,
    )  # fmt: skip
    xi, yi, xj, yj = (
        px - BODY[i, X],
        py - BODY[i, Y],
        px - BODY[j, X] - BODY[j, VX] * h,
        py - BODY[j, Y] - BODY[j, VY] * h,
    )
    arm_i, arm_j = xi * ny - yi * nx, xj * ny - yj * nx
    u = nx * (BODY[j, VX] - BODY[i, VX]) + ny * (BODY[j, VY] - BODY[i, VY])
    u += arm_j * BODY[j, SPIN] - arm_i * BODY[i, SPIN]
    closing = nx * (PULL[i, 0] - PULL[j, 0]) + ny * (PULL[i, 1] - PULL[j, 1])
    closing += arm_i * PULL[i, 2] - arm_j * PULL[j, 2]
    mass = 1.0 / (BODY[i, IM] + BODY[j, IM] + BODY[i, II] * arm_i * arm_i + BODY[j, II] * arm_j * arm_j)
    return g, u, closing, mass


@uncounted
def rests(A: Scene, a: int, b: int, t: float, lossy: bool) -> bool:
    """Whether a pair whose bodies are at instant t is in sustained contact until the end of the step.

    e < 1: iff its bounce e |u| is below half of what presses it together, P = max(a_n h, A_nn f h) with f the load it
    carried, and it is in touch (u <= P) or carried a force and closes again. e = 1: iff it touches without speed and
    against what does not move is pressed.
    """
    e = law(A.SHAPE, A.RULE, a, b)[0]
    g, u, closing, mass = approach(A.BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, A.PULL, a, b, t)
    h = A.PAR[DT] - t
    small = min(A.SHAPE[a, SIZE], A.SHAPE[b, SIZE])
    force, load = remembered(A.KEYS, A.FORCES, A.SHAPE.shape[0], a, b, A.PAR[STAMP] - 1.0)
    if e >= 1.0 and not lossy:
        limit = (_WAS_STILL if force > 0.0 else _STILL) * A.PAR[PULLED] * A.PAR[DT]
        fixed = A.BODY[A.LINK[b, OWNER], IM] == 0.0 or A.BODY[A.LINK[a, OWNER], IM] == 0.0
        return g <= TOUCH * small and abs(u) <= limit and (not fixed or closing > 0.0 or force > 0.0)
    press = max(closing, load / mass) * h
    if not -e * min(u, 0.0) < 0.5 * press:
        return False
    if g <= TOUCH * small:
        return u <= press
    return force > 0.0 and g + u * h - 0.5 * press * h <= 0.0


@uncounted
def members(A: Scene, root: int, MINE: IntArray) -> int:
    """The bodies of an island into MINE; how many they are."""
    i, n = root, 0
    while i >= 0:
        MINE[n] = i
        n += 1
        i = A.MEMBER[i, AFTER_ME]
    return n


@uncounted
def flag_again(A: Scene) -> None:
    """Flag the pairs of all spans, in lists that were made anew."""
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] >= 0:
            a, b = A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
            mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], a, b, 1)


@uncounted
def book(A: Scene, c: int, t: float) -> None:
    """Book what contact number c has done in its span until instant t, note its impulse, and end it.

    Velocities go linearly through a span, so that after the part f of it D_n = -f lam (u_n + f (u_n+ - u_n) / 2). What
    a contact's friction gives back counts against its restitution, and the other way round.
    """
    PAR, COUNT, R = A.PAR, A.COUNT, A.PUSHED[c]
    root, a, b = A.PUSHED_BY[c, ROOT], A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B]
    A.PUSHED_BY[c, ROOT] = LASTED if t == PAR[DT] else ENDED
    mark_pair(A.LIST, A.POOL, A.FLAG, A.LIST.shape[0], a, b, 0)
    f = (t - R[SPAN_FROM]) / R[SPAN]
    if f <= 0.0 or (R[LAM] == 0.0 and R[BETA] == 0.0):
        return
    normal = -f * R[LAM] * (R[UN_BEFORE] + 0.5 * f * (R[UN_AFTER] - R[UN_BEFORE]))
    tangential = -f * R[BETA] * (R[UT_BEFORE] + 0.5 * f * (R[UT_AFTER] - R[UT_BEFORE]))
    both = normal + tangential
    if normal < 0.0:
        normal, tangential = min(both, 0.0), max(both, 0.0)
    elif tangential < 0.0:
        normal, tangential = both, 0.0
    PAR[LEDGER + RESTITUTION] += normal
    PAR[LEDGER + FRICTIONAL] += tangential
    PAR[LEDGER + EXTERNAL] += f * R[WORK_OF]
    A.RESTING[root, LOST] += both
    if COUNT[LOGGED] < A.LOG.shape[0]:
        note(
            A.LOG, COUNT[LOGGED], a, b, R[SPAN_FROM] + 0.5 * f * R[SPAN], f * R[LAM], f * R[BETA], R[PUSH_NX],
            R[PUSH_NY], R[PUSH_X], R[PUSH_Y], f * R[PUSH_CHANGE],
        )  # fmt: skip
        COUNT[LOGGED] += 1


@uncounted
def end_span(A: Scene, root: int, t: float) -> None:
    """End the span of an island at instant t: book its contacts, and bring its bodies there."""
    for c in range(A.COUNT[PUSHES]):
        if A.PUSHED_BY[c, ROOT] == root:
            book(A, c, t)
    i = root
    while i >= 0:
        move_to(A.BODY, i, t)
        i = A.MEMBER[i, AFTER_ME]


@uncounted
def lift_out(A: Scene, root: int, end: float) -> None:
    """Lift the bodies of an island, at the end of its span, out of each other; the losses pay what that costs beyond
    the work of forces: the change of kinetic energy, less m a.D + I alpha dtheta for displacements D."""
    PAR, BODY, PULL, JUMP = A.PAR, A.BODY, A.PULL, A.RESTING
    spent = 0.0
    i = root
    while i >= 0:
        move_to(BODY, i, end)
        linear = PULL[i, 0] * JUMP[i, LIFT] + PULL[i, 1] * JUMP[i, LIFT + 1]
        for c in range(2):
            linear -= JUMP[i, LIFT + 3 + c] * (BODY[i, VX + c] + 0.5 * JUMP[i, LIFT + 3 + c])
        spent -= linear / BODY[i, IM]
        if BODY[i, II] > 0.0:
            turning = JUMP[i, LIFT + 5] * (BODY[i, SPIN] + 0.5 * JUMP[i, LIFT + 5])
            spent += (turning - PULL[i, 2] * JUMP[i, LIFT + 2]) / BODY[i, II]
        for c in range(6):
            BODY[i, X + c] += JUMP[i, LIFT + c]
        i = A.MEMBER[i, AFTER_ME]
    PAR[LEDGER + RESTITUTION] -= spent
    if PAR[LEDGER + RESTITUTION] < 0.0 and PAR[LEDGER + FRICTIONAL] > 0.0:
        PAR[LEDGER + FRICTIONAL] += PAR[LEDGER + RESTITUTION]
        PAR[LEDGER + RESTITUTION] = 0.0


@uncounted
def way_of(A: Scene, i: int, h: float) -> float:
    """How far points of body i may come in h, with some room, where all contacts act together."""
    pulled = 0.5 * A.PAR[PULLED] * h if A.BODY[i, IM] > 0.0 else 0.0
    return 1.1 * (A.RESTING[i, SPEED] + pulled) * h


@kernel
def pairs_of(A: Scene, root: int, t: float, lossy: bool, LOCAL: IntArray, MINE: IntArray, n: int) -> IntArray:
    """(p, 2) pairs of shapes of an island, whose n bodies are MINE, that its solve takes over: what touches, and what
    will rest within the span; where it is busy all that comes near. All others meet at their times of impact, unless
    all contacts act together."""
    found = np.empty((4 * n + 8, 2), np.int64)
    p = 0
    BODY, LINK, STATE = A.BODY, A.LINK, A.STATE
    h = A.PAR[DT] - t
    together = A.COUNT[TOGETHER] > 0
    for q in range(n):
        i = MINE[q]
        for s in range(STATE[i, FIRST_SHAPE], STATE[i, FIRST_SHAPE] + STATE[i, SHAPES]):
            for w in range(A.LIST[s, START], A.LIST[s, START] + A.LIST[s, NUMBER]):
                o = int(A.POOL[w])
                j = LINK[o, OWNER]
                if BODY[j, IM] > 0.0 and (STATE[j, ISLAND] != root or j < i):
                    continue
                if barred(A.RULE, s, o):
                    continue
                small = min(A.SHAPE[s, SIZE], A.SHAPE[o, SIZE])
                busy = A.MEMBER[i, BUSY] > 0 or A.MEMBER[j, BUSY] > 0
                speed = math.hypot(BODY[i, VX], BODY[i, VY]) + math.hypot(BODY[j, VX], BODY[j, VY])
                speed += abs(BODY[i, SPIN]) * BODY[i, EXTENT] + abs(BODY[j, SPIN]) * BODY[j, EXTENT]
                reach = 1.1 * (speed * h + A.PAR[PULLED] * h * h) + TOUCH * small
                if together:
                    reach = way_of(A, i, h) + way_of(A, j, h) + TOUCH * small
                if o < A.LIST.shape[0]:
                    ax, ay = centre(BODY, A.SHAPE, LINK, s, t)
                    bx, by = centre(BODY, A.SHAPE, LINK, o, t)
                    apart = A.SHAPE[s, BOUND] + A.SHAPE[o, BOUND] + reach
                    if (bx - ax) * (bx - ax) + (by - ay) * (by - ay) > apart * apart:
                        continue
                g, u, closing, mass = approach(A.BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, A.PULL, s, o, t)
                if not busy and not together:
                    reach = 1.1 * (max(-u, 0.0) * h + A.PAR[PULLED] * h * h) + TOUCH * small
                if g > reach:
                    continue
                e = law(A.SHAPE, A.RULE, s, o)[0]
                if together:
                    pass
                elif e >= 1.0 and not lossy:
                    if not rests(A, s, o, t, False):
                        continue
                elif g > TOUCH * small and not busy:
                    press = (
                        max(closing, remembered(A.KEYS, A.FORCES, A.SHAPE.shape[0], s, o, A.PAR[STAMP] - 1.0)[1] / mass)
                        * h
                    )
                    if not -e * min(u, 0.0) < 0.5 * press:
                        continue
                if p == found.shape[0]:
                    more = np.empty((2 * p, 2), np.int64)
                    more[:p] = found
                    found = more
                found[p, 0], found[p, 1] = s, o
                p += 1
    return found[:p]


@uncounted
def span_of(A: Scene, found: IntArray, t: float) -> float:
    """Length of a span that begins at instant t: to the end of the step, or until a normal may have turned by _TURN; of
    islands of few contacts, as every span costs a solve. Normals turn with shapes that are not round, and as round
    ones go round one another."""
    BODY, LINK = A.BODY, A.LINK
    h = A.PAR[DT] - t
    if found.shape[0] > _FEW or A.COUNT[TOGETHER] > 0:
        return h
    rate = 0.0
    for c in range(found.shape[0]):
        a, b = found[c, 0], found[c, 1]
        i, j = LINK[a, OWNER], LINK[b, OWNER]
        for s in (a, b):
            if LINK[s, COUNT_OF] > 1:
                rate = max(rate, abs(BODY[LINK[s, OWNER], SPIN]))
        if LINK[a, COUNT_OF] == 1 and LINK[b, COUNT_OF] == 1:
            speed = math.hypot(BODY[j, VX] - BODY[i, VX], BODY[j, VY] - BODY[i, VY])
            rate = max(rate, speed / max(A.SHAPE[a, ROUNDING] + A.SHAPE[b, ROUNDING], 1e-300))
    if rate * h <= _TURN:
        return h
    return max(_TURN / rate, A.PAR[DT] / _PARTS)


@kernel
def stick_time(
    P: IntArray, Q: IntArray, ROWS: FloatArray, L: FloatArray, FREE: FloatArray, VN: FloatArray, m: int, h: float
) -> float:
    """When, within a span h of few contacts, those that slip come to stick; h if none does.

    The solve ends their slip u_t with frictions beta, which change it by F, beside a_t h by other forces. Full friction
    changes it by F sum mu lam / sum |beta| (single ones of a body's contacts are not unique): so fast the slip is over
    after h |u_t| / (|F| sum mu lam / sum |beta| - a_t h).
    """
    if m > _FEW:
        return h
    limit, beta, slip, others = 0.0, 0.0, 0.0, 0.0
    for z in range(m):
        most = ROWS[z, FRICTION] * L[z, 0]
        before = abs(ROWS[z, UT])
        # What sticks all along has no slip but round-off before.
        if most == 0.0 or before <= _STICKS * most / ROWS[z, K_T]:
            continue
        if abs(tangent_rate(P, Q, ROWS, VN, z)) > _STICKS * before:
            continue
        sign = 1.0 if ROWS[z, UT] > 0.0 else -1.0
        limit += most
        beta -= sign * L[z, 1]
        if before > slip:
            slip, others = before, sign * (tangent_rate(P, Q, ROWS, FREE, z) - ROWS[z, UT])
    if beta <= _STICKS * limit or beta >= (1.0 - _STICKS) * limit:
        return h
    rate = (slip + others) * limit / beta - others
    return h * slip / rate if rate > slip else h


@kernel
def solve(A: Scene, root: int, t: float) -> int:
    """Begin a span of the island at instant t, at which all its bodies are. Bodies without contact leave it.

    DONE, or PUSHES_FULL, which leaves everything as it was.
    """
    BODY, STATE, MEMBER, COUNT = A.BODY, A.STATE, A.MEMBER, A.COUNT
    n = MEMBER[root, BODIES]
    MINE = np.empty(n, np.int64)
    members(A, root, MINE)
    MINE.sort()
    lossy = False
    for q in range(n):
        A.PLACE[MINE[q]] = q
        for s in range(STATE[MINE[q], FIRST_SHAPE], STATE[MINE[q], FIRST_SHAPE] + STATE[MINE[q], SHAPES]):
            lossy = lossy or A.SHAPE[s, ELASTICITY] < 1.0
    found = pairs_of(A, root, t, lossy, A.PLACE, MINE, n)
    p = len(found)
    h = span_of(A, found, t)
    if COUNT[PUSHES] + 2 * p > A.PUSHED.shape[0] or 2 * (COUNT[REMEMBERED] + 2 * p) > A.KEYS.shape[0]:
        for q in range(n):
            A.PLACE[MINE[q]] = -1
        return PUSHES_FULL
    # Bodies that impulses do not move stand after those of the island.
    FIXED, fixed = np.empty(p, np.int64), 0
    for c in range(p):
        j = A.LINK[found[c, 1], OWNER]
        if A.PLACE[j] < 0:
            A.PLACE[j] = n + fixed
            FIXED[fixed] = j
            fixed += 1
    k = n + fixed
    WHO = np.empty(k, np.int64)
    POSE, V, ACC = np.empty((k, 3)), np.empty((k, 3)), np.zeros((k, 3))
    IMS, IIS, SIZES = np.empty(k), np.empty(k), np.empty(k)
    for q in range(k):
        i = MINE[q] if q < n else FIXED[q - n]
        WHO[q] = i
        s = t - BODY[i, SINCE]
        V[q, 0], V[q, 1], V[q, 2] = BODY[i, VX], BODY[i, VY], BODY[i, SPIN]
        for c in range(3):
            POSE[q, c] = BODY[i, X + c] + V[q, c] * s
        IMS[q], IIS[q], SIZES[q] = BODY[i, IM], BODY[i, II], BODY[i, EXTENT]
        if q < n:
            for c in range(3):
                ACC[q, c] = A.PULL[i, c]
    PAIRS = np.empty((p, 4), np.int64)
    for c in range(p):
        PAIRS[c, 0], PAIRS[c, 1] = found[c, 0], found[c, 1]
        PAIRS[c, 2], PAIRS[c, 3] = A.PLACE[A.LINK[found[c, 0], OWNER]], A.PLACE[A.LINK[found[c, 1], OWNER]]
    for q in range(k):
        A.PLACE[WHO[q]] = -1
    room = 2 * p + 1
    P, Q, KEY = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    ROWS, L, LOSS = np.empty((room, ROW_COLUMNS)), np.zeros((room, 2)), np.zeros((room, 2))
    VN, JUMP, BOOK, OUT = np.empty((k, 3)), np.zeros((k, 6)), np.zeros(LEDGER_SIZE), np.zeros(OUT_SIZE)
    least = 0.0
    if COUNT[TOGETHER] > 0:
        for q in range(k):
            least = max(least, way_of(A, WHO[q], h))
    m = 0
    if p > 0 and h > 0.0:
        m = step_island(
            POSE, V, ACC, IMS, IIS, SIZES, n, PAIRS, p, A.SHAPE, A.RULE, A.LINK, A.VERTEX, A.WORK, h,
            least, max(-A.RESTING[root, LOST], 0.0), A.KEYS, A.FORCES, COUNT[REMEMBERED:], A.PAR[STAMP],
            A.RESTING[MINE[0], RELAX : RELAX + 3], P, Q, ROWS, KEY, L, LOSS, VN, JUMP, BOOK, OUT,
        )  # fmt: skip
        stuck = h if COUNT[TOGETHER] > 0 else stick_time(P, Q, ROWS, L, V + h * ACC, VN, m, h)
        if stuck < h:
            # Where slip ends on the way, so does the span: friction changes its law there.
            h = max(stuck, A.PAR[DT] / _PARTS)
            BOOK[:] = 0.0
            m = step_island(
                POSE, V, ACC, IMS, IIS, SIZES, n, PAIRS, p, A.SHAPE, A.RULE, A.LINK, A.VERTEX, A.WORK, h,
                least, max(-A.RESTING[root, LOST], 0.0), A.KEYS, A.FORCES, COUNT[REMEMBERED:], A.PAR[STAMP],
                A.RESTING[MINE[0], RELAX : RELAX + 3], P, Q, ROWS, KEY, L, LOSS, VN, JUMP, BOOK, OUT,
            )  # fmt: skip
        if abs(OUT[LOCK_OF] - 1.0) > abs(A.PAR[LOCK] - 1.0):
            A.PAR[LOCK] = OUT[LOCK_OF]
    COUNT[SOLVES] += 1
    COUNT[SWEEPS] += int(OUT[SWEEPS_OF])
    COUNT[DIRECT] += int(OUT[POLISHES_OF])
    shapes = A.SHAPE.shape[0]
    first = COUNT[PUSHES]
    moving = A.LIST.shape[0]
    TOUCHED = np.zeros(k, np.uint8)
    for z in range(m):
        pair = KEY[z] >> 1
        a, b = pair // shapes, pair % shapes
        if A.LINK[a, OWNER] != WHO[P[z]]:
            a, b = b, a
        TOUCHED[P[z]], TOUCHED[Q[z]] = 1, 1
        mark_pair(A.LIST, A.POOL, A.FLAG, moving, a, b, 1)
        c = first + z
        A.PUSHED_BY[c, PUSH_A], A.PUSHED_BY[c, PUSH_B] = a, b
        ROW = A.PUSHED[c]
        ROW[LAM], ROW[BETA], ROW[SPAN_FROM], ROW[SPAN] = L[z, 0], L[z, 1], t, h
        ROW[UN_BEFORE], ROW[UT_BEFORE] = ROWS[z, UN], ROWS[z, UT]
        ROW[UN_AFTER], ROW[UT_AFTER] = normal_rate(P, Q, ROWS, VN, z), tangent_rate(P, Q, ROWS, VN, z)
        ROW[WORK_OF] = carried(P[z : z + 1], Q[z : z + 1], ROWS[z : z + 1], L[z : z + 1], V, IMS, 1)
        ROW[PUSH_NX], ROW[PUSH_NY] = ROWS[z, NX], ROWS[z, NY]
        # The point from its arms: r = arm_t n - arm_n t.
        x, y = POSE[P[z], 0] + 0.5 * h * V[P[z], 0], POSE[P[z], 1] + 0.5 * h * V[P[z], 1]
        ROW[PUSH_X] = x + ROWS[z, ARM_TA] * ROWS[z, NX] + ROWS[z, ARM_NA] * ROWS[z, NY]
        ROW[PUSH_Y] = y + ROWS[z, ARM_TA] * ROWS[z, NY] - ROWS[z, ARM_NA] * ROWS[z, NX]
        ROW[PUSH_CHANGE] = L[z, 0] / ROWS[z, K_N]
    lost, hits = A.RESTING[root, LOST], MEMBER[root, HITS]
    head, tail, size = -1, -1, 0
    for q in range(n):
        i = MINE[q]
        STATE[i, KINKS] += 1
        for c in range(6):
            A.RESTING[i, LIFT + c] = JUMP[q, c]
        if TOUCHED[q] == 0:
            STATE[i, ISLAND] = -1
            BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2]
            continue
        BODY[i, AX], BODY[i, AY] = (VN[q, 0] - V[q, 0]) / h, (VN[q, 1] - V[q, 1]) / h
        BODY[i, TWIST] = (VN[q, 2] - V[q, 2]) / h
        if head < 0:
            head = i
        else:
            MEMBER[tail, AFTER_ME] = i
        tail = i
        size += 1
        STATE[i, ISLAND], MEMBER[i, AFTER_ME] = head, -1
    if head >= 0:
        MEMBER[head, LAST_ONE], MEMBER[head, BODIES], MEMBER[head, HITS] = tail, size, hits
        A.RESTING[head, LOST] = lost
        A.RESTING[head, UNTIL] = t + h if t + h < A.PAR[DT] * (1.0 - 1e-12) else math.inf
        for z in range(m):
            A.PUSHED_BY[first + z, ROOT] = head
        COUNT[PUSHES] += m
    return DONE

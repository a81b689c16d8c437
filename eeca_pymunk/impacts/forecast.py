"""Forecasts: the next event of a body on its present path, among the shapes of its lists.

A forecast is a function of the two paths alone, not of when it is made: times are counted from the later of the two
bodies' kinks. Paths of equal acceleration give times that hold beyond the step; others are looked at to its end, and
give a time before which nothing happens: the body is forecast anew then.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import inlined, uncounted
from ..geometry.flight import norm
from ..layout import (
    AX,
    AY,
    CENTRE_X,
    CENTRE_Y,
    DUE,
    EXTENT,
    OWNER,
    SINCE,
    SPIN,
    TWIST,
    VX,
    VY,
    X,
    Y,
)  # fmt: skip
from ..pairs.grid import renew
from ..pairs.layout import AT_X, AT_Y, LATER, MARGIN, NUMBER, START
from ..pairs.lists import centre
from ..pairs.rules import barred
from .heap import push
from .layout import (
    CHECK,
    EVEN,
    FIRST_SHAPE,
    HEAP,
    KINKS,
    KNOWN,
    LEAVE,
    NOTHING,
    OTHER,
    OWN,
    RENEW,
    SHAPES,
    UNMET,
    Scene,
)  # fmt: skip
from .times import meet, one_pull

_SAME = 1e-9  # of the step, within which an instant that was computed again is the same
AHEAD, _FARTHEST = 0.4, 0.7  # of the margin, that a new circle is before a shape that leaves its own; at most
_INSIDE = 0.1  # of the margin that is left, above which a shape has not left its circle


@uncounted
def leaves(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, disks: int, i: int, s: int, now: float
) -> float:
    """Instant before which the centre of shape s of body i stays within its margin circle; exact for straight paths."""
    m = MARK[s, MARGIN]
    if m == math.inf:
        return math.inf
    h = now - BODY[i, SINCE]
    arm = 0.0 if s < disks else norm(SHAPE[s, CENTRE_X], SHAPE[s, CENTRE_Y])
    ax, ay = BODY[i, AX], BODY[i, AY]
    if ax == 0.0 and ay == 0.0 and arm == 0.0:
        vx, vy = BODY[i, VX], BODY[i, VY]
        dx, dy = BODY[i, X] + vx * h - MARK[s, AT_X], BODY[i, Y] + vy * h - MARK[s, AT_Y]
        squared = vx * vx + vy * vy
        b = dx * vx + dy * vy
        c = m * m - dx * dx - dy * dy
        # What the user has put elsewhere is outside, even at rest or on its way back.
        if c <= 0.0:
            return now
        if squared == 0.0:
            return math.inf
        root = math.sqrt(b * b + squared * c)
        return float(now + ((root - b) / squared if b <= 0.0 else c / (root + b)))
    # The length of the way bounds the distance: u s + g s^2 / 2 until the room is used up.
    x, y = centre(BODY, SHAPE, LINK, s, now)
    room = m - norm(x - MARK[s, AT_X], y - MARK[s, AT_Y])
    if room <= 0.0:
        return now
    u = norm(BODY[i, VX] + ax * h, BODY[i, VY] + ay * h) + abs(BODY[i, SPIN] + BODY[i, TWIST] * h) * arm
    g = norm(ax, ay) + abs(BODY[i, TWIST]) * arm
    if u + g == 0.0:
        return math.inf
    return float(now + 2.0 * room / (u + math.sqrt(u * u + 2.0 * g * room)))


@uncounted
def has_left(BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, MARK: FloatArray, s: int, now: float) -> bool:
    """Whether shape s is as good as out of its margin circle."""
    x, y = centre(BODY, SHAPE, LINK, s, now)
    return bool(norm(x - MARK[s, AT_X], y - MARK[s, AT_Y]) > (1.0 - _INSIDE) * MARK[s, MARGIN])


@inlined
def predict(
    BODY: FloatArray, STATE: IntArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, MARK: FloatArray,
    LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, RULE: FloatArray, TIME: FloatArray, OF: IntArray,
    WORK: FloatArray, PLACE: IntArray, COUNT: IntArray, disks: int, moving: int, i: int, now: float, end: float,
    until: float,
) -> None:  # fmt: skip
    """Forecast body i from its present path, at an instant `now` of the loop, and put what is due in this step on the
    heap.

    Args:
        PLACE: (n,) 0 or more for bodies that are forecast together, the first of a pair of which sees it; else -1.
        until: instant at which a span of the body's island ends, infinite if it has none of its own.
    """
    best, own, other = math.inf, -1, NOTHING
    first = STATE[i, FIRST_SHAPE]
    for s in range(first, first + STATE[i, SHAPES]):
        t = leaves(BODY, SHAPE, LINK, MARK, disks, i, s, now)
        if t < best:
            best, own, other = t, s, LEAVE
        start = LIST[s, START]
        for q in range(start, start + LIST[s, NUMBER]):
            if FLAG[q] != 0:
                continue
            o = int(POOL[q])
            if PLACE[LINK[o, OWNER]] >= 0 and LINK[o, OWNER] < i:
                continue
            if RULE.shape[0] > 0 and barred(RULE, s, o):
                continue
            t, certain = meet(BODY, SHAPE, LINK, VERTEX, WORK, s, o, disks, end, -1.0)
            if t < best or (t == best and other >= 0 and (s < own or (s == own and o < other))):
                best, own, other = t, s, (o if certain else CHECK)
    if until < best:
        best, own, other = until, -1, RENEW
    best = max(best, now)
    BODY[i, DUE] = best
    STATE[i, OWN], STATE[i, OTHER] = own, other
    if other >= 0:
        STATE[i, KNOWN] = STATE[LINK[other, 0], KINKS]
    if i < disks:
        LIST[i, LATER] = CHECK
    if best < end:
        COUNT[HEAP] = push(TIME, OF, COUNT[HEAP], best, i)


@uncounted
def carrier(LINK: IntArray, disks: int, s: int) -> int:
    """Row of the body of shape s: lone disks have the same number as their shapes."""
    return s if s < disks else int(LINK[s, OWNER])


@uncounted
def first_meeting(
    A: Scene, disks: int, i: int, known: int, best: float, other: int, end: float, several: bool
) -> tuple[float, int]:  # fmt: skip
    """Instant and shape of the first meeting of the lone disk i with those of its list from place `known` on, or what is
    known to come before, `best` and `other`; CHECK for a shape if it is not certain.

    Args:
        several: whether bodies that have a PLACE are forecast together, see `predict`.
    """
    BODY, POOL, FLAG = A.BODY, A.POOL, A.FLAG
    even = A.COUNT[EVEN] > 0
    flagged = not even or A.COUNT[UNMET] > 0
    x, y, vx, vy, since = BODY[i, X], BODY[i, Y], BODY[i, VX], BODY[i, VY], BODY[i, SINCE]
    ax, ay, extent = BODY[i, AX], BODY[i, AY], BODY[i, EXTENT]
    start, ruled = A.LIST[i, START], A.RULE.shape[0] > 0
    for q in range(start + known, start + A.LIST[i, NUMBER]):
        if flagged and FLAG[q] != 0:
            continue
        o = int(POOL[q])
        if several:
            j = carrier(A.LINK, disks, o)
            if A.PLACE[j] >= 0 and j < i:
                continue
        if ruled and barred(A.RULE, i, o):
            continue
        certain = True
        if o >= disks:
            t, certain = meet(BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, o, disks, end, -1.0)
        elif even or (BODY[o, AX] == ax and BODY[o, AY] == ay):
            t = one_pull(
                since, x, y, vx, vy, BODY[o, SINCE], BODY[o, X], BODY[o, Y], BODY[o, VX], BODY[o, VY], ax, ay,
                extent + BODY[o, EXTENT], best,
            )  # fmt: skip
        else:
            t, certain = meet(BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, o, disks, end, -1.0)
        if t < best or (t == best and other >= 0 and o < other):
            best, other = t, (o if certain else CHECK)
    return best, other


@uncounted
def expect(A: Scene, disks: int, i: int, best: float, other: int, now: float, end: float) -> None:
    """Take it that lone disk i meets shape `other` next, at instant `best`, or before that leaves its margin circle; put
    what is due in this step on the heap."""
    out = leaves(A.BODY, A.SHAPE, A.LINK, A.MARK, disks, i, i, now)
    if other >= 0:
        A.STATE[i, KNOWN] = A.STATE[carrier(A.LINK, disks, other), KINKS]
    if out <= best and out < math.inf:
        A.LIST[i, LATER] = other
        best, other = out, LEAVE
    best = max(best, now)
    A.BODY[i, DUE], A.STATE[i, OWN], A.STATE[i, OTHER] = best, i, other
    if best < end:
        A.COUNT[HEAP] = push(A.HEAP_TIME, A.HEAP_BODY, A.COUNT[HEAP], best, i)


@uncounted
def predict_disk(A: Scene, disks: int, i: int, now: float, end: float, several: bool) -> None:
    """As `predict`, of a lone disk that is in no island."""
    best, other = first_meeting(A, disks, i, 0, math.inf, NOTHING, end, several)
    expect(A, disks, i, best, other, now, end)


@uncounted
def go_on(A: Scene, disks: int, i: int, now: float, end: float) -> bool:
    """Lone disk i, in no island, leaves its margin circle and goes straight on: only what has come into its list is new
    in its forecast. False if the pool is full."""
    BODY = A.BODY
    best, other, later, known = math.inf, NOTHING, A.LIST[i, LATER], A.LIST[i, NUMBER]
    ahead = AHEAD
    if later >= 0 and A.STATE[carrier(A.LINK, disks, later), KINKS] == A.STATE[i, KNOWN]:
        best, certain = meet(A.BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, later, disks, end, -1.0)
        other = later if certain else CHECK
    if has_left(BODY, A.SHAPE, A.LINK, A.MARK, i, now):
        h = now - BODY[i, SINCE]
        if later == NOTHING or other >= 0:
            # Its course changes where it meets somebody: its circle is to be about there.
            way = norm(BODY[i, VX] + BODY[i, AX] * h, BODY[i, VY] + BODY[i, AY] * h) * (best - now)
            ahead = min(way / A.MARK[i, MARGIN], _FARTHEST)
        known = renew(
            BODY, A.SHAPE, A.LINK, A.MARK, A.CELL, A.LIST, A.POOL, A.FLAG, A.HEAD, A.GRID, A.INFO, A.BOX, A.CSR, i, now,
            ahead,
        )  # fmt: skip
        if known < 0:
            return False
    if later != NOTHING and other < 0:
        known = 0
    best, other = first_meeting(A, disks, i, known, best, other, end, False)
    expect(A, disks, i, best, other, now, end)
    return True


@uncounted
def holds(A: Scene, disks: int, i: int, end: float) -> bool:
    """Whether the forecast that lone disk i, in no island, was given in an earlier step is still good, as its path and
    that of whom it meets are the same; puts it on the heap. The instant is computed again, from the paths as they are
    described in this step, so that no bit depends on how long ago the forecast was made."""
    other, due = A.STATE[i, OTHER], A.BODY[i, DUE]
    if due <= 0.0:
        return False
    if other >= 0:
        if A.STATE[carrier(A.LINK, disks, other), KINKS] != A.STATE[i, KNOWN]:
            return False
        t, certain = meet(A.BODY, A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, other, disks, end, -1.0)
        if not (certain and abs(t - due) <= _SAME * end):
            return False
        A.BODY[i, DUE] = due = t
    elif other != LEAVE:
        return False
    if due < end:
        A.COUNT[HEAP] = push(A.HEAP_TIME, A.HEAP_BODY, A.COUNT[HEAP], due, i)
    return True

"""Near lists: of every shape that moves the shapes it may meet before one of the two leaves its margin circle.

A list is complete while the centres of the bounding circles stay within their margins: |d| > R_a + m_a + R_b + m_b
where lists were made keeps the circles apart. A pair of moving shapes stands in both lists, a static shape in that of
the other.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, FloatArray, IntArray, PoolArray
from ..compiled import uncounted
from ..layout import (
    ANGLE,
    AX,
    AY,
    BOUND,
    CATEGORIES,
    CENTRE_X,
    CENTRE_Y,
    GROUP,
    II,
    IM,
    MASK,
    OWNER,
    SINCE,
    SPIN,
    TWIST,
    VX,
    VY,
    X,
    Y,
)  # fmt: skip
from .layout import CAPACITY, NUMBER, POOL_END, START


@uncounted
def centre(BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, s: int, t: float) -> tuple[float, float]:
    """Centre of the bounding circle of shape s at instant t."""
    i = LINK[s, OWNER]
    h = t - BODY[i, SINCE]
    x = BODY[i, X] + (BODY[i, VX] + 0.5 * BODY[i, AX] * h) * h
    y = BODY[i, Y] + (BODY[i, VY] + 0.5 * BODY[i, AY] * h) * h
    a, b = SHAPE[s, CENTRE_X], SHAPE[s, CENTRE_Y]
    if a != 0.0 or b != 0.0:
        angle = BODY[i, ANGLE] + (BODY[i, SPIN] + 0.5 * BODY[i, TWIST] * h) * h
        c, d = math.cos(angle), math.sin(angle)
        x += c * a - d * b
        y += d * a + c * b
    return x, y


@uncounted
def far_apart(
    BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, a: int, b: int, t: float, reach: float
) -> bool:  # fmt: skip
    """Whether the bounding circles of shapes a and b are farther apart than `reach`, length, at instant t."""
    ax, ay = centre(BODY, SHAPE, LINK, a, t)
    bx, by = centre(BODY, SHAPE, LINK, b, t)
    apart = SHAPE[a, BOUND] + SHAPE[b, BOUND] + reach
    return bool((bx - ax) * (bx - ax) + (by - ay) * (by - ay) > apart * apart)


@uncounted
def course(BODY: FloatArray, LINK: IntArray, s: int, t: float) -> tuple[float, float]:
    """Unit vector along which the body of shape s moves at instant t; 0 if it is at rest."""
    i = LINK[s, OWNER]
    h = t - BODY[i, SINCE]
    ux, uy = BODY[i, VX] + BODY[i, AX] * h, BODY[i, VY] + BODY[i, AY] * h
    u = math.sqrt(ux * ux + uy * uy)
    return (ux / u, uy / u) if u > 0.0 else (0.0, 0.0)


@uncounted
def may_meet(BODY: FloatArray, LINK: IntArray, a: int, b: int) -> bool:
    """Whether two shapes may collide: of two bodies, one of which impulses move, let through by pymunk's filters."""
    i, j = LINK[a, OWNER], LINK[b, OWNER]
    if i == j or (BODY[i, IM] == 0.0 and BODY[j, IM] == 0.0 and BODY[i, II] == 0.0 and BODY[j, II] == 0.0):
        return False
    if LINK[a, GROUP] != 0 and LINK[a, GROUP] == LINK[b, GROUP]:
        return False
    return bool((LINK[a, CATEGORIES] & LINK[b, MASK]) != 0 and (LINK[b, CATEGORIES] & LINK[a, MASK]) != 0)


@uncounted
def append(LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, INFO: IntArray, a: int, b: int) -> bool:
    """Put b at the end of a's list, which moves to the end of the pool when it is full. False if that is full too."""
    start, n = LIST[a, START], LIST[a, NUMBER]
    if n == LIST[a, CAPACITY]:
        end, capacity = INFO[POOL_END], 2 * n + 8
        if end + capacity > POOL.shape[0]:
            return False
        for q in range(n):
            POOL[end + q] = POOL[start + q]
            FLAG[end + q] = FLAG[start + q]
        LIST[a, START], LIST[a, CAPACITY] = end, capacity
        INFO[POOL_END] = end + capacity
        start = end
    POOL[start + n] = b
    FLAG[start + n] = 0
    LIST[a, NUMBER] = n + 1
    return True


@uncounted
def place_in(LIST: IntArray, POOL: PoolArray, s: int, o: int) -> int:
    """Where in the pool o stands in the list of s, -1 if it does not."""
    for q in range(LIST[s, START], LIST[s, START] + LIST[s, NUMBER]):
        if POOL[q] == o:
            return q
    return -1


@uncounted
def remove(LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, a: int, b: int) -> None:
    """Take b out of a's list; the last one takes its place."""
    start, last = LIST[a, START], LIST[a, START] + LIST[a, NUMBER] - 1
    for q in range(start, last + 1):
        if POOL[q] == b:
            POOL[q], FLAG[q] = POOL[last], FLAG[last]
            LIST[a, NUMBER] -= 1
            return


@uncounted
def mark_pair(LIST: IntArray, POOL: PoolArray, FLAG: FlagArray, moving: int, a: int, b: int, value: int) -> None:
    """Set the flags of the pair in the lists that it stands in."""
    if a < moving:
        for q in range(LIST[a, START], LIST[a, START] + LIST[a, NUMBER]):
            if POOL[q] == b:
                FLAG[q] = value
    if b < moving:
        for q in range(LIST[b, START], LIST[b, START] + LIST[b, NUMBER]):
            if POOL[q] == a:
                FLAG[q] = value

"""Near lists: of every shape that moves the shapes it may meet before one of the two leaves its margin circle.

A list is complete while the centres of the bounding circles stay within their margins: |d| > R_a + m_a + R_b + m_b
where lists were made keeps the circles apart. A pair of moving shapes stands in both lists, a static shape in that of
the other.
"""

from __future__ import annotations

import math

from ..arrays import FlagArray, IntArray, PoolArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.shapes import Link, List, Shape
from .layout import POOL_END


@uncounted
def centre(BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], s: int, t: float) -> tuple[float, float]:
    """Centre of the bounding circle of shape s at instant t."""
    i = LINK[s].owner
    h = t - BODY[i].since
    x = BODY[i].x + (BODY[i].vx + 0.5 * BODY[i].ax * h) * h
    y = BODY[i].y + (BODY[i].vy + 0.5 * BODY[i].ay * h) * h
    a, b = SHAPE[s].centre_x, SHAPE[s].centre_y
    if a != 0.0 or b != 0.0:
        angle = BODY[i].angle + (BODY[i].spin + 0.5 * BODY[i].angular * h) * h
        c, d = math.cos(angle), math.sin(angle)
        x += c * a - d * b
        y += d * a + c * b
    return x, y


@uncounted
def far_apart(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], a: int, b: int, t: float, reach: float
) -> bool:  # fmt: skip
    """Whether the bounding circles of shapes a and b are farther apart than `reach`, length, at instant t."""
    ax, ay = centre(BODY, SHAPE, LINK, a, t)
    bx, by = centre(BODY, SHAPE, LINK, b, t)
    apart = SHAPE[a].bound + SHAPE[b].bound + reach
    return bool((bx - ax) * (bx - ax) + (by - ay) * (by - ay) > apart * apart)


@uncounted
def course(BODY: Rows[Body], LINK: Rows[Link], s: int, t: float) -> tuple[float, float]:
    """Unit vector along which the body of shape s moves at instant t; 0 if it is at rest."""
    i = LINK[s].owner
    h = t - BODY[i].since
    ux, uy = BODY[i].vx + BODY[i].ax * h, BODY[i].vy + BODY[i].ay * h
    u = math.sqrt(ux * ux + uy * uy)
    return (ux / u, uy / u) if u > 0.0 else (0.0, 0.0)


@uncounted
def may_meet(BODY: Rows[Body], LINK: Rows[Link], a: int, b: int) -> bool:
    """Whether two shapes may collide: of two bodies, one of which impulses move, let through by pymunk's filters."""
    i, j = LINK[a].owner, LINK[b].owner
    if i == j or (
        BODY[i].inv_mass == 0.0
        and BODY[j].inv_mass == 0.0
        and BODY[i].inv_inertia == 0.0
        and BODY[j].inv_inertia == 0.0
    ):
        return False
    if LINK[a].group != 0 and LINK[a].group == LINK[b].group:
        return False
    return bool((LINK[a].categories & LINK[b].mask) != 0 and (LINK[b].categories & LINK[a].mask) != 0)


@uncounted
def append(LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray, INFO: IntArray, a: int, b: int) -> bool:
    """Put b at the end of a's list, which moves to the end of the pool when it is full. False if that is full too."""
    start, n = LIST[a].start, LIST[a].number
    if n == LIST[a].capacity:
        end, capacity = INFO[POOL_END], 2 * n + 8
        if end + capacity > POOL.shape[0]:
            return False
        for q in range(n):
            POOL[end + q] = POOL[start + q]
            FLAG[end + q] = FLAG[start + q]
        LIST[a].start, LIST[a].capacity = end, capacity
        INFO[POOL_END] = end + capacity
        start = end
    POOL[start + n] = b
    FLAG[start + n] = 0
    LIST[a].number = n + 1
    return True


@uncounted
def place_in(LIST: Rows[List], POOL: PoolArray, s: int, o: int) -> int:
    """Where in the pool o stands in the list of s, -1 if it does not."""
    for q in range(LIST[s].start, LIST[s].start + LIST[s].number):
        if POOL[q] == o:
            return q
    return -1


@uncounted
def remove(LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray, a: int, b: int) -> None:
    """Take b out of a's list; the last one takes its place."""
    start, last = LIST[a].start, LIST[a].start + LIST[a].number - 1
    for q in range(start, last + 1):
        if POOL[q] == b:
            POOL[q], FLAG[q] = POOL[last], FLAG[last]
            LIST[a].number -= 1
            return


@uncounted
def mark_pair(LIST: Rows[List], POOL: PoolArray, FLAG: FlagArray, moving: int, a: int, b: int, value: int) -> None:
    """Set the flags of the pair in the lists that it stands in."""
    if a < moving:
        for q in range(LIST[a].start, LIST[a].start + LIST[a].number):
            if POOL[q] == b:
                FLAG[q] = value
    if b < moving:
        for q in range(LIST[b].start, LIST[b].start + LIST[b].number):
            if POOL[q] == a:
                FLAG[q] = value

"""Which pairs of shapes may meet, and by which laws.

Near lists have for every moving shape the shapes that it may meet before one of the two leaves its margin circle. Let d
be the distance of the centres of two margin circles, R the radii of the bounding circles (`Shape.bound`) and m the
margins. If d > R_a + m_a + R_b + m_b, the bounding circles are apart as long as their centres are inside the margin
circles, and the pair is in no list. A pair of moving shapes is in both lists, a static shape in that of the other one.

Elasticity, friction and surface velocity are pymunk's products, or the values that collision handlers or joints have
set for this step in RULE (see `..model.scene`), whose rows are sorted by pair.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..geometry.flight import pose, rotated
from ..geometry.gap import gap_round_off
from ..geometry.widths import smaller
from ..model.parameters.impulses import FACE_ROUND_OFF, ROCKING
from ..model.scene import Scene
from ..model.shapes import Link


@nonallocating
def row_of(RULE: FloatArray, a: int, b: int) -> int:
    """The row of shapes a and b in either order, -1 if there is none; by bisection."""
    low, high = 0, RULE.shape[0]
    if high == 0:
        return -1
    first, second = float(min(a, b)), float(max(a, b))
    while low < high:
        middle = (low + high) // 2
        if RULE[middle, 0] < first or (RULE[middle, 0] == first and RULE[middle, 1] < second):
            low = middle + 1
        else:
            high = middle
    if low < RULE.shape[0] and RULE[low, 0] == first and RULE[low, 1] == second:
        return low
    return -1


@nonallocating
def barred(A: Scene, a: int, b: int) -> bool:
    """Whether shapes a and b do not collide in this step, because of a handler or a joint."""
    r = row_of(A.RULE, a, b)
    return bool(r >= 0 and A.RULE[r, 2] < 0.0)


@nonallocating
def law(A: Scene, a: int, b: int) -> tuple[float, float, float, float]:
    """Elasticity, friction, and surface velocity (x, y) of b relative to a, in this step."""
    RULE, one, two, r = A.RULE, A.SHAPE[a], A.SHAPE[b], row_of(A.RULE, a, b)
    if r >= 0:
        sign = 1.0 if a < b else -1.0
        return RULE[r, 2], RULE[r, 3], sign * RULE[r, 4], sign * RULE[r, 5]
    surface_x, surface_y = two.surface_x - one.surface_x, two.surface_y - one.surface_y
    return one.elasticity * two.elasticity, one.friction * two.friction, surface_x, surface_y


@nonallocating
def face_tolerance(A: Scene, a: int, b: int) -> float:
    """The `tolerance` (length) of `..geometry.manifold.face` in an impact of shapes a and b: the difference of gaps up
    to which both ends of a common face touch at once."""
    tolerance = FACE_ROUND_OFF * gap_round_off(A, a, b)
    if law(A, a, b)[0] < 1.0:
        tolerance = max(tolerance, ROCKING * smaller(A, a, b))
    return tolerance


@nonallocating
def checksum(RULE: FloatArray) -> float:
    """A number that other laws of pairs change: the sum of their values, weighted by their places."""
    total, weight, golden = 0.0, 0.0, 0.5 * (math.sqrt(5.0) - 1.0)
    for r in range(RULE.shape[0]):
        for c in range(RULE.shape[1]):
            weight += golden if weight < 1.0 else golden - 1.0  # between 0 and 1.62, nowhere the same
            total += weight * (RULE[r, c] + 1.0)
    return total


@nonallocating
def circle_centre(A: Scene, s: int, t: float) -> tuple[float, float]:
    """Centre of the bounding circle of shape s at instant t."""
    x, y, angle = pose(A.BODY, A.LINK[s].owner, t)
    px, py = rotated(A.SHAPE[s].centre_x, A.SHAPE[s].centre_y, angle)
    return x + px, y + py


@nonallocating
def far_apart(A: Scene, a: int, b: int, t: float, reach: float) -> bool:
    """Whether the bounding circles of shapes a and b are at a distance above `reach`, length, at instant t."""
    ax, ay = circle_centre(A, a, t)
    bx, by = circle_centre(A, b, t)
    apart = A.SHAPE[a].bound + A.SHAPE[b].bound + reach
    return bool((bx - ax) * (bx - ax) + (by - ay) * (by - ay) > apart * apart)


@nonallocating
def allowed(LINK: Rows[Link], a: int, b: int) -> bool:
    """Whether pymunk's filters let two shapes collide."""
    if LINK[a].group != 0 and LINK[a].group == LINK[b].group:
        return False
    return bool((LINK[a].categories & LINK[b].mask) != 0 and (LINK[b].categories & LINK[a].mask) != 0)


@nonallocating
def may_collide(A: Scene, a: int, b: int) -> bool:
    """Whether two shapes may collide: they belong to two bodies, impulses move one of these, and filters allow it."""
    BODY, LINK = A.BODY, A.LINK
    i, j = LINK[a].owner, LINK[b].owner
    still = BODY[i].inv_mass == 0.0 and BODY[i].inv_inertia == 0.0
    if i == j or (still and BODY[j].inv_mass == 0.0 and BODY[j].inv_inertia == 0.0):
        return False
    return allowed(LINK, a, b)


@nonallocating
def append(A: Scene, a: int, b: int) -> bool:
    """Append b to the list of a, which moves to the end of the pool when it is full. False if the pool is full too."""
    POOL, FLAG, own = A.POOL, A.FLAG, A.LIST[a]
    start, n = own.start, own.number
    if n == own.capacity:
        end, capacity = A.GRID.pool_end, 2 * n + 8  # doubled, so that a list of n moves some log2 n times
        if end + capacity > POOL.shape[0]:
            return False
        for q in range(n):
            POOL[end + q] = POOL[start + q]
            FLAG[end + q] = FLAG[start + q]
        own.start, own.capacity = end, capacity
        A.GRID.pool_end = end + capacity
        start = end
    POOL[start + n] = b
    FLAG[start + n] = 0
    own.number = n + 1
    return True


@nonallocating
def place_in(A: Scene, s: int, o: int) -> int:
    """Index in POOL of o in the list of s, -1 if it is not there."""
    POOL, own = A.POOL, A.LIST[s]
    for q in range(own.start, own.start + own.number):
        if POOL[q] == o:
            return q
    return -1


@nonallocating
def remove(A: Scene, a: int, b: int) -> None:
    """Remove b from the list of a; the last entry takes its place."""
    q = place_in(A, a, b)
    if q >= 0:
        last = A.LIST[a].start + A.LIST[a].number - 1
        A.POOL[q], A.FLAG[q] = A.POOL[last], A.FLAG[last]
        A.LIST[a].number -= 1


@nonallocating
def mark_pair(A: Scene, a: int, b: int, value: int) -> None:
    """Set the flags of a pair in the lists that contain it: 1 while an island solves it, or after its impact was left
    out in this step, so that it makes no events."""
    for s, o in ((a, b), (b, a)):
        q = place_in(A, s, o) if s < A.LIST.shape[0] else -1
        if q >= 0:
            A.FLAG[q] = value

"""Laws of a pair of shapes. Elasticity, friction and surface velocity are pymunk's products, or the values that
collision handlers or joints have set for this step in RULE (see `..model.scene`), whose rows are sorted by pair.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..geometry.gap import gap_round_off
from ..geometry.sides import smaller
from ..model.parameters.impulses import FACE_ROUND_OFF, ROCKING
from ..model.scene import Scene


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
    """Elasticity, friction, and surface velocity (x, y) of b relative to a."""
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

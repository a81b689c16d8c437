"""What a pair of shapes is to each other: pymunk's products, or what a collision handler has set for this step.

RULE (r, 6): shapes a < b, elasticity (below 0: they pass through one another), friction, surface velocity of b relative
to a (x, y).
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import uncounted
from ..layout import ELASTICITY, FRICTION, SURFACE_X, SURFACE_Y


@uncounted
def barred(RULE: FloatArray, a: int, b: int) -> bool:
    """Whether a collision handler has said that shapes a and b pass through one another in this step."""
    low, high = float(min(a, b)), float(max(a, b))
    for r in range(RULE.shape[0]):
        if RULE[r, 0] == low and RULE[r, 1] == high:
            return RULE[r, 2] < 0.0
    return False


@uncounted
def law(SHAPE: FloatArray, RULE: FloatArray, a: int, b: int) -> tuple[float, float, float, float]:
    """Elasticity, friction, and surface velocity (x, y) of b relative to a."""
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

"""First instants at which a gap closes, in closed form and without cancellation; infinite if it never does."""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..model.parameters.events import MISS_DISTANCE


@nonallocating
def falling_root(g: float, w: float, alpha: float) -> float:
    """First root of g + w s + alpha s² / 2 = 0 in s >= 0 with the gap falling; 0 in overlap that deepens.

    The falling root is 2 g / (sqrt(D) - w) with D = w² - 2 alpha g for w < 0, and (w + sqrt(D)) / -alpha for w >= 0 >
    alpha: the gap opens first, and the acceleration closes it again. In overlap without a real root the result is the
    time at which the gap has its present value again. A gap of 0 with w = 0 closes now for alpha < 0, never for
    alpha >= 0.

    Args:
        g: gap, length.  w: its rate, length/time.  alpha: its constant second derivative, length/time². If alpha is
            only a lower bound of the second derivative, the root is a lower bound of the instant.
    """
    if w < 0.0:
        if g <= 0.0:
            return 0.0
        D = w * w - 2.0 * alpha * g
        if D < 0.0:
            return math.inf
        return 2.0 * g / (math.sqrt(D) - w)
    if alpha < 0.0:
        D = w * w - 2.0 * alpha * g
        if D < 0.0:
            D = w * w
        return (w + math.sqrt(D)) / -alpha
    return math.inf


@nonallocating
def disks_meet(dx: float, dy: float, ux: float, uy: float, extent: float) -> float:
    """First root of |d + u s| = extent in s >= 0 with the distance falling; 0 for circles that overlap and approach.

    With b = d . u < 0 the root is s = c / (sqrt(D) - b), c = |d|² - extent² and D = b² - |u|² c. The discriminant
    D = |u|² extent² - (d x u)², taken as a product of a sum and a difference, keeps its digits for grazing hits.
    Exchanging the two circles changes no bit.

    Args:
        dx, dy: from centre a to centre b, length.  ux, uy: relative velocity, constant.  extent: sum of the radii.
    """
    b = dx * ux + dy * uy
    if b >= 0.0:
        return math.inf
    cross = abs(dx * uy - dy * ux)
    squared = ux * ux + uy * uy
    # Most miss each other, which needs no root.
    if cross * cross > MISS_DISTANCE * extent * extent * squared:
        return math.inf
    reach = math.sqrt(squared) * extent
    if cross >= reach:
        return math.inf
    d = math.sqrt(dx * dx + dy * dy)
    s = (d - extent) * (d + extent) / (math.sqrt((reach - cross) * (reach + cross)) - b)
    return s if s > 0.0 else 0.0

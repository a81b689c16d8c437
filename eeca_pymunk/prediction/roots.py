"""First instants at which a gap closes, in closed form and without cancellation; infinity where it never does."""

from __future__ import annotations

import math

from ..compiled import uncounted


@uncounted
def flat(g: float, w: float, alpha: float) -> float:
    """First root of g + w s + alpha s² / 2 = 0 in s >= 0 with the gap falling; 0 in overlap that deepens.

    The falling root is 2 g / (sqrt(D) - w) with D = w² - 2 alpha g for w < 0, and (w + sqrt(D)) / -alpha for w >= 0 >
    alpha: the gap opens first, and the pull closes it again. In overlap a gap that never opens closes again when it is
    back where it was. A gap of 0 that neither opens nor closes is closed by a pull now, and never without.

    Args:
        g: gap, length.  w: its rate, length/time.  alpha: the rate's rate, constant, length/time²: of a gap that is
            only known to bend down by no more than that, this root is a bound from below.
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


@uncounted
def ball_point(dx: float, dy: float, ux: float, uy: float, extent: float) -> float:
    """First root of |d + u s| = extent in s >= 0 with the distance falling; 0 for circles that overlap and approach.

    With b = d . u < 0 the root is s = c / (sqrt(D) - b), c = |d|² - extent² and D = b² - |u|² c. The discriminant
    D = |u|² extent² - (d x u)², taken as a product of a sum and a difference, keeps its digits for grazing hits.
    No bit depends on the sign of d and u together.

    Args:
        dx, dy: from centre a to centre b, length.  ux, uy: relative velocity, constant.  extent: sum of the radii.
    """
    b = dx * ux + dy * uy
    if b >= 0.0:
        return math.inf
    cross = abs(dx * uy - dy * ux)
    squared = ux * ux + uy * uy
    # Most pass far from one another, which needs no root.
    if cross * cross > 1.000001 * extent * extent * squared:
        return math.inf
    reach = math.sqrt(squared) * extent
    if cross >= reach:
        return math.inf
    d = math.sqrt(dx * dx + dy * dy)
    s = (d - extent) * (d + extent) / (math.sqrt((reach - cross) * (reach + cross)) - b)
    return s if s > 0.0 else 0.0

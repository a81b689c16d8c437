"""Time until which two shapes are certainly apart, from circles around them: most pairs need no search."""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..geometry.convex import place_vertices, point_core
from ..geometry.flight import pose, rate, rotated
from ..model.scene import Scene
from .circles import circle_circle, circle_outline
from .roots import falling_root


@nonallocating
def circles_meet(A: Scene, a: int, b: int, start: float, duration: float, tolerance: float) -> float:
    """Time after `start` until which shapes a < b are certainly apart; infinite if they never meet.

    Circles about the centres of mass, of radius `extent`, which do not rotate, are compared; a static shape counts with
    its outline. 0 if they overlap. `tolerance` and `duration` as in `circles.circle_circle`.
    """
    BODY, SHAPE, LINK = A.BODY, A.SHAPE, A.LINK
    ground = BODY.shape[0] - 1
    i, j = LINK[a].owner, LINK[b].owner
    x_a, y_a, _ = pose(BODY, i, start)
    ux_a, uy_a, _ = rate(BODY, i, start)
    if j == ground:
        q = place_vertices(A, b, 0.0, 0.0, 0.0, A.CORE[1])
        extent = SHAPE[a].extent + SHAPE[b].rounding
        if point_core(x_a, y_a, A.CORE[1], q)[0] - extent <= tolerance:
            return 0.0
        return circle_outline(x_a, y_a, ux_a, uy_a, BODY[i].ax, BODY[i].ay, extent, tolerance, A, b, duration)[0]
    x_b, y_b, _ = pose(BODY, j, start)
    ux_b, uy_b, _ = rate(BODY, j, start)
    dx, dy = x_b - x_a, y_b - y_a
    extent = SHAPE[a].extent + SHAPE[b].extent
    if math.sqrt(dx * dx + dy * dy) - extent <= tolerance:
        return 0.0
    ax, ay = BODY[j].ax - BODY[i].ax, BODY[j].ay - BODY[i].ay
    return circle_circle(dx, dy, ux_b - ux_a, uy_b - uy_a, ax, ay, extent, tolerance, duration)[0]


@nonallocating
def carried_circle(A: Scene, s: int, start: float, duration: float) -> tuple[float, float, float, float, float]:
    """Centre (2) and velocity (2) at `start` of the bounding circle of shape s on its rotating body, and a bound of the
    acceleration (length/time²) by rotation within the time `duration`."""
    BODY, i = A.BODY, A.LINK[s].owner
    x, y, angle = pose(BODY, i, start)
    ux, uy, w = rate(BODY, i, start)
    px, py = rotated(A.SHAPE[s].centre_x, A.SHAPE[s].centre_y, angle)
    twist = abs(BODY[i].angular)
    most = abs(w) + twist * duration
    return x + px, y + py, ux - w * py, uy + w * px, math.sqrt(px * px + py * py) * (most * most + twist)


@nonallocating
def carried_circles_meet(A: Scene, a: int, b: int, start: float, duration: float) -> float:
    """Time after `start` until which the bounding circles of shapes a and b are certainly apart. Tighter than
    `circles_meet` for shapes far from their centres of mass. A result above `duration` is valid only if neither body
    has angular acceleration; else the shapes are apart up to `duration`."""
    x_a, y_a, ux_a, uy_a, bend_a = carried_circle(A, a, start, duration)
    x_b, y_b, ux_b, uy_b, bend_b = carried_circle(A, b, start, duration)
    BODY, SHAPE, i, j = A.BODY, A.SHAPE, A.LINK[a].owner, A.LINK[b].owner
    dx, dy = x_b - x_a, y_b - y_a
    d = math.sqrt(dx * dx + dy * dy)
    gap = d - SHAPE[a].bound - SHAPE[b].bound
    if gap <= 0.0:
        return 0.0
    pull = math.sqrt((BODY[j].ax - BODY[i].ax) ** 2 + (BODY[j].ay - BODY[i].ay) ** 2)
    return falling_root(gap, ((ux_b - ux_a) * dx + (uy_b - uy_a) * dy) / d, -(pull + bend_a + bend_b))

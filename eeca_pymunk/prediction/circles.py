"""When a circle meets another one, or a static outline, on parabolic paths.

Straight relative paths, and flat sides under constant acceleration, have closed forms. Round ends under acceleration a
have no cheap one (a quartic). There the bound g + g' s - |a| s² / 2 <= gap(s), which holds because the distance of
convex sets is a convex function of a translation, leads to the first root from below. No root is missed, and the
iteration, a Newton method from below, converges quadratically.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..model.parameters.events import ADVANCES, RESOLUTION, SEARCH_AHEAD
from ..model.scene import Scene
from .roots import disks_meet, falling_root


@nonallocating
def circle_circle(
    dx: float, dy: float, ux: float, uy: float, ax: float, ay: float, extent: float, tolerance: float, duration: float
) -> tuple[float, bool]:
    """Time s at which |d + u s + a s² / 2| = extent with the distance falling, and whether it is exact or a lower
    bound.

    Args:
        dx, dy: from centre to centre, length.  ux, uy: relative velocity.  ax, ay: relative acceleration.
        extent: sum of the radii.  tolerance: length, a gap that counts as closed.
        duration: finite time up to which is searched; lower bounds are at least that. After ADVANCES looks a search
            is given up, and an impact before `duration` may be missed.
    """
    if ax == 0.0 and ay == 0.0:
        return disks_meet(dx, dy, ux, uy, extent), True
    if duration > 0.0:
        later = SEARCH_AHEAD * duration
        reach = extent + (abs(ux) + abs(uy) + 0.5 * (abs(ax) + abs(ay)) * later) * later
        if dx * dx + dy * dy > reach * reach:
            return later, False
    pull = math.sqrt(ax * ax + ay * ay)
    s, stride = 0.0, duration / RESOLUTION
    for _ in range(ADVANCES):
        x, y = dx + (ux + 0.5 * ax * s) * s, dy + (uy + 0.5 * ay * s) * s
        vx, vy = ux + ax * s, uy + ay * s
        d = math.sqrt(x * x + y * y)
        gap = d - extent
        w = (x * vx + y * vy) / d if d > 0.0 else math.sqrt(vx * vx + vy * vy)
        step = falling_root(gap, w, -pull)
        if gap <= tolerance:
            if w < 0.0:
                return s + step, True
            step = max(step, stride)
        s += step
        if s > duration:
            return s, False
    return duration, False


@nonallocating
def circle_outline(
    x: float, y: float, vx: float, vy: float, ax: float, ay: float, extent: float, tolerance: float,
    A: Scene, b: int, duration: float,
) -> tuple[float, bool]:  # fmt: skip
    """Time at which a circle meets the static shape b, and whether it is exact or a lower bound.

    The outline is the region inside all its sides, moved outward by `extent`, with round corners. The circle is apart
    at least until its centre is behind every side that it is in front of now; each side is a quadratic equation. If the
    centre passes the last of these sides beside its edge, that is the impact. Otherwise the corner may be hit: a closed
    form for straight paths, else the bound above. Centres inside a polygon leave through the nearest side.

    Args:
        x, y: centre, length.  vx, vy: velocity.  ax, ay: acceleration.  extent: radius and b's rounding together.
        tolerance, duration: as in `circle_circle`.
    """
    VERTEX, first, count = A.VERTEX, A.LINK[b].first, A.LINK[b].vertices
    sides = count if count > 1 else 0
    straight = ax == 0.0 and ay == 0.0
    pull = math.sqrt(ax * ax + ay * ay)
    s, stride = 0.0, duration / RESOLUTION
    for _ in range(ADVANCES):
        px, py = x + (vx + 0.5 * ax * s) * s, y + (vy + 0.5 * ay * s) * s
        ux, uy = vx + ax * s, vy + ay * s
        entry, last = 0.0, -1
        apart, near = -math.inf, 0
        for j in range(sides):
            nx, ny = VERTEX[first + j, 2], VERTEX[first + j, 3]
            h = (px - VERTEX[first + j, 0]) * nx + (py - VERTEX[first + j, 1]) * ny
            if h > apart:
                apart, near = h, j
            if h - extent >= -tolerance:
                enters = falling_root(h - extent, ux * nx + uy * ny, ax * nx + ay * ny)
                if enters == math.inf:
                    return math.inf, True
                if enters >= entry:
                    entry, last = enters, j
        corner, beside = first, False
        nx, ny = 0.0, 0.0
        if sides > 0:
            edge, qx, qy = near, px, py
            if last >= 0:
                edge, qx, qy = last, px + (ux + 0.5 * ax * entry) * entry, py + (uy + 0.5 * ay * entry) * entry
            corner, beside = beside_edge(VERTEX, first, count, edge, qx, qy)
            if last >= 0:
                if beside:
                    return s + entry, True
                if not straight:
                    corner, beside = beside_edge(VERTEX, first, count, near, px, py)
            nx, ny = VERTEX[first + near, 2], VERTEX[first + near, 3]
        if straight:
            if beside:  # in overlap
                return (0.0 if ux * nx + uy * ny < 0.0 else math.inf), True
            return disks_meet(px - VERTEX[corner, 0], py - VERTEX[corner, 1], ux, uy, extent), True
        gap = apart - extent
        if not beside:
            dx, dy = px - VERTEX[corner, 0], py - VERTEX[corner, 1]
            d = math.sqrt(dx * dx + dy * dy)
            gap = d - extent
            if d > 0.0:
                nx, ny = dx / d, dy / d
        w = ux * nx + uy * ny
        step = falling_root(gap, w, -pull)
        if gap <= tolerance:
            if w < 0.0:
                return s + step, True
            step = max(step, stride)
        s += max(step, entry)
        if s > duration:
            return s, False
    return duration, False


@nonallocating
def beside_edge(VERTEX: FloatArray, first: int, count: int, edge: int, x: float, y: float) -> tuple[int, bool]:
    """The end of an outline's edge (row of VERTEX) that is nearer in direction to a point, and whether the foot of the
    point lies on the edge."""
    start = first + edge
    end = start + 1 if edge + 1 < count else first
    ex, ey = VERTEX[end, 0] - VERTEX[start, 0], VERTEX[end, 1] - VERTEX[start, 1]
    along = (x - VERTEX[start, 0]) * ex + (y - VERTEX[start, 1]) * ey
    if along < 0.0:
        return start, False
    return end, along <= ex * ex + ey * ey

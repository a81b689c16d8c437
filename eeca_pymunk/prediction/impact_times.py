"""When two shapes meet next if nothing else happens to their bodies.

A forecast is a function of the two paths alone, from the later of their two SINCE on, and the same for (a, b) and
(b, a). The second result tells whether the instant is when they meet (infinity: never), or only one before which
they do not, to be looked at again then; it is no earlier than the horizon. Instants count from the start of the step.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.parameters.detection import GAP_ROUND_OFF
from ..model.parameters.events import APPROACH_ROUND_OFF, DISTANCE_ROUND_OFF, MISS_DISTANCE, PATH_REACH
from ..model.shapes import Link, Shape
from .circles import circle_circle, circle_outline
from .roots import ball_point
from .turning import general


@uncounted
def passes(dx: float, dy: float, ux: float, uy: float, extent: float, left: float) -> bool:
    """Whether disks at a distance d and of relative velocity u part, pass far from one another, or are too far away to
    meet within `left`: for certain. Most do, which needs no root: the first one of |d + u s| = extent is at
    s >= c / (2 |d.u|), c = |d|² - extent²."""
    closing, cross, squared = -(dx * ux + dy * uy), dx * uy - dy * ux, extent * extent
    far = dx * dx + dy * dy - PATH_REACH * squared > 2.0 * PATH_REACH * closing * left
    return bool((closing <= 0.0) | (cross * cross > MISS_DISTANCE * squared * (ux * ux + uy * uy)) | far)


@uncounted
def one_pull(
    since_i: float, x_i: float, y_i: float, vx_i: float, vy_i: float, since_j: float, x_j: float, y_j: float,
    vx_j: float, vy_j: float, ax: float, ay: float, extent: float, latest: float,
) -> float:  # fmt: skip
    """Instant at which two disks meet that one acceleration pulls, which cancels; closed form. Disks that touch and
    approach by the round-off of their speeds do not: they part. Infinity if that is certainly after `latest`."""
    # Every other pair is the other way round: what is 0 for one of the two is faster computed than asked for.
    start = max(since_i, since_j)
    g, h = start - since_i, start - since_j
    dx = (x_j + (vx_j + 0.5 * h * ax) * h) - (x_i + (vx_i + 0.5 * g * ax) * g)
    dy = (y_j + (vy_j + 0.5 * h * ay) * h) - (y_i + (vy_i + 0.5 * g * ay) * g)
    ux, uy = (vx_j + h * ax) - (vx_i + g * ax), (vy_j + h * ay) - (vy_i + g * ay)
    closing = -(dx * ux + dy * uy)
    squared = extent * extent
    if passes(dx, dy, ux, uy, extent, latest - start):
        return math.inf
    if closing < APPROACH_ROUND_OFF * extent * (abs(vx_i) + abs(vy_i) + abs(vx_j) + abs(vy_j)):
        if dx * dx + dy * dy < squared * (1.0 + DISTANCE_ROUND_OFF):
            return math.inf
    return start + ball_point(dx, dy, ux, uy, extent)


@uncounted
def disk_disk(BODY: Rows[Body], i: int, j: int, horizon: float) -> tuple[float, bool]:
    """Lone disks i and j: in closed form where one acceleration pulls both."""
    since_i, since_j = BODY[i].since, BODY[j].since
    x_i, y_i, vx_i, vy_i, ax_i, ay_i = BODY[i].x, BODY[i].y, BODY[i].vx, BODY[i].vy, BODY[i].ax, BODY[i].ay
    x_j, y_j, vx_j, vy_j, ax_j, ay_j = BODY[j].x, BODY[j].y, BODY[j].vx, BODY[j].vy, BODY[j].ax, BODY[j].ay
    extent = BODY[i].extent + BODY[j].extent
    if ax_i == ax_j and ay_i == ay_j:
        t = one_pull(since_i, x_i, y_i, vx_i, vy_i, since_j, x_j, y_j, vx_j, vy_j, ax_i, ay_i, extent, math.inf)
        return t, True
    start = max(since_i, since_j)
    s = start - since_i
    x_i, y_i = x_i + (vx_i + 0.5 * s * ax_i) * s, y_i + (vy_i + 0.5 * s * ay_i) * s
    vx_i, vy_i = vx_i + s * ax_i, vy_i + s * ay_i
    s = start - since_j
    x_j, y_j = x_j + (vx_j + 0.5 * s * ax_j) * s, y_j + (vy_j + 0.5 * s * ay_j) * s
    vx_j, vy_j = vx_j + s * ax_j, vy_j + s * ay_j
    far = max(max(abs(x_i), abs(y_i)), max(abs(x_j), abs(y_j)))
    t, certain = circle_circle(
        x_j - x_i, y_j - y_i, vx_j - vx_i, vy_j - vy_i, ax_j - ax_i, ay_j - ay_i, extent,
        GAP_ROUND_OFF * (far + extent), max(horizon - start, 0.0),
    )  # fmt: skip
    return start + t, certain or t == math.inf


@uncounted
def disk_wall(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, i: int, b: int, horizon: float
) -> tuple[float, bool]:
    """Lone disk i and a static shape b: in closed form, but for round ends under a pull."""
    x, y, since = BODY[i].x, BODY[i].y, BODY[i].since
    extent = BODY[i].extent + SHAPE[b].rounding
    tolerance = GAP_ROUND_OFF * (max(abs(x), abs(y)) + extent)
    t, certain = circle_outline(
        x, y, BODY[i].vx, BODY[i].vy, BODY[i].ax, BODY[i].ay, extent, tolerance, LINK, VERTEX, b,
        max(horizon - since, 0.0),
    )  # fmt: skip
    return since + t, certain or t == math.inf


@uncounted
def meet(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, WORK: FloatArray,
    a: int, b: int, disks: int, horizon: float, held: float,
) -> tuple[float, bool]:  # fmt: skip
    """Instant at which shapes a and b meet next, and whether they do; `disks` lone disks have the first numbers.

    Args:
        WORK: (2, K, 4) scratch, K the most vertices of a shape.
        horizon: instant until which the caller wants to know; finite, but for lone disks.
        held: speed up to which corners that touch stay where they are, as forces hold them; below 0 for none.
    """
    if a > b:
        a, b = b, a
    if a < disks:
        if b < disks:
            return disk_disk(BODY, a, b, horizon)
        if LINK[b].owner == BODY.shape[0] - 1:
            return disk_wall(BODY, SHAPE, LINK, VERTEX, a, b, horizon)
    return general(BODY, SHAPE, LINK, VERTEX, WORK, a, b, disks, horizon, held)

"""When two shapes meet next if no impulse acts before.

Results (t, certain) are functions of the two paths only, from the later `Body.since` on, and equal for (a, b) and
(b, a). Certain: the shapes meet at t, never if t is infinite. Not certain: they do not meet before t, which is no
earlier than the horizon, or than the instant until which the search was asked for, unless the work of the step is
spent. Instants count from the start of the step.
"""

from __future__ import annotations

import math

from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..geometry.flight import pose, rate
from ..geometry.gap import gap_round_off
from ..model.bodies import Body
from ..model.parameters.detection import GAP_ROUND_OFF
from ..model.parameters.events import APPROACH_ROUND_OFF, DISTANCE_ROUND_OFF, MISS_DISTANCE, PATH_REACH
from ..model.scene import Scene
from ..pairs.passing import flush
from .circles import circle_circle, circle_outline
from .roots import disks_meet
from .search import general


@nonallocating
def certainly_apart(dx: float, dy: float, ux: float, uy: float, extent: float, duration: float) -> bool:
    """Whether disks with the vector d from centre to centre, relative velocity u and sum of radii `extent` certainly
    part, miss each other, or are too far away to meet within the time `duration`. True for most pairs, and found
    without a root, as the first one of |d + u s| = extent is at s >= c / (2 |d.u|), c = |d|² - extent²."""
    closing, cross, squared = -(dx * ux + dy * uy), dx * uy - dy * ux, extent * extent
    far = dx * dx + dy * dy - PATH_REACH * squared > 2.0 * PATH_REACH * closing * duration
    return bool((closing <= 0.0) | (cross * cross > MISS_DISTANCE * squared * (ux * ux + uy * uy)) | far)


@inlined
def between(BODY: Rows[Body], i: int, j: int, t: float, ax: float, ay: float) -> tuple[float, float, float, float]:
    """The vector (2) from body i to body j at instant t, and their relative velocity (2), for equal accelerations a.
    One of the two paths begins at t; computing its terms, which are 0, costs less than a branch."""
    g, h = t - BODY[i].since, t - BODY[j].since
    dx = (BODY[j].x + (BODY[j].vx + 0.5 * h * ax) * h) - (BODY[i].x + (BODY[i].vx + 0.5 * g * ax) * g)
    dy = (BODY[j].y + (BODY[j].vy + 0.5 * h * ay) * h) - (BODY[i].y + (BODY[i].vy + 0.5 * g * ay) * g)
    return dx, dy, (BODY[j].vx + h * ax) - (BODY[i].vx + g * ax), (BODY[j].vy + h * ay) - (BODY[i].vy + g * ay)


@inlined
def misses(BODY: Rows[Body], i: int, j: int, ax: float, ay: float, latest: float) -> bool:
    """Whether single disks i and j with equal accelerations a certainly part, miss each other, or are too far away to
    meet until `latest`. Never true if `meet_in_free_fall` is finite. Without branches."""
    start = max(BODY[i].since, BODY[j].since)
    dx, dy, ux, uy = between(BODY, i, j, start, ax, ay)
    return certainly_apart(dx, dy, ux, uy, BODY[i].extent + BODY[j].extent, latest - start)


@nonallocating
def meet_in_free_fall(BODY: Rows[Body], i: int, j: int, latest: float) -> float:
    """Instant at which single disks i and j with equal accelerations, which cancel, meet; closed form. Disks that touch
    and approach by no more than the round-off of their speeds count as parting. Infinite if the instant is certainly
    after `latest`."""
    start = max(BODY[i].since, BODY[j].since)
    dx, dy, ux, uy = between(BODY, i, j, start, BODY[i].ax, BODY[i].ay)
    extent = BODY[i].extent + BODY[j].extent
    if certainly_apart(dx, dy, ux, uy, extent, latest - start):
        return math.inf
    fastest = abs(BODY[i].vx) + abs(BODY[i].vy) + abs(BODY[j].vx) + abs(BODY[j].vy)
    if -(dx * ux + dy * uy) < APPROACH_ROUND_OFF * extent * fastest:
        if dx * dx + dy * dy < extent * extent * (1.0 + DISTANCE_ROUND_OFF):
            return math.inf
    return start + disks_meet(dx, dy, ux, uy, extent)


@nonallocating
def disk_disk(BODY: Rows[Body], i: int, j: int, horizon: float) -> tuple[float, bool]:
    """(t, certain) of single disks i and j: a closed form if their accelerations are equal."""
    ax_i, ay_i, ax_j, ay_j = BODY[i].ax, BODY[i].ay, BODY[j].ax, BODY[j].ay
    if ax_i == ax_j and ay_i == ay_j:
        return meet_in_free_fall(BODY, i, j, math.inf), True
    start, extent = max(BODY[i].since, BODY[j].since), BODY[i].extent + BODY[j].extent
    x_i, y_i, _ = pose(BODY, i, start)
    x_j, y_j, _ = pose(BODY, j, start)
    vx_i, vy_i, _ = rate(BODY, i, start)
    vx_j, vy_j, _ = rate(BODY, j, start)
    far = max(max(abs(x_i), abs(y_i)), max(abs(x_j), abs(y_j)))
    t, certain = circle_circle(
        x_j - x_i, y_j - y_i, vx_j - vx_i, vy_j - vy_i, ax_j - ax_i, ay_j - ay_i, extent,
        GAP_ROUND_OFF * (far + extent), max(horizon - start, 0.0),
    )  # fmt: skip
    return start + t, certain


@nonallocating
def disk_wall(A: Scene, i: int, b: int, horizon: float) -> tuple[float, bool]:
    """(t, certain) of single disk i and a static shape b: a closed form, except for round ends under acceleration."""
    body = A.BODY[i]
    extent = body.extent + A.SHAPE[b].rounding
    t, certain = circle_outline(
        body.x, body.y, body.vx, body.vy, body.ax, body.ay, extent, gap_round_off(A, i, b), A, b,
        max(horizon - body.since, 0.0),
    )  # fmt: skip
    return body.since + t, certain


@nonallocating
def time_of_impact(A: Scene, a: int, b: int, horizon: float, latest: float) -> tuple[float, bool]:
    """(t, certain) of shapes a and b, see the module; searched up to a finite instant `horizon`. A search ends at
    instant `latest`, with a later lower bound: it does not matter to the caller what comes after. Shapes that pass a
    corner of one another do not meet there."""
    if a > b:
        a, b = b, a
    disks = A.COUNT.disks
    if b < disks:
        return disk_disk(A.BODY, a, b, horizon)
    if a < disks and A.LINK[b].owner == A.BODY.shape[0] - 1:
        t, certain = disk_wall(A, a, b, horizon)
    else:
        t, certain = general(A, a, b, horizon, latest)
    if certain and t <= horizon and flush(A, a, b, t).passes:
        return horizon, False  # an impact there would have no impulse, and be the next one for ever
    return t, certain

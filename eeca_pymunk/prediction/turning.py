"""When shapes that turn, or are carried, meet: from bounds of the motion of their vertices.

Shapes are apart where they are apart along some axis. Along an axis n the least gap of some points bounds that of the
shapes, and a point's gap g with rate g' stays above g + g' s - B s² / 2 if nothing on the path bends it by more than
B. So each axis gives an instant before which the shapes are apart, and the latest of these is a safe place to look
again. Three axes: the normal as it stands in space now, with the vertices of both shapes; and the normals of the
edges of a and of b along which they are farthest apart, which turn with their bodies, with the other one's vertices.

Bounds until the horizon, with r the reach of a core about its centre of mass, w the spin, q its rate, A the relative
acceleration of the centres, V their relative speed, and L their distance:

    fixed axis        B = A + sum of r (w² + q) of both,
    axis of body a    B = A + r_b (w_b² + q_b) + 2 w_a (V + w_b r_b) + (w_a² + q_a) (L + r_b).

Shapes have met where points close along all axes on which they touch.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..geometry.convex import place
from ..geometry.flight import pose, rate
from ..geometry.gap import touching
from ..geometry.sides import closest_on_side, known_side, near_side, note_side, remembers
from ..model.bodies import Body
from ..model.parameters.events import ADVANCES, STRIDE
from ..model.shapes import Link, Shape
from .bounds import carried_circles_meet, circles_meet
from .roots import flat


@uncounted
def first_close(
    best: float, near: float, closing: bool, g: float, w: float, bend: float, tolerance: float, held: float
) -> tuple[float, float, bool]:
    """Take one more point with gap g and rate w into an axis: the first instant at which one may close, the least gap,
    and whether one touches and closes. A point that touches and moves no faster than `held` stays where it is."""
    near = min(near, g)
    if g <= tolerance:
        if abs(w) <= held:
            return best, near, closing
        closing = closing or w < 0.0
    # The bound's one root is before `best` where the bound is negative there.
    if best == math.inf or g + (w - 0.5 * bend * best) * best < 0.0:
        best = min(best, flat(g, w, -bend))
    return best, near, closing


@uncounted
def fixed_axis(
    P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float,
    x_a: float, y_a: float, ux_a: float, uy_a: float, w_a: float,
    x_b: float, y_b: float, ux_b: float, uy_b: float, w_b: float,
    extent: float, bend: float, tolerance: float, held: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """`first_close` of all vertices of a against all of b along the normal as it stands."""
    best, near, closing = math.inf, math.inf, False
    for i in range(p):
        x, y = P[i, 0], P[i, 1]
        vx, vy = ux_a - w_a * (y - y_a), uy_a + w_a * (x - x_a)
        for j in range(q):
            g = (Q[j, 0] - x) * nx + (Q[j, 1] - y) * ny - extent
            w = (ux_b - w_b * (Q[j, 1] - y_b) - vx) * nx + (uy_b + w_b * (Q[j, 0] - x_b) - vy) * ny
            best, near, closing = first_close(best, near, closing, g, w, bend, tolerance, held)
    return best, near, closing


@uncounted
def turning_axis(
    P: FloatArray, edge: int, Q: FloatArray, q: int,
    x_a: float, y_a: float, ux_a: float, uy_a: float, w_a: float,
    x_b: float, y_b: float, ux_b: float, uy_b: float, w_b: float,
    extent: float, bend: float, tolerance: float, held: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """`first_close` of the vertices of b against an edge of a: rates are relative to a's matter at that place."""
    best, near, closing = math.inf, math.inf, False
    nx, ny = P[edge, 2], P[edge, 3]
    for j in range(q):
        x, y = Q[j, 0], Q[j, 1]
        g = (x - P[edge, 0]) * nx + (y - P[edge, 1]) * ny - extent
        w = (ux_b - w_b * (y - y_b) - (ux_a - w_a * (y - y_a))) * nx
        w += (uy_b + w_b * (x - x_b) - (uy_a + w_a * (x - x_a))) * ny
        best, near, closing = first_close(best, near, closing, g, w, bend, tolerance, held)
    return best, near, closing


@uncounted
def reach_of(BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], s: int) -> tuple[float, float, float]:
    """A point of the body of shape s, relative to its centre of mass, and the reach of the shape about it: the centre
    of mass itself, but for what stands on the ground the shape's own centre."""
    if LINK[s].owner == BODY.shape[0] - 1:
        return SHAPE[s].centre_x, SHAPE[s].centre_y, SHAPE[s].bound
    return 0.0, 0.0, SHAPE[s].extent


@uncounted
def bends(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], a: int, b: int, start: float, left: float
) -> tuple[float, float, float]:
    """The bounds B (length/time²) of the fixed axis and those of a and b, from `start` on for `left`."""
    i, j = LINK[a].owner, LINK[b].owner
    x_a, y_a, _ = pose(BODY, i, start)
    x_b, y_b, _ = pose(BODY, j, start)
    ux_a, uy_a, w_a = rate(BODY, i, start)
    ux_b, uy_b, w_b = rate(BODY, j, start)
    q_a, q_b = abs(BODY[i].angular), abs(BODY[j].angular)
    w_a, w_b = abs(w_a) + q_a * left, abs(w_b) + q_b * left
    px_a, py_a, r_a = reach_of(BODY, SHAPE, LINK, a)
    px_b, py_b, r_b = reach_of(BODY, SHAPE, LINK, b)
    r_a, r_b = max(r_a - SHAPE[a].rounding, 0.0), max(r_b - SHAPE[b].rounding, 0.0)
    A = math.sqrt((BODY[j].ax - BODY[i].ax) ** 2 + (BODY[j].ay - BODY[i].ay) ** 2)
    V = math.sqrt((ux_b - ux_a) ** 2 + (uy_b - uy_a) ** 2) + A * left
    L = math.sqrt((x_b + px_b - x_a - px_a) ** 2 + (y_b + py_b - y_a - py_a) ** 2) + V * left
    around_a, around_b = r_a * (w_a * w_a + q_a), r_b * (w_b * w_b + q_b)
    of_a = A + around_b + 2.0 * w_a * (V + w_b * r_b) + (w_a * w_a + q_a) * (L + r_b)
    of_b = A + around_a + 2.0 * w_b * (V + w_a * r_a) + (w_b * w_b + q_b) * (L + r_a)
    return A + around_a + around_b, of_a, of_b


@uncounted
def pressed(BODY: Rows[Body], i: int, j: int, t: float, nx: float, ny: float, px: float, py: float) -> float:
    """When bodies that touch at a point, and there part with u >= 0 or rest, are back: 2 u / a_n if the point's
    acceleration closes by a_n > 0; infinity else."""
    x_a, y_a, _ = pose(BODY, i, t)
    x_b, y_b, _ = pose(BODY, j, t)
    ux_a, uy_a, w_a = rate(BODY, i, t)
    ux_b, uy_b, w_b = rate(BODY, j, t)
    rx_a, ry_a, rx_b, ry_b = px - x_a, py - y_a, px - x_b, py - y_b
    q_a, q_b = BODY[i].angular, BODY[j].angular
    u = nx * (ux_b - w_b * ry_b - ux_a + w_a * ry_a) + ny * (uy_b + w_b * rx_b - uy_a - w_a * rx_a)
    ax = BODY[j].ax - q_b * ry_b - w_b * w_b * rx_b - (BODY[i].ax - q_a * ry_a - w_a * w_a * rx_a)
    ay = BODY[j].ay + q_b * rx_b - w_b * w_b * ry_b - (BODY[i].ay + q_a * rx_a - w_a * w_a * ry_a)
    closing = -(nx * ax + ny * ay)
    return 2.0 * max(u, 0.0) / closing if closing > 0.0 else math.inf


@uncounted
def leaving(
    BODY: Rows[Body], i: int, j: int, t: float, nx: float, ny: float, px: float, py: float
) -> tuple[float, float]:  # fmt: skip
    """The rate with which bodies part along the normal n, and the acceleration with which they are pressed together."""
    x_a, y_a, _ = pose(BODY, i, t)
    x_b, y_b, _ = pose(BODY, j, t)
    ux_a, uy_a, w_a = rate(BODY, i, t)
    ux_b, uy_b, w_b = rate(BODY, j, t)
    u = nx * (ux_b - w_b * (py - y_b) - ux_a + w_a * (py - y_a))
    u += ny * (uy_b + w_b * (px - x_b) - uy_a - w_a * (px - x_a))
    return u, nx * (BODY[i].ax - BODY[j].ax) + ny * (BODY[i].ay - BODY[j].ay)


@uncounted
def begin_side(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, WORK: FloatArray, a: int, b: int,
    start: float, left: float, tolerance: float,
) -> None:  # fmt: skip
    """Note on which side of each other thin shapes a < b begin.

    Segments that were put flush on one another, which have no inside to tell, rest where they are pressed together if
    they move by less than `tolerance` (length) in the time `left`. If they move, and their distance is round-off too,
    they are where they part. Of all else the geometry tells the side.
    """
    i, j = LINK[a].owner, LINK[b].owner
    x_a, y_a, angle_a = pose(BODY, i, start)
    x_b, y_b, angle_b = pose(BODY, j, start)
    p = place(LINK, VERTEX, a, x_a, y_a, angle_a, WORK[0])
    q = place(LINK, VERTEX, b, x_b, y_b, angle_b, WORK[1])
    d, nx, ny, px, py, _, _, _, _, _ = closest_on_side(
        SHAPE, LINK, WORK, WORK[0], p, WORK[1], q, a, b
    )  # fmt: skip
    if d > near_side(SHAPE, a, b):
        note_side(SHAPE, LINK, WORK, a, b, nx, ny, False)
    elif not known_side(SHAPE, LINK, WORK, a, b):
        parting, pressing = leaving(BODY, i, j, start, nx, ny, px, py)
        resting = abs(parting) * left <= tolerance
        other = (resting and pressing < 0.0) or (not resting and d <= tolerance and parting < 0.0)
        sign = -1.0 if p == 2 and q == 2 and other else 1.0
        note_side(SHAPE, LINK, WORK, a, b, sign * nx, sign * ny, True)


@uncounted
def general(
    BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, WORK: FloatArray,
    a: int, b: int, disks: int, horizon: float, held: float,
) -> tuple[float, bool]:  # fmt: skip
    """Instant at which any two shapes meet next, and whether they do, or are only known to be apart until then.

    A function of the two paths from the later SINCE on, whatever the order of a and b. Shapes that touch and close
    meet then. Shapes that touch and part do not; they are followed until the horizon, by at least a thousandth of it
    a look, as no bound of theirs is above 0.

    Args:
        horizon: finite instant; lower bounds are no earlier. Of what takes more than 1000 looks at a sixteenth of the
            time until then the rest is given up.
        held: speed up to which points that touch stay where they are, as forces hold them; below 0 for none.
    """
    if a > b:
        a, b = b, a
    i, j = LINK[a].owner, LINK[b].owner
    start = max(BODY[i].since, BODY[j].since)
    left = max(horizon - start, 0.0)
    tolerance = touching(BODY, SHAPE, LINK, a, b, disks)
    s, never = circles_meet(BODY, SHAPE, LINK, VERTEX, WORK, a, b, start, left, tolerance)
    if s > left:
        return start + s, never
    if s == 0.0:
        s = carried_circles_meet(BODY, SHAPE, LINK, a, b, start, left)
        if s > left:
            if BODY[i].angular == 0.0 and BODY[j].angular == 0.0:
                return start + s, s == math.inf
            return horizon, False
    bend, bend_a, bend_b = bends(BODY, SHAPE, LINK, a, b, start, left)
    extent = SHAPE[a].rounding + SHAPE[b].rounding
    P, Q = WORK[0], WORK[1]
    if remembers(LINK, WORK, a, b):
        begin_side(BODY, SHAPE, LINK, VERTEX, WORK, a, b, start, left, tolerance)
    looks, mark = 0, s
    while looks < ADVANCES:
        looks += 1
        if s > mark + STRIDE * left:  # what turns fast is followed for many turns
            looks, mark = 0, s
        x_a, y_a, angle_a = pose(BODY, i, start + s)
        x_b, y_b, angle_b = pose(BODY, j, start + s)
        ux_a, uy_a, w_a = rate(BODY, i, start + s)
        ux_b, uy_b, w_b = rate(BODY, j, start + s)
        p = place(LINK, VERTEX, a, x_a, y_a, angle_a, P)
        q = place(LINK, VERTEX, b, x_b, y_b, angle_b, Q)
        d, nx, ny, px, py, _, edge_a, apart_a, edge_b, apart_b = closest_on_side(SHAPE, LINK, WORK, P, p, Q, q, a, b)
        if d > near_side(SHAPE, a, b):
            note_side(SHAPE, LINK, WORK, a, b, nx, ny, False)
        safe, near, met = fixed_axis(
            P, p, Q, q, nx, ny, x_a, y_a, ux_a, uy_a, w_a, x_b, y_b, ux_b, uy_b, w_b, extent, bend, tolerance, held
        )
        least = min(d - extent, 0.0) - tolerance
        if apart_a - extent >= least:
            may, gap, closes = turning_axis(
                P, edge_a, Q, q, x_a, y_a, ux_a, uy_a, w_a, x_b, y_b, ux_b, uy_b, w_b, extent, bend_a, tolerance, held
            )
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if apart_b - extent >= least:
            may, gap, closes = turning_axis(
                Q, edge_b, P, p, x_b, y_b, ux_b, uy_b, w_b, x_a, y_a, ux_a, uy_a, w_a, extent, bend_b, tolerance, held
            )
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if not met and near <= tolerance:
            back = pressed(BODY, i, j, start + s, nx, ny, px + SHAPE[a].rounding * nx, py + SHAPE[a].rounding * ny)
            if back <= STRIDE * left:
                return start + s + back, True
            safe = max(safe, left / ADVANCES)
        s += safe
        if met:
            return start + s, True
        if s > left:
            return horizon, False
    return horizon, False

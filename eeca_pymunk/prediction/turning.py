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
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..geometry.convex import place
from ..geometry.flight import pose, rate
from ..geometry.gap import touching
from ..geometry.manifold import common_face, face, face_tolerance
from ..geometry.sides import closest_on_side, key_of, known_side, near_side, note_side, remembers, side_row, smaller
from ..model.bodies import Body
from ..model.parameters.events import ADVANCES, APPROACH_ROUND_OFF, DEEP, GRAZED, RESOLUTION
from ..model.scene import Scene
from .bounds import carried_circles_meet, circles_meet
from .roots import flat


class Motion(NamedTuple):
    """Place and velocity of a body at one instant."""

    x: float
    y: float
    angle: float
    vx: float
    vy: float
    spin: float


class Closing(NamedTuple):
    """What the gaps of points along an axis are measured by."""

    extent: float  # gap of the cores where the shapes touch: length
    bend: float  # bound of the second derivative of gaps: length/time²
    tolerance: float  # gap up to which points touch: length
    still: float  # rate up to which points that touch do not close, but by round-off: length/time


@uncounted
def motion(BODY: Rows[Body], i: int, t: float) -> Motion:
    """The motion of body i at instant t."""
    x, y, angle = pose(BODY, i, t)
    vx, vy, spin = rate(BODY, i, t)
    return Motion(x, y, angle, vx, vy, spin)


@uncounted
def first_close(best: float, near: float, closing: bool, g: float, w: float, of: Closing) -> tuple[float, float, bool]:
    """Take one more point with gap g and rate w into an axis: the first instant at which one may close, the least gap,
    and whether one touches and closes."""
    near = min(near, g)
    if g <= of.tolerance:
        closing = closing or w < -of.still
    # The bound's one root is before `best` where the bound is negative there.
    if best == math.inf or g + (w - 0.5 * of.bend * best) * best < 0.0:
        best = min(best, flat(g, w, -of.bend))
    return best, near, closing


@uncounted
def fixed_axis(
    P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float, a: Motion, b: Motion, of: Closing
) -> tuple[float, float, bool]:
    """`first_close` of all vertices of a against all of b along the normal as it stands."""
    best, near, closing = math.inf, math.inf, False
    for i in range(p):
        x, y = P[i, 0], P[i, 1]
        vx, vy = a.vx - a.spin * (y - a.y), a.vy + a.spin * (x - a.x)
        for j in range(q):
            g = (Q[j, 0] - x) * nx + (Q[j, 1] - y) * ny - of.extent
            w = (b.vx - b.spin * (Q[j, 1] - b.y) - vx) * nx + (b.vy + b.spin * (Q[j, 0] - b.x) - vy) * ny
            best, near, closing = first_close(best, near, closing, g, w, of)
    return best, near, closing


@uncounted
def turning_axis(
    P: FloatArray, edge: int, Q: FloatArray, q: int, a: Motion, b: Motion, of: Closing
) -> tuple[float, float, bool]:
    """`first_close` of the vertices of b against an edge of a: rates are relative to a's matter at that place."""
    best, near, closing = math.inf, math.inf, False
    nx, ny = P[edge, 2], P[edge, 3]
    for j in range(q):
        x, y = Q[j, 0], Q[j, 1]
        g = (x - P[edge, 0]) * nx + (y - P[edge, 1]) * ny - of.extent
        w = (b.vx - b.spin * (y - b.y) - (a.vx - a.spin * (y - a.y))) * nx
        w += (b.vy + b.spin * (x - b.x) - (a.vy + a.spin * (x - a.x))) * ny
        best, near, closing = first_close(best, near, closing, g, w, of)
    return best, near, closing


@uncounted
def reach_of(A: Scene, s: int) -> tuple[float, float, float]:
    """A point of the body of shape s, relative to its centre of mass, and the reach of the shape about it: the centre
    of mass itself, but for what stands on the ground the shape's own centre."""
    if A.LINK[s].owner == A.BODY.shape[0] - 1:
        return A.SHAPE[s].centre_x, A.SHAPE[s].centre_y, A.SHAPE[s].bound
    return 0.0, 0.0, A.SHAPE[s].extent


@uncounted
def bends(A: Scene, a: int, b: int, start: float, left: float) -> tuple[float, float, float]:
    """The bounds B (length/time²) of the fixed axis and those of a and b, from `start` on for `left`."""
    one, two = A.BODY[A.LINK[a].owner], A.BODY[A.LINK[b].owner]
    m, n = motion(A.BODY, A.LINK[a].owner, start), motion(A.BODY, A.LINK[b].owner, start)
    q_a, q_b = abs(one.angular), abs(two.angular)
    w_a, w_b = abs(m.spin) + q_a * left, abs(n.spin) + q_b * left
    px_a, py_a, r_a = reach_of(A, a)
    px_b, py_b, r_b = reach_of(A, b)
    r_a, r_b = max(r_a - A.SHAPE[a].rounding, 0.0), max(r_b - A.SHAPE[b].rounding, 0.0)
    pull = math.sqrt((two.ax - one.ax) ** 2 + (two.ay - one.ay) ** 2)
    V = math.sqrt((n.vx - m.vx) ** 2 + (n.vy - m.vy) ** 2) + pull * left
    L = math.sqrt((n.x + px_b - m.x - px_a) ** 2 + (n.y + py_b - m.y - py_a) ** 2) + V * left
    around_a, around_b = r_a * (w_a * w_a + q_a), r_b * (w_b * w_b + q_b)
    of_a = pull + around_b + 2.0 * w_a * (V + w_b * r_b) + (w_a * w_a + q_a) * (L + r_b)
    of_b = pull + around_a + 2.0 * w_b * (V + w_a * r_a) + (w_b * w_b + q_b) * (L + r_a)
    return pull + around_a + around_b, of_a, of_b


@uncounted
def fastest(A: Scene, s: int, t: float) -> float:
    """Bound of the speed of points of shape s at instant t, length/time."""
    i = A.LINK[s].owner
    vx, vy, spin = rate(A.BODY, i, t)
    return abs(vx) + abs(vy) + abs(spin) * A.SHAPE[s].extent


@uncounted
def pressed(BODY: Rows[Body], i: int, j: int, t: float, nx: float, ny: float, px: float, py: float) -> float:
    """When bodies that touch at a point, and there part with u >= 0 or rest, are back: 2 u / a_n if the point's
    acceleration closes by a_n > 0; infinity else."""
    a, b = motion(BODY, i, t), motion(BODY, j, t)
    rx_a, ry_a, rx_b, ry_b = px - a.x, py - a.y, px - b.x, py - b.y
    q_a, q_b = BODY[i].angular, BODY[j].angular
    u = nx * (b.vx - b.spin * ry_b - a.vx + a.spin * ry_a) + ny * (b.vy + b.spin * rx_b - a.vy - a.spin * rx_a)
    ax = BODY[j].ax - q_b * ry_b - b.spin * b.spin * rx_b - (BODY[i].ax - q_a * ry_a - a.spin * a.spin * rx_a)
    ay = BODY[j].ay + q_b * rx_b - b.spin * b.spin * ry_b - (BODY[i].ay + q_a * rx_a - a.spin * a.spin * ry_a)
    closing = -(nx * ax + ny * ay)
    return 2.0 * max(u, 0.0) / closing if closing > 0.0 else math.inf


@uncounted
def leaving(
    BODY: Rows[Body], i: int, j: int, t: float, nx: float, ny: float, px: float, py: float
) -> tuple[float, float]:  # fmt: skip
    """The rate with which bodies part along the normal n, and the acceleration with which they are pressed together."""
    a, b = motion(BODY, i, t), motion(BODY, j, t)
    u = nx * (b.vx - b.spin * (py - b.y) - a.vx + a.spin * (py - a.y))
    u += ny * (b.vy + b.spin * (px - b.x) - a.vy - a.spin * (px - a.x))
    return u, nx * (BODY[i].ax - BODY[j].ax) + ny * (BODY[i].ay - BODY[j].ay)


@kernel
def parts(A: Scene, a: int, b: int, one: Motion, two: Motion, tolerance: float) -> bool:
    """Whether bodies move apart at all points at which an impact of shapes a < b, which overlap, would push them: a
    vertex beside these may close all the same."""
    POSE, OUT = np.empty((2, 3)), np.empty((2, 5))
    POSE[0, 0], POSE[0, 1], POSE[0, 2] = one.x, one.y, one.angle
    POSE[1, 0], POSE[1, 1], POSE[1, 2] = two.x, two.y, two.angle
    apart = True
    for k in range(face(A, a, b, POSE, 0, 1, tolerance, OUT)):
        nx, ny, x, y = OUT[k, 0], OUT[k, 1], OUT[k, 2], OUT[k, 3]
        u = nx * (two.vx - two.spin * (y - two.y) - one.vx + one.spin * (y - one.y))
        u += ny * (two.vy + two.spin * (x - two.x) - one.vy - one.spin * (x - one.x))
        apart = apart and u >= 0.0
    return apart


@uncounted
def begin_side(A: Scene, a: int, b: int, start: float, left: float, tolerance: float) -> None:
    """Note on which side of each other thin shapes a < b begin.

    Segments that were put flush on one another, which have no inside to tell, rest where they are pressed together if
    they move by less than `tolerance` (length) in the time `left`. If they move, and their distance is round-off too,
    they are where they part. Of all else the geometry tells the side.
    """
    i, j, P, Q = A.LINK[a].owner, A.LINK[b].owner, A.CORE[0], A.CORE[1]
    x_a, y_a, angle_a = pose(A.BODY, i, start)
    x_b, y_b, angle_b = pose(A.BODY, j, start)
    p = place(A, a, x_a, y_a, angle_a, P)
    q = place(A, b, x_b, y_b, angle_b, Q)
    d, nx, ny, px, py, _, _, _, _, _ = closest_on_side(A, P, p, Q, q, a, b)
    if d > near_side(A, a, b):
        note_side(A, a, b, nx, ny, False)
    elif not known_side(A, a, b):
        parting, pressing = leaving(A.BODY, i, j, start, nx, ny, px, py)
        resting = abs(parting) * left <= tolerance
        other = (resting and pressing < 0.0) or (not resting and d <= tolerance and parting < 0.0)
        sign = -1.0 if p == 2 and q == 2 and other else 1.0
        note_side(A, a, b, sign * nx, sign * ny, True)


@uncounted
def face_closes(
    A: Scene, a: int, b: int, nx: float, ny: float, x: float, y: float, d: float, one: Motion, two: Motion, still: float
) -> bool:  # fmt: skip
    """Whether any of the points closes at which an impact of shapes a < b acts: of bodies that overlap others may be
    inside, beside their common face. (x, y) is the point of a's core, d the gap of the cores."""
    P, Q, p, q = A.CORE[0], A.CORE[1], A.LINK[a].vertices, A.LINK[b].vertices
    g = d - A.SHAPE[a].rounding - A.SHAPE[b].rounding
    away = A.SHAPE[a].rounding + 0.5 * g
    low, high, top, wide = 0.0, 0.0, 0.0, False
    if p > 1 and q > 1:
        low, high, top, wide = common_face(P, p, Q, q, nx, ny, face_tolerance(A, a, b) + max(-g, 0.0))
    for k in range(2 if wide else 1):
        px, py = x + away * nx, y + away * ny
        if wide:
            along = low if k == 0 else high
            px, py = (top + away) * nx - along * ny, (top + away) * ny + along * nx
        u = nx * (two.vx - two.spin * (py - two.y) - one.vx + one.spin * (py - one.y))
        u += ny * (two.vy + two.spin * (px - two.x) - one.vy - one.spin * (px - one.x))
        if u < -still:
            return True
    return False


@uncounted
def general(A: Scene, a: int, b: int, horizon: float) -> tuple[float, bool]:
    """`search` of any two shapes a and b, which leaves the memory of sides as it is where they are now: what is between
    may never come."""
    if a > b:
        a, b = b, a
    if not remembers(A, a, b):
        return search(A, a, b, horizon, math.inf)
    start = max(A.BODY[A.LINK[a].owner].since, A.BODY[A.LINK[b].owner].since)
    begin_side(A, a, b, start, max(horizon - start, 0.0), touching(A, a, b))
    side = A.SIDE[side_row(A, key_of(A, a, b))]
    key, nx, ny, deep = side.key, side.nx, side.ny, side.deep
    t, certain = search(A, a, b, horizon, math.inf)
    side.key, side.nx, side.ny, side.deep = key, nx, ny, deep
    return t, certain


@uncounted
def follow_side(A: Scene, a: int, b: int, t: float, horizon: float) -> None:
    """Note on which side of each other the thin shapes a and b are at instant t, at which they meet."""
    search(A, min(a, b), max(a, b), horizon, t)


@uncounted
def search(A: Scene, a: int, b: int, horizon: float, until: float) -> tuple[float, bool]:
    """Instant at which any two shapes meet next, and whether they do, or are only known to be apart until then.

    A function of the two paths from the later SINCE on, whatever the order of a and b. Shapes that touch and close
    meet then. Shapes that touch and part do not; they are followed until the horizon, by at least a thousandth of it
    a look, as no bound of theirs is above 0, but by no more than the time `graze` in which no point of theirs comes
    deeper than `GRAZED`. So are those of which 1000 looks at a sixteenth of the time do not tell when they meet.

    Args:
        a, b: a < b.
        horizon: finite instant; lower bounds are no earlier.
        until: instant at which the search ends.
    """
    BODY, SHAPE = A.BODY, A.SHAPE
    i, j = A.LINK[a].owner, A.LINK[b].owner
    start = max(BODY[i].since, BODY[j].since)
    left = max(horizon - start, 0.0)
    tolerance = touching(A, a, b)
    s, never = circles_meet(A, a, b, start, left, tolerance)
    if s > left:
        return start + s, never
    if s == 0.0:
        s = carried_circles_meet(A, a, b, start, left)
        if s > left:
            if BODY[i].angular == 0.0 and BODY[j].angular == 0.0:
                return start + s, s == math.inf
            return horizon, False
    bend, bend_a, bend_b = bends(A, a, b, start, left)
    extent = SHAPE[a].rounding + SHAPE[b].rounding
    still = APPROACH_ROUND_OFF * (fastest(A, a, start) + fastest(A, b, start))
    fixed, of_a, of_b = (
        Closing(extent, bend, tolerance, still), Closing(extent, bend_a, tolerance, still),
        Closing(extent, bend_b, tolerance, still),
    )  # fmt: skip
    P, Q = A.CORE[0], A.CORE[1]
    if remembers(A, a, b):
        begin_side(A, a, b, start, left, tolerance)
    graze = math.sqrt(2.0 * GRAZED * smaller(A, a, b) / max(max(bend, max(bend_a, bend_b)), 1e-300))
    graze = max(graze, left / RESOLUTION / ADVANCES)
    looks, mark = 0, s
    while True:
        looks += 1
        A.COUNT.work += 1
        if s > mark + left / RESOLUTION:  # what turns fast is followed for many turns
            looks, mark = 0, s
        one, two = motion(BODY, i, start + s), motion(BODY, j, start + s)
        p = place(A, a, one.x, one.y, one.angle, P)
        q = place(A, b, two.x, two.y, two.angle, Q)
        d, nx, ny, px, py, _, edge_a, apart_a, edge_b, apart_b = closest_on_side(A, P, p, Q, q, a, b)
        if d > near_side(A, a, b):
            note_side(A, a, b, nx, ny, False)
        safe, near, met = fixed_axis(P, p, Q, q, nx, ny, one, two, fixed)
        least = min(d - extent, 0.0) - tolerance
        if apart_a - extent >= least:
            may, gap, closes = turning_axis(P, edge_a, Q, q, one, two, of_a)
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if apart_b - extent >= least:
            may, gap, closes = turning_axis(Q, edge_b, P, p, two, one, of_b)
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if met and near < -tolerance:
            met = face_closes(A, a, b, nx, ny, px, py, d, one, two, still)
        if met and d - extent < -DEEP * tolerance and parts(A, a, b, one, two, tolerance):
            met = False
        if not met and near <= tolerance:
            back = pressed(BODY, i, j, start + s, nx, ny, px + SHAPE[a].rounding * nx, py + SHAPE[a].rounding * ny)
            if back <= min(left / RESOLUTION, graze):
                return start + s + back, True
            safe = max(safe, min(left / ADVANCES, graze))
        if met:
            return start + s + safe, True
        s += safe if looks < ADVANCES else max(safe, graze)
        if s > left or looks > 2.0 * ADVANCES * RESOLUTION or start + s > until:
            return horizon, False

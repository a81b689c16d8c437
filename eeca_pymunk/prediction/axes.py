"""Bounds of the gap of two shapes along one axis, from the motion of their vertices.

Along an axis n the least gap of some points bounds the gap of the shapes, and a point's gap g with rate g' stays above
g + g' s - B s² / 2 if B bounds its second derivative. So each axis gives an instant before which the shapes are apart.

Bounds until the horizon, with r the reach of a core about its centre of mass, w the spin, q its rate, A the relative
acceleration of the centres, b's less a's, V their relative speed, and L their distance:

    fixed axis n      B = max(-A . n, 0) + sum of r (w² + q) of both,
    axis of body a    B = A + r_b (w_b² + q_b) + 2 w_a (V + w_b r_b) + (w_a² + q_a) (L + r_b).

The second bounds the terms of g'' = n.p'' + 2 n'.p' + n''.p, where n turns with a, and p leads from a's centre to a
vertex of b.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..geometry.flight import pose, rate
from ..model.bodies import Body
from ..model.parameters.detection import MANY_CORNERS
from ..model.scene import Scene
from .roots import falling_root


class MotionState(NamedTuple):
    """Pose and velocity of a body at one instant."""

    x: float
    y: float
    angle: float
    vx: float
    vy: float
    spin: float


class Closing(NamedTuple):
    """Constants of the gaps of points along an axis."""

    extent: float  # gap of the cores where the shapes touch: length
    bend: float  # bound of the second derivative of gaps: length/time²
    tolerance: float  # gap up to which points touch: length
    depth: float  # to which points that do not approach may get between two looks: length
    round_off: float  # rate of approach up to which points that touch do not close: length/time


@nonallocating
def motion(BODY: Rows[Body], i: int, t: float) -> MotionState:
    """The motion of body i at instant t."""
    x, y, angle = pose(BODY, i, t)
    vx, vy, spin = rate(BODY, i, t)
    return MotionState(x, y, angle, vx, vy, spin)


@nonallocating
def first_close(best: float, near: float, closing: bool, g: float, w: float, of: Closing) -> tuple[float, float, bool]:
    """Include one more point of an axis, with gap g (length) and rate w (length/time), in the results so far, and
    return them: the time `best` before which no point can close, the least gap `near` (length), and whether a point
    touches and approaches (`closing`). A point that does not approach may get as deep as `depth`."""
    near = min(near, g)
    approaches = w < -of.round_off
    closing = closing or (g <= of.tolerance and approaches)
    # The root is needed only if the bound is negative at `best`.
    if best == math.inf or g + (w - 0.5 * of.bend * best) * best < 0.0:
        root = falling_root(g, w, -of.bend)
        if not approaches:
            root = max(root, math.sqrt(2.0 * of.depth / max(of.bend, 1e-300)))
        best = min(best, root)
    return best, near, closing


@nonallocating
def deciding_heights(
    P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float, a: MotionState, b: MotionState, of: Closing
) -> tuple[float, float]:
    """Heights along n from which on vertices P, and up to which vertices Q, may decide `fixed_axis`.

    The lowest Q and the highest P may close after the time `best`. The gap of any other pair stays above
    g + u s - B s² / 2, where u = `slowest` - `fastest` is the least rate that there is: so it is positive until `best`
    if g > 0 and g > (B best / 2 - u) best. As g is at least the height of P below the lowest Q less `extent`, vertices
    P that are lower by more than `reach` do not decide; nor do vertices Q as far above the highest P.
    """
    top, bottom, fastest, slowest, i, j = -math.inf, math.inf, -math.inf, math.inf, 0, 0
    for k in range(p):
        height = P[k, 0] * nx + P[k, 1] * ny
        fastest = max(fastest, (a.vx - a.spin * (P[k, 1] - a.y)) * nx + (a.vy + a.spin * (P[k, 0] - a.x)) * ny)
        if height > top:
            top, i = height, k
    for k in range(q):
        height = Q[k, 0] * nx + Q[k, 1] * ny
        slowest = min(slowest, (b.vx - b.spin * (Q[k, 1] - b.y)) * nx + (b.vy + b.spin * (Q[k, 0] - b.x)) * ny)
        if height < bottom:
            bottom, j = height, k
    w = (b.vx - b.spin * (Q[j, 1] - b.y) - a.vx + a.spin * (P[i, 1] - a.y)) * nx
    w += (b.vy + b.spin * (Q[j, 0] - b.x) - a.vy - a.spin * (P[i, 0] - a.x)) * ny
    best, _, _ = first_close(math.inf, math.inf, False, bottom - top - of.extent, w, of)
    if best == math.inf:
        return -math.inf, math.inf
    reach = of.extent + of.tolerance + max(of.tolerance, (0.5 * of.bend * best - (slowest - fastest)) * best)
    return bottom - reach, top + reach


@nonallocating
def fixed_axis(
    P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float, a: MotionState, b: MotionState, of: Closing
) -> tuple[float, float, bool]:
    """`first_close` of all vertices P of a against all vertices Q of b, p and q of them, along the present normal n
    from a to b, fixed in space. P, Q: columns 0 and 1 are the vertices in space, 2 and 3 the normals of the edges."""
    best, near, closing = math.inf, math.inf, False
    low, high = -math.inf, math.inf
    if min(p, q) >= MANY_CORNERS:
        low, high = deciding_heights(P, p, Q, q, nx, ny, a, b, of)
    for i in range(p):
        x, y = P[i, 0], P[i, 1]
        if x * nx + y * ny < low:
            continue
        vx, vy = a.vx - a.spin * (y - a.y), a.vy + a.spin * (x - a.x)
        for j in range(q):
            if Q[j, 0] * nx + Q[j, 1] * ny > high:
                continue
            g = (Q[j, 0] - x) * nx + (Q[j, 1] - y) * ny - of.extent
            w = (b.vx - b.spin * (Q[j, 1] - b.y) - vx) * nx + (b.vy + b.spin * (Q[j, 0] - b.x) - vy) * ny
            best, near, closing = first_close(best, near, closing, g, w, of)
    return best, near, closing


@nonallocating
def turning_axis(
    P: FloatArray, edge: int, Q: FloatArray, q: int, a: MotionState, b: MotionState, of: Closing
) -> tuple[float, float, bool]:
    """`first_close` of the q vertices Q of b against one edge of a, a row of P: rates are relative to the material
    point of a there."""
    best, near, closing = math.inf, math.inf, False
    nx, ny = P[edge, 2], P[edge, 3]
    for j in range(q):
        x, y = Q[j, 0], Q[j, 1]
        g = (x - P[edge, 0]) * nx + (y - P[edge, 1]) * ny - of.extent
        w = (b.vx - b.spin * (y - b.y) - (a.vx - a.spin * (y - a.y))) * nx
        w += (b.vy + b.spin * (x - b.x) - (a.vy + a.spin * (x - a.x))) * ny
        best, near, closing = first_close(best, near, closing, g, w, of)
    return best, near, closing


@nonallocating
def reach_of(A: Scene, s: int) -> tuple[float, float, float]:
    """A reference point of shape s relative to its body's centre of mass, and the radius of the shape about it: the
    centre of mass itself for moving bodies, the centre of its bounding circle for static shapes."""
    if A.LINK[s].owner == A.BODY.shape[0] - 1:
        return A.SHAPE[s].centre_x, A.SHAPE[s].centre_y, A.SHAPE[s].bound
    return 0.0, 0.0, A.SHAPE[s].extent


@nonallocating
def bends(A: Scene, a: int, b: int, start: float, duration: float) -> tuple[float, float, float, float]:
    """The parts of the bound B (length/time²) of a fixed axis that rotation of a and of b gives, and the bounds of the
    axes of a and of b, from instant `start` on for a time `duration`."""
    one, two = A.BODY[A.LINK[a].owner], A.BODY[A.LINK[b].owner]
    m, n = motion(A.BODY, A.LINK[a].owner, start), motion(A.BODY, A.LINK[b].owner, start)
    q_a, q_b = abs(one.angular), abs(two.angular)
    w_a, w_b = abs(m.spin) + q_a * duration, abs(n.spin) + q_b * duration
    px_a, py_a, r_a = reach_of(A, a)
    px_b, py_b, r_b = reach_of(A, b)
    r_a, r_b = max(r_a - A.SHAPE[a].rounding, 0.0), max(r_b - A.SHAPE[b].rounding, 0.0)
    pull = math.sqrt((two.ax - one.ax) ** 2 + (two.ay - one.ay) ** 2)
    V = math.sqrt((n.vx - m.vx) ** 2 + (n.vy - m.vy) ** 2) + pull * duration
    L = math.sqrt((n.x + px_b - m.x - px_a) ** 2 + (n.y + py_b - m.y - py_a) ** 2) + V * duration
    around_a, around_b = r_a * (w_a * w_a + q_a), r_b * (w_b * w_b + q_b)
    of_a = pull + around_b + 2.0 * w_a * (V + w_b * r_b) + (w_a * w_a + q_a) * (L + r_b)
    of_b = pull + around_a + 2.0 * w_b * (V + w_a * r_a) + (w_b * w_b + q_b) * (L + r_a)
    return around_a, around_b, of_a, of_b


@nonallocating
def pulled_along(A: Scene, a: int, b: int, nx: float, ny: float) -> float:
    """The acceleration (length/time²) with which the centres of the bodies of shapes a and b approach along the normal
    n from a to b, 0 if they part: what slides along a wall does not approach it."""
    one, two = A.BODY[A.LINK[a].owner], A.BODY[A.LINK[b].owner]
    return max(nx * (one.ax - two.ax) + ny * (one.ay - two.ay), 0.0)


@nonallocating
def speed_bound(A: Scene, s: int, t: float) -> float:
    """Bound of the speed of points of shape s at instant t, length/time."""
    i = A.LINK[s].owner
    vx, vy, spin = rate(A.BODY, i, t)
    return abs(vx) + abs(vy) + abs(spin) * A.SHAPE[s].extent

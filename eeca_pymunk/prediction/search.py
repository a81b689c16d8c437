"""When rotating shapes meet: conservative advancement (Mirtich 1996) from bounds of the motion of their vertices.

Shapes are apart if they are apart along some axis. Each axis gives an instant before which the shapes are apart
(`axes.py`), and the search continues at the latest of these. There are three axes: the present normal, fixed in space,
with the vertices of both shapes; and the normals of the edges of a and of b along which they are farthest apart, which
rotate with their bodies, with the vertices of the other shape.

Of a shape that turns more than once in the time searched, a fourth bound holds: it is inside the disk that it sweeps,
which does not turn (`swept`). So its turns need not be followed where the disk is apart.

Shapes meet if, along each of the axes some point touches and approaches.

A look is one evaluation of the gap in a search.

Side effect: `sides.begin_side` and `search` note the sides of thin shapes in SIDE; of these notes only those of
`begin_side` are left when `general` has ended.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..geometry import sides
from ..geometry.convex import closest, place_vertices
from ..geometry.gap import gap_round_off
from ..geometry.manifold import face_points
from ..geometry.widths import smaller
from ..model.parameters.events import ADVANCES, APPROACH_ROUND_OFF, LONGEST_SEARCH, RESOLUTION
from ..model.parameters.intervals import TOUCH
from ..model.scene import Scene
from ..pairs.rules import face_tolerance
from .axes import Closing, MotionState, bends, fixed_axis, motion, pulled_along, speed_bound, turning_axis
from .bounding_circles import carried_circles_meet, circles_meet
from .sides import begin_side, closing_acceleration, opening
from .work import look_work, most_work


@nonallocating
def time_to_contact_again(
    A: Scene, a: int, b: int, nx: float, ny: float, px: float, py: float, one: MotionState, two: MotionState
) -> float:
    """Time after which shapes a and b, with the motions `one` and `two` of their bodies, that touch at the point p and
    part there along n with u >= 0 touch again: 2 u / a_n if the acceleration of the points closes the gap with a_n > 0,
    else infinite."""
    u, i, j = opening(one, two, nx, ny, px, py), A.BODY[A.LINK[a].owner], A.BODY[A.LINK[b].owner]
    closing = closing_acceleration(one, two, i.ax, i.ay, i.angular, j.ax, j.ay, j.angular, nx, ny, px, py)
    return 2.0 * max(u, 0.0) / closing if closing > 0.0 else math.inf


@nonallocating
def points_of_face(
    A: Scene, a: int, b: int, nx: float, ny: float, x: float, y: float, d: float
) -> tuple[float, float, float, float]:  # fmt: skip
    """The two points (2, 2) at which an impact of shapes a < b would act.

    Args:
        nx, ny: normal from a to b.  x, y: point of a's core.  d: gap of the cores.
    """
    g = d - A.SHAPE[a].rounding - A.SHAPE[b].rounding
    away, tolerance = A.SHAPE[a].rounding + 0.5 * g, face_tolerance(A, a, b)
    _, px, py, qx, qy = face_points(A, a, b, g, nx, ny, x + away * nx, y + away * ny, tolerance)
    return px, py, qx, qy


@nonallocating
def face_closes(
    A: Scene, a: int, b: int, nx: float, ny: float, x: float, y: float, d: float, one: MotionState, two: MotionState,
    still: float,
) -> bool:  # fmt: skip
    """Whether the gap closes, faster than `still` (length/time), at a point at which an impact of shapes a < b would
    act: shapes that overlap may approach elsewhere, inside each other. one, two: motions of the bodies; other arguments
    as of `points_of_face`."""
    px, py, qx, qy = points_of_face(A, a, b, nx, ny, x, y, d)
    return bool(min(opening(one, two, nx, ny, px, py), opening(one, two, nx, ny, qx, qy)) < -still)


@nonallocating
def face_closes_again(
    A: Scene, a: int, b: int, nx: float, ny: float, x: float, y: float, d: float, one: MotionState, two: MotionState
) -> float:
    """`time_to_contact_again` of shapes a < b that touch. Where the point that is nearest approaches, it is beyond the
    end of the face that both have in common, as that of a rod on a shorter plank is: then at the ends of this face.
    Arguments as of `face_closes`."""
    px, py = x + A.SHAPE[a].rounding * nx, y + A.SHAPE[a].rounding * ny
    if opening(one, two, nx, ny, px, py) >= 0.0:
        return time_to_contact_again(A, a, b, nx, ny, px, py, one, two)
    px, py, qx, qy = points_of_face(A, a, b, nx, ny, x, y, d)
    again = time_to_contact_again(A, a, b, nx, ny, px, py, one, two)
    return min(again, time_to_contact_again(A, a, b, nx, ny, qx, qy, one, two))


@nonallocating
def turns_fast(A: Scene, s: int, start: float, duration: float) -> bool:
    """Whether shape s turns more than once within a `duration` from instant `start` on."""
    i = A.LINK[s].owner
    return (abs(motion(A.BODY, i, start).spin) + abs(A.BODY[i].angular) * duration) * duration > 2.0 * math.pi


@nonallocating
def swept(
    A: Scene, a: int, b: int, p: int, q: int, one: MotionState, two: MotionState, fast_a: bool, fast_b: bool,
    bend: float, of: Closing,
) -> float:  # fmt: skip
    """Time for which shapes a and b are apart, as the disk that a fast one sweeps about its centre of mass is; 0 if it
    is not.

    Args:
        p, q: numbers of the vertices of the cores, in CORE, which change.  one, two: motions of the bodies.
        bend: part of the bound B of a fixed axis that rotation of a slow one gives.  of: constants of a fixed axis.
    """
    P, Q = A.CORE[0], A.CORE[1]
    if fast_a:
        P[0, 0], P[0, 1], p = one.x, one.y, 1
    if fast_b:
        Q[0, 0], Q[0, 1], q = two.x, two.y, 1
    extent = A.SHAPE[a].extent if fast_a else A.SHAPE[a].rounding
    extent += A.SHAPE[b].extent if fast_b else A.SHAPE[b].rounding
    near = closest(P, p, Q, q)
    if near.distance <= extent:
        return 0.0
    bend += pulled_along(A, a, b, near.nx, near.ny)
    sure = Closing(extent, bend, of.tolerance, of.depth, of.round_off)
    return fixed_axis(P, p, Q, q, near.nx, near.ny, one, two, sure)[0]


@nonallocating
def general(A: Scene, a: int, b: int, horizon: float, latest: float) -> tuple[float, bool]:
    """`search` for shapes a and b in either order, up to instant `latest`; once LONGEST_SEARCH of the step's work is
    spent, it ends where it is. It changes the remembered side of thin ones as it follows them on their paths;
    afterwards that is again the side at its start, since an impulse may change the paths before."""
    if a > b:
        a, b = b, a
    most = LONGEST_SEARCH * most_work(A)
    if not sides.remembers(A, a, b):
        return search(A, a, b, horizon, latest, most)
    start = max(A.BODY[A.LINK[a].owner].since, A.BODY[A.LINK[b].owner].since)
    begin_side(A, a, b, start, max(horizon - start, 0.0))
    A.COUNT.work += look_work(A, a, b)
    side = A.SIDE[sides.side_row(A, sides.side_key(A, a, b))]
    key, nx, ny, deep = side.key, side.nx, side.ny, side.deep
    t, certain = search(A, a, b, horizon, latest, most)
    side.key, side.nx, side.ny, side.deep = key, nx, ny, deep
    return t, certain


@nonallocating
def note_sides(A: Scene, a: int, b: int, t: float) -> None:
    """Note on which side of each other thin shapes a < b are at instant t, as they follow their paths."""
    start = max(A.BODY[A.LINK[a].owner].since, A.BODY[A.LINK[b].owner].since)
    begin_side(A, a, b, start, max(A.PAR.dt - start, 0.0))
    search(A, a, b, A.PAR.dt, t, math.inf)


@nonallocating
def search(A: Scene, a: int, b: int, horizon: float, until: float, most: float) -> tuple[float, bool]:
    """(t, certain) of any two shapes.

    Depends only on the two paths, from the later of their instants `since` to the horizon, the `duration`. Shapes that
    touch and approach meet at once. Shapes that touch and part do not meet: the search goes on where they may be as
    deep as TOUCH (`axes.first_close`), or ends where they touch again if that is before.

    Its work is bounded: after ADVANCES looks within an interval of duration / RESOLUTION each look advances by at least
    that interval over ADVANCES; of shapes that overlap, but do not close, by duration / ADVANCES. So an interval takes
    about 2 ADVANCES looks at most.

    Args:
        a, b: a < b.
        horizon: finite instant.
        until: instant from which on the search is not continued.
        most: work of the step at which the search ends where it is.

    Returns:
        as defined in `impact_times.py`; lower bounds are no earlier than the horizon or `until`, unless the work is
        spent.
    """
    BODY, SHAPE = A.BODY, A.SHAPE
    i, j = A.LINK[a].owner, A.LINK[b].owner
    start = max(BODY[i].since, BODY[j].since)
    duration = max(horizon - start, 0.0)
    tolerance = gap_round_off(A, a, b)
    s = circles_meet(A, a, b, start, duration, tolerance)
    if s > duration:
        return start + s, s == math.inf
    if s == 0.0:
        s = carried_circles_meet(A, a, b, start, duration)
        if s > duration:
            if BODY[i].angular == 0.0 and BODY[j].angular == 0.0:
                return start + s, s == math.inf
            return horizon, False
    if start + s > until:
        return start + s, False
    around_a, around_b, bend_a, bend_b = bends(A, a, b, start, duration)
    extent = SHAPE[a].rounding + SHAPE[b].rounding
    still = APPROACH_ROUND_OFF * (speed_bound(A, a, start) + speed_bound(A, b, start))
    depth = TOUCH * smaller(A, a, b)
    of_a, of_b = Closing(extent, bend_a, tolerance, depth, still), Closing(extent, bend_b, tolerance, depth, still)
    P, Q = A.CORE[0], A.CORE[1]
    looks, mark, interval = 0, s, duration / RESOLUTION
    each = look_work(A, a, b)
    fast_a, fast_b = turns_fast(A, a, start, duration), turns_fast(A, b, start, duration)
    slow = (0.0 if fast_a else around_a) + (0.0 if fast_b else around_b)
    while True:
        looks += 1
        A.COUNT.work += each
        if s > mark + interval:  # a new interval: fast rotation is followed for many turns
            looks, mark = 0, s
        one, two = motion(BODY, i, start + s), motion(BODY, j, start + s)
        p = place_vertices(A, a, one.x, one.y, one.angle, P)
        q = place_vertices(A, b, two.x, two.y, two.angle, Q)
        here = sides.closest_on_side(A, P, p, Q, q, a, b)
        d, nx, ny, px, py, faces = here.distance, here.nx, here.ny, here.x, here.y, here.faces
        if d > sides.near_side(A, a, b):
            sides.note_side(A, a, b, nx, ny, False)
        fixed = Closing(extent, around_a + around_b + pulled_along(A, a, b, nx, ny), tolerance, depth, still)
        safe, near, met = fixed_axis(P, p, Q, q, nx, ny, one, two, fixed)
        # Edges along whose normals the shapes overlap more than along n do not bound when they meet.
        least = min(d - extent, 0.0) - tolerance
        if faces.apart_p - extent >= least:
            may, gap, closes = turning_axis(P, faces.edge_p, Q, q, one, two, of_a)
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if faces.apart_q - extent >= least:
            may, gap, closes = turning_axis(Q, faces.edge_q, P, p, two, one, of_b)
            safe, near, met = max(safe, may), max(near, gap), met and closes
        if met and near < -tolerance and not face_closes(A, a, b, nx, ny, px, py, d, one, two, still):
            met, safe = False, max(safe, duration / ADVANCES)
        if not met and near <= tolerance:
            back = face_closes_again(A, a, b, nx, ny, px, py, d, one, two)
            if back <= min(safe, interval):
                return start + s + back, True
        if met:
            return start + s + safe, True
        if fast_a or fast_b:
            safe = max(safe, swept(A, a, b, p, q, one, two, fast_a, fast_b, slow, fixed))
        s += safe if looks < ADVANCES else max(safe, interval / ADVANCES)
        # More looks in one interval than all intervals may take: s no longer grows, as the duration is round-off or 0,
        # or a motion is not finite.
        if s > duration or looks > 2.0 * ADVANCES * RESOLUTION:
            return horizon, False
        if start + s > until or A.COUNT.work > most:
            return start + s, False

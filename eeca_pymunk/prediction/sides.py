"""On which side of each other thin shapes are whose paths begin, or that nothing is known of.

Thin shapes that are apart by more than FLUSH, or of which one way apart is longer than that, are where the geometry
tells. The geometry of others, as of rods that lie flush, does not tell it, as intervals leave some as deep; then

1. another shape of one of the bodies that forces hold in contact tells it, as a body lies on one side of a wall;
2. else shapes that hardly move along their normal n, with the velocity u and the acceleration a without contacts,
   u² <= 2 |a| near_side, are on the side on which they press against each other, see below;
3. else shapes whose distance is round-off are on the side to which they part.

Of rule 2: on the side on which a presses shapes together, forces may hold them at rest, u = 0, for any time. On the
other side a moves them apart, so that u² = 2 |a| y with y the way from the place where u is 0: they satisfy the
condition only if their motion into each other ends within near_side of here, and for a time of
2 (2 near_side / |a|)^(1/2).
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..geometry import sides
from ..geometry.convex import place_vertices
from ..geometry.flight import pose
from ..geometry.gap import gap, gap_round_off
from ..geometry.separation import separation
from ..geometry.widths import smaller
from ..model.parameters.detection import FLUSH, SAME_SIDE
from ..model.scene import Scene
from ..pairs.rules import barred, far_apart
from .axes import MotionState, motion


@nonallocating
def opening(a: MotionState, b: MotionState, nx: float, ny: float, px: float, py: float) -> float:
    """Velocity (length/time) of b less that of a at the point p along n."""
    u = nx * (b.vx - b.spin * (py - b.y) - a.vx + a.spin * (py - a.y))
    return u + ny * (b.vy + b.spin * (px - b.x) - a.vy - a.spin * (px - a.x))


@nonallocating
def closing_acceleration(
    a: MotionState, b: MotionState, ax_a: float, ay_a: float, q_a: float, ax_b: float, ay_b: float, q_b: float,
    nx: float, ny: float, px: float, py: float,
) -> float:  # fmt: skip
    """Acceleration (length/time²) with which the points at p of two bodies close along n, from the motions a and b of
    the bodies, their accelerations (2) and angular accelerations q."""
    rx_a, ry_a, rx_b, ry_b = px - a.x, py - a.y, px - b.x, py - b.y
    ax = ax_b - q_b * ry_b - b.spin * b.spin * rx_b - (ax_a - q_a * ry_a - a.spin * a.spin * rx_a)
    ay = ay_b + q_b * rx_b - b.spin * b.spin * ry_b - (ay_a + q_a * rx_a - a.spin * a.spin * ry_a)
    return -(nx * ax + ny * ay)


@inlined
def in_one_island(A: Scene, i: int, j: int) -> bool:
    """Whether forces may hold bodies i and j in contact: both are in one island, or one is and impulses do not move the
    other."""
    one, two = A.STATE[i].island, A.STATE[j].island
    if one >= 0:
        return bool(one == two or A.BODY[j].inv_mass == 0.0)
    return bool(two >= 0 and A.BODY[i].inv_mass == 0.0)


@nonallocating
def flush(P: FloatArray, p: int, Q: FloatArray, q: int, nx: float, ny: float, depth: float) -> bool:
    """Whether cores with the shortest way apart along n overlap by no more than `depth` along -n too."""
    apart_p, _, _ = separation(P, p, Q, q, -nx, -ny)
    apart_q, _, _ = separation(Q, q, P, p, nx, ny)
    return max(apart_p, apart_q) >= -depth


@nonallocating
def side_of_others(A: Scene, a: int, b: int, nx: float, ny: float) -> float:
    """How far along n, from shape a to shape b, the normal from another shape of the one body to the shape of the other
    leads, if forces hold the two and it is almost parallel to n; 0 if there is none."""
    for turn in range(2):
        i = A.LINK[a if turn == 0 else b].owner
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            one, two = (s, b) if turn == 0 else (a, s)
            mx, my = sides.side_of(A, one, two)
            along = nx * mx + ny * my
            if abs(along) > SAME_SIDE and A.SIDE[sides.side_row(A, sides.side_key(A, one, two))].deep > 0.0:
                return along
    return 0.0


@nonallocating
def on_other_side(
    A: Scene, a: int, b: int, d: float, nx: float, ny: float, px: float, py: float, start: float, duration: float
) -> bool:
    """Whether flush shapes a < b of which nothing is known are on the side against n, see the module.

    Args:
        d, nx, ny, px, py: distance of the cores, normal from a to b, point.  start, duration: of the paths: time.
    """
    along = side_of_others(A, a, b, nx, ny)
    if along != 0.0:
        return along < 0.0
    i, j, PULL = A.LINK[a].owner, A.LINK[b].owner, A.PULL
    one, two = motion(A.BODY, i, start), motion(A.BODY, j, start)
    u = opening(one, two, nx, ny, px, py)
    pressing = closing_acceleration(
        one, two, PULL[i, 0], PULL[i, 1], PULL[i, 2], PULL[j, 0], PULL[j, 1], PULL[j, 2], nx, ny, px, py
    )
    fast = abs(u) + abs(two.spin - one.spin) * smaller(A, a, b)
    if fast * fast <= 2.0 * abs(pressing) * sides.near_side(A, a, b):
        return pressing < 0.0
    tolerance = gap_round_off(A, a, b)
    return d <= tolerance and u < 0.0 and -u * duration > tolerance


@nonallocating
def begin_side(A: Scene, a: int, b: int, start: float, duration: float) -> None:
    """Note on which side of each other thin shapes a < b are at instant `start` of their paths, which end after
    `duration`, a time.

    Shapes that touch without overlap, and that no forces hold, part: they keep their side up to `near_side` only, not
    up to `held_side`, as the bodies may turn by any angle before they come near again.
    """
    i, j, P, Q = A.LINK[a].owner, A.LINK[b].owner, A.CORE[0], A.CORE[1]
    x_a, y_a, angle_a = pose(A.BODY, i, start)
    x_b, y_b, angle_b = pose(A.BODY, j, start)
    p = place_vertices(A, a, x_a, y_a, angle_a, P)
    q = place_vertices(A, b, x_b, y_b, angle_b, Q)
    near = sides.closest_on_side(A, P, p, Q, q, a, b)
    d, nx, ny = near.distance, near.nx, near.ny
    key = sides.side_key(A, a, b)
    side = A.SIDE[sides.side_row(A, key)]
    depth, most = sides.near_side(A, a, b), FLUSH * smaller(A, a, b)
    held = d < -depth or in_one_island(A, i, j)
    if side.key != key and d <= most and flush(P, p, Q, q, nx, ny, most):
        if on_other_side(A, a, b, d, nx, ny, near.x, near.y, start, duration):
            nx, ny, held = -nx, -ny, held or d > depth
        sides.note_side(A, a, b, nx, ny, held)
    elif side.key != key or d > depth:
        sides.note_side(A, a, b, nx, ny, held and d <= depth)
    else:
        side.nx, side.ny = nx, ny  # it turns with the shapes
        side.deep = side.deep if held else 0.0


@nonallocating
def find_sides(A: Scene, every: bool) -> None:
    """At the start of a step, note the sides of thin shapes that touch and of which nothing is known, of bodies that
    the program has placed or beside which it has changed something, or of `every` body: no impulse of the step has
    acted yet."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i].placed == 0 and not every:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                if not sides.remembers(A, s, o) or barred(A, s, o):
                    continue
                a, b = min(s, o), max(s, o)
                mx, my = sides.side_of(A, a, b)
                most, extent = FLUSH * smaller(A, a, b), A.SHAPE[a].rounding + A.SHAPE[b].rounding
                if mx == 0.0 and my == 0.0 and not far_apart(A, a, b, 0.0, most):
                    if gap(A, a, b, 0.0)[0] + extent <= most:
                        begin_side(A, a, b, 0.0, A.PAR.dt)

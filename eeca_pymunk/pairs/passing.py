"""Corners that bodies pass: where the surface of one shape goes on, flush, as that of another one.

A body that slides or rolls over the joint of two flush shapes approaches the corner at which the second one begins: as
fast as it slides, if it is a box. Along the line between the closest points it would be stopped there; but this corner
lies in the surface of the first shape. So a pair of shapes S and O has the normal m of an edge of one of both if

* along m the two are neither apart nor deep in each other, by more than d, and
* S touches a third shape along m, which contains the corner, the closest point of O, both within d.

d is INTERVAL_DEPTH_LEAST of the smaller shape: up to that depth an interval leaves bodies in each other. The third
shape is one of a body that impulses do not move if O is. Thin shapes pass only corners where two shapes of one body
meet: in stacks of rods that lie on one another, ends are in the surfaces of others everywhere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..geometry.convex import place_vertices, point_core
from ..geometry.flight import pose
from ..geometry.gap import gap
from ..geometry.sides import remembers
from ..geometry.widths import smaller
from ..model.contacts import ContactPoint
from ..model.parameters.detection import ALIGNED, FACE_PASSES, SAME_NORMAL
from ..model.parameters.intervals import INTERVAL_DEPTH_LEAST
from ..model.scene import Scene
from .rules import barred, far_apart


class Flush(NamedTuple):
    """The contact of a pair that passes a corner: unit normal from a to b, gap g, and point."""

    passes: bool
    nx: float
    ny: float
    g: float
    px: float
    py: float


@nonallocating
def place(A: Scene, s: int, t: float, OUT: FloatArray) -> int:
    """Write the vertices of shape s at instant t, and the normals of its edges, to OUT; returns their number."""
    x, y, angle = pose(A.BODY, A.LINK[s].owner, t)
    return place_vertices(A, s, x, y, angle, OUT)


@nonallocating
def next_flush_edge(
    P: FloatArray, p: int, Q: FloatArray, q: int, edge: int, extent: float, nx: float, ny: float, most: float,
    deep: float,
) -> tuple[int, float]:  # fmt: skip
    """The next edge of P after `edge` along which Q is no farther than `deep` from touching, and the gap; p if there is
    none. extent: both roundings.  most: largest cosine between n and the normal of the edge, which is not against n."""
    for k in range(edge + 1, p if p > 1 else 0):
        mx, my = P[k, 2], P[k, 3]
        if not -ALIGNED <= nx * mx + ny * my <= most:
            continue
        g = math.inf
        for i in range(q):
            g = min(g, (Q[i, 0] - P[k, 0]) * mx + (Q[i, 1] - P[k, 1]) * my - extent)
        if abs(g) <= deep:
            return k, g
    return p, 0.0


@nonallocating
def has_normal(P: FloatArray, p: int, nx: float, ny: float) -> bool:
    """Whether n is the normal of an edge of P."""
    for k in range(p if p > 1 else 0):
        if nx * P[k, 2] + ny * P[k, 3] > 1.0 - SAME_NORMAL:
            return True
    return False


@nonallocating
def support_vertex(P: FloatArray, p: int, mx: float, my: float, deep: float, x: float, y: float) -> int:
    """Of the vertices of P that are at most `deep` below the highest along m, the one nearest to (x, y)."""
    top, least, found = -math.inf, math.inf, 0
    for i in range(p):
        top = max(top, mx * P[i, 0] + my * P[i, 1])
    for i in range(p):
        squared = (P[i, 0] - x) ** 2 + (P[i, 1] - y) ** 2
        if mx * P[i, 0] + my * P[i, 1] >= top - deep and squared < least:
            least, found = squared, i
    return found


@nonallocating
def goes_on(A: Scene, o: int, k: int, one_body: bool) -> bool:
    """Whether shape k may continue the surface of o: it is of the same body, or, unless they must be of `one_body`, it
    is not one of a body that impulses move while they do not move o."""
    i, j = A.LINK[o].owner, A.LINK[k].owner
    return bool(i == j or not (one_body or (A.BODY[i].inv_mass == 0.0 and A.BODY[j].inv_mass > 0.0)))


@nonallocating
def continues(
    A: Scene, s: int, o: int, t: float, mx: float, my: float, x: float, y: float, deep: float, one_body: bool
) -> bool:  # fmt: skip
    """Whether shape s of a body that moves touches another one than o along m, which (x, y) is in, both within `deep`.
    one_body: see `goes_on`."""
    if s >= A.LIST.shape[0]:
        return False
    for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
        k = int(A.POOL[w])
        if k == o or not goes_on(A, o, k, one_body) or barred(A, s, k) or far_apart(A, s, k, t, deep):
            continue
        g, nx, ny, _, _ = gap(A, s, k, t)
        if g > deep or nx * mx + ny * my < 1.0 - ALIGNED:
            continue
        if point_core(x, y, A.CORE[1], place(A, k, t, A.CORE[1]))[0] - A.SHAPE[k].rounding <= deep:
            return True
    return False


@nonallocating
def along(
    A: Scene, a: int, b: int, t: float, mx: float, my: float, g: float, near: tuple[float, float, float, float],
    deep: float,
) -> Flush:  # fmt: skip
    """`flush` for the normal m from a to b, along which their gap is g. near: closest points of a and b (2 each)."""
    ax, ay, bx, by = near
    thin = remembers(A, a, b)
    if continues(A, a, b, t, mx, my, bx, by, deep, thin):
        away, p = A.SHAPE[a].rounding + 0.5 * g, place(A, a, t, A.CORE[0])
        i = support_vertex(A.CORE[0], p, mx, my, deep, ax, ay)
        return Flush(True, mx, my, g, A.CORE[0][i, 0] + away * mx, A.CORE[0][i, 1] + away * my)
    if continues(A, b, a, t, -mx, -my, ax, ay, deep, thin):
        away, q = A.SHAPE[b].rounding + 0.5 * g, place(A, b, t, A.CORE[1])
        j = support_vertex(A.CORE[1], q, -mx, -my, deep, bx, by)
        return Flush(True, mx, my, g, A.CORE[1][j, 0] - away * mx, A.CORE[1][j, 1] - away * my)
    return Flush(False, 0.0, 0.0, 0.0, 0.0, 0.0)


@nonallocating
def flush(A: Scene, a: int, b: int, t: float) -> Flush:
    """The contact of shapes a and b at instant t, if one of the two passes a corner of the other."""
    none = Flush(False, 0.0, 0.0, 0.0, 0.0, 0.0)
    if A.LINK[a].vertices == 1 and A.LINK[b].vertices == 1:
        return none
    g, nx, ny, px, py = gap(A, a, b, t)
    ax, ay, bx, by = px - 0.5 * g * nx, py - 0.5 * g * ny, px + 0.5 * g * nx, py + 0.5 * g * ny
    deep, extent = INTERVAL_DEPTH_LEAST * smaller(A, a, b), A.SHAPE[a].rounding + A.SHAPE[b].rounding
    P, Q, first, second, looked = A.CORE[0], A.CORE[1], -1, -1, False
    p, q = place(A, a, t, P), place(A, b, t, Q)
    most = FACE_PASSES if has_normal(P, p, nx, ny) or has_normal(Q, q, -nx, -ny) else 1.0 - SAME_NORMAL
    while True:
        first, apart = next_flush_edge(P, p, Q, q, first, extent, nx, ny, most, deep)
        if first < p:
            mx, my = P[first, 2], P[first, 3]
        else:
            second, apart = next_flush_edge(Q, q, P, p, second, extent, -nx, -ny, most, deep)
            if second >= q:
                return none
            mx, my = -Q[second, 2], -Q[second, 3]
        if not looked:
            looked = True
            if continues(A, a, b, t, nx, ny, bx, by, deep, True) or continues(A, b, a, t, -nx, -ny, ax, ay, deep, True):
                return none  # the closest points are on a surface that goes on
        found = along(A, a, b, t, mx, my, apart, (ax, ay, bx, by), deep)
        if found.passes:
            return found
        p, q = place(A, a, t, P), place(A, b, t, Q)  # `continues` has placed others there


@nonallocating
def pass_corner(A: Scene, a: int, b: int, t: float, point: ContactPoint) -> bool:
    """Set the contact of shapes a and b at instant t to `flush`, if one of them passes a corner of the other. Returns
    whether it does."""
    found = flush(A, a, b, t)
    if found.passes:
        point.nx, point.ny, point.gap, point.px, point.py = found.nx, found.ny, found.g, found.px, found.py
    return found.passes

"""Contact rows of an island from the geometry of its pairs, for an interval h from now.

Normals and arms are those at the predicted middle q + (h/2) v, gaps those now: with u = G(middle) v the gap at the end
is g + (h/2)(u- + u+) to third order in h, so that bodies follow curved surfaces to second order without a loss; and an
island without forces keeps its angular momentum exactly, as its middle and the predicted one differ by multiples of the
impulses.

A pair has the geometry now instead if it moves too far in half an interval (an impact at high speed), hardly moves, or
has another number of contact points at the middle. How far it moves is measured in the frame of a rotating body without
mobility if it has one. Arms are then those now too; but in a free island they are still those at the middle, and the
points of the pair are displaced by the mean of the displacements of its two bodies.

What a wall that turns by w h carries along has, with the geometry of the middle, the tangential velocities -c_0 at the
start and c_1 at the end, both about w^2 h x/2 with its distance x from the middle of the wall; and its mean velocity
exceeds the mean of both by m, (w h)^2/12 of it. So u_t is counted from -c_0 + m and from c_1 + m: what sticks has no
slip, in its position neither, and friction does no work on it in the frame of the wall.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..geometry.manifold import manifold
from ..geometry.sides import note_side
from ..model.contacts import Row
from ..model.islands import Island, IslandContacts
from ..model.parameters.intervals import INTERVAL_WAY, MANIFOLD_ROUND_OFF, MIDPOINT_SAME
from ..model.scene import Scene
from ..pairs.rules import law
from ..rows.build import normal_rate, place_row, slip_rate
from .memory import key_of


@nonallocating
def way_about(POSE: FloatArray, V: FloatArray, a: int, b: int, extent: float) -> float:
    """Largest speed of points of local body b, up to `extent` from its centre of mass, in the frame of body a, which
    rotates. POSE, V: (k, 3)."""
    x = V[b, 0] - V[a, 0] + V[a, 2] * (POSE[b, 1] - POSE[a, 1])
    y = V[b, 1] - V[a, 1] - V[a, 2] * (POSE[b, 0] - POSE[a, 0])
    return math.sqrt(x * x + y * y) + abs(V[b, 2] - V[a, 2]) * extent


@nonallocating
def gap_rate(POSE: FloatArray, V: FloatArray, a: int, b: int, nx: float, ny: float, px: float, py: float) -> float:
    """Velocity of local body b's point (px, py) relative to body a's along the normal n. POSE, V: (k, 3)."""
    x = V[b, 0] - V[b, 2] * (py - POSE[b, 1]) - V[a, 0] + V[a, 2] * (py - POSE[a, 1])
    y = V[b, 1] + V[b, 2] * (px - POSE[b, 0]) - V[a, 1] - V[a, 2] * (px - POSE[a, 0])
    return nx * x + ny * y


@nonallocating
def carried_along(isle: Island, row: Row, h: float) -> tuple[float, float]:
    """If the body without mobility of a row, which rotates, carries the other one along for h: the change of the
    tangential velocity, and by how much its mean is above the mean of those at the start and the end.

    Let X lead from the one to the other, r = V_b - V_a - w x X be its velocity in the rotating frame, and R the
    rotation by w h. Then X' = R X + h R^(1/2) r, and V_b' = V_a + w x X' + R r.
    """
    POSE, V, sign = isle.POSE, isle.V, 1.0
    a, b = row.a, row.b
    if isle.IM[a] > 0.0:
        a, b, sign = b, a, -1.0
    w, x, y = V[a, 2], POSE[b, 0] - POSE[a, 0], POSE[b, 1] - POSE[a, 1]
    ux, uy = V[b, 0] - V[a, 0], V[b, 1] - V[a, 1]
    rx, ry = ux + w * y, uy - w * x
    half_c, half_s = math.cos(0.5 * w * h), math.sin(0.5 * w * h)
    s, less = 2.0 * half_s * half_c, -2.0 * half_s * half_s  # sine, and cosine less 1
    dx = less * x - s * y + h * (half_c * rx - half_s * ry)
    dy = s * x + less * y + h * (half_s * rx + half_c * ry)
    vx, vy = less * rx - s * ry - w * dy, s * rx + less * ry + w * dx
    mx, my = dx / h - ux - 0.5 * vx, dy / h - uy - 0.5 * vy
    return sign * (row.nx * vy - row.ny * vx), sign * (row.nx * my - row.ny * mx)


@nonallocating
def follow_wall(isle: Island, ROWS: Rows[Row], m: int, count: int, NOW: FloatArray, h: float) -> None:
    """Let `count` rows from m on, of a body and a wall that turns, know the geometry of the start, NOW (2, 5): normal,
    point, gap of each point. h: 0 for walls that are disks, whose spin does not turn the tangent."""
    POSE, V, a, b = isle.POSE, isle.V, ROWS[m].a, ROWS[m].b
    swing, slid, unsure = 0.0, 0.0, 0.0
    if h > 0.0:
        swing, mean = carried_along(isle, ROWS[m], h)
        nx, ny, px, py = NOW[0, 0], NOW[0, 1], NOW[0, 2], NOW[0, 3]
        slid = slip_rate(ROWS[m], V) + swing - gap_rate(POSE, V, a, b, -ny, nx, px, py) + mean
        unsure = abs(0.5 * h * V[a if isle.IM[a] == 0.0 else b, 2] * swing) + 2.0 * abs(mean)
    for z in range(count):
        row = ROWS[m + z]
        u = gap_rate(POSE, V, a, b, NOW[z, 0], NOW[z, 1], NOW[z, 2], NOW[z, 3])
        row.turned = max(u - normal_rate(row, V), 0.0)
        row.surface -= slid
        row.swung, row.unsure = 0.5 * swing, unsure


@kernel
def gather(
    A: Scene, isle: Island, contacts: IslandContacts, MIDDLE: FloatArray, REACH: FloatArray, h: float, free: bool
) -> int:  # fmt: skip
    """Write the ROWS of all contacts of an island's pairs whose gap is at most the sum of both bodies' REACH.

    Args:
        h: length of the interval.  isle, contacts: the island, and its contacts, out.
        MIDDLE: (k, 3) poses predicted for h/2.  REACH: (k,) length.
        free: whether impulses move all k bodies.

    Returns:
        The number of rows, or -1 if they need more memory.
    """
    SHAPE, LINK = A.SHAPE, A.LINK
    POSE, V, EXTENT, PAIRS = isle.POSE, isle.V, isle.EXTENT, isle.PAIRS
    ROWS = contacts.ROWS
    NOW, THEN = np.empty((2, 5)), np.empty((2, 5))  # (n_x, n_y, p_x, p_y, g) of up to two points
    m = 0
    shapes = len(SHAPE)
    half = 0.5 * h
    for c in range(len(PAIRS)):
        s, r, a, b = PAIRS[c, 0], PAIRS[c, 1], PAIRS[c, 2], PAIRS[c, 3]
        if isle.IM[a] == 0.0 and isle.IM[b] == 0.0:
            continue
        small = min(SHAPE[s].extent, SHAPE[r].extent)
        reach = REACH[a] + REACH[b]
        count = manifold(A, s, r, POSE, a, b, reach, MANIFOLD_ROUND_OFF * small, NOW)
        if count == 0:
            continue
        if m + count > len(ROWS):
            return -1
        note_side(A, s, r, NOW[0, 0], NOW[0, 1], True)
        # How far points of both bodies move against each other in h/2; about: in the frame of a body that rotates.
        way = half * (
            math.sqrt((V[b, 0] - V[a, 0]) ** 2 + (V[b, 1] - V[a, 1]) ** 2)
            + abs(V[a, 2]) * EXTENT[a]
            + abs(V[b, 2]) * EXTENT[b]
        )
        about, turning = way, False
        if isle.IM[a] == 0.0 and V[a, 2] != 0.0:
            about, turning = half * way_about(POSE, V, a, b, EXTENT[b]), True
        elif isle.IM[b] == 0.0 and V[b, 2] != 0.0:
            about, turning = half * way_about(POSE, V, b, a, EXTENT[a]), True
        centre = MIDDLE
        # Normals rotate as circles move around each other, slowly around a large one.
        far = SHAPE[s].rounding + SHAPE[r].rounding if LINK[s].vertices == 1 and LINK[r].vertices == 1 else small
        ahead = MIDPOINT_SAME * small < way and about <= 0.5 * INTERVAL_WAY * far
        if ahead:
            again = manifold(A, s, r, MIDDLE, a, b, reach + about, MANIFOLD_ROUND_OFF * small, THEN)
            ahead = again == count
        if not ahead:
            x, y = 0.0, 0.0
            if not free:
                centre = POSE
            else:
                # The same point for both bodies, relative to their middles, adds no angular momentum.
                x = 0.5 * (MIDDLE[a, 0] - POSE[a, 0] + MIDDLE[b, 0] - POSE[b, 0])
                y = 0.5 * (MIDDLE[a, 1] - POSE[a, 1] + MIDDLE[b, 1] - POSE[b, 1])
            for z in range(count):
                for q in range(5):
                    THEN[z, q] = NOW[z, q]
                THEN[z, 2] += x
                THEN[z, 3] += y
        elasticity, friction, sx, sy = law(A, s, r)
        for z in range(count):
            i = m + z
            row = ROWS[i]
            row.a, row.b, row.key = a, b, key_of(shapes, s, r) + z
            row.nx, row.ny, row.gap = THEN[z, 0], THEN[z, 1], NOW[z, 4]
            row.elasticity, row.friction, row.surface = elasticity, friction, 0.0
            place_row(row, THEN[z, 2], THEN[z, 3], centre, isle.IM, isle.II)
            row.surface = row.nx * sy - row.ny * sx
        if ahead and turning:
            edge = LINK[s if isle.IM[a] == 0.0 else r].vertices > 1
            follow_wall(isle, ROWS, m, count, NOW, h if edge else 0.0)
        m += count
    return m

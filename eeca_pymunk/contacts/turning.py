"""Contacts of bodies with a wall, which impulses do not move, that turns by w h within an interval.

With the geometry of the middle of the interval (`geometry.py`) what the wall carries along has the relative velocities
-c_0 at its start and c_1 at its end, both about w^2 h x/2 with the way x between the bodies, along the normal as along
the tangent.

* u_n + c_0 bounces, see `targets.py`.
* u_t is counted from -c_0 + m and from c_1 + m. By m the mean velocity exceeds the mean of both, (w h)^2/12 of it: what
  sticks has no slip, in its position neither, and friction does no work on it in the frame of the wall. How arms change
  as a body turns by itself is no motion of the wall, and as on a wall that rests u_t has those of the middle.

Between bodies that impulses move neither is done: what rocks in piles, or rides on what rocks, would bounce for ever.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.islands import Island
from ..rows.build import normal_rate


@nonallocating
def spin_of_wall(isle: Island, a: int, b: int) -> float:
    """The spin of that one of local bodies a and b that has no mobility, 0 if both have."""
    return float(isle.V[a, 2]) if isle.IM[a] == 0.0 else float(isle.V[b, 2]) if isle.IM[b] == 0.0 else 0.0


@nonallocating
def way_about(isle: Island, a: int, b: int, w: float) -> float:
    """Largest relative speed of points of local bodies a and b in a frame that turns with spin w."""
    POSE, V, EXTENT = isle.POSE, isle.V, isle.EXTENT
    x = V[b, 0] - V[a, 0] + w * (POSE[b, 1] - POSE[a, 1])
    y = V[b, 1] - V[a, 1] - w * (POSE[b, 0] - POSE[a, 0])
    return math.sqrt(x * x + y * y) + abs(V[a, 2] - w) * EXTENT[a] + abs(V[b, 2] - w) * EXTENT[b]


@nonallocating
def gap_rate(POSE: FloatArray, V: FloatArray, a: int, b: int, nx: float, ny: float, px: float, py: float) -> float:
    """Velocity of local body b's point (px, py) relative to body a's along the normal n. POSE, V: (k, 3)."""
    x = V[b, 0] - V[b, 2] * (py - POSE[b, 1]) - V[a, 0] + V[a, 2] * (py - POSE[a, 1])
    y = V[b, 1] + V[b, 2] * (px - POSE[b, 0]) - V[a, 1] - V[a, 2] * (px - POSE[a, 0])
    return nx * x + ny * y


@nonallocating
def carried_along(isle: Island, row: Row, w: float, h: float) -> tuple[float, float, float]:
    """If the bodies of a row turn together with spin w for h: the change of their tangential velocity, and what it has
    at the end, with the geometry of the middle, for no slip in the frame that turns; and the error of that.

    Let x lead from a to b, r = v_b - v_a - w x x be the velocity in the rotating frame, and R the rotation by w h. Then
    x' = R x + h R^(1/2) r, and v_b' - v_a' = w x x' + R r. In the frame of the middle the bodies have R^(1/2) r: the
    rest of v_b - v_a, with both spins w, is carried along. By `mean` the mean velocity is above that of start and end.
    """
    POSE, V, a, b = isle.POSE, isle.V, row.a, row.b
    x, y = POSE[b, 0] - POSE[a, 0], POSE[b, 1] - POSE[a, 1]
    ux, uy = V[b, 0] - V[a, 0], V[b, 1] - V[a, 1]
    rx, ry = ux + w * y, uy - w * x
    half_c, half_s = math.cos(0.5 * w * h), math.sin(0.5 * w * h)
    s, less = 2.0 * half_s * half_c, -2.0 * half_s * half_s  # sine, and cosine less 1
    sx, sy = half_c * rx - half_s * ry, half_s * rx + half_c * ry
    dx, dy = less * x - s * y + h * sx, s * x + less * y + h * sy
    vx, vy = less * rx - s * ry - w * dy, s * rx + less * ry + w * dx
    mx, my = dx / h - ux - 0.5 * vx, dy / h - uy - 0.5 * vy
    swing, mean = row.nx * vy - row.ny * vx, row.nx * my - row.ny * mx
    begins = row.nx * (uy - sy) - row.ny * (ux - sx) + w * (row.arm_tb - row.arm_ta)
    return swing, begins + swing + mean, abs(0.5 * w * h * swing) + 2.0 * abs(mean)


@nonallocating
def follow_rotation(isle: Island, ROWS: Rows[Row], m: int, count: int, NOW: FloatArray, w: float, h: float) -> None:
    """Let `count` rows from m on know the geometry of the start, NOW (2, 5): normal, point, gap of each point.

    w: the spin of the wall.  h: 0 if that is a disk, whose spin does not turn the tangent.
    """
    POSE, V, a, b = isle.POSE, isle.V, ROWS[m].a, ROWS[m].b
    swing, counted, unsure = 0.0, 0.0, 0.0
    if h > 0.0 and ROWS[m].friction > 0.0:
        swing, counted, unsure = carried_along(isle, ROWS[m], w, h)
    for z in range(count):
        row = ROWS[m + z]
        u = gap_rate(POSE, V, a, b, NOW[z, 0], NOW[z, 1], NOW[z, 2], NOW[z, 3])
        row.turned = max(u - normal_rate(row, V), 0.0)
        row.surface -= counted
        row.swung, row.unsure = 0.5 * swing, unsure

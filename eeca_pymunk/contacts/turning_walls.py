"""Contacts of bodies with a wall, a body without mobility, that turns with spin w: by w h in an interval h.

Rows have the geometry of the middle of the interval (`gathering.py`). With it a body that the wall carries along, which
has no velocity in the wall's frame, has the relative velocity -c_0 at the start and c_1 at the end of the interval.
Along the normal both are about -w^2 h (x.n)/2, with x from body a to body b; likewise along the tangent.

* u_n + c_0 bounces, see `targets.py`.
* u_t counts from -c_0 + m at the start and from c_1 + m at the end. The mean of the velocity over h exceeds that of
  start and end by m, which is about (w h)^2/12 of it: so a contact that sticks does not slip, in its position either,
  and its friction does no work in the wall's frame. Arms that change as a body turns relative to the wall remain those
  of the middle, as on a wall at rest.

Between bodies that impulses move neither is done: bodies that rock in piles, or on others, would bounce without end.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..geometry.flight import opening_rate_at
from ..model.contacts import ContactPoint, Row
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
def carried_along(isle: Island, row: Row, w: float, h: float) -> tuple[float, float, float]:
    """c_0 + c_1 and c_1 + m of the module, along the tangent of a row whose bodies turn with spin w for h; then the
    error of c_1 + m.

    Let x lead from a to b, r = v_b - v_a - w x x be the velocity in the rotating frame, and R the rotation by w h. At
    the end x' = R x + h R^(1/2) r, and v_b' - v_a' = w x x' + R r. With the geometry of the middle the bodies have the
    velocity R^(1/2) r of their own; v_b - v_a less that, with both spins w, is carried along: -c_0.
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
def follow_rotation(
    isle: Island, ROWS: Rows[Row], first: int, count: int, NOW: Rows[ContactPoint], w: float, h: float
) -> None:
    """Set what the rotation of a wall changes in `count` rows from `first` on: `turned`, `surface`, `swung`, `unsure`.

    NOW: (2,) their points at the start of the interval.
    w: the spin of the wall.  h: 0 if that is a disk, whose spin does not turn the tangent.
    """
    POSE, V, a, b = isle.POSE, isle.V, ROWS[first].a, ROWS[first].b
    swing, counted, unsure = 0.0, 0.0, 0.0
    if h > 0.0 and ROWS[first].friction > 0.0:
        swing, counted, unsure = carried_along(isle, ROWS[first], w, h)
    for z in range(count):
        row = ROWS[first + z]
        u = opening_rate_at(POSE, V, a, b, NOW[z].nx, NOW[z].ny, NOW[z].px, NOW[z].py)
        row.turned = max(u - normal_rate(row, V), 0.0)
        row.surface -= counted
        row.swung, row.unsure = 0.5 * swing, unsure

"""Impacts of a single disk, by the closed law; which shapes touch at an instant.

A is the scene, t an instant within the step, i and j rows of BODY, a, b, o and s rows of SHAPE. A single disk has one
row number in both: the first COUNT.disks are those of single disks.
"""

from __future__ import annotations

import math

from ..compiled import inlined, nonallocating
from ..geometry.flight import move_to, pose
from ..geometry.gap import gap, gap_at, gap_round_off
from ..model.contacts import Impulse
from ..model.scene import Scene
from ..pairs.rules import barred, far_apart, law


@nonallocating
def touches(A: Scene, a: int, b: int, t: float) -> bool:
    """Whether shapes a and b touch at instant t, up to round-off."""
    tolerance = gap_round_off(A, a, b)
    if far_apart(A, a, b, t, tolerance):
        return False
    if max(a, b) < A.COUNT.disks:
        return True  # their bounding circles are the disks
    return gap(A, a, b, t)[0] <= tolerance


@inlined
def only_pair(A: Scene, i: int, o: int, t: float) -> bool:
    """Whether the impact of the single disk i with shape o, another single disk or a static shape, at instant t is
    theirs alone: no third shape touches either disk. A static shape passes no impulse on."""
    BODY, POOL, disks, even = A.BODY, A.POOL, A.COUNT.disks, A.COUNT.even > 0
    for s, partner in ((i, o), (o, i)):
        if s >= disks:
            continue
        x, y, _ = pose(BODY, s, t)
        ax, ay = BODY[s].ax, BODY[s].ay
        for q in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            k = int(POOL[q])
            if k == partner:
                continue
            if k < disks:
                # Bounding circles suffice for most, wider by more than the round-off of `touches`.
                h = t - BODY[k].since
                if not even:
                    ax, ay = BODY[k].ax, BODY[k].ay
                dx = BODY[k].x + (BODY[k].vx + 0.5 * ax * h) * h - x
                dy = BODY[k].y + (BODY[k].vy + 0.5 * ay * h) * h - y
                far = 1.001 * (BODY[s].extent + BODY[k].extent) + 1e-9 * (abs(x) + abs(y))
                if dx * dx + dy * dy > far * far:
                    continue
            if touches(A, s, k, t) and not barred(A, s, k):
                return False
    return True


@nonallocating
def log_impulse(
    row: Impulse, a: int, b: int, t: float, lam: float, beta: float, nx: float, ny: float, px: float, py: float,
    change: float, gap: float,
) -> None:  # fmt: skip
    """Write a row of the log: impulses lam and beta between shapes a and b at instant t, along the normal (nx, ny) and
    across, at the point (px, py). change: of the normal velocity by the impulse alone.  gap: at the start of the step,
    nan if it is still to be computed."""
    row.first, row.second, row.when, row.normal, row.tangential = a, b, t, lam, beta
    row.nx, row.ny, row.px, row.py, row.change = nx, ny, px, py, change
    row.gap, row.duration = gap, 0.0


@inlined
def strike_disk(A: Scene, i: int, o: int, t: float) -> None:
    """Impact of the single disk i with shape o, another single disk or a static shape.

    Bodies get their velocities after the impact, the log a row, the ledger the losses. The normal passes through both
    centres, so that normal and tangential direction are independent:

        lam = (1 + e) |u_n| / (1/m_i + 1/m_j),   beta = -u_t / A_tt, at most mu lam,   A_tt = sum 1/m + r^2/I.

    Two disks that overlap act on each other at one point, halfway between their surfaces.
    """
    BODY, PAR = A.BODY, A.PAR
    disk = o < A.COUNT.disks
    j = o if disk else A.LINK[o].owner
    move_to(BODY, i, t)
    x, y = BODY[i].x, BODY[i].y
    r_i, r_j = BODY[i].extent, 0.0
    if disk:
        move_to(BODY, j, t)
        nx, ny = BODY[j].x - x, BODY[j].y - y
        d = math.sqrt(nx * nx + ny * ny)
        nx, ny = nx / d, ny / d
        r_i = 0.5 * (d + r_i - BODY[j].extent)
        r_j = r_i - d
        px, py = x + r_i * nx, y + r_i * ny
    else:
        _, nx, ny, px, py = gap_at(A, i, x, y, BODY[i].angle, o, BODY[j].x, BODY[j].y, BODY[j].angle)
    e, mu, sx, sy = BODY[i].elasticity * BODY[j].elasticity, BODY[i].friction * BODY[j].friction, 0.0, 0.0
    if not disk or mu > 0.0 or A.RULE.shape[0] > 0:
        e, mu, sx, sy = law(A, i, o)
    vx, vy = BODY[j].vx - BODY[i].vx, BODY[j].vy - BODY[i].vy
    u = nx * vx + ny * vy
    free = BODY[i].inv_mass + BODY[j].inv_mass
    lam = (1.0 + e) * max(-u, 0.0) / free
    beta = 0.0
    if mu > 0.0:
        surface = nx * sy - ny * sx
        slip = nx * vy - ny * vx + surface + r_j * BODY[j].spin - r_i * BODY[i].spin
        turning = free + BODY[i].inv_inertia * r_i * r_i + BODY[j].inv_inertia * r_j * r_j
        beta = min(max(-slip / turning, -mu * lam), mu * lam)
        PAR.frictional -= beta * (slip + 0.5 * beta * turning)
        # The spin of a body with infinite moment does work, as a moving surface does.
        driven = surface + (r_j * BODY[j].spin if BODY[j].inv_inertia == 0.0 else 0.0)
        driven -= r_i * BODY[i].spin if BODY[i].inv_inertia == 0.0 else 0.0
        PAR.external -= beta * driven
    fx, fy = lam * nx - beta * ny, lam * ny + beta * nx
    BODY[i].vx -= fx * BODY[i].inv_mass
    BODY[i].vy -= fy * BODY[i].inv_mass
    BODY[i].spin -= BODY[i].inv_inertia * r_i * beta
    A.STATE[i].version += 1
    A.STATE[i].impacts += 1
    if disk:
        BODY[j].vx += fx * BODY[j].inv_mass
        BODY[j].vy += fy * BODY[j].inv_mass
        BODY[j].spin += BODY[j].inv_inertia * r_j * beta
        A.STATE[j].version += 1
        A.STATE[j].impacts += 1
    PAR.restitution += 0.5 * lam * (1.0 - e) * max(-u, 0.0)
    log_impulse(A.LOG[A.COUNT.logged], i, o, t, lam, beta, nx, ny, px, py, lam * free, math.nan)
    A.COUNT.logged += 1

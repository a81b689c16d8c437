"""Impacts of one disk alone, by the closed law; what touches whom, and the law of a pair."""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import merged, uncounted
from ..geometry.flight import pose
from ..geometry.gap import gap_at, touching
from ..layout import (
    ANGLE,
    AX,
    AY,
    BOUNCE,
    CHANGE,
    EXTENT,
    GAP,
    GRIP,
    II,
    IM,
    IMPULSE,
    NORMAL_X,
    NORMAL_Y,
    OWNER,
    POINT_X,
    POINT_Y,
    SINCE,
    SPIN,
    TANGENTIAL,
    VX,
    VY,
    WHEN,
    X,
    Y,
)  # fmt: skip
from ..layout import (
    FIRST_SHAPE as BY,
)
from ..layout import (
    SECOND_SHAPE as ON,
)
from ..pairs.layout import NUMBER, START
from ..pairs.lists import far_apart
from ..pairs.rules import barred, law
from .layout import (
    EVEN,
    EVENTS,
    EXTERNAL,
    FIRST_SHAPE,
    FRICTIONAL,
    IMPACTS,
    KINKS,
    LEDGER,
    LOGGED,
    RESTITUTION,
    SHAPES,
    Scene,
)  # fmt: skip


@uncounted
def move_to(BODY: FloatArray, i: int, t: float) -> None:
    """Let the path of body i begin at instant t."""
    s = t - BODY[i, SINCE]
    if s != 0.0:
        for c in range(3):
            BODY[i, X + c] += (BODY[i, VX + c] + 0.5 * BODY[i, AX + c] * s) * s
            BODY[i, VX + c] += BODY[i, AX + c] * s
        BODY[i, SINCE] = t


@uncounted
def kinetic(BODY: FloatArray, i: int) -> float:
    """Kinetic energy of body i; 0 for what impulses do not move."""
    if BODY[i, IM] == 0.0:
        return 0.0
    vx, vy, spin = BODY[i, VX], BODY[i, VY], BODY[i, SPIN]
    return 0.5 * (vx * vx + vy * vy) / BODY[i, IM] + (0.5 * spin * spin / BODY[i, II] if BODY[i, II] > 0.0 else 0.0)


@uncounted
def touches(A: Scene, disks: int, a: int, b: int, t: float) -> bool:
    """Whether shapes a and b touch at instant t, up to round-off."""
    BODY = A.BODY
    tolerance = touching(BODY, A.SHAPE, A.LINK, a, b, disks)
    if b < A.LIST.shape[0]:
        if far_apart(BODY, A.SHAPE, A.LINK, a, b, t, tolerance):
            return False
        if a < disks and b < disks:
            return True
    i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
    xa, ya, qa = pose(BODY, i, t)
    xb, yb, qb = pose(BODY, j, t)
    return gap_at(A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, xa, ya, qa, b, xb, yb, qb)[0] <= tolerance


@merged
def alone(A: Scene, disks: int, i: int, other: int, t: float) -> bool:
    """Whether no shape but `other` touches the shapes of body i at instant t."""
    BODY, POOL = A.BODY, A.POOL
    x, y, _ = pose(BODY, i, t)
    even, ax, ay = A.COUNT[EVEN] > 0, BODY[i, AX], BODY[i, AY]
    for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
        start = A.LIST[s, START]
        for q in range(start, start + A.LIST[s, NUMBER]):
            o = int(POOL[q])
            if o == other:
                continue
            if o < disks:
                # Most are plainly apart.
                h = t - BODY[o, SINCE]
                if not even:
                    ax, ay = BODY[o, AX], BODY[o, AY]
                dx = BODY[o, X] + (BODY[o, VX] + 0.5 * ax * h) * h - x
                dy = BODY[o, Y] + (BODY[o, VY] + 0.5 * ay * h) * h - y
                far = 1.001 * (BODY[i, EXTENT] + BODY[o, EXTENT]) + 1e-9 * (abs(x) + abs(y))
                if dx * dx + dy * dy > far * far:
                    continue
            if touches(A, disks, s, o, t) and not barred(A.RULE, s, o):
                return False
    return True


@uncounted
def note(
    LOG: FloatArray, n: int, a: int, b: int, t: float, lam: float, beta: float, nx: float, ny: float, px: float,
    py: float, change: float, gap: float,
) -> None:  # fmt: skip
    """Row n of the log: an impulse between shapes a and b at instant t; `gap` at the start of the step, nan if that is
    to be found out."""
    LOG[n, BY], LOG[n, ON], LOG[n, WHEN], LOG[n, IMPULSE], LOG[n, TANGENTIAL] = a, b, t, lam, beta
    LOG[n, NORMAL_X], LOG[n, NORMAL_Y], LOG[n, POINT_X], LOG[n, POINT_Y], LOG[n, CHANGE] = nx, ny, px, py, change
    LOG[n, GAP] = gap


@uncounted
def law_of_disks(BODY: FloatArray, i: int, j: int) -> tuple[float, float, float, float]:
    """`law` of two lone disks of which no handler says otherwise, and which have no friction: else their surfaces count
    too. From rows that are at hand."""
    return BODY[i, BOUNCE] * BODY[j, BOUNCE], BODY[i, GRIP] * BODY[j, GRIP], 0.0, 0.0


@merged
def strike_disk(A: Scene, disks: int, i: int, o: int, t: float) -> None:
    """Impact of the lone disk i with shape o, another of the lone `disks` or static.

    The normal goes through both centres, so that the two directions do not mix:

        lam = (1 + e) |u_n| / (1/m_i + 1/m_j),   beta = -u_t / A_tt, at most mu lam,   A_tt = sum 1/m + r^2/I.
    """
    BODY, PAR = A.BODY, A.PAR
    disk = o < disks
    j = o if disk else A.LINK[o, OWNER]
    move_to(BODY, i, t)
    x, y = BODY[i, X], BODY[i, Y]
    if disk:
        move_to(BODY, j, t)
        nx, ny = BODY[j, X] - x, BODY[j, Y] - y
        d = math.sqrt(nx * nx + ny * ny)
        nx, ny = nx / d, ny / d
        px, py = x + BODY[i, EXTENT] * nx, y + BODY[i, EXTENT] * ny
    else:
        _, nx, ny, px, py = gap_at(
            A.SHAPE, A.LINK, A.VERTEX, A.WORK, i, x, y, BODY[i, ANGLE], o, BODY[j, X], BODY[j, Y], BODY[j, ANGLE]
        )
    e, mu, sx, sy = law_of_disks(BODY, i, j)
    if not disk or mu > 0.0 or A.RULE.shape[0] > 0:
        e, mu, sx, sy = law(A.SHAPE, A.RULE, i, o)
    vx, vy = BODY[j, VX] - BODY[i, VX], BODY[j, VY] - BODY[i, VY]
    u = nx * vx + ny * vy
    free = BODY[i, IM] + BODY[j, IM]
    lam = (1.0 + e) * max(-u, 0.0) / free
    beta = 0.0
    r_i, r_j = BODY[i, EXTENT], -BODY[j, EXTENT] if disk else 0.0
    if mu > 0.0:
        surface = nx * sy - ny * sx
        slip = nx * vy - ny * vx + surface + r_j * BODY[j, SPIN] - r_i * BODY[i, SPIN]
        turning = free + BODY[i, II] * r_i * r_i + BODY[j, II] * r_j * r_j
        beta = min(max(-slip / turning, -mu * lam), mu * lam)
        PAR[LEDGER + FRICTIONAL] -= beta * (slip + 0.5 * beta * turning)
        # What nothing turns drives as a surface does.
        driven = surface + (r_j * BODY[j, SPIN] if BODY[j, II] == 0.0 else 0.0)
        driven -= r_i * BODY[i, SPIN] if BODY[i, II] == 0.0 else 0.0
        PAR[LEDGER + EXTERNAL] -= beta * driven
    fx, fy = lam * nx - beta * ny, lam * ny + beta * nx
    BODY[i, VX] -= fx * BODY[i, IM]
    BODY[i, VY] -= fy * BODY[i, IM]
    BODY[i, SPIN] -= BODY[i, II] * r_i * beta
    A.STATE[i, KINKS] += 1
    A.STATE[i, EVENTS] += 1
    if disk:
        BODY[j, VX] += fx * BODY[j, IM]
        BODY[j, VY] += fy * BODY[j, IM]
        BODY[j, SPIN] += BODY[j, II] * r_j * beta
        A.STATE[j, KINKS] += 1
        A.STATE[j, EVENTS] += 1
    PAR[LEDGER + RESTITUTION] += 0.5 * lam * (1.0 - e) * max(-u, 0.0)
    note(A.LOG, A.COUNT[LOGGED], i, o, t, lam, beta, nx, ny, px, py, lam * free, math.nan)
    A.COUNT[LOGGED] += 1
    A.COUNT[IMPACTS] += 1

"""The two ends of a step: what was read from the space becomes the bodies' paths, and the other way round.

Bitwise comparison with what was written last finds what the user has changed: only that is forecast anew.
"""

from __future__ import annotations

import math

from ..compiled import uncounted
from ..geometry.gap import gap_at
from ..layout import ANGLE, AX, AY, DUE, II, IM, OWNER, SINCE, SPIN, TWIST, VX, VY, X, Y
from .layout import (
    AFTER, BEFORE, BLOCKS, BY, CHANGED, DAMPED, DAMPING, DONE, DT, EVENTS, EXTERNAL, FORECASTS, GAP, GRAVITY_X,
    GRAVITY_Y, HEAP, IMPACTS, KINKS, LAST, LEDGER, LIFTED, LOCK, LOGGED, NOT_FINITE, ON, STALE, UNMET, Edge, Scene,
)  # fmt: skip
from .loop import forecast
from .strike import move_to

_X, _Y, _ANGLE, _VX, _VY, _SPIN, _FX, _FY, _TORQUE = range(9)  # columns of G


@uncounted
def energy(A: Scene, i: int) -> float:
    """Kinetic energy of body i, and potential energy -m g.x in the uniform gravity; 0 for what impulses do not move."""
    BODY = A.BODY
    if BODY[i, IM] == 0.0:
        return 0.0
    vx, vy, spin = BODY[i, VX], BODY[i, VY], BODY[i, SPIN]
    kinetic = 0.5 * (vx * vx + vy * vy) - A.PAR[GRAVITY_X] * BODY[i, X] - A.PAR[GRAVITY_Y] * BODY[i, Y]
    turning = 0.5 * spin * spin / BODY[i, II] if BODY[i, II] > 0.0 else 0.0
    return kinetic / BODY[i, IM] + turning


@uncounted
def begin(A: Scene, E: Edge, disks: int, moving: int) -> int:
    """Take what was read from the space as the start of a step of PAR[DT]: paths, and forecasts of what is due in it.

    CHANGED where bodies have come, gone, or are other static ones than they were; NOT_FINITE before anything is taken.
    """
    BODY, STATE, G, PAR, COUNT = A.BODY, A.STATE, E.G, A.PAR, A.COUNT
    for k in range(E.KNOWN.shape[0]):
        if E.IDS[k] != E.KNOWN[k]:
            return CHANGED
        if E.ROW[k] < 0:
            for c in range(3):
                if G[k, c] != E.EXPECT[k, c]:
                    return CHANGED
        total = 0.0
        for c in range(9):
            total += abs(G[k, c])
        if not math.isfinite(total):
            return NOT_FINITE
    for c in (HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE):
        COUNT[c] = 0
    if COUNT[UNMET] > 0:
        A.FLAG[:] = 0
        COUNT[UNMET] = 0
    for c in (0, 1, 2, 3, LIFTED):
        PAR[LEDGER + c] = 0.0
    PAR[LOCK] = 1.0
    damping, last = PAR[DAMPING], PAR[LAST]
    before = 0.0
    for k in range(E.KNOWN.shape[0]):
        i = E.ROW[k]
        if i < 0:
            continue
        ax, ay, twist = 0.0, 0.0, 0.0
        if BODY[i, IM] > 0.0:
            ax = PAR[GRAVITY_X] + G[k, _FX] * BODY[i, IM]
            ay = PAR[GRAVITY_Y] + G[k, _FY] * BODY[i, IM]
            twist = G[k, _TORQUE] * BODY[i, II]
        steered = E.EXTRA[i, 0] != 0.0
        if steered:
            ax, ay, twist = E.EXTRA[i, 1], E.EXTRA[i, 2], E.EXTRA[i, 3]
        damped = damping != 1.0 and not steered and BODY[i, IM] > 0.0
        same = not damped and ax == BODY[i, AX] and ay == BODY[i, AY] and twist == BODY[i, TWIST]
        for c in range(6):
            same = same and G[k, c] == E.EXPECT[k, c]
        if same:
            BODY[i, DUE] = max(BODY[i, DUE] - last, 0.0)
            before += energy(A, i)
        else:
            x, y, angle = G[k, _X], G[k, _Y], G[k, _ANGLE]
            px, py = E.COG[i, 0], E.COG[i, 1]
            if px != 0.0 or py != 0.0:
                c_, s_ = math.cos(angle), math.sin(angle)
                x += c_ * px - s_ * py
                y += s_ * px + c_ * py
            BODY[i, X], BODY[i, Y], BODY[i, ANGLE] = x, y, angle
            BODY[i, VX], BODY[i, VY], BODY[i, SPIN] = G[k, _VX], G[k, _VY], G[k, _SPIN]
            BODY[i, AX], BODY[i, AY], BODY[i, TWIST] = ax, ay, twist
            whole = energy(A, i)
            before += whole
            if damped:
                BODY[i, VX] *= damping
                BODY[i, VY] *= damping
                BODY[i, SPIN] *= damping
                PAR[LEDGER + DAMPED] += whole - energy(A, i)
            STATE[i, KINKS] += 1
            BODY[i, DUE] = -1.0
        BODY[i, SINCE] = 0.0
        STATE[i, EVENTS] = 0
        A.START[i, 0], A.START[i, 1], A.START[i, 2] = BODY[i, X], BODY[i, Y], BODY[i, ANGLE]
    PAR[BEFORE] = before
    for i in range(BODY.shape[0] - 1):
        if BODY[i, DUE] < PAR[DT]:
            forecast(A, disks, moving, i, 0.0, PAR[DT])
    return DONE


@uncounted
def finish(A: Scene, E: Edge) -> int:
    """Bring all bodies to the end of the step and write them out. NOT_FINITE if something overflows."""
    BODY, PAR, OUT = A.BODY, A.PAR, E.OUT
    end, damping = PAR[DT], PAR[DAMPING]
    after = 0.0
    finite = True
    for k in range(E.KNOWN.shape[0]):
        i = E.ROW[k]
        if i < 0:
            continue
        move_to(BODY, i, end)
        BODY[i, SINCE] = 0.0
        ax, ay, twist = BODY[i, AX], BODY[i, AY], BODY[i, TWIST]
        if BODY[i, IM] > 0.0:
            # What forces other than gravity have done.
            fx, fy = ax - PAR[GRAVITY_X], ay - PAR[GRAVITY_Y]
            if fx != 0.0 or fy != 0.0:
                work = fx * (BODY[i, X] - A.START[i, 0]) + fy * (BODY[i, Y] - A.START[i, 1])
                PAR[LEDGER + EXTERNAL] += work / BODY[i, IM]
            if twist != 0.0 and BODY[i, II] > 0.0:
                PAR[LEDGER + EXTERNAL] += twist * (BODY[i, ANGLE] - A.START[i, 2]) / BODY[i, II]
            if damping != 1.0 and E.EXTRA[i, 0] == 0.0:
                whole = energy(A, i)
                BODY[i, VX] *= damping
                BODY[i, VY] *= damping
                BODY[i, SPIN] *= damping
                PAR[LEDGER + DAMPED] += whole - energy(A, i)
        x, y, angle = BODY[i, X], BODY[i, Y], BODY[i, ANGLE]
        px, py = E.COG[i, 0], E.COG[i, 1]
        if px != 0.0 or py != 0.0:
            c_, s_ = math.cos(angle), math.sin(angle)
            x -= c_ * px - s_ * py
            y -= s_ * px + c_ * py
        OUT[k, 0], OUT[k, 1], OUT[k, 2] = x, y, angle
        OUT[k, 3], OUT[k, 4], OUT[k, 5] = BODY[i, VX], BODY[i, VY], BODY[i, SPIN]
        total = 0.0
        for c in range(6):
            E.EXPECT[k, c] = OUT[k, c]
            total += abs(OUT[k, c])
        finite = finite and math.isfinite(total)
        after += energy(A, i)
    PAR[AFTER] = after
    PAR[LAST] = end
    START, LOG = A.START, A.LOG
    for n in range(A.COUNT[LOGGED]):
        a, b = int(LOG[n, BY]), int(LOG[n, ON])
        i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
        LOG[n, GAP] = gap_at(
            A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, START[i, 0], START[i, 1], START[i, 2],
            b, START[j, 0], START[j, 1], START[j, 2],
        )[0]  # fmt: skip
    return DONE if finite else NOT_FINITE

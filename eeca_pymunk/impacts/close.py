"""A step's end: paths come to its last instant, islands and the work of forces are booked."""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import uncounted
from ..geometry.gap import gap_at
from ..layout import ANGLE, EXTENT, GAP, II, IM, OWNER, X, Y
from ..layout import FIRST_SHAPE as FIRST_OF
from ..layout import SECOND_SHAPE as SECOND_OF
from .booking import book, lift_out
from .calm import LIKELY, find_still
from .energy import total, unsteered
from .layout import (
    AFTER,
    DAMPED,
    DISKS,
    DT,
    EVEN,
    EXTERNAL,
    FRICTIONAL,
    GRAVITY_X,
    GRAVITY_Y,
    ISLAND,
    LAST,
    LEDGER,
    LEFT_OVER,
    LOGGED,
    PUSHES,
    QUIET,
    RESTITUTION,
    ROOT,
    STILL,
    STORED,
    Scene,
)
from .still import halt, keep, leave, stand
from .strike import move_to


@uncounted
def close(A: Scene, WALK: IntArray) -> None:
    """Bring all paths to the end of the step; book islands, the work of forces, the energy; gaps at the start."""
    BODY, PAR, LOG, BEGAN, COUNT = A.BODY, A.PAR, A.LOG, A.BEGAN, A.COUNT
    end = PAR[DT]
    even = COUNT[EVEN] > 0  # no islands
    COUNT[QUIET] = COUNT[QUIET] + 1 if even else 0
    if not even:
        find_still(A)
    for c in range(COUNT[PUSHES]):
        root = A.PUSHED_BY[c, ROOT]
        if root >= 0 and A.MEMBER[root, STILL] == 1:
            stand(A, c)
        elif root >= 0:
            book(A, c, end)
            if A.MEMBER[root, STILL] == LIKELY:
                keep(A, c, root)
    gx, gy = PAR[GRAVITY_X], PAR[GRAVITY_Y]
    for i in range(BODY.shape[0] - 1):
        move_to(BODY, i, end)
        if not even and A.STATE[i, ISLAND] == i:
            lift_out(A, i, end)
            if A.MEMBER[i, STILL] == LIKELY:
                halt(A, i)
    for i in range(BODY.shape[0] - 1):
        fx, fy, twist = A.PULL[i, 0] - gx, A.PULL[i, 1] - gy, A.PULL[i, 2]
        if BODY[i, IM] > 0.0 and (fx != 0.0 or fy != 0.0 or twist != 0.0):
            work = (fx * (BODY[i, X] - BEGAN[i, 0]) + fy * (BODY[i, Y] - BEGAN[i, 1])) / BODY[i, IM]
            if BODY[i, II] > 0.0:
                work += twist * (BODY[i, ANGLE] - BEGAN[i, 2]) / BODY[i, II]
            PAR[LEDGER + EXTERNAL] += work
    # What friction gives back counts against restitution, and the other way round.
    for one, other in ((RESTITUTION, FRICTIONAL), (FRICTIONAL, RESTITUTION)):
        if PAR[LEDGER + one] < 0.0 and PAR[LEDGER + other] > 0.0:
            PAR[LEDGER + other] += PAR[LEDGER + one]
            PAR[LEDGER + one] = 0.0
    PAR[AFTER] = total(A) + PAR[STORED]
    left = PAR[LEFT_OVER]
    if left != 1.0:
        lost = unsteered(A, WALK) * (1.0 - left * left)
        PAR[LEDGER + DAMPED] += lost
        PAR[AFTER] -= lost
    PAR[LAST] = end
    for n in range(COUNT[LOGGED]):
        if not math.isnan(LOG[n, GAP]):
            continue
        a, b = int(LOG[n, FIRST_OF]), int(LOG[n, SECOND_OF])
        if max(a, b) < COUNT[DISKS]:
            dx, dy = BEGAN[a, 0] - BEGAN[b, 0], BEGAN[a, 1] - BEGAN[b, 1]
            LOG[n, GAP] = math.sqrt(dx * dx + dy * dy) - BODY[min(a, b), EXTENT] - BODY[max(a, b), EXTENT]
            continue
        i, j = A.LINK[a, OWNER], A.LINK[b, OWNER]
        LOG[n, GAP] = gap_at(
            A.SHAPE, A.LINK, A.VERTEX, A.WORK, a, BEGAN[i, 0], BEGAN[i, 1], BEGAN[i, 2],
            b, BEGAN[j, 0], BEGAN[j, 1], BEGAN[j, 2],
        )[0]  # fmt: skip
    if not even:
        leave(A)

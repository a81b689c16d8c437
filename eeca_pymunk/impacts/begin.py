"""A step's beginning: who is forecast anew, and the energy that there is."""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import uncounted
from ..layout import ANGLE, AX, AY, DUE, IM, TWIST, X, Y
from .booking import flag_spans
from .energy import total, unsteered
from .layout import (
    BEFORE,
    BLOCKS,
    BUSY,
    CARRIES,
    CRAMMED,
    DAMPED,
    DIRECT,
    EVEN,
    EVENTS,
    FORECASTS,
    HEAP,
    IGNORED,
    IMPACTS,
    ISLAND,
    KINKS,
    LAST,
    LEDGER,
    LEDGER_LENGTH,
    LEFT_OVER,
    LOCK,
    LOGGED,
    PENDING,
    PHASE,
    PULLED,
    PUT,
    QUIET,
    SOLVED,
    SOLVES,
    STALE,
    STAMP,
    STILL,
    STILL_DUE,
    STORED,
    SWEEPS,
    TIED,
    UNMET,
    Scene,
)
from .settle import BUSY_FOR
from .still import stays, watch


@uncounted
def begin(A: Scene, WALK: IntArray) -> None:
    """Count from the start of this step; forecast the bodies that were edited, and all that is due."""
    BODY, STATE, PAR, COUNT = A.BODY, A.STATE, A.PAR, A.COUNT
    for c in (HEAP, LOGGED, IMPACTS, BLOCKS, FORECASTS, STALE, SOLVES, SOLVED, IGNORED, SWEEPS, DIRECT):
        COUNT[c] = 0
    if COUNT[UNMET] > 0:
        A.FLAG[:] = 0
        COUNT[UNMET] = 0
        # Pairs that were passed over are in nobody's forecast.
        for i in range(BODY.shape[0] - 1):
            BODY[i, DUE], A.RESTING[i, STILL_DUE] = min(BODY[i, DUE], 0.0), 0.0
        flag_spans(A)
    for c in range(LEDGER_LENGTH):
        PAR[LEDGER + c] = 0.0
    PAR[LOCK], PAR[STORED] = 1.0, 0.0
    PAR[BEFORE] = total(A)
    left = PAR[LEFT_OVER]
    if left != 1.0:
        # `take` has damped velocities already, by half a step's worth.
        PAR[LEDGER + DAMPED] = unsteered(A, WALK) * (1.0 / (left * left) - 1.0)
        PAR[BEFORE] += PAR[LEDGER + DAMPED]
    PAR[STAMP] += 1.0
    COUNT[PENDING], COUNT[PHASE] = -1, 0
    n, last = BODY.shape[0] - 1, PAR[LAST]
    pulled, even, carries = 0.0, True, A.RULE.shape[0] == 0
    quiet = COUNT[QUIET] > BUSY_FOR
    for i in range(n):
        STATE[i, EVENTS] = 0
        carries = carries and A.MEMBER[i, TIED] < 0
        if not quiet:
            A.MEMBER[i, BUSY] = max(A.MEMBER[i, BUSY] - 1, 0)
        if not quiet and A.MEMBER[i, STILL] == 1 and stays(A, i, last):
            pulled = max(pulled, A.PULL[i, 0] * A.PULL[i, 0] + A.PULL[i, 1] * A.PULL[i, 1])
            even = False
            continue
        if BODY[i, IM] == 0.0:
            watch(A, i)
        ax, ay = BODY[i, AX], BODY[i, AY]
        A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2] = ax, ay, BODY[i, TWIST]
        pulled = max(pulled, ax * ax + ay * ay)
        A.BEGAN[i, 0], A.BEGAN[i, 1], A.BEGAN[i, 2] = BODY[i, X], BODY[i, Y], BODY[i, ANGLE]
        if BODY[i, DUE] < 0.0:
            STATE[i, KINKS] += 1
            if BODY[i, DUE] == -math.inf:
                A.MEMBER[i, PUT] = 1
        else:
            BODY[i, DUE] = max(BODY[i, DUE] - last, 0.0)
        alike = BODY[i, IM] == 0.0 or (ax == BODY[0, AX] and ay == BODY[0, AY])
        even = even and alike and STATE[i, ISLAND] < 0
    PAR[PULLED] = math.sqrt(pulled)
    COUNT[EVEN] = 1 if even else 0
    COUNT[CARRIES] = 1 if carries else 0
    COUNT[CRAMMED] = 0
    for i in range(n):
        COUNT[CRAMMED] += A.MEMBER[i, PUT]

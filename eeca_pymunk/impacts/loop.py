"""The event loop of a step: one queue of impacts, leaves and looks, each body on its own clock.

Nobody is moved at another's event: a body's path begins at its own last kink. What was forecast with a path that has
kinked since is forecast anew when it comes up; until then it can only be too early.
"""

from __future__ import annotations

from ..compiled import kernel, uncounted
from ..layout import BODY_COLUMNS, DUE, IM, OWNER
from ..pairs.grid import renew
from ..pairs.lists import mark_pair
from .forecast import has_left, predict
from .heap import pop, push, sweep_out
from .layout import (
    CHECK, DONE, DT, EVENTS, HEAP, KINKS, KNOWN, LEAVE, LIMIT, LOG_FULL, LOGGED, NOW, OTHER, OWN,
    BLOCK_DUE, POOL_FULL, STRUCK, UNMET, Scene,
)  # fmt: skip
from .strike import alone, strike, strike_disk

_SQUEEZED = 50  # impacts of a body in a step, from which those with a kinematic one are left out: walls may close in


@uncounted
def forecast(A: Scene, disks: int, moving: int, i: int, t: float, end: float) -> None:
    """The next event of body i, seen from instant t of the loop."""
    predict(
        A.BODY, A.STATE, A.SHAPE, A.LINK, A.VERTEX, A.MARK, A.LIST, A.POOL, A.FLAG, A.RULE, A.HEAP_TIME, A.HEAP_BODY,
        A.WORK, A.COUNT, disks, moving, i, t, end,
    )  # fmt: skip


@uncounted
def give_up(A: Scene, i: int, j: int) -> bool:
    """Whether bodies i and j have met as often as a step allows."""
    limit = A.COUNT[LIMIT]
    if A.STATE[i, EVENTS] >= limit or A.STATE[j, EVENTS] >= limit:
        return True
    ground = A.BODY.shape[0] - 1
    carried = (A.BODY[i, IM] == 0.0 and i != ground) or (A.BODY[j, IM] == 0.0 and j != ground)
    return carried and max(A.STATE[i, EVENTS], A.STATE[j, EVENTS]) >= _SQUEEZED


@uncounted
def run(A: Scene, disks: int, smooth: bool) -> int:
    """Follow the events until the end of the step, or the next one that is a block (BLOCK_DUE) or wants more room.

    Args:
        disks: the first so many bodies are lone disks.  smooth: whether nothing has friction.
    """
    BODY, STATE, COUNT, TIME, OF = A.BODY, A.STATE, A.COUNT, A.HEAP_TIME, A.HEAP_BODY
    moving = A.LIST.shape[0]
    end = A.PAR[DT]
    while COUNT[HEAP] > 0:
        t, i = TIME[0], OF[0]
        if t != BODY[i, DUE]:
            COUNT[HEAP] = pop(TIME, OF, COUNT[HEAP])
            continue
        if COUNT[HEAP] + BODY.shape[0] > TIME.shape[0]:
            COUNT[HEAP] = sweep_out(TIME, OF, COUNT[HEAP], BODY)
        if COUNT[LOGGED] == A.LOG.shape[0]:
            return LOG_FULL
        COUNT[HEAP] = pop(TIME, OF, COUNT[HEAP])
        s, o = STATE[i, OWN], STATE[i, OTHER]
        if o == LEAVE:
            if has_left(BODY, A.SHAPE, A.LINK, A.MARK, s, t) and not renew(
                BODY, A.SHAPE, A.LINK, A.MARK, A.CELL, A.LIST, A.POOL, A.FLAG, A.HEAD, A.GRID, A.INFO, A.BOX, A.CSR,
                s, t,
            ):  # fmt: skip
                A.PAR[NOW] = t
                COUNT[HEAP] = push(TIME, OF, COUNT[HEAP], t, i)
                return POOL_FULL
            forecast(A, disks, moving, i, t, end)
            continue
        if o < 0 or STATE[A.LINK[o, OWNER], KINKS] != STATE[i, KNOWN]:
            forecast(A, disks, moving, i, t, end)
            continue
        j = A.LINK[o, OWNER]
        if give_up(A, i, j):
            COUNT[UNMET] += 1
            mark_pair(A.LIST, A.POOL, A.FLAG, moving, s, o, 1)
            forecast(A, disks, moving, i, t, end)
            continue
        if (
            smooth
            and i < disks
            and (o < disks or o >= moving)
            and alone(A, disks, i, o, t)
            and (o >= moving or alone(A, disks, j, i, t))
        ):
            strike_disk(A, i, o, t)
            forecast(A, disks, moving, i, t, end)
            if o < disks:
                forecast(A, disks, moving, j, t, end)
            continue
        A.PAR[NOW], COUNT[STRUCK] = t, i
        return BLOCK_DUE
    return DONE


@kernel
def follow(A: Scene, disks: int, smooth: bool) -> int:
    """The events of the step, blocks included. After a status other than DONE, make room and call again."""
    COUNT = A.COUNT
    moving, end = A.LIST.shape[0], A.PAR[DT]
    while True:
        status = run(A, disks, smooth)
        if status != BLOCK_DUE:
            return status
        t, i = A.PAR[NOW], COUNT[STRUCK]
        status, n = strike(A, disks, A.STATE[i, OWN], A.STATE[i, OTHER], t)
        if status != DONE:
            COUNT[HEAP] = push(A.HEAP_TIME, A.HEAP_BODY, COUNT[HEAP], t, i)
            return status
        for q in range(n):
            forecast(A, disks, moving, A.BLOCK[q], t, end)

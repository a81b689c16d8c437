"""A step whose contacts act together at its middle, psi2 = 0: the bounded solve of islands on all contacts.

No event is followed. Every pair that may close within the step is a contact of an island, and every island has one
span, the step. Who may be reached depends on whom impulses make fast: a body of mass m that moves at v gives one of
mass M up to 2 m v / (m + M), and so on from body to body; the product of these factors round a loop is at most 1.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..layout import EXTENT, IM, OWNER, SIZE, SPIN, VX, VY
from ..pairs.candidates import cover
from ..pairs.layout import NUMBER, START
from ..transfer import EVENTS as SOME
from ..transfer import give, take
from .forecast import barred
from .islands import TOUCH, approach, solve, unite, way_of
from .layout import (
    DONE,
    DT,
    FIRST_SHAPE,
    GRAVITY_X,
    GRAVITY_Y,
    ISLAND,
    LEFT_OVER,
    LOGGED,
    NOW,
    PUSHES,
    SHAPES,
    SPEED,
    TOGETHER,
    Scene,
)  # fmt: skip
from .step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, ROOM_FOR_LISTS, begin, close

_MORE = 1.0 + 1e-9  # ratio of speeds from which a body is looked after again


@uncounted
def reaches(A: Scene, USUAL: FloatArray, i: int) -> bool:
    """Make the lists of body i complete for what it may reach within the step. False if there is no room."""
    way = way_of(A, i, A.PAR[DT])
    for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
        if not cover(
            A.BODY, A.SHAPE, A.LINK, A.MARK, A.CELL, A.LIST, A.POOL, A.FLAG, A.HEAD, A.GRID, A.INFO, A.BOX, A.CSR,
            USUAL, s, way,
        ):  # fmt: skip
            return False
    return True


@uncounted
def meet(A: Scene, i: int, QUEUE: IntArray, WAITS: IntArray, first: int, count: int) -> int:
    """Put body i and whom it may touch within the step into one island, and make these as fast as it may make them;
    those that get faster join the queue. How many are in it then."""
    BODY, STATE, LINK, RESTING = A.BODY, A.STATE, A.LINK, A.RESTING
    dt, n = A.PAR[DT], QUEUE.shape[0]
    for s in range(STATE[i, FIRST_SHAPE], STATE[i, FIRST_SHAPE] + STATE[i, SHAPES]):
        for w in range(A.LIST[s, START], A.LIST[s, START] + A.LIST[s, NUMBER]):
            o = int(A.POOL[w])
            j = LINK[o, OWNER]
            if (BODY[i, IM] == 0.0 and BODY[j, IM] == 0.0) or barred(A.RULE, s, o):
                continue
            touch = TOUCH * min(A.SHAPE[s, SIZE], A.SHAPE[o, SIZE])
            if approach(A, s, o, 0.0)[0] > way_of(A, i, dt) + way_of(A, j, dt) + touch:
                continue
            if BODY[i, IM] > 0.0:
                unite(A, i, j if BODY[j, IM] > 0.0 else i)
            if BODY[j, IM] == 0.0:
                continue
            if BODY[i, IM] == 0.0:
                unite(A, j, j)
            speed = RESTING[i, SPEED] * 2.0 * BODY[j, IM] / (BODY[i, IM] + BODY[j, IM])
            if speed > _MORE * RESTING[j, SPEED]:
                RESTING[j, SPEED] = speed
                if WAITS[j] == 0:
                    WAITS[j] = 1
                    QUEUE[(first + count) % n] = j
                    count += 1
    return count


@kernel
def gather_all(A: Scene, USUAL: FloatArray) -> bool:
    """The islands of all bodies that may touch within the step. False if there is no room for lists."""
    BODY, STATE = A.BODY, A.STATE
    n = BODY.shape[0] - 1
    QUEUE, WAITS = np.empty(n, np.int64), np.ones(n, np.int64)
    A.RESTING[n, SPEED] = 0.0
    for i in range(n):
        STATE[i, ISLAND] = -1
        QUEUE[i] = i
        A.RESTING[i, SPEED] = math.hypot(BODY[i, VX], BODY[i, VY]) + abs(BODY[i, SPIN]) * BODY[i, EXTENT]
    for i in range(n):
        if not reaches(A, USUAL, i):
            return False
    first, count = 0, n
    while count > 0:
        i = QUEUE[first]
        first, count, WAITS[i] = (first + 1) % n, count - 1, 0
        if not reaches(A, USUAL, i):
            return False
        count = meet(A, i, QUEUE, WAITS, first, count)
    return True


@kernel
def resume_together(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, USUAL: FloatArray, status: int
) -> int:
    """The rest of a step, whose bits so far are `status`; from its start, if it has been broken off for more room."""
    COUNT = A.COUNT
    n = A.BODY.shape[0] - 1
    COUNT[PUSHES] = 0
    if not gather_all(A, USUAL):
        return ROOM_FOR_LISTS
    for i in range(n):
        if A.STATE[i, ISLAND] == i and solve(A, i, 0.0) != DONE:
            return ROOM_FOR_CONTACTS
    if COUNT[PUSHES] > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    close(A, WALK)
    if COUNT[LOGGED] > 0:
        status |= SOME
    return give(STATES, WALK, EXTRA, A.BODY, ENDS, A.PAR[DT], A.PAR[LEFT_OVER], status)


@kernel
def step_together(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float, gy: float,
    left: float, USUAL: FloatArray,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written: arguments and answer as of `step.step`.

    Args:
        USUAL: (k,) margins of shapes that are not fast, length.
    """
    status = take(STATES, WALK, EXTRA, A.BODY, gx, gy, left)
    if status < 0:
        return status
    A.PAR[DT], A.PAR[GRAVITY_X], A.PAR[GRAVITY_Y], A.PAR[LEFT_OVER] = dt, gx, gy, left
    A.COUNT[TOGETHER], A.PAR[NOW] = 1, 0.0
    begin(A, WALK)
    return resume_together(A, STATES, WALK, EXTRA, ENDS, USUAL, status)

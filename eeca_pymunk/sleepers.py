"""Kernels of sleeping: which bodies were at rest in a step, sleep together, were touched as they slept, or may be."""

from __future__ import annotations

import math

import numpy as np

from .arrays import FloatArray, IntArray
from .compiled import kernel
from .compiled.records import Rows
from .joints.plan import representative
from .layout import BODY_ROW, READ, WRITTEN
from .model.contacts import Impulse
from .model.values import DYNAMIC, KINEMATIC

ROUND = 1e-14  # round-off, relative to coordinates and to the largest speed


@kernel
def rests(
    STATES: FloatArray, IDS: IntArray, DYNAMIC: IntArray, SIZE: FloatArray, RESTED: FloatArray, READY: IntArray,
    slow: float, dt: float, need: float,
) -> int:  # fmt: skip
    """Add up for how long bodies have been at rest: at both ends of the step

        |v|, |spin| SIZE <= slow + round-off     and     |x - x0| <= slow dt + round-off,

    without forces; `slow` and its reason are in `space/sleeping.py`. DYNAMIC (N,): 1 for dynamic bodies. SIZE (N,):
    length, 0 for bodies without shapes, of which |spin| itself is compared. RESTED (N,): time. READY (N,): 1 for bodies
    that have been at rest for the time `need`, and may sleep.

    Returns:
        1 if any body may sleep, else 0.
    """
    before, after = STATES[READ], STATES[WRITTEN]
    N, fastest, some = IDS.shape[1], 0.0, 0
    for i in range(N):
        vx, vy = after[i, 3], after[i, 4]
        fastest = max(fastest, math.sqrt(vx * vx + vy * vy))
    limit = slow + ROUND * fastest
    for i in range(N):
        still = IDS[BODY_ROW, i] >= 0 and DYNAMIC[i] > 0
        if still:
            size = SIZE[i]
            for c in range(3):
                scale = size if c == 2 else 1.0
                way, place = scale * abs(after[i, c] - before[i, c]), scale * abs(after[i, c])
                still = still and way <= limit * dt + ROUND * place
            for k in range(2):
                vx, vy, spin = STATES[k, i, 3], STATES[k, i, 4], STATES[k, i, 5]
                still = still and math.sqrt(vx * vx + vy * vy) <= limit
                still = still and abs(spin) * (size if size > 0.0 else 1.0) <= limit
            still = still and before[i, 6] == 0.0 and before[i, 7] == 0.0 and before[i, 8] == 0.0
        RESTED[i] = RESTED[i] + dt if still else 0.0
        READY[i] = 1 if still and RESTED[i] >= need else 0
        some = max(some, READY[i])
    return some


@kernel
def connect(PAIRS: IntArray, KIND: IntArray, READY: IntArray, GROUP: IntArray) -> None:
    """The groups of dynamic bodies that contacts and joints connect, all of which may sleep. A body that touches a
    kinematic one, or is jointed to it, may not.

    Args:
        PAIRS (m, 2): rows of bodies that touch or are jointed.  KIND (N,): of the bodies.
        READY (N,): 1 for bodies that may sleep.
        GROUP (N,): out, the number of its group; -1 for bodies that stay awake.
    """
    N = KIND.shape[0]
    parent, awake = np.arange(N), np.zeros(N, np.int64)
    for p in range(PAIRS.shape[0]):
        a, b = representative(parent, PAIRS[p, 0]), representative(parent, PAIRS[p, 1])
        if KIND[a] == DYNAMIC and KIND[b] == DYNAMIC:
            parent[a] = b
        elif KIND[a] == KINEMATIC:
            awake[PAIRS[p, 1]] = 1
        elif KIND[b] == KINEMATIC:
            awake[PAIRS[p, 0]] = 1
    for i in range(N):
        if KIND[i] == DYNAMIC and (awake[i] == 1 or READY[i] == 0):
            awake[representative(parent, i)] = 1
    for i in range(N):
        GROUP[i] = representative(parent, i)
        if READY[i] == 0 or awake[GROUP[i]] == 1:
            GROUP[i] = -1


@kernel
def touches_sleeper(LOG: Rows[Impulse], OWNER: IntArray, ASLEEP: IntArray, STILL: IntArray, count: int) -> int:
    """Whether one of the first `count` impulses is between a sleeping body and one that moves. OWNER (k,): bodies of
    shapes. ASLEEP (N,): 1 for sleeping bodies. STILL (N,): 1 for sleeping and static ones."""
    for e in range(count):
        a, b = OWNER[int(LOG[e].first)], OWNER[int(LOG[e].second)]
        if (ASLEEP[a] == 1 and STILL[b] == 0) or (ASLEEP[b] == 1 and STILL[a] == 0):
            return 1
    return 0


@kernel
def approaches(
    STATES: FloatArray, MOVES: IntArray, FREE: IntArray, SIZE: FloatArray, INVERSE: FloatArray, BOXES: FloatArray,
    MET: IntArray, dt: float, pull: float,
) -> int:  # fmt: skip
    """Find the boxes of sleeping shapes to which bodies may come within dt: those that move freely come no farther than

        SIZE + dt (|v| + dt (|g| + |f| / m)).

    Args:
        MOVES (m,): bodies that may.  FREE (N,): 1 for dynamic ones; others move by their velocities only.
        SIZE (N,): length from the origin of a body to its farthest point, 0 if it has no shape.
        INVERSE (N,): 1/mass.  BOXES (w, 4): left, bottom, right and top of sleeping shapes.
        MET (w,): out, the numbers of those boxes.  pull: |g|.

    Returns:
        the number of entries of MET. Bodies whose states are not finite meet none: the step raises.
    """
    now, m = STATES[READ], MOVES.shape[0]
    REACH, count = np.full(m, -math.inf), 0
    for k in range(m):
        i = MOVES[k]
        speed = math.sqrt(now[i, 3] * now[i, 3] + now[i, 4] * now[i, 4])
        force = math.sqrt(now[i, 6] * now[i, 6] + now[i, 7] * now[i, 7]) * INVERSE[i]
        reach = SIZE[i] + dt * (speed + dt * (pull + force))
        moves = FREE[i] == 1 or speed > 0.0 or now[i, 5] != 0.0
        if SIZE[i] > 0.0 and moves and reach < math.inf:
            REACH[k] = reach
    for w in range(BOXES.shape[0]):
        for k in range(m):
            x, y, reach = now[MOVES[k], 0], now[MOVES[k], 1], REACH[k]
            beside = BOXES[w, 0] <= x + reach and BOXES[w, 2] >= x - reach
            if beside and BOXES[w, 1] <= y + reach and BOXES[w, 3] >= y - reach:
                MET[count] = w
                count += 1
                break
    return count

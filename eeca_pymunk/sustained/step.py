"""One span of one island: v+ = v + h a + M^-1 (G^T lam + T^T beta), each body on the parabola between v and v+."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..model.bodies import Rest
from ..model.contacts import Row
from ..model.parameters.impulses import DENSE_CONTACTS
from ..model.parameters.intervals import (
    DIRECT,
    DIRECT_MOVING,
    INTERVAL_RESIDUAL,
    INTERVAL_RESIDUAL_MOVING,
    INTERVAL_RESIDUAL_SPEED,
    LARGE_ISLAND,
    MIDPOINT_SAME,
    MIDPOINT_SAME_LARGE,
    NEAR_REST,
    SWEEPS_NEAR_REST,
)
from ..model.shapes import Link, Shape
from ..model.step import Count
from ..rows.build import conserves, rates
from ..rows.energy import lock, works
from ..rows.sweeps import velocities
from .contacts import gather
from .ledger import against, carried
from .lifting import lifting
from .memory import find, remember_loads
from .relax import relax
from .statics import comes_to_stand
from .targets import target

# Of OUT (8,)
SWEEPS, POLISHES, RESIDUAL, LOCK, OWED, DEEPEST, CLOSED, STOOD = 0, 1, 2, 3, 4, 5, 6, 7
OUT_SIZE = 8


@uncounted
def recall(
    KEY: IntArray, m: int, KEYS: IntArray, FORCES: FloatArray, stamp: float, h: float, L: FloatArray,
    EXPECTED: FloatArray,
) -> None:  # fmt: skip
    """First guesses L (m, 2) of the impulses, and those of loads (m,), from forces of this step or the last."""
    for i in range(m):
        L[i, 0] = 0.0
        L[i, 1] = 0.0
        EXPECTED[i] = 0.0
        row = find(KEYS, KEY[i])
        if row >= 0 and FORCES[row, 3] >= stamp - 1.0:
            L[i, 0] = h * FORCES[row, 0]
            L[i, 1] = h * FORCES[row, 1]
            EXPECTED[i] = h * FORCES[row, 2]


@uncounted
def speeds(
    V: FloatArray, ACC: FloatArray, EXTENT: FloatArray, IM: FloatArray, n: int, h: float, REACH: FloatArray
) -> tuple[float, float, float]:
    """Root mean square and largest speed of points of the n bodies, and their largest acceleration |a|.

    An island on nothing has no frame: speeds are relative to its common motion. REACH (k,) = how far a body's points
    may come in h, with some room.
    """
    x = 0.0
    y = 0.0
    if len(IM) == n:
        mass = 0.0
        for i in range(n):
            mass += 1.0 / IM[i]
            x += V[i, 0] / IM[i]
            y += V[i, 1] / IM[i]
        x /= mass
        y /= mass
    square = 0.0
    most = 0.0
    pull = 0.0
    for i in range(n):
        pull = max(pull, math.sqrt(ACC[i, 0] ** 2 + ACC[i, 1] ** 2))
    for i in range(len(IM)):
        speed = math.sqrt((V[i, 0] - x) ** 2 + (V[i, 1] - y) ** 2) + abs(V[i, 2]) * EXTENT[i]
        REACH[i] = 1.1 * speed * h
        if i < n:
            REACH[i] += 1.1 * pull * h * h + 1e-9 * EXTENT[i]
            square += speed * speed
            most = max(most, speed)
    return math.sqrt(square / n), most, pull


@kernel
def moved(X: FloatArray, V: FloatArray, s: float) -> FloatArray:
    """X + s V, all (k, 3)."""
    Y = np.empty_like(X)
    for i in range(len(X)):
        for c in range(3):
            Y[i, c] = X[i, c] + s * V[i, c]
    return Y


@kernel
def step_island(
    POSE: FloatArray, V: FloatArray, ACC: FloatArray, IM: FloatArray, II: FloatArray, EXTENT: FloatArray,
    FELT: FloatArray, n: int, PAIRS: IntArray, p: int, SHAPE: Rows[Shape], RULE: FloatArray, LINK: Rows[Link],
    VERTEX: FloatArray, WORK: FloatArray, h: float, most: int, least: float, owed: float, free: float, KEYS: IntArray,
    FORCES: FloatArray, COUNT: Count, stamp: float, STATE: Rest, calm: float,
    A: IntArray, B: IntArray, ROWS: Rows[Row], KEY: IntArray, L: FloatArray, LOSS: FloatArray, VN: FloatArray,
    JUMP: FloatArray, LEDGER: FloatArray, OUT: FloatArray,
) -> int:  # fmt: skip
    """Solve an island over h from now.

    Args:
        POSE, V, ACC: (k, 3) pose, velocity, acceleration without contacts.  IM, II, EXTENT: (k,).
        FELT: (k,) their EXTENT, 0 of bodies whose turning no contact feels.
        n: bodies that impulses move, the first of k; the others keep their velocities. A body without mobility that
            rests (the ground) is among the k as well; an island without any is free.
        PAIRS: (p, 4) as `contacts.gather`.  RULE: see `..pairs.rules`.  WORK: scratch of the geometry.
        most: sweeps of an island that moves.
        least: length that every body's points may come at least, 0 if their velocities tell.
        owed: energy >= 0 to take out at least.
        free: energy >= 0 that lifting may cost beyond the losses: from outside, by who put bodies into one another.
        KEYS, FORCES, COUNT, stamp: memory of forces; the number of this step.  STATE: (3,) of `relax`.
        calm: speed relative to |a| h at which it may come to a stand, see `.statics`, 0 if it may not; V is 0 once it
            does, its energy is the caller's to book. Negative: that is all that is asked for.
        A, B, ROWS, KEY, L, LOSS: the m contact rows out, with impulses over h and losses (D_n, D_t).
        VN: (k, 3) velocities at the end, out.  JUMP: (k, 6) what to add to pose and velocity then, out.
        LEDGER: (8,) added to.  OUT: (8,) sweeps, direct solutions, residual, scale of the lock, energy still owed,
            deepest gap at the end before lifting, contacts that push, whether the island came to a stand.
    Returns:
        m, or -1 if the arrays of rows (or the memory) are too small; nothing is changed then.
    """
    for i in range(len(OUT)):
        OUT[i] = 0.0
    OUT[3] = 1.0
    k = len(IM)
    REACH = np.empty(k)
    slow, fast, pull = speeds(V, ACC, EXTENT, IM, n, h, REACH)
    for i in range(k):
        REACH[i] = max(REACH[i], least)
    MIDDLE = moved(POSE, V, 0.5 * h)
    NOW = np.empty((2, 5))
    THEN = np.empty((2, 5))
    m = gather(
        PAIRS, p, SHAPE, RULE, LINK, VERTEX, WORK, POSE, MIDDLE, V, REACH, EXTENT, IM, II, h,
        k == n, MIDPOINT_SAME if n < LARGE_ISLAND else MIDPOINT_SAME_LARGE, A, B, ROWS, KEY, NOW, THEN,
    )  # fmt: skip
    if m < 0 or 2 * (COUNT.remembered + m) > len(KEYS):
        return -1
    FREE = moved(V, ACC, h)
    for i in range(k):
        for c in range(3):
            VN[i, c] = FREE[i, c]
            JUMP[i, c] = 0.0
            JUMP[i, 3 + c] = 0.0
    if m > 0:
        EXPECTED = np.empty(m)
        recall(KEY, m, KEYS, FORCES, stamp, h, L, EXPECTED)
        rates(A, B, ROWS, V, m)
        target(A, B, ROWS, m, ACC, EXPECTED, pull, h)
        if calm != 0.0:
            stands, polishes = comes_to_stand(
                A, B, ROWS, L, V, FREE, IM, II, POSE, FELT, VN, n, m, pull * h, abs(calm)
            )  # fmt: skip
            OUT[1] = polishes
            if stands:
                OUT[STOOD] = 1.0
                OUT[CLOSED] = remember_loads(ROWS, KEY, L, m, h, KEYS, FORCES, COUNT, stamp)
                return m
            if calm < 0.0:
                return 0
            rates(A, B, ROWS, V, m)
            target(A, B, ROWS, m, ACC, EXPECTED, pull, h)
        velocities(A, B, ROWS, L, FREE, IM, II, m, VN)
        scale = pull * h if pull > 0.0 else 1e-3 * fast
        elastic = conserves(ROWS, m)
        # Elastic crowds would melt away by the losses of a solve cut short.
        few = m <= DENSE_CONTACTS
        rounds = DIRECT if elastic or slow < pull * h else (DIRECT_MOVING if few else 0)
        coarse = 0.0 if elastic or few else INTERVAL_RESIDUAL_MOVING * scale + INTERVAL_RESIDUAL_SPEED * slow
        if slow < NEAR_REST * pull * h:
            # What stands tall falls over by what is left undone.
            most = SWEEPS_NEAR_REST
        sweeps, polishes, worst = relax(
            A, B, ROWS, L, VN, FREE, IM, II, POSE, n, m, rounds, INTERVAL_RESIDUAL * scale, coarse, STATE, most
        )  # fmt: skip
        # Sums over many sweeps have their own round-off: the velocities are those of the impulses.
        velocities(A, B, ROWS, L, FREE, IM, II, m, VN)
        OUT[0] += sweeps
        OUT[1] += polishes
        OUT[2] = worst
        OUT[3], OUT[4] = lock(A, B, ROWS, L, VN, FREE, IM, II, m, owed, elastic)
        normal, tangential = works(A, B, ROWS, L, VN, m, LOSS)
        size = np.inf
        for i in range(n):
            size = min(size, EXTENT[i])
        # Losses pay for lifting; what is elastic has none, whatever round-off says.
        budget = -1.0 if elastic else normal + tangential - owed
        if free > 0.0:
            budget = max(budget, 0.0) + free
        lifted, OUT[5] = lifting(A, B, ROWS, MIDDLE, VN, ACC, IM, II, n, m, h, size, budget, JUMP)
        LEDGER[0] += normal
        LEDGER[1] += tangential
        LEDGER[2] += carried(A, B, ROWS, L, V, VN, IM, II, m)
        LEDGER[3] += lifted
        OUT[CLOSED] = remember_loads(ROWS, KEY, L, m, h, KEYS, FORCES, COUNT, stamp)
    else:
        OUT[4] = owed
    LEDGER[4] += 0.5 * h * (against(ACC, IM, II, n, V) + against(ACC, IM, II, n, VN))
    return m

"""Impulses inside their cones that take all motion of an island, if there are any.

A contact's cone is spanned by its edges g = n +- mu t (without friction by n): v + M^-1 (G^T lam + T^T beta) = 0 is a
linear system B x = f in x >= 0, one x for each edge. Of all x the one next to a guess w is approached,

    minimise (1/2) sum A_gg (x - w)^2,   B x = f,   x >= 0,

by a primal-dual interior-point method with Mehrotra's predictor and corrector (1992). A step solves, for the
multipliers y of B x = f, which are velocities,

    (1/R + B Theta B^T) dy = r,   Theta = 1 / (A_gg + s / x),   s >= 0 those of x >= 0,

with the factor of `cholesky.py`. Where many contacts share the loads a step or two find forces that balance; active
sets, which have to be guessed right to the last contact, may need a hundred.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows, zeros
from ..model.contacts import ROW, Row
from ..model.parameters.impulses import PROXIMAL_STATICS
from ..model.parameters.rest import (
    STATICS_EARLY,
    STATICS_GAP,
    STATICS_PROGRESS,
    STATICS_RUNAWAY,
    STATICS_STALLED,
    STATICS_START,
    STATICS_STEP,
)
from .build import normal_rate
from .cholesky import assemble, factorise, substitute
from .inplace import copy
from .ordering import dissect, neighbours, pattern

# EDGE (K, 6) float: of each edge
X, S, GUESS, A_GG, DX, DS = 0, 1, 2, 3, 4, 5
EDGE_COLUMNS = 6


@uncounted
def bound(vx: float, vy: float, spin: float, extent: float) -> float:
    """A bound on the speed of the points of a body, no farther than extent from its centre of mass."""
    return abs(vx) + abs(vy) + extent * abs(spin)


@uncounted
def fastest(V: FloatArray, EXTENT: FloatArray, n: int) -> float:
    """A bound on the speed of all points of the n bodies; inf where one is not finite."""
    found = 0.0
    for i in range(n):
        one = bound(V[i, 0], V[i, 1], V[i, 2], EXTENT[i])
        if not one < np.inf:
            return np.inf
        found = max(found, one)
    return found


@uncounted
def edges(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, IM: FloatArray, II: FloatArray, m: int, OF: IntArray,
    P: IntArray, Q: IntArray, G: Rows[Row], EDGE: FloatArray,
) -> int:  # fmt: skip
    """The edges G (2 m, ..), as rows between P and Q, of the contacts OF whose TARGET is not below 0; how many.

    GUESS and X are set from L, A_GG = g^T M^-1 g.
    """
    K = 0
    for i in range(m):
        if ROWS[i].target < 0.0:
            continue
        mu = ROWS[i].friction
        for side in range(2 if mu > 0.0 else 1):
            slope = mu if side == 0 else -mu
            P[K], Q[K], OF[K] = A[i], B[i], i
            G[K].nx = ROWS[i].nx - slope * ROWS[i].ny
            G[K].ny = ROWS[i].ny + slope * ROWS[i].nx
            G[K].arm_na = ROWS[i].arm_na + slope * ROWS[i].arm_ta
            G[K].arm_nb = ROWS[i].arm_nb + slope * ROWS[i].arm_tb
            EDGE[K, GUESS] = L[i, 0] if mu <= 0.0 else max(0.5 * (L[i, 0] + L[i, 1] / slope), 0.0)
            EDGE[K, X] = EDGE[K, GUESS]
            EDGE[K, A_GG] = (IM[A[i]] + IM[B[i]]) * (1.0 + mu * mu)
            EDGE[K, A_GG] += II[A[i]] * G[K].arm_na ** 2 + II[B[i]] * G[K].arm_nb ** 2
            K += 1
    return K


@uncounted
def inside(EDGE: FloatArray, K: int) -> bool:
    """Go to X + DX, next to the guess of all that balances, and say whether it is inside the cones; if not, put it
    there, with S to begin with."""
    mean, least = 0.0, np.inf
    for e in range(K):
        EDGE[e, X] += EDGE[e, DX]
        mean += abs(EDGE[e, X]) / K
        least = min(least, EDGE[e, X])
    if least >= 0.0:
        return True
    load = 0.0
    for e in range(K):
        EDGE[e, X] = max(EDGE[e, X], STATICS_START * mean)
        load += EDGE[e, X] / K
    for e in range(K):
        EDGE[e, S] = EDGE[e, A_GG] * load
    return False


@uncounted
def send(
    P: IntArray, Q: IntArray, G: Rows[Row], EDGE: FloatArray, what: int, K: int, IM: FloatArray, II: FloatArray,
    V: FloatArray,
) -> None:  # fmt: skip
    """V += M^-1 sum g EDGE[what]."""
    for e in range(K):
        lam = EDGE[e, what]
        a, b = P[e], Q[e]
        V[a, 0] -= IM[a] * lam * G[e].nx
        V[a, 1] -= IM[a] * lam * G[e].ny
        V[a, 2] -= II[a] * lam * G[e].arm_na
        V[b, 0] += IM[b] * lam * G[e].nx
        V[b, 1] += IM[b] * lam * G[e].ny
        V[b, 2] += II[b] * lam * G[e].arm_nb


@uncounted
def along(
    P: IntArray, Q: IntArray, G: Rows[Row], EDGE: FloatArray, K: int, IM: FloatArray, II: FloatArray, n: int,
    SCALE: FloatArray, place: IntArray, columns: IntArray, rows: IntArray, DIAGONAL: FloatArray, BELOW: FloatArray,
    LEFT: FloatArray, Y: FloatArray, f: FloatArray, V: FloatArray, DY: FloatArray, centre: float, second: bool,
) -> None:  # fmt: skip
    """Newton's step DX, DS, DY towards X S = centre, less the product of the last step's if it is the second.

    LEFT (k, 3): velocities that X leaves.  f (n, 3), V (k, 3): scratch.
    """
    for i in range(len(V)):
        for c in range(3):
            V[i, c] = 0.0
    for e in range(K):
        x, s = EDGE[e, X], EDGE[e, S]
        if s == 0.0:
            EDGE[e, DX] = 0.0
            continue
        dual = EDGE[e, A_GG] * (x - EDGE[e, GUESS]) - normal_rate(P, Q, G, Y, e) - s
        product = x * s - centre + (EDGE[e, DX] * EDGE[e, DS] if second else 0.0)
        EDGE[e, DS] = product
        EDGE[e, DX] = G[e].k_n * (dual + product / x)
    send(P, Q, G, EDGE, DX, K, IM, II, V)
    for i in range(n):
        for c in range(3):
            f[place[i], c] = PROXIMAL_STATICS * (V[i, c] - LEFT[i, c]) / SCALE[i, c] if SCALE[i, c] > 0.0 else 0.0
    substitute(n, columns, rows, DIAGONAL, BELOW, f)
    for i in range(n):
        for c in range(3):
            DY[i, c] = SCALE[i, c] * f[place[i], c]
    for e in range(K):
        EDGE[e, DX] = G[e].k_n * normal_rate(P, Q, G, DY, e) - EDGE[e, DX]
        if EDGE[e, S] > 0.0:
            EDGE[e, DS] = -(EDGE[e, DS] + EDGE[e, S] * EDGE[e, DX]) / EDGE[e, X]


@uncounted
def reach(EDGE: FloatArray, K: int, value: int, change: int) -> float:
    """How much of a change, at most all of it, leaves all values well positive."""
    most = 1.0
    for e in range(K):
        if EDGE[e, change] < 0.0:
            most = min(most, -STATICS_STEP * EDGE[e, value] / EDGE[e, change])
    return most


@uncounted
def products(EDGE: FloatArray, K: int, primal: float, dual: float) -> float:
    """Mean of x s after parts of a step."""
    total = 0.0
    for e in range(K):
        total += (EDGE[e, X] + primal * EDGE[e, DX]) * (EDGE[e, S] + dual * EDGE[e, DS])
    return total / K


@uncounted
def go(EDGE: FloatArray, K: int, Y: FloatArray, DY: FloatArray, primal: float, dual: float) -> None:
    """Take parts of a step."""
    for e in range(K):
        EDGE[e, X] += primal * EDGE[e, DX]
        EDGE[e, S] += dual * EDGE[e, DS]
    for i in range(len(Y)):
        for c in range(3):
            Y[i, c] += dual * DY[i, c]


@uncounted
def give(ROWS: Rows[Row], EDGE: FloatArray, OF: IntArray, K: int, L: FloatArray, m: int) -> None:
    """Impulses L (m, 2) of the x of their edges."""
    for i in range(m):
        L[i, 0] = L[i, 1] = 0.0
    for e in range(K):
        i = OF[e]
        slope = ROWS[i].friction
        if e > 0 and OF[e - 1] == i:
            slope = -slope
        L[i, 0] += EDGE[e, X]
        L[i, 1] += slope * EDGE[e, X]


@kernel
def equilibrium(
    A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, START: FloatArray, IM: FloatArray, II: FloatArray,
    POSE: FloatArray, EXTENT: FloatArray, n: int, m: int, tolerance: float, most: int, nearest: bool,
) -> tuple[bool, int]:  # fmt: skip
    """Look for impulses that take the velocities START (k, 3) of the n bodies that impulses move.

    Args:
        ROWS: m contacts; those with a TARGET below 0 carry nothing.
        START: out, if there are none, a motion that nothing holds: the multipliers y, which grow along it.
        L: (m, 2) guess in, impulses out if they are found.
        POSE: (k, 3), for the order of elimination alone.  EXTENT: (k,) how far points of bodies are.
        tolerance: speed of their points that may be left.  most: factors at most.
        nearest: whether to go on to the impulses next to the guess.
    Returns:
        Whether they are found, and how many factors that took.
    """
    k = len(IM)
    OF, P, Q = np.empty(2 * m, np.int64), np.empty(2 * m, np.int64), np.empty(2 * m, np.int64)
    G, EDGE = zeros(2 * m, ROW), np.zeros((2 * m, EDGE_COLUMNS))
    K = edges(A, B, ROWS, L, IM, II, m, OF, P, Q, G, EDGE)
    LEFT, Y, DY, V, f = np.empty((k, 3)), np.zeros((k, 3)), np.zeros((k, 3)), np.empty((k, 3)), np.empty((n, 3))
    if K == 0:
        return fastest(START, EXTENT, n) <= tolerance, 0  # START is that motion itself
    SCALE = np.empty((k, 3))
    for i in range(k):
        SCALE[i, 0] = SCALE[i, 1] = math.sqrt(IM[i])
        SCALE[i, 2] = math.sqrt(II[i])
    held, stuck = np.ones(K, np.int64), np.zeros(K, np.int64)
    start, other = neighbours(P, Q, K, n, held)
    place = np.empty(n, np.int64)
    dissect(POSE, n, start, other, place)
    columns, rows = pattern(n, start, other, place)
    DIAGONAL, BELOW = np.empty((n, 3, 3)), np.empty((len(rows), 3, 3))
    found, free, stalled, last, first = False, True, 0, np.inf, 0.0
    given = fastest(START, EXTENT, n)
    for done in range(most + 1):
        copy(LEFT, START)
        send(P, Q, G, EDGE, X, K, IM, II, LEFT)
        speed = fastest(LEFT, EXTENT, n)
        centre = products(EDGE, K, 0.0, 0.0)
        if speed <= tolerance:
            found = True
            give(ROWS, EDGE, OF, K, L, m)
            if not nearest or centre <= STATICS_GAP * first:
                return True, done
        elif not found and done > STATICS_EARLY:
            if speed <= STATICS_PROGRESS * last:
                stalled = 0
            else:
                stalled += STATICS_STALLED if fastest(Y, EXTENT, n) > STATICS_RUNAWAY * given else 1
        if done == most or stalled >= STATICS_STALLED or not (speed < np.inf and (centre > 0.0 or free)):
            if not found:
                copy(START, Y)
            return found, done
        last = speed
        if done == 0 or not free:
            for e in range(K):
                G[e].k_n = 1.0 / (EDGE[e, A_GG] + (0.0 if free else EDGE[e, S] / EDGE[e, X]))
            assemble(P, Q, G, K, n, held, stuck, SCALE, place, columns, rows, PROXIMAL_STATICS, DIAGONAL, BELOW)
            factorise(n, columns, rows, DIAGONAL, BELOW)
        along(
            P, Q, G, EDGE, K, IM, II, n, SCALE, place, columns, rows, DIAGONAL, BELOW, LEFT, Y, f, V, DY, 0.0, False
        )  # fmt: skip
        if free:
            # Next to the guess of all that balances, cones or not: often that is all.
            free = inside(EDGE, K)
            first = products(EDGE, K, 0.0, 0.0)
            continue
        aim = centre * (products(EDGE, K, reach(EDGE, K, X, DX), reach(EDGE, K, S, DS)) / centre) ** 3
        along(
            P, Q, G, EDGE, K, IM, II, n, SCALE, place, columns, rows, DIAGONAL, BELOW, LEFT, Y, f, V, DY, aim, True
        )  # fmt: skip
        go(EDGE, K, Y, DY, reach(EDGE, K, X, DX), reach(EDGE, K, S, DS))
    return found, most

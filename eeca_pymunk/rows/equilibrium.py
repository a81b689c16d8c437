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
from ..model.contacts import EDGE as EDGE_KIND
from ..model.contacts import ROW, Edge, Problem, Row
from ..model.parameters.impulses import PROXIMAL_STATICS
from ..model.parameters.rest import (
    STATICS_GAP,
    STATICS_PROGRESS,
    STATICS_RUNAWAY,
    STATICS_STALLED,
    STATICS_START,
    STATICS_STEP,
)
from .build import normal_rate
from .cholesky import Factor, assemble, factorise, substitute
from .inplace import copy
from .ordering import dissect, neighbours, pattern


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
    P: IntArray, Q: IntArray, G: Rows[Row], EDGE: Rows[Edge],
) -> int:  # fmt: skip
    """The edges G (2 m, ..), as rows between P and Q, of the contacts OF whose target is not below 0; how many.

    guess and x are set from L, a_gg = g^T M^-1 g.
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
            EDGE[K].guess = L[i, 0] if mu <= 0.0 else max(0.5 * (L[i, 0] + L[i, 1] / slope), 0.0)
            EDGE[K].x = EDGE[K].guess
            EDGE[K].a_gg = (IM[A[i]] + IM[B[i]]) * (1.0 + mu * mu)
            EDGE[K].a_gg += II[A[i]] * G[K].arm_na ** 2 + II[B[i]] * G[K].arm_nb ** 2
            K += 1
    return K


@uncounted
def inside(EDGE: Rows[Edge], K: int) -> bool:
    """Go to x + dx, next to the guess of all that balances, and say whether it is inside the cones; if not, put it
    there, with s to begin with."""
    mean, least = 0.0, np.inf
    for e in range(K):
        EDGE[e].x += EDGE[e].dx
        mean += abs(EDGE[e].x) / K
        least = min(least, EDGE[e].x)
    if least >= 0.0:
        return True
    load = 0.0
    for e in range(K):
        EDGE[e].x = max(EDGE[e].x, STATICS_START * mean)
        load += EDGE[e].x / K
    for e in range(K):
        EDGE[e].s = EDGE[e].a_gg * load
    return False


@uncounted
def send(
    P: IntArray, Q: IntArray, G: Rows[Row], EDGE: Rows[Edge], steps: bool, K: int, IM: FloatArray, II: FloatArray,
    V: FloatArray,
) -> None:  # fmt: skip
    """V += M^-1 sum g x, or dx (`steps`)."""
    for e in range(K):
        lam = EDGE[e].dx if steps else EDGE[e].x
        a, b = P[e], Q[e]
        V[a, 0] -= IM[a] * lam * G[e].nx
        V[a, 1] -= IM[a] * lam * G[e].ny
        V[a, 2] -= II[a] * lam * G[e].arm_na
        V[b, 0] += IM[b] * lam * G[e].nx
        V[b, 1] += IM[b] * lam * G[e].ny
        V[b, 2] += II[b] * lam * G[e].arm_nb


@uncounted
def along(
    edges: Problem, EDGE: Rows[Edge], SCALE: FloatArray, factor: Factor, LEFT: FloatArray, Y: FloatArray, f: FloatArray,
    V: FloatArray, DY: FloatArray, centre: float, second: bool,
) -> None:  # fmt: skip
    """Newton's step dx, ds, DY towards x s = centre, less the product of the last step's if it is the second.

    edges: the rows of the edges.  LEFT (k, 3): velocities that x leaves.  f (n, 3), V (k, 3): scratch.
    """
    P, Q, G, K, n, place = edges.A, edges.B, edges.ROWS, edges.m, edges.n, factor.place
    for i in range(len(V)):
        for c in range(3):
            V[i, c] = 0.0
    for e in range(K):
        x, s = EDGE[e].x, EDGE[e].s
        if s == 0.0:
            EDGE[e].dx = 0.0
            continue
        dual = EDGE[e].a_gg * (x - EDGE[e].guess) - normal_rate(P, Q, G, Y, e) - s
        product = x * s - centre + (EDGE[e].dx * EDGE[e].ds if second else 0.0)
        EDGE[e].ds = product
        EDGE[e].dx = G[e].k_n * (dual + product / x)
    send(P, Q, G, EDGE, True, K, edges.IM, edges.II, V)
    for i in range(n):
        for c in range(3):
            f[place[i], c] = PROXIMAL_STATICS * (V[i, c] - LEFT[i, c]) / SCALE[i, c] if SCALE[i, c] > 0.0 else 0.0
    substitute(n, factor, f)
    for i in range(n):
        for c in range(3):
            DY[i, c] = SCALE[i, c] * f[place[i], c]
    for e in range(K):
        EDGE[e].dx = G[e].k_n * normal_rate(P, Q, G, DY, e) - EDGE[e].dx
        if EDGE[e].s > 0.0:
            EDGE[e].ds = -(EDGE[e].ds + EDGE[e].s * EDGE[e].dx) / EDGE[e].x


@uncounted
def reach(EDGE: Rows[Edge], K: int, dual: bool) -> float:
    """How much of a step, at most all of it, leaves all x, or all s (`dual`), well positive."""
    most = 1.0
    for e in range(K):
        value, change = (EDGE[e].s, EDGE[e].ds) if dual else (EDGE[e].x, EDGE[e].dx)
        if change < 0.0:
            most = min(most, -STATICS_STEP * value / change)
    return most


@uncounted
def products(EDGE: Rows[Edge], K: int, primal: float, dual: float) -> float:
    """Mean of x s after parts of a step."""
    total = 0.0
    for e in range(K):
        total += (EDGE[e].x + primal * EDGE[e].dx) * (EDGE[e].s + dual * EDGE[e].ds)
    return total / K


@uncounted
def go(EDGE: Rows[Edge], K: int, Y: FloatArray, DY: FloatArray, primal: float, dual: float) -> None:
    """Take parts of a step."""
    for e in range(K):
        EDGE[e].x += primal * EDGE[e].dx
        EDGE[e].s += dual * EDGE[e].ds
    for i in range(len(Y)):
        for c in range(3):
            Y[i, c] += dual * DY[i, c]


@uncounted
def give(ROWS: Rows[Row], EDGE: Rows[Edge], OF: IntArray, K: int, L: FloatArray, m: int) -> None:
    """Impulses L (m, 2) of the x of their edges."""
    for i in range(m):
        L[i, 0] = L[i, 1] = 0.0
    for e in range(K):
        i = OF[e]
        slope = ROWS[i].friction
        if e > 0 and OF[e - 1] == i:
            slope = -slope
        L[i, 0] += EDGE[e].x
        L[i, 1] += slope * EDGE[e].x


@kernel
def equilibrium(
    problem: Problem, L: FloatArray, START: FloatArray, EXTENT: FloatArray, tolerance: float, most: int, nearest: bool
) -> tuple[bool, int]:
    """Look for impulses that take the velocities START (k, 3) of the n bodies that impulses move.

    Args:
        ROWS: m contacts; those with a target below 0 carry nothing.
        START: out, if there are none, a motion that nothing holds: the multipliers y, which grow along it.
        L: (m, 2) guess in, impulses out if they are found.
        POSE: (k, 3), for the order of elimination alone.  EXTENT: (k,) how far points of bodies are.
        tolerance: speed of their points that may be left.  most: factors at most.
        nearest: whether to go on to the impulses next to the guess.
    Returns:
        Whether they are found, and how many factors that took.
    """
    IM, II, n, m = problem.IM, problem.II, problem.n, problem.m
    k = len(IM)
    OF, P, Q = np.empty(2 * m, np.int64), np.empty(2 * m, np.int64), np.empty(2 * m, np.int64)
    G, EDGE = zeros(2 * m, ROW), zeros(2 * m, EDGE_KIND)
    K = edges(problem.A, problem.B, problem.ROWS, L, IM, II, m, OF, P, Q, G, EDGE)
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
    dissect(problem.POSE, n, start, other, place)
    columns, rows = pattern(n, start, other, place)
    factor = Factor(place, columns, rows, np.empty((n, 3, 3)), np.empty((len(rows), 3, 3)))
    problem_of_edges = Problem(P, Q, G, IM, II, problem.POSE, n, K)
    found, free, stalled, last, first = False, True, 0, np.inf, 0.0
    given = fastest(START, EXTENT, n)
    for done in range(most + 1):
        copy(LEFT, START)
        send(P, Q, G, EDGE, False, K, IM, II, LEFT)
        speed = fastest(LEFT, EXTENT, n)
        centre = products(EDGE, K, 0.0, 0.0)
        if speed <= tolerance:
            found = True
            give(problem.ROWS, EDGE, OF, K, L, m)
            if not nearest or centre <= STATICS_GAP * first:
                return True, done
        elif not found and done > 0:
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
                G[e].k_n = 1.0 / (EDGE[e].a_gg + (0.0 if free else EDGE[e].s / EDGE[e].x))
            assemble(P, Q, G, K, n, held, stuck, SCALE, PROXIMAL_STATICS, factor)
            factorise(n, factor)
        along(problem_of_edges, EDGE, SCALE, factor, LEFT, Y, f, V, DY, 0.0, False)
        if free:
            # Next to the guess of all that balances, cones or not: often that is all.
            free = inside(EDGE, K)
            first = products(EDGE, K, 0.0, 0.0)
            continue
        aim = centre * (products(EDGE, K, reach(EDGE, K, False), reach(EDGE, K, True)) / centre) ** 3
        along(problem_of_edges, EDGE, SCALE, factor, LEFT, Y, f, V, DY, aim, True)
        go(EDGE, K, Y, DY, reach(EDGE, K, False), reach(EDGE, K, True))
    return found, most

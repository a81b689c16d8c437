"""Contact impulses inside the friction cones that end all motion of an island, if there are any.

In the edges g of the cones (`cones.py`), v + M^-1 (G^T lam + T^T beta) = 0 is a linear system B x = f in x >= 0, one x
for each edge: the columns of B are the edges, f = -M v. Of all solutions the one nearest to a guess w is sought,

    minimise (1/2) sum A_gg (x - w)^2,   B x = f,   x >= 0,

by a primal-dual interior-point method with Mehrotra's predictor and corrector (1992). A step solves, for the
multipliers y of B x = f, which are velocities,

    (M/R + B Theta B^T) dy = r,   Theta = 1 / (A_gg + s / x),   s >= 0 those of x >= 0,

with the factor of `cholesky.py` and R = PROXIMAL_STATICS. Where many contacts share the loads, one or two steps
suffice; active-set methods, whose set has to be right to the last contact, may need a hundred. The iteration ends with
the first x that balances, or where none can: any x >= 0 with B x = f has y.f = sum (B^T y)_g x_g for the multipliers y,
so that

    sum x >= y.f / max (B^T y)_g   if y.f > 0,

which grows without bound if there is no x (Farkas' lemma), within a few steps.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, zeros
from ..geometry.flight import fastest_point
from ..model.contacts import EDGE as EDGE_KIND
from ..model.contacts import ROW, Edge, Problem
from ..model.parameters.impulses import PROXIMAL_STATICS
from ..model.parameters.rest import STATICS_START, STATICS_STEP, STATICS_SUM
from .build import normal_rate
from .cholesky import Factor, assemble_blocks, factor_blocks, make_factor, solve_blocks
from .cones import add_impulses, cone_edges, impulses_of
from .inplace import copy


@nonallocating
def move_into_cones(EDGE: Rows[Edge], K: int) -> bool:
    """Set x to x + dx, the balancing impulses nearest to the guess, and return whether all are inside the cones. If
    not, move them inside, and set multipliers s from which the iteration starts."""
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


@nonallocating
def newton_step(
    edges: Problem, EDGE: Rows[Edge], factor: Factor, LEFT: FloatArray, Y: FloatArray, f: FloatArray, V: FloatArray,
    DY: FloatArray, centre: float, second: bool,
) -> None:  # fmt: skip
    """Newton's step dx, ds (fields of EDGE) and DY of

        A_gg (x - w) = g.Y + s,   LEFT = 0,   x s = centre;

    with a proximal term, LEFT + M^-1 sum g dx = -DY / R, for redundant edges. The corrector step (`second`) also
    subtracts the product dx ds of the predictor from x s.

    Args:
        edges: rows of the edges, with k_n = Theta.  LEFT: (k, 3) velocities that the impulses x leave.
        Y, DY: (k, 3) multipliers, and their step.
        f, V: (n, 3) and (k, 3), scratch.
    """
    G, K, n, place, SCALE = edges.ROWS, edges.m, edges.n, factor.place, factor.SCALE
    V[:] = 0.0
    for e in range(K):
        x, s = EDGE[e].x, EDGE[e].s
        if s == 0.0:
            EDGE[e].dx = 0.0
            continue
        dual = EDGE[e].a_gg * (x - EDGE[e].guess) - normal_rate(G[e], Y) - s
        product = x * s - centre + (EDGE[e].dx * EDGE[e].ds if second else 0.0)
        EDGE[e].ds = product
        EDGE[e].dx = G[e].k_n * (dual + product / x)
    add_impulses(edges, EDGE, True, V)
    for i in range(n):
        for c in range(3):
            f[place[i], c] = PROXIMAL_STATICS * (V[i, c] - LEFT[i, c]) / SCALE[i, c] if SCALE[i, c] > 0.0 else 0.0
    solve_blocks(factor, f)
    for i in range(n):
        for c in range(3):
            DY[i, c] = SCALE[i, c] * f[place[i], c]
    for e in range(K):
        EDGE[e].dx = G[e].k_n * normal_rate(G[e], DY) - EDGE[e].dx
        if EDGE[e].s > 0.0:
            EDGE[e].ds = -(EDGE[e].ds + EDGE[e].s * EDGE[e].dx) / EDGE[e].x


@nonallocating
def step_length(EDGE: Rows[Edge], K: int, dual: bool) -> float:
    """Largest part of the Newton step, at most 1, that keeps all x, or all s (`dual`), positive: STATICS_STEP of the
    way to the first 0."""
    most = 1.0
    for e in range(K):
        value, change = (EDGE[e].s, EDGE[e].ds) if dual else (EDGE[e].x, EDGE[e].dx)
        if change < 0.0:
            most = min(most, -STATICS_STEP * value / change)
    return most


@nonallocating
def mean_product(EDGE: Rows[Edge], K: int, primal: float, dual: float) -> float:
    """Mean of x s after the parts `primal` of dx and `dual` of ds."""
    total = 0.0
    for e in range(K):
        total += (EDGE[e].x + primal * EDGE[e].dx) * (EDGE[e].s + dual * EDGE[e].ds)
    return total / K


@nonallocating
def update_iterate(EDGE: Rows[Edge], K: int, Y: FloatArray, DY: FloatArray, primal: float, dual: float) -> None:
    """Add the part `primal` of dx, and the part `dual` of ds and DY."""
    for e in range(K):
        EDGE[e].x += primal * EDGE[e].dx
        EDGE[e].s += dual * EDGE[e].ds
    for i in range(len(Y)):
        for c in range(3):
            Y[i, c] += dual * DY[i, c]


@nonallocating
def leave(edges: Problem, EDGE: Rows[Edge], START: FloatArray, EXTENT: FloatArray, LEFT: FloatArray) -> float:
    """Set LEFT (k, 3), the velocities that the impulses x of the edges leave of START; the speed of the fastest point
    of the bodies that impulses move."""
    copy(LEFT, START)
    add_impulses(edges, EDGE, False, LEFT)
    return fastest_point(LEFT, EXTENT, edges.n)


@nonallocating
def sum_of_momenta(problem: Problem, V: FloatArray, EXTENT: FloatArray) -> float:
    """The impulses that would stop the bodies one by one, those of spins at their EXTENT."""
    _, IM, II, _, n, _ = problem
    total = 0.0
    for i in range(n):
        total += (abs(V[i, 0]) + abs(V[i, 1])) / IM[i] if IM[i] > 0.0 else 0.0
        total += abs(V[i, 2]) / (II[i] * EXTENT[i]) if II[i] > 0.0 and EXTENT[i] > 0.0 else 0.0
    return total


@nonallocating
def needs_more(edges: Problem, START: FloatArray, Y: FloatArray, most: float) -> bool:
    """Whether impulses that balance START have a sum above `most`, by the multipliers Y (see the module)."""
    work, fastest = 0.0, 0.0
    for i in range(edges.n):
        for c in range(3):
            inverse = edges.IM[i] if c < 2 else edges.II[i]
            work -= START[i, c] * Y[i, c] / inverse if inverse > 0.0 else 0.0
    for e in range(edges.m):
        fastest = max(fastest, normal_rate(edges.ROWS[e], Y))
    return work > most * fastest


@kernel
def equilibrium(
    problem: Problem, L: FloatArray, START: FloatArray, EXTENT: FloatArray, tolerance: float, most: int
) -> tuple[bool, int]:
    """Search contact impulses that bring the n bodies of a problem from velocities START to rest.

    Args:
        problem: its m contacts; those with a target below 0 exert no impulse. POSE is used for the order of elimination
            only.
        L: (m, 2) in: guess; out: the impulses if found.
        START: (k, 3) in: velocities; out, if nothing is found: a motion against which no contact acts, which is that of
            the multipliers y, since they grow along it.
        EXTENT: (k,) largest distance of a point of the body from its centre of mass.
        tolerance: speed of points that may remain.  most: largest number of factorisations.
    Returns:
        Whether impulses are found, and the number of factorisations.
    """
    IM, II, n, m = problem.IM, problem.II, problem.n, problem.m
    k = len(IM)
    OF, G, EDGE = np.empty(2 * m, np.int64), zeros(2 * m, ROW), zeros(2 * m, EDGE_KIND)
    K = cone_edges(problem, L, OF, G, EDGE)
    edges = Problem(G, IM, II, problem.POSE, n, K)
    LEFT, Y, DY, V, f = np.empty((k, 3)), np.zeros((k, 3)), np.zeros((k, 3)), np.empty((k, 3)), np.empty((n, 3))
    if K == 0:
        return fastest_point(START, EXTENT, n) <= tolerance, 0  # without contacts START is that motion
    speed = leave(edges, EDGE, START, EXTENT, LEFT)
    if speed <= tolerance:  # the guess balances
        impulses_of(problem, EDGE, OF, K, L)
        return True, 0
    active, stuck = np.ones(K, np.int64), np.zeros(K, np.int64)
    factor = make_factor(edges, active)
    most_impulse = STATICS_SUM * n * sum_of_momenta(problem, START, EXTENT)
    unbounded = True  # whether cones are left out so far
    for done in range(most + 1):
        if speed <= tolerance:
            impulses_of(problem, EDGE, OF, K, L)
            return True, done
        centre = mean_product(EDGE, K, 0.0, 0.0)
        if done == most or not (speed < np.inf and (centre > 0.0 or unbounded)):
            break
        if done > 1 and needs_more(edges, START, Y, most_impulse):
            break
        if done == 0 or not unbounded:
            for e in range(K):
                G[e].k_n = 1.0 / (EDGE[e].a_gg + (0.0 if unbounded else EDGE[e].s / EDGE[e].x))
            assemble_blocks(edges, active, stuck, PROXIMAL_STATICS, factor)
            factor_blocks(factor)
        newton_step(edges, EDGE, factor, LEFT, Y, f, V, DY, 0.0, False)
        if unbounded:
            # Without regard to the cones, the nearest balancing impulses need one linear solve: often they are inside.
            unbounded = move_into_cones(EDGE, K)
            for i in range(n if unbounded else 0):  # all but round-off is left in motions that no contact can end
                for c in range(3):
                    Y[i, c] += DY[i, c]
        else:
            reduced = mean_product(EDGE, K, step_length(EDGE, K, False), step_length(EDGE, K, True)) / centre
            newton_step(edges, EDGE, factor, LEFT, Y, f, V, DY, centre * reduced**3, True)
            update_iterate(EDGE, K, Y, DY, step_length(EDGE, K, False), step_length(EDGE, K, True))
        speed = leave(edges, EDGE, START, EXTENT, LEFT)
    copy(START, Y)
    return False, done

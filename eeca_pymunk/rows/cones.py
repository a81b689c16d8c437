"""Friction cones as sums of their edges: an impulse inside the cone of a contact is sum x g, x >= 0, of its two edges
g = n +- mu t, or of g = n without friction. So the statics of contacts are linear in x (`equilibrium.py`)."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.contacts import Edge, Problem, Row
from .build import push_contact


@nonallocating
def cone_edges(problem: Problem, L: FloatArray, OF: IntArray, G: Rows[Row], EDGE: Rows[Edge]) -> int:
    """Write the edges of the cones of m contacts, and return their number K <= 2 m.

    Args:
        problem: contacts with a target below 0 have no edges.
        L: (m, 2) normal and tangential impulses, from which `guess` and `x` of the edges follow.
        OF: out, the contact of each edge.  G: out, rows of the edges, those of a contact one after the other.
        EDGE: out, with a_gg = g^T M^-1 g.
    """
    ROWS, IM, II, _, _, m = problem
    K = 0
    for i in range(m):
        if ROWS[i].target < 0.0:
            continue
        a, b, mu = ROWS[i].a, ROWS[i].b, ROWS[i].friction
        for side in range(2 if mu > 0.0 else 1):
            slope = mu if side == 0 else -mu
            OF[K], G[K].a, G[K].b = i, a, b
            G[K].nx = ROWS[i].nx - slope * ROWS[i].ny
            G[K].ny = ROWS[i].ny + slope * ROWS[i].nx
            G[K].arm_na = ROWS[i].arm_na + slope * ROWS[i].arm_ta
            G[K].arm_nb = ROWS[i].arm_nb + slope * ROWS[i].arm_tb
            EDGE[K].guess = L[i, 0] if mu <= 0.0 else max(0.5 * (L[i, 0] + L[i, 1] / slope), 0.0)
            EDGE[K].x = EDGE[K].guess
            EDGE[K].a_gg = (IM[a] + IM[b]) * (1.0 + mu * mu)
            EDGE[K].a_gg += II[a] * G[K].arm_na ** 2 + II[b] * G[K].arm_nb ** 2
            K += 1
    return K


@nonallocating
def add_impulses(edges: Problem, EDGE: Rows[Edge], steps: bool, V: FloatArray) -> None:
    """Add M^-1 sum g x over all edges, the rows of `edges`, to the velocities V (k, 3); with dx in place of x if
    `steps`."""
    for e in range(edges.m):
        push_contact(edges.ROWS[e], edges.IM, edges.II, EDGE[e].dx if steps else EDGE[e].x, 0.0, V)


@nonallocating
def impulses_of(problem: Problem, EDGE: Rows[Edge], OF: IntArray, K: int, L: FloatArray) -> None:
    """Set the normal and tangential impulses L (m, 2) of m contacts from the x of their K edges."""
    for i in range(problem.m):
        L[i, 0] = L[i, 1] = 0.0
    for e in range(K):
        i = OF[e]
        slope = problem.ROWS[i].friction
        if e > 0 and OF[e - 1] == i:
            slope = -slope
        L[i, 0] += EDGE[e].x
        L[i, 1] += slope * EDGE[e].x

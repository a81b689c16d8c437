"""A common rotation of the velocities of bodies that press on each other, in a free island, which keeps its angular
momentum, and what contacts report of it: it changes their momenta by dp, whose sum is 0, as impulses between them do.

Contacts that connect the bodies as a tree have one set of such impulses: that of the contact between a body and the
rest of the tree is the sum of dp of all bodies beyond it.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..contacts.correction import turn_groups, unturn_groups
from ..contacts.single import log_impulse
from ..geometry.flight import norm
from ..model.scene import Scene
from .local import give_places, set_places, take_places
from .membership import members_of
from .rest import spins_freely
from .shortened import pressing_groups


@nonallocating
def angular_gain(A: Scene, c: int, t: float) -> float:
    """Angular momentum that contact c adds if its interval h is cut after s, since its arms are those of the middle of
    the whole: -(1/2) s (h - s) (v_b - v_a) x f, with the force f and v at the start of the interval. t: the instant of
    the cut. All bodies move by impulses (`keep_angular_momentum`)."""
    pushed, BODY = A.PUSHED[c], A.BODY
    i, j = A.LINK[A.PUSHED_BY[c].a].owner, A.LINK[A.PUSHED_BY[c].b].owner
    s, h = t - pushed.start, pushed.length
    fx = (pushed.normal * pushed.nx - pushed.tangential * pushed.ny) / h
    fy = (pushed.normal * pushed.ny + pushed.tangential * pushed.nx) / h
    back_i, back_j = BODY[i].since - pushed.start, BODY[j].since - pushed.start
    vx = BODY[j].vx - back_j * BODY[j].ax - BODY[i].vx + back_i * BODY[i].ax
    vy = BODY[j].vy - back_j * BODY[j].ay - BODY[i].vy + back_i * BODY[i].ay
    return -0.5 * s * max(h - s, 0.0) * (vx * fy - vy * fx)


@kernel
def keep_angular_momentum(A: Scene, root: int, first: int, end: int, t: float) -> None:
    """Remove the angular momentum that contacts [first, end) of an island have given it, as their interval has ended at
    instant t, where its bodies are: by a common rotation of each group of bodies that press on each other, if the
    island is free. Free spins stay as they are. The change of energy counts as restitution."""
    most = 0.0
    for c in range(first, end):
        for shape in (A.PUSHED_BY[c].a, A.PUSHED_BY[c].b):
            j = A.LINK[shape].owner
            if A.BODY[j].inv_mass == 0.0 or A.STATE[j].island != root:
                return
        most = max(most, abs(angular_gain(A, c, t)))
    if most == 0.0:
        return
    MINE, GATHERED = members_of(A, root), take_places(A)
    set_places(A, MINE)
    n = len(MINE)
    GROUP, EXCESS = pressing_groups(A, MINE, first, end), np.zeros(n)
    TURN, ONE = np.zeros((n, 3)), np.empty(n, np.uint8)
    for c in range(first, end):
        EXCESS[GROUP[A.PLACE[A.LINK[A.PUSHED_BY[c].a].owner]]] += angular_gain(A, c, t)
    POSE, V, IM, II = np.empty((n, 3)), np.empty((n, 3)), np.empty(n), np.empty(n)
    for q in range(n):
        body = A.BODY[MINE[q]]
        POSE[q, 0], POSE[q, 1], V[q, 0], V[q, 1], V[q, 2] = body.x, body.y, body.vx, body.vy, body.spin
        IM[q], II[q] = body.inv_mass, body.inv_inertia
        if II[q] > 0.0 and spins_freely(A, MINE[q]):
            II[q] = np.inf
    gained, square = unturn_groups(POSE, np.zeros((n, 2)), V, IM, II, GROUP, ONE, EXCESS, TURN)
    turn_groups(POSE, GROUP, ONE, TURN, V, 0)
    DP = np.empty((n, 2))
    for q in range(n):
        body = A.BODY[MINE[q]]
        DP[q, 0], DP[q, 1] = (V[q, 0] - body.vx) / body.inv_mass, (V[q, 1] - body.vy) / body.inv_mass
        body.vx, body.vy = V[q, 0], V[q, 1]
        body.spin = V[q, 2] if II[q] < np.inf else body.spin
    report_turn(A, MINE, DP)
    give_places(A, GATHERED)
    A.PAR.restitution -= gained + square
    A.RESTING[root].lost -= gained + square


@kernel
def report_lift(A: Scene, root: int) -> None:
    """`report_turn`, for the rotation that is part of the correction of a free island."""
    MINE, GATHERED = members_of(A, root), take_places(A)
    set_places(A, MINE)
    DP = np.empty((len(MINE), 2))
    for q in range(len(MINE)):
        lift = A.RESTING[MINE[q]]
        DP[q, 0] = lift.lift_vx / A.BODY[MINE[q]].inv_mass
        DP[q, 1] = lift.lift_vy / A.BODY[MINE[q]].inv_mass
    report_turn(A, MINE, DP)
    give_places(A, GATHERED)


@kernel
def report_turn(A: Scene, MINE: IntArray, DP: FloatArray) -> None:
    """Log the impulses that change the momenta of the bodies MINE (n,), which have their places, by DP (n, 2), which is
    overwritten, at the last contacts that connect them as a tree."""
    n = len(MINE)
    ORDER, PARENT, VIA = np.zeros(n, np.int64), np.full(n, -1), np.full(n, -1)
    found = 0
    for start in range(n):
        if PARENT[start] >= 0:
            continue
        ORDER[found], PARENT[start] = start, start
        k, found = found, found + 1
        while k < found:
            found = branches(A, ORDER, PARENT, VIA, k, found)
            k += 1
    for k in range(n - 1, -1, -1):
        q = ORDER[k]
        if VIA[q] >= 0:
            log_more(A, int(VIA[q]), int(MINE[q]), DP[q, 0], DP[q, 1])
            DP[PARENT[q], 0] += DP[q, 0]
            DP[PARENT[q], 1] += DP[q, 1]


@nonallocating
def branches(A: Scene, ORDER: IntArray, PARENT: IntArray, VIA: IntArray, k: int, found: int) -> int:
    """Append the bodies beyond body ORDER[k] of a tree to its first `found`; returns how many there are then."""
    for c in range(A.COUNT.pushes - 1, -1, -1):
        p, q = A.PLACE[A.LINK[A.PUSHED_BY[c].a].owner], A.PLACE[A.LINK[A.PUSHED_BY[c].b].owner]
        if p >= 0 and q >= 0 and (p == ORDER[k] or q == ORDER[k]):
            other = q if p == ORDER[k] else p
            if PARENT[other] < 0:
                ORDER[found], PARENT[other], VIA[other] = other, ORDER[k], c
                found += 1
    return found


@nonallocating
def log_more(A: Scene, c: int, i: int, x: float, y: float) -> None:
    """Log an impulse on body i at contact c: with the last impulse there, if the sum still presses, else on its own, as
    one along its own direction."""
    pushed, a, b = A.PUSHED[c], A.PUSHED_BY[c].a, A.PUSHED_BY[c].b
    sign = 1.0 if A.LINK[b].owner == i else -1.0
    x, y = sign * x, sign * y
    size = norm(x, y)
    for e in range(A.COUNT.logged - 1, -1, -1):
        one = A.LOG[e]
        if int(one.first) == a and int(one.second) == b and one.normal + x * one.nx + y * one.ny > 0.0:
            one.normal += x * one.nx + y * one.ny
            one.tangential += y * one.nx - x * one.ny
            return
    if size > 0.0 and A.COUNT.logged < A.LOG.shape[0]:
        one = A.LOG[A.COUNT.logged]
        log_impulse(one, a, b, pushed.start, size, 0.0, x / size, y / size, pushed.px, pushed.py, 0.0, pushed.gap)
        A.COUNT.logged += 1

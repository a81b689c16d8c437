"""Blocks: the bodies and contacts of a simultaneous impact.

Contacts that touch at the instant of an impact take part in it, and so on from body to body: the impulses of a rack of
disks are simultaneous. So do loaded contacts of islands, and all bodies of a component. Bodies that impulses do not
move do not pass them on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows, empty
from ..contacts.single import touches
from ..contacts.targets import hardly_bounces
from ..geometry.flight import move_to, opening_rate_at, pose, rate
from ..geometry.manifold import face
from ..geometry.sides import note_side, pair_of, shapes_of_pair
from ..islands.accounting import end_rest_or_interval
from ..islands.membership import budget_spent, fixed_support, in_large_island, remembered_force
from ..model.contacts import CONTACT_POINT, ROW, Row
from ..model.parameters.impulses import BLOCK_BODIES
from ..model.scene import Scene
from ..pairs.passing import pass_corner
from ..pairs.rules import barred, face_tolerance, law
from ..rows.build import normal_rate, place_row
from ..rows.inplace import sort


@nonallocating
def takes_part(A: Scene, s: int, o: int, t: float) -> bool:
    """Whether shapes s and o touch at instant t, or are a loaded contact of an island. False if the path of o's body
    begins later, as jointed bodies may meet before the last event (`..jointed.meet`)."""
    if barred(A, s, o) or A.BODY[A.LINK[o].owner].since > t:
        return False
    if touches(A, s, o, t):
        return True
    i, j = A.LINK[s].owner, A.LINK[o].owner
    if A.STATE[i].island < 0 or not (A.STATE[j].island == A.STATE[i].island or fixed_support(A, j)):
        return False
    return remembered_force(A, s, o, A.PAR.stamp)[0] > 0.0


@nonallocating
def bring_to(A: Scene, i: int, t: float) -> None:
    """Move body i to instant t, and end the interval of its island there, unless that has joints."""
    root = A.STATE[i].island
    if root >= 0 and A.MEMBER[root].open > 0:
        if A.MEMBER[root].jointed > 0:
            return
        end_rest_or_interval(A, root, t)
    move_to(A.BODY, i, t)


@nonallocating
def add_component(A: Scene, i: int, n: int, t: float) -> int:
    """Add body i, and all bodies of its component, to the n bodies in A.BLOCK, and move them to instant t; returns
    their number."""
    j = i
    while A.PLACE[j] < 0:
        A.BLOCK[n], A.PLACE[j] = j, n
        n += 1
        bring_to(A, j, t)
        if A.MEMBER[j].tied < 0:
            break
        j = A.MEMBER[j].next_tied
    return n


@kernel
def gather_block(A: Scene, a: int, b: int, t: float) -> tuple[int, int, IntArray]:
    """Collect the block of an impact of shapes a and b at instant t: n bodies in A.BLOCK, which move to that instant,
    with their places in A.PLACE; and m pairs as numbers a k + b (k shapes) in increasing order. Returns n, m and the
    pairs."""
    BODIES = A.BLOCK
    PAIRS = np.empty(16, np.int64)
    PAIRS[0] = pair_of(A, a, b)
    n, m, q = 0, 1, 0
    most = BLOCK_BODIES if in_large_island(A, a, b) else A.BLOCK.shape[0]
    for s in (a, b):
        i = A.LINK[s].owner
        if A.BODY[i].inv_mass > 0.0 and A.PLACE[i] < 0:
            n = add_component(A, i, n, t)
    while q < n:
        i = BODIES[q]
        q += 1
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            start = A.LIST[s].start
            for p in range(start, start + A.LIST[s].number):
                o = int(A.POOL[p])
                j = A.LINK[o].owner
                moves = A.BODY[j].inv_mass > 0.0
                key = pair_of(A, s, o)
                # Pairs with earlier bodies of the block are there already.
                if key == PAIRS[0] or (moves and 0 <= A.PLACE[j] < q - 1):
                    continue
                # Bodies beyond the limit are hit later.
                full = moves and A.PLACE[j] < 0 and (n >= most or budget_spent(A, A.STATE[j].island))
                if full or not takes_part(A, s, o, t):
                    continue
                if moves and A.PLACE[j] < 0:
                    n = add_component(A, j, n, t)
                if m == PAIRS.shape[0]:
                    more = np.empty(2 * m, np.int64)
                    for c in range(m):
                        more[c] = PAIRS[c]
                    PAIRS = more
                PAIRS[m] = key
                m += 1
    sort(PAIRS, m)
    return n, m, PAIRS[:m]


@nonallocating
def take_owed_energy(A: Scene, n: int) -> tuple[float, bool]:
    """Energy owed by the islands of the n bodies in A.BLOCK, as shortened intervals have given it: their block has to
    lose it, and they owe it no longer. Also whether any of the bodies is in an island."""
    owed, in_islands = 0.0, False
    for q in range(n):
        root = A.STATE[A.BLOCK[q]].island
        if root >= 0:
            in_islands = True
            owes = max(-A.RESTING[root].lost, 0.0)
            A.RESTING[root].lost += owes
            owed += owes
    return owed, in_islands


class Block(NamedTuple):
    """The arrays of a block of n bodies and m pairs of shapes, which have c <= 2 m contacts.

    POSE, V (n + m, 3), IM, II (n + m,): first the n bodies, then one for each pair with a body without mobility. ROWS
    (c,): rows of contacts between local bodies. POINTS (c, 2): their points, length.
    """

    POSE: FloatArray
    V: FloatArray
    IM: FloatArray
    II: FloatArray
    ROWS: Rows[Row]
    POINTS: FloatArray


@kernel
def make_block(A: Scene, n: int, m: int, PAIRS: IntArray, hit: int, lasts: bool, t: float) -> Block:
    """The block of the n bodies in A.BLOCK, which are sorted by row here, and of m PAIRS, at instant t.

    Args:
        hit: the pair that meets now.  lasts: whether its contact persists from now on.
    """
    BODY, LINK, BODIES = A.BODY, A.LINK, A.BLOCK
    k = A.SHAPE.shape[0]
    sort(BODIES, n)
    for q in range(n):
        A.PLACE[BODIES[q]] = q
    POSE, V = np.zeros((n + m, 3)), np.zeros((n + m, 3))
    IMS, IIS = np.zeros(n + m), np.zeros(n + m)
    for q in range(n):
        i = BODIES[q]
        POSE[q, 0], POSE[q, 1], POSE[q, 2] = BODY[i].x, BODY[i].y, BODY[i].angle
        V[q, 0], V[q, 1], V[q, 2] = BODY[i].vx, BODY[i].vy, BODY[i].spin
        IMS[q], IIS[q] = BODY[i].inv_mass, BODY[i].inv_inertia
    ROWS, POINTS = empty(2 * m, ROW), np.empty((2 * m, 2))
    found = empty(2, CONTACT_POINT)
    rows, place = 0, n
    for z in range(m):
        sa, sb = shapes_of_pair(k, PAIRS[z])
        i, j = LINK[sa].owner, LINK[sb].owner
        p, q = A.PLACE[i], A.PLACE[j]
        # A body without mobility has a local body for each of its contacts.
        for side in range(2):
            w = i if side == 0 else j
            if BODY[w].inv_mass == 0.0:
                POSE[place, 0], POSE[place, 1], POSE[place, 2] = pose(BODY, w, t)
                V[place, 0], V[place, 1], V[place, 2] = rate(BODY, w, t)
                p, q = (place, q) if side == 0 else (p, place)
                place += 1
        e, mu, sx, sy = law(A, sa, sb)
        if lasts and PAIRS[z] == hit:
            e = 0.0
        load = remembered_force(A, sa, sb, A.PAR.stamp - 1.0)[1]
        count = face(A, sa, sb, POSE, p, q, face_tolerance(A, sa, sb), found)
        note_side(A, sa, sb, found[0].nx, found[0].ny, True)
        one = found[0]
        if opening_rate_at(POSE, V, p, q, one.nx, one.ny, one.px, one.py) < 0.0 and pass_corner(A, sa, sb, t, one):
            count = 1
        for c in range(count):
            row, point = ROWS[rows], found[c]
            nx, ny = point.nx, point.ny
            row.a, row.b, row.key = p, q, (PAIRS[z] << 1) + c
            row.nx, row.ny, row.gap, row.elasticity, row.friction = nx, ny, point.gap, e, mu
            row.surface = nx * sy - ny * sx
            place_row(row, point.px, point.py, POSE, IMS, IIS)
            u = normal_rate(row, V)
            if e < 1.0 and hardly_bounces(e, u, load * A.PAR.dt / row.k_n):
                # The contact persists: its bounce would end within a time dt.
                row.elasticity = 0.0
            POINTS[rows, 0], POINTS[rows, 1] = point.px, point.py
            rows += 1
    return Block(POSE, V, IMS, IIS, ROWS[:rows], POINTS[:rows])

"""Contact candidates of an island's interval, and the length of the interval."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..compiled.records import Rows
from ..contacts.forces import shapes_of
from ..contacts.targets import hardly_bounces
from ..geometry.flight import fastest, norm
from ..geometry.widths import smaller, turns
from ..model.contacts import Row
from ..model.parameters import intervals
from ..model.parameters.events import PAIR_LOOKS, RESOLUTION
from ..model.scene import Scene
from ..pairs.passing import flush
from ..pairs.rules import barred, far_apart, law
from ..rows.build import tangent_rate
from .membership import approach, fixed_support, persists, remembered_force


@inlined
def shortest_interval(A: Scene) -> float:
    """Length below which intervals are not shortened for accuracy: the step over RESOLUTION."""
    return float(A.PAR.dt / RESOLUTION)


@nonallocating
def travel_bound(A: Scene, i: int, h: float) -> float:
    """Bound of the distance that points of body i travel in a time h, with a margin; for `Midstep`."""
    body = A.BODY[i]
    pulled = A.PAR.pulled if body.inv_mass > 0.0 else norm(body.ax, body.ay) + abs(body.angular) * body.extent
    return intervals.TRAVEL_MARGIN * (A.RESTING[i].speed + 0.5 * pulled * h) * h


@kernel
def pairs_within(A: Scene, root: int, t: float, h: float, lossy: bool, MINE: IntArray) -> IntArray:
    """Contact candidates of an island: (p, 2) pairs of shapes that its solve over h from instant t includes.

    These touch, or persist within the interval, or pass a corner; for `busy` bodies all that come near; for `Midstep`
    all that may meet. Other pairs meet at their times of impact.

    Args:
        lossy: whether any shape of the island has an elasticity below 1.  MINE: its bodies.
    """
    n, p, gaps = len(MINE), 0, 0
    found = np.empty((4 * n + 8, 2), np.int64)
    BODY, LINK, STATE = A.BODY, A.LINK, A.STATE
    together, since = A.COUNT.together > 0, A.PAR.stamp - 1.0
    for q in range(n):
        i = MINE[q]
        own = fastest(BODY[i])
        for s in range(STATE[i].first_shape, STATE[i].first_shape + STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                j = LINK[o].owner
                # Each pair of two bodies of the island once; else pairs with fixed bodies only.
                inside = STATE[j].island == root
                if (inside and j < i) or not (inside or fixed_support(A, j)):
                    continue
                if barred(A, s, o):
                    continue
                small = smaller(A, s, o)
                busy = A.MEMBER[i].busy > 0 or A.MEMBER[j].busy > 0
                reach = (
                    intervals.TRAVEL_MARGIN * ((own + fastest(BODY[j])) * h + A.PAR.pulled * h * h)
                    + intervals.TOUCH * small
                )
                if together:
                    reach = travel_bound(A, i, h) + travel_bound(A, j, h) + intervals.TOUCH * small
                if far_apart(A, s, o, t, reach):
                    continue
                # In a large island all loaded contacts remain candidates: a hit acts on a few bodies at once, and
                # reaches the others through the interval.
                may_be_loaded = lossy and not together
                if not (n >= intervals.LARGE_ISLAND and may_be_loaded and remembered_force(A, s, o, since)[0] > 0.0):
                    g, u, closing, _, mass = approach(A, s, o, t)
                    gaps += 1
                    if not together:
                        if not busy:
                            way = max(-u, 0.0) * h + max(A.PAR.pulled, closing) * h * h
                            reach = intervals.TRAVEL_MARGIN * way + intervals.TOUCH * small
                        # Present velocities lead no farther than INTERVAL_WAY, and a motion that is taken no farther
                        # than INTERVAL_RETRY times that; other pairs meet at their times of impact.
                        reach = min(reach, 2.0 * intervals.INTERVAL_WAY * small)
                    if g > reach:
                        continue
                    e, meets = law(A, s, o)[0], False
                    if e >= 1.0 and not lossy and not together:
                        meets = not persists(A, s, o, t)
                    elif g > intervals.TOUCH * small and not (together or busy):
                        load = remembered_force(A, s, o, since)[1] if lossy else 0.0
                        meets = not hardly_bounces(e, u, max(closing, load / mass) * h)
                    if meets and not flush(A, s, o, t).passes:
                        continue
                if p == found.shape[0]:
                    more = np.empty((2 * p, 2), np.int64)
                    for c in range(p):
                        more[c, 0], more[c, 1] = found[c, 0], found[c, 1]
                    found = more
                found[p, 0], found[p, 1] = s, o
                p += 1
    A.COUNT.work += PAIR_LOOKS * max(gaps - p, 0)  # that of the others is part of their solve
    return found[:p]


@nonallocating
def to_end_of_step(A: Scene) -> bool:
    """Whether intervals last to the end of the step: for `Midstep`, and to bound the work, after as many solves in the
    step as there are bodies, N; in small scenes after RESOLUTION - 2 N if that is more."""
    bodies = A.BODY.shape[0]
    return A.COUNT.together > 0 or A.COUNT.solves >= max(RESOLUTION - 2.0 * bodies, bodies)


@nonallocating
def before_end(A: Scene, t: float) -> bool:
    """Whether instant t is before the end of the step, by more than round-off."""
    return bool(t < A.PAR.dt * (1.0 - 1e-12))


@nonallocating
def sweeps_of(n: int, t: float) -> int:
    """Sweeps of an island of n bodies in an interval from instant t: fewer after a hit on a large one, whose solve
    begins with the forces of the interval before."""
    if n < intervals.LARGE_ISLAND:
        return intervals.SMALL_SWEEPS
    return intervals.LARGE_SWEEPS if t == 0.0 else intervals.LARGE_SWEEPS_HIT


@nonallocating
def interval_length(A: Scene, found: IntArray, t: float) -> float:
    """Length of an interval from instant t: to the end of the step, or until a normal of the pairs `found` (p, 2) may
    have rotated by NORMAL_TURN. Normals rotate with all but centred disks, and as circles move around each other. Of
    more than EXACT_CONTACTS pairs, and once hits make intervals short (`to_end_of_step`), normals do not limit it, as
    each interval costs a solve."""
    BODY, LINK = A.BODY, A.LINK
    h = A.PAR.dt - t
    if found.shape[0] > intervals.EXACT_CONTACTS or to_end_of_step(A):
        return h
    rate = 0.0
    for c in range(found.shape[0]):
        a, b = found[c, 0], found[c, 1]
        i, j = LINK[a].owner, LINK[b].owner
        for s in (a, b):
            if turns(A, s):
                rate = max(rate, abs(BODY[LINK[s].owner].spin))
        if LINK[a].vertices == 1 and LINK[b].vertices == 1:
            speed = norm(BODY[j].vx - BODY[i].vx, BODY[j].vy - BODY[i].vy)
            rate = max(rate, speed / max(A.SHAPE[a].rounding + A.SHAPE[b].rounding, 1e-300))
    if rate * h <= intervals.NORMAL_TURN:
        return h
    return min(max(intervals.NORMAL_TURN / rate, shortest_interval(A)), h)


@nonallocating
def way_rate(A: Scene, a: int, b: int, vx: float, vy: float, spin_a: float, spin_b: float) -> float:
    """1/(time in which the bodies of shapes a and b, with relative velocity v and these spins, move relative to each
    other by INTERVAL_WAY of the size of the smaller one, or one that is not a centred disk rotates by that angle)."""
    rate = norm(vx, vy) / smaller(A, a, b)
    if turns(A, a):
        rate = max(rate, abs(spin_a))
    if turns(A, b):
        rate = max(rate, abs(spin_b))
    return rate / intervals.INTERVAL_WAY


@nonallocating
def interval_within_way(A: Scene, found: IntArray, h: float) -> float:
    """The part of an interval h in which bodies of the pairs `found` move by no more than `way_rate` allows, at their
    present velocities."""
    rate = 0.0
    for c in range(found.shape[0]):
        a, b = found[c, 0], found[c, 1]
        one, two = A.BODY[A.LINK[a].owner], A.BODY[A.LINK[b].owner]
        rate = max(rate, way_rate(A, a, b, two.vx - one.vx, two.vy - one.vy, one.spin, two.spin))
    return h if rate * h <= 1.0 else 1.0 / rate


@nonallocating
def excess_way(A: Scene, ROWS: Rows[Row], V: FloatArray, VN: FloatArray, m: int, h: float) -> float:
    """How many times longer a solved interval h of m contacts is than `way_rate` allows at its mean velocities.

    Args:
        ROWS: of the contacts.  V, VN: (k, 3) velocities at the start and the end.
    """
    rate = 0.0
    for z in range(m):
        p, q = ROWS[z].a, ROWS[z].b
        a, b = shapes_of(A, ROWS[z])
        x = V[q, 0] + VN[q, 0] - V[p, 0] - VN[p, 0]
        y = V[q, 1] + VN[q, 1] - V[p, 1] - VN[p, 1]
        rate = max(rate, way_rate(A, a, b, x, y, V[p, 2] + VN[p, 2], V[q, 2] + VN[q, 2]))
    return 0.5 * h * rate


@kernel
def slip_time(
    ROWS: Rows[Row], L: FloatArray, FREE: FloatArray, VN: FloatArray, m: int, h: float, turns: bool, sticks: bool
) -> float:  # fmt: skip
    """Time after which slip ends within an interval h of few contacts, where it turns round or the contact sticks; else
    h.

    Let contacts slip with u_t at the start, and by the solve no longer at the end. Their frictions beta, which are
    below the limits mu lam, change u_t by F in h; other forces increase |u_t| by a_t h, so that |F| = |u_t| + a_t h.
    Until the slip ends, however, friction is at its limit, and changes u_t by F sum mu lam / sum |beta| in h; sums over
    these contacts are taken, as the frictions of single contacts of a body are not unique. So the slip ends after h
    |u_t| / (|F| sum mu lam / sum |beta| - a_t h), with u_t and a_t of the contact that slips fastest.

    Where slip has turned round by the end, to u_t+, friction has acted with it at first: it would have given energy if
    the interval were cut. At its limit against u_t it would change that by |u_t - u_t+| + A_tt (mu lam - |beta|) if
    beta is against u_t, too, else with + |beta|.

    Args:
        turns, sticks: which ends of slip count.
        ROWS, L: the m contacts with their impulses.  FREE, VN: (k, 3) velocities at the end without and with them.
    """
    if m > intervals.EXACT_CONTACTS:
        return h
    limit, beta, slip, others, turned = 0.0, 0.0, 0.0, 0.0, 0.0
    for z in range(m):
        most = ROWS[z].friction * L[z, 0]
        before = abs(ROWS[z].ut)
        # The slip of contacts that stick throughout is round-off, or the error of what a turning body carries along.
        change = most / ROWS[z].k_t
        if most == 0.0 or before <= max(intervals.STICK_TOLERANCE * change, ROWS[z].unsure):
            continue
        sign = 1.0 if ROWS[z].ut > 0.0 else -1.0
        after = sign * tangent_rate(ROWS[z], VN)
        if after > intervals.STICK_TOLERANCE * before:
            continue
        limit += most
        beta -= sign * L[z, 1]
        if before > slip:
            slip, others = before, sign * (tangent_rate(ROWS[z], FREE) - ROWS[z].ut)
            back = turns and after < -intervals.STICK_TOLERANCE * before
            turned = before - after + change + sign * L[z, 1] / ROWS[z].k_t if back else 0.0
    if turned > 0.0:
        return h * slip / turned
    if not sticks or beta <= intervals.STICK_TOLERANCE * limit or beta >= (1.0 - intervals.STICK_TOLERANCE) * limit:
        return h
    rate = (slip + others) * limit / beta - others
    return h * slip / rate if rate > slip else h

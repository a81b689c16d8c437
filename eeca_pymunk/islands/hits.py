"""Impacts on islands: how many a step allows, as each is a solve of the whole island, and which are passed over."""

from __future__ import annotations

from ..compiled import kernel, nonallocating
from ..geometry.flight import norm, rate
from ..geometry.gap import gap
from ..geometry.widths import half_width
from ..model.parameters.events import BUSY_STEPS, RESOLUTION, WORK_JOINTED
from ..model.parameters.intervals import INTERVAL_DEPTH_WIDTH
from ..model.scene import Scene
from ..pairs.rules import law
from .membership import budget_spent, jointed, largest_island, members_of, persists_from


@nonallocating
def hits_of(A: Scene, a: int, b: int) -> int:
    """Number of hits in this step on the islands of shapes a and b, the larger one."""
    hits = 0
    for s in (a, b):
        root = A.STATE[A.LINK[s].owner].island
        if root >= 0:
            hits = max(hits, A.MEMBER[root].hits)
    return hits


@nonallocating
def most_hits(A: Scene, a: int, b: int) -> int:
    """Largest number of hits in a step on the islands of shapes a and b: RESOLUTION if the pair loses nothing; else
    that over the bodies of the larger island, as each hit is a solve of all of them, and WORK_JOINTED times that with
    joints."""
    if law(A, a, b)[0] >= 1.0:
        return RESOLUTION
    hung = jointed(A, A.LINK[a].owner) or jointed(A, A.LINK[b].owner)
    return max(1, (WORK_JOINTED if hung else 1) * RESOLUTION // max(1, largest_island(A, a, b)))


@nonallocating
def stays_shallow(A: Scene, a: int, b: int, t: float, h: float) -> bool:
    """Whether shapes a and b, which touch at instant t, get no deeper in a time h than INTERVAL_DEPTH_WIDTH allows,
    without impulses on each other. Without losses no depth is corrected: there the present one adds to it."""
    i, j = A.LINK[a].owner, A.LINK[b].owner
    one, two = A.BODY[i], A.BODY[j]
    vx, vy, spin = rate(A.BODY, i, t)
    wx, wy, turn = rate(A.BODY, j, t)
    speed = norm(vx - wx, vy - wy) + abs(spin) * one.extent + abs(turn) * two.extent
    # Joints may pull harder than gravity, as the present paths show.
    pulled = norm(one.ax - two.ax, one.ay - two.ay)
    pulled += abs(one.angular) * one.extent + abs(two.angular) * two.extent
    deepest = (speed + max(A.PAR.pulled, pulled) * h) * h
    if law(A, a, b)[0] >= 1.0:
        deepest += max(-gap(A, a, b, t)[0], 0.0)
    return bool(deepest <= INTERVAL_DEPTH_WIDTH * (half_width(A, a) + half_width(A, b)))


@kernel
def make_busy(A: Scene, i: int) -> None:
    """Let body i, and its island, be `busy` for BUSY_STEPS steps: all that comes near then joins the island."""
    if A.BODY[i].inv_mass > 0.0:
        A.MEMBER[i].busy = BUSY_STEPS
    if A.STATE[i].island >= 0:
        for member in members_of(A, A.STATE[i].island):
            A.MEMBER[member].busy = BUSY_STEPS


@kernel
def passed_over(A: Scene, a: int, b: int, t: float) -> bool:
    """Whether an impact of shapes a and b at instant t on an island is passed over: it was hit `most_hits` times, or
    its budget is spent (`budget_spent`), and they `stays_shallow` until the end of the step. Bodies of a pair with
    losses then are `busy`. One without losses whose contact persists from then on is not passed over: friction of other
    contacts makes such bounces ever shorter."""
    i, j, loses = A.LINK[a].owner, A.LINK[b].owner, law(A, a, b)[0] < 1.0
    spent = budget_spent(A, A.STATE[i].island) or budget_spent(A, A.STATE[j].island)
    if hits_of(A, a, b) < most_hits(A, a, b) and not spent:
        return False
    if not loses and not jointed(A, i) and not jointed(A, j) and persists_from(A, a, b, t):
        return False
    if not stays_shallow(A, a, b, t, A.PAR.dt - t):
        return False
    if loses:
        make_busy(A, i)
        make_busy(A, j)
    return True

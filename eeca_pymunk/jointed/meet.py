"""Islands with joints are brought to the instant at which they meet other shapes, on their own paths."""

from __future__ import annotations

import math

from ..compiled import kernel, nonallocating
from ..geometry.gap import gap
from ..islands.membership import in_large_island, members_of
from ..islands.rest import speed
from ..model.joint_steps import LINEAR
from ..model.joints import Joints
from ..model.parameters.intervals import TOUCH
from ..model.parameters.joints import (
    CLOSES,
    COLUMN_CONTACTS,
    MEET,
    MEET_DOUBLINGS,
    MEET_HALVINGS,
    MEET_LOADED,
    MEET_MANY,
    MEET_SECANTS,
    MEET_SECANTS_LOADED,
)
from ..model.scene import Scene
from .allowed import gap_and_rate
from .ends import end_here, left_apart, shorten, under_way
from .ledger import work_left
from .partners import carry
from .paths import crossing_of_paths, passes_through


@nonallocating
def begun(A: Scene, i: int) -> float:
    """The latest instant at which an interval of an island without joints has begun or ended, of those islands that
    shapes of body i may touch."""
    latest = 0.0
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            j = A.LINK[A.POOL[w]].owner
            root = A.STATE[j].island
            if root >= 0 and A.MEMBER[root].jointed == 0:
                latest = max(latest, A.BODY[j].since)
    return latest


@kernel
def shorten_both(A: Scene, J: Joints, one: int, other: int, t: float) -> int:
    """`shorten` two islands, or one if both are the same; returns how many contacts they had."""
    loaded = int(shorten(A, J, one, t))
    if other != one:
        loaded += shorten(A, J, other, t)
    return loaded


@nonallocating
def too_late(A: Scene, J: Joints, roots: tuple[int, int], t: float) -> float:
    """The instant by which one of both islands, whose intervals end at t, has moved too far: it `passes_through`
    another shape, or is `left_apart` at t; infinity if neither has."""
    if left_apart(A, J, roots[0]) or left_apart(A, J, roots[1]):
        return t
    return min(passes_through(A, roots[0], t), passes_through(A, roots[1], t))


@kernel
def end_before(A: Scene, J: Joints, root: int, t: float, fits: bool, spent: bool) -> bool:
    """End the interval of an island, which was shortened to instant t; whether the island ends before t. Unless the
    interval is known to fit (`fits`), it is halved while joints do not hold at its end or it has passed through other
    shapes, at last to nothing. The island then stays there until t, or moves with its moving partners (`carry`); if the
    work of the step is `spent`, until the end of the step."""
    if not under_way(A, root):
        return False
    began, then = A.BODY[root].since, t
    for tries in range(0 if fits else MEET_SECANTS):
        if not (left_apart(A, J, root) or passes_through(A, root, then) < math.inf):
            break
        J.TALLY.worst = LINEAR
        then = began if tries + 1 == MEET_SECANTS else 0.5 * (began + then)
        shorten(A, J, root, then)
    end_here(A, J, root, then)
    if not spent:
        carry(A, J, root, t)
    for i in members_of(A, root):
        A.BODY[i].since = then if spent else t
    return bool(then < t)


@kernel
def locate_impact(A: Scene, J: Joints, a: int, b: int, t: float) -> tuple[float, bool]:
    """Bring the islands of shapes a and b, predicted to meet at instant t, to the instant at which they do. Returns it,
    and whether the shapes are apart there.

    An interval that ends earlier has another path, so t is found by secants on the gap at the end of shortened
    intervals. The gap is no continuous function of their length: stiff springs swing more than once in a coarse
    interval. If shapes are on the far side of each other, their paths cross before the end, or it is `too_late`, t is
    halved towards the last instant at which they were apart. If no interval ends at contact, both end where they are
    apart; an island for which no interval fits stays where it is until then. Shapes that touch at the start, and close
    by velocities that joints allow (`allowed`), meet there. Once the work of the step is spent, t is the last instant
    at which they were apart.
    """
    i, j = A.LINK[a].owner, A.LINK[b].owner
    roots = (A.STATE[i].island, A.STATE[j].island if A.BODY[j].inv_mass > 0.0 else -1)
    if not (under_way(A, roots[0]) or under_way(A, roots[1])):
        # Both are at t, and have no paths beyond it: only bodies that they touch have joints.
        return t, False
    # Not before any path begins, where overlapping shapes would have met, nor after an interval's end.
    least, latest = A.BODY[i].since, A.PAR.dt
    if A.BODY[j].inv_mass > 0.0:
        least = max(least, A.BODY[j].since)
    for end in range(2):
        root = roots[end]
        if under_way(A, root):
            least, latest = max(least, A.BODY[root].since), min(latest, A.RESTING[root].until)
            for member in members_of(A, root):
                least = max(least, begun(A, member))
        elif end == 0 or A.BODY[j].inv_mass > 0.0:
            least = max(least, begun(A, i if end == 0 else j))
    # Nor after the next event of other bodies, which comes first.
    if A.COUNT.heap > 0:
        latest = min(latest, max(t, A.HEAP_TIME[0]))
    small = min(A.SHAPE[a].extent, A.SHAPE[b].extent)
    # Shapes that overlap at the start without closing meet when they are as deep again.
    start, rate = gap_and_rate(A, J, a, b, least, False)
    # Closing by round-off, as after an impact, does not count: an impact would not change it.
    rate = 0.0 if abs(rate) <= CLOSES * max(speed(A, i), speed(A, j)) else rate
    if rate >= 0.0 and start <= TOUCH * small:
        _, allowed = gap_and_rate(A, J, a, b, least, True)
        if allowed < -CLOSES * max(speed(A, i), speed(A, j)):
            rate, t = allowed, least
    level = min(start, 0.0) if rate >= 0.0 else 0.0
    before, gap_before, g, touch, loaded = -1.0, 0.0, 0.0, 0.0, 0
    apart, crossed, crosses = least, False, False
    spent = J.PROGRESS.effort > J.PROGRESS.budget
    most = 1 if spent or in_large_island(A, a, b) else MEET_SECANTS_LOADED
    for tries in range(MEET_SECANTS):
        loaded = shorten_both(A, J, roots[0], roots[1], t)
        g = gap(A, a, b, t)[0] - level
        touch = MEET if loaded == 0 else MEET_LOADED if loaded <= COLUMN_CONTACTS else MEET_MANY
        crosses, through = False, t
        if g + level > touch * small:
            through, crosses = crossing_of_paths(A, a, b, t)
        # Depths add up from impact to impact.
        deep = not spent and g < -MEET_MANY * small
        if ((loaded > 0 or spent) and tries + 1 >= most and not deep) or abs(g) <= touch * small:
            break
        secant = before >= 0.0 and t != before
        slope = (g - gap_before) / (t - before) if secant else gap_and_rate(A, J, a, b, t, False)[1]
        if not slope < 0.0 and g < -touch * small and start >= -touch * small:
            # Beyond the middle of a thin shape the normal is that of its far side.
            through, crosses = crossing_of_paths(A, a, b, t)[0], True
        if crosses:
            if tries + 1 == MEET_SECANTS:
                break
            crossed, before = True, -1.0
            t = through if apart < through < t else 0.5 * (apart + t)
            continue
        if g > 0.0 and not (left_apart(A, J, roots[0]) or left_apart(A, J, roots[1])):
            apart = t
        # The last attempt stays.
        if not slope < 0.0 or tries + 1 == MEET_SECANTS:
            break
        before, gap_before = t, g
        then = max(min(t - g / slope, latest), least)
        # A flat secant leads back to the start, where shapes that were apart do not meet.
        away = level < 0.0 or start > touch * small
        if (then == least and away) or (then <= apart and loaded > 0 and deep):
            then = 0.5 * (apart + t)
        if then == t:
            break
        t = then
    if loaded == 0 and rate >= 0.0 and g < -MEET_MANY * small:
        crosses = True  # joints bring the shapes together before the first secant
    fits = False
    for _ in range(MEET_HALVINGS):
        late = math.inf if crosses else too_late(A, J, roots, t)
        fits = not (crosses or late < math.inf)
        if fits:
            break
        if late <= apart:  # shapes were too far at `apart` already
            apart = least
        spent = work_left(A, J) < 0.0
        crossed, t = True, apart if spent else 0.5 * (apart + t)
        shorten_both(A, J, roots[0], roots[1], t)
        g = gap(A, a, b, t)[0] - level
        # Where a limit drives them together, the instant after it counts: before it they are as at the start.
        crosses = g < -TOUCH * small or (g + level > touch * small and crossing_of_paths(A, a, b, t)[1])
        if spent:
            break
    if rate >= 0.0 and t - least <= A.PAR.instant:
        # Shapes only close once joints act, for instance at a limit that directs velocities into the other shape. The
        # interval doubles with each impact of the bodies, so that the step ends.
        met = min(max(A.STATE[i].events, A.STATE[j].events), MEET_DOUBLINGS)
        t = min(least + 2.0 ** (met + 1) * A.PAR.instant, latest)
        shorten_both(A, J, roots[0], roots[1], t)
        fits = too_late(A, J, roots, t) == math.inf
        while not fits and t - least > A.PAR.instant and work_left(A, J) >= 0.0:
            t = 0.5 * (least + t)
            shorten_both(A, J, roots[0], roots[1], t)
            fits = too_late(A, J, roots, t) == math.inf
    for root in roots:
        if end_before(A, J, root, t, fits, work_left(A, J) < 0.0):
            g, crossed = math.inf if work_left(A, J) < 0.0 else gap(A, a, b, t)[0] - level, True
    # Shapes that close within PAR.instant, which is no interval, meet now.
    return t, crossed and g > max(touch * small, -rate * A.PAR.instant)

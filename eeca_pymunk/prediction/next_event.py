"""The next event of a body on its present path, among the shapes of its lists.

A prediction is a function of the two paths and of the horizon only, not of the instant at which it is made: times count
from the later start of the two paths. Paths of equal acceleration give times that are valid beyond the step. For other
pairs the search stops at the end of the step and returns a lower bound; the body is predicted again at that instant.
"""

from __future__ import annotations

import math

from ..compiled import inlined, nonallocating
from ..geometry.flight import norm, pose
from ..model.bodies import CHECK, LEAVE, NOTHING, RENEW
from ..model.parameters.events import ENTRY_LOOKS, MARGIN_LEFT, SHAPES_LOOK
from ..model.scene import Scene
from ..pairs.rules import barred, circle_centre
from .heap import push_event
from .impact_times import time_of_impact


@inlined
def passage(room: float, u: float, g: float) -> float:
    """Least time in which a point of speed u and acceleration g covers a way `room`: u t + g t^2 / 2 = room."""
    if room <= 0.0:
        return 0.0
    speeds = u + math.sqrt(u * u + 2.0 * g * room)
    return 2.0 * room / speeds if speeds > 0.0 else math.inf


@inlined
def straight_exit(dx: float, dy: float, vx: float, vy: float, m: float) -> float:
    """Time at which a point that moves from d with the velocity v leaves the circle of radius m about 0; 0 if it is
    outside, be it on its way back."""
    c = m * m - dx * dx - dy * dy
    if m <= 0.0 or c <= 0.0:
        return 0.0
    squared = vx * vx + vy * vy
    b = dx * vx + dy * vy
    root = math.sqrt(b * b + squared * c)
    if root == 0.0:
        return math.inf  # at rest, or so slow that squares underflow
    return float((root - b) / squared if b <= 0.0 else c / (root + b))


@inlined
def exit_time(dx: float, dy: float, vx: float, vy: float, g: float, m: float) -> float:
    """`straight_exit` of a point whose acceleration is no larger than g: exact for g = 0, else a lower bound.

    Up to an instant t acceleration displaces the point by g t² / 2 at most, so it is inside until the straight path
    leaves a circle that is smaller by this.
    """
    t = straight_exit(dx, dy, vx, vy, m)
    if g == 0.0 or t == 0.0:
        return t
    least = passage(m - norm(dx, dy), norm(vx, vy), g)
    return max(least, straight_exit(dx, dy, vx, vy, m - 0.5 * g * t * t)) if t < math.inf else least


@nonallocating
def inside_until(A: Scene, i: int, s: int, now: float) -> float:
    """Instant up to which the centre of the bounding circle of shape s, of body i, stays inside its margin circle:
    exact for a straight path of a shape about the centre of mass, else a lower bound. `now` itself if it is outside, as
    a shape may be that the program has moved."""
    BODY, SHAPE, MARK = A.BODY, A.SHAPE, A.MARK
    m = MARK[s].margin
    if m == math.inf:
        return math.inf
    h = now - BODY[i].since
    ax, ay = BODY[i].ax, BODY[i].ay
    vx, vy, g = BODY[i].vx + ax * h, BODY[i].vy + ay * h, norm(ax, ay)
    arm = 0.0 if s < A.COUNT.disks else norm(SHAPE[s].centre_x, SHAPE[s].centre_y)
    # The centre of the circle is never farther from the body's centre of mass than its arm, however fast it goes around
    # that.
    x, y, _ = pose(BODY, i, now)
    inside = exit_time(x - MARK[s].x, y - MARK[s].y, vx, vy, g, m - arm)
    if arm > 0.0:
        # Another lower bound: it moves no farther than its path is long.
        x, y = circle_centre(A, s, now)
        turned = abs(BODY[i].spin + BODY[i].angular * h)
        room = m - norm(x - MARK[s].x, y - MARK[s].y)
        inside = max(inside, passage(room, norm(vx, vy) + turned * arm, g + abs(BODY[i].angular) * arm))
    return now + inside


@nonallocating
def margin_used(A: Scene, s: int, now: float) -> bool:
    """Whether shape s has used more than 1 - MARGIN_LEFT of its margin."""
    x, y = circle_centre(A, s, now)
    return bool(norm(x - A.MARK[s].x, y - A.MARK[s].y) > (1.0 - MARGIN_LEFT) * A.MARK[s].margin)


@nonallocating
def horizon_of(A: Scene, i: int) -> float:
    """Instant up to which impacts on the present path of body i are searched: the end of the step; for a body of an
    island whose interval ends within the step, as long after the end of the interval as the path began before it. The
    body has another path then, and the bounds of a path that bends sharply are too wide over a longer time."""
    root = A.STATE[i].island
    if root < 0 or A.RESTING[root].until == math.inf:
        return A.PAR.dt
    until = A.RESTING[root].until
    return min(A.PAR.dt, until + max(until - A.BODY[i].since, 0.0))


@inlined
def predict(A: Scene, i: int, now: float) -> None:
    """Predict the next event of body i from its present path, at an instant `now` of the loop; one that is due in this
    step goes on the heap. Ties go to the lower shape numbers, so that the result does not depend on the order of lists.

    The end of an island's interval is an event of its root. PLACE (n,) >= 0 marks bodies that are predicted together; a
    pair of two such bodies is tested for the one with the lower number only.
    """
    BODY, STATE, LINK, LIST = A.BODY, A.STATE, A.LINK, A.LIST
    best, own, other, entries = math.inf, -1, NOTHING, 0
    horizon = horizon_of(A, i)
    first = STATE[i].first_shape
    for s in range(first, first + STATE[i].shapes):
        t = inside_until(A, i, s, now)
        if t < best:
            best, own, other = t, s, LEAVE
        start = LIST[s].start
        entries += LIST[s].number
        for q in range(start, start + LIST[s].number):
            if A.FLAG[q] != 0:
                continue
            o = int(A.POOL[q])
            if A.PLACE[LINK[o].owner] >= 0 and LINK[o].owner < i:
                continue
            if A.RULE.shape[0] > 0 and barred(A, s, o):
                continue
            t, certain = time_of_impact(A, s, o, min(horizon, horizon_of(A, LINK[o].owner)), best)
            if t < best or (t == best and other >= 0 and (s < own or (s == own and o < other))):
                best, own, other = t, s, (o if certain else CHECK)
    A.COUNT.work += 1 + ENTRY_LOOKS * entries + (STATE[i].shapes - 1) / SHAPES_LOOK
    if STATE[i].island == i and A.RESTING[i].until < best:
        best, own, other = A.RESTING[i].until, -1, RENEW
    best = max(best, now)
    BODY[i].due = best
    STATE[i].own, STATE[i].other = own, other
    if other >= 0:
        STATE[i].known = STATE[LINK[other].owner].version
    if i < A.COUNT.disks:
        # No impact is kept for `disks.continue_path`, which therefore tests the whole list.
        LIST[i].later = CHECK
    if best < A.PAR.dt:
        A.COUNT.heap = push_event(A.HEAP_TIME, A.HEAP_BODY, A.COUNT.heap, best, i)

"""Gaps of joints to their limits, and the rates of these gaps. Rows must be those of the present poses.

side: -1 the lower, 1 the upper bound; `link.side` is the one on which the joint stands, 0 for none.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import JointStep
from ..model.joints import GROOVE, RATCHET, ROTARY_LIMIT, SLIDE, Coupling, Workspace
from ..model.parameters.joints import JOINT_TOUCH, LIMIT_HOP, LIMIT_WAY
from ..newton.entries import along, idle
from ..newton.rows import joint_rows


@nonallocating
def limit_gap(W: Workspace, k: int, side: int) -> float:
    """Gap of joint k to its bound at this side at the end of the present iterate: length or rad, negative beyond the
    bound; infinite if it has none. The bound of a limit that is apart is its `target` beyond it, in this step: let go,
    it comes back as bodies move."""
    kind, joint, hinge = W.link[k].kind, W.J.JOINT[W.link[k].joint], W.J.HINGE[k]
    bound = joint.notch if kind == RATCHET else joint.upper if side > 0 else joint.lower
    if kind == RATCHET:
        bounded = side * joint.tooth < 0.0
    elif kind == SLIDE and side < 0:
        bounded = bound > 0.0
    else:
        bounded = kind in (SLIDE, ROTARY_LIMIT, GROOVE) and abs(bound) < math.inf
    if not bounded:
        return math.inf
    left = hinge.target[W.link[k].rows - 1] if W.link[k].bounded == 0 else 0.0
    if side * left > 0.0:  # a slide's g is (d.d/bound - bound)/2
        bound = math.sqrt(max(bound * (bound + 2.0 * left), 0.0)) if kind == SLIDE else bound + left
    return float(side * (bound - hinge.measure))


@inlined
def stand(W: Workspace, k: int, side: int) -> None:
    """Let joint k stand on its bound at this side. A `target` that leaves it apart at the other side ends: it is that
    of the bound on which it stands."""
    last = W.link[k].rows - 1
    if side * W.J.HINGE[k].target[last] < 0.0:
        W.J.HINGE[k].target[last] = 0.0
    W.link[k].side = side


@nonallocating
def stand_as_stepped(W: Workspace) -> None:
    """Let joints stand on the bounds on which the last step has left them, or on none."""
    for k in range(W.joints):
        W.link[k].side = W.J.JOINT[W.link[k].joint].side


@inlined
def inactive(link: Rows[Coupling], k: int) -> bool:
    """Whether joint k stands on no bound, and its force is not bounded: if it is a limit, it may meet one. True of all
    joints that are no limits, whose gaps are infinite (`limit_gap`)."""
    return link[k].side == 0 and link[k].bounded == 0


@nonallocating
def passed_side(W: Workspace, k: int, least: float) -> int:
    """The side on which joint k is beyond its bound by more than `least`, in units of its g; 0 if there is none."""
    least *= W.J.HINGE[k].unit
    return 1 if limit_gap(W, k, 1) < -least else -1 if limit_gap(W, k, -1) < -least else 0


@nonallocating
def limit_gap_rate(hinge: JointStep, rows: int, side: int, v_a: FloatArray, v_b: FloatArray) -> float:
    """Rate of the gap at this side, negative if it closes: by the last of a joint's `rows` rows J and the velocities
    v_a and v_b (3,) of its bodies."""
    return -side * along(hinge, rows - 1, v_a, v_b)


@inlined
def gap_rates(W: Workspace, k: int, side: int) -> tuple[float, float]:
    """`limit_gap_rate` of joint k at the start and at the end of the present iterate."""
    hinge, rows, a, b = W.J.HINGE[k], W.link[k].rows, W.J.LOCAL[W.link[k].body[0]], W.J.LOCAL[W.link[k].body[1]]
    return limit_gap_rate(hinge, rows, side, a.v0, b.v0), limit_gap_rate(hinge, rows, side, a.v1, b.v1)


@nonallocating
def standing(W: Workspace) -> bool:
    """Whether a joint stands on a limit."""
    for k in range(W.joints):
        if W.link[k].side != 0:
            return True
    return False


@nonallocating
def closes_on_limit(W: Workspace, h: float) -> bool:
    """Whether a joint that stands on a limit moves into its bound within h by more than round-off of its place. Rows
    must be those of the present poses."""
    link = W.link
    for k in range(W.joints):
        if link[k].side != 0 and link[k].bounded == 0:
            rate, _ = gap_rates(W, k, link[k].side)
            if -rate * h > LIMIT_WAY * W.J.HINGE[k].unit:
                return True
    return False


@nonallocating
def update_idle(W: Workspace, k: int, h: float) -> None:
    """Compute the rows of joint k at the present iterate if it is a limit on which it does not stand (`idle`)."""
    if idle(W.link, k):
        joint_rows(W, k, h, False)


@nonallocating
def in_reach(W: Workspace, k: int) -> bool:
    """Whether joint k is `inactive` and may meet a bound in the present iterate, in which bodies turn by at most chi
    each."""
    if not inactive(W.link, k):
        return False
    j, a, b = W.J.JOINT[W.link[k].joint], W.J.LOCAL[W.link[k].body[0]], W.J.LOCAL[W.link[k].body[1]]
    angle, reach = b.pose[2] - a.pose[2], abs(a.way[2]) + abs(b.way[2])
    return bool(W.link[k].kind != ROTARY_LIMIT or not j.lower < angle - reach or not angle + reach < j.upper)


@nonallocating
def begin_part(W: Workspace) -> None:
    """Start a part of a step: no limit has been released in it."""
    for k in range(W.joints):
        W.link[k].let_go = 0


@nonallocating
def hold_passed(W: Workspace) -> bool:
    """Let all limits act, at their bounds, that the present iterate has passed; whether there are any. Only after
    `first_bound` or `start.compute_rows`, which compute their rows."""
    found = False
    for k in range(W.joints):
        side = passed_side(W, k, JOINT_TOUCH) if in_reach(W, k) else 0
        if side != 0:
            stand(W, k, side)
            found = True
    return found


@nonallocating
def held_till_then(W: Workspace, k: int, side: int, instant: float) -> bool:
    """Whether limit k, passed at about this instant, stood on its bound at the start of the part, was released, and has
    not left its bound since: its force changes sign only later."""
    link, hinge = W.link, W.J.HINGE
    rate, _ = gap_rates(W, k, side)
    return bool(link[k].let_go == side and rate * instant <= LIMIT_WAY * hinge[k].unit)


@nonallocating
def hops(W: Workspace, k: int, side: int, instant: float, h: float) -> bool:
    """Whether limit k starts the solved part h on its bound, leaves it by no more than LIMIT_HOP, and is back at about
    this instant. Two limits that stop one another do so after ever shorter times, and end on both bounds. Not if it was
    released in this part, since its force changes sign then."""
    link, hinge = W.link, W.J.HINGE
    before, after = gap_rates(W, k, side)
    start = limit_gap(W, k, side) - 0.5 * h * (before + after)
    way = max(start, 0.0) + 0.25 * before * instant
    return bool(link[k].let_go != side and before >= 0.0 and way <= LIMIT_HOP * hinge[k].unit)


@inlined
def instant_of(start: float, before: float, after: float, h: float) -> float:
    """The first root t of a gap start + before t + (after - before) t^2/(2h), start >= 0, that is negative at h: its
    rate changes uniformly from `before` to `after`."""
    curvature = 0.5 * (after - before) / h
    root = math.sqrt(max(before * before - 4.0 * curvature * start, 0.0))
    if before > 0.0:
        return -0.5 * (before + root) / curvature if curvature < 0.0 else h
    return 2.0 * start / (root - before) if root - before > 0.0 else 0.0


@nonallocating
def first_bound(W: Workspace, h: float) -> tuple[int, int, float]:
    """The inactive limit that the solved step h passes first, by the rates of its gap, -1 for none; its side; and
    approximately the instant, from the start of the step."""
    hinge = W.J.HINGE
    which, at_side, instant = -1, 0, h
    for k in range(W.joints):
        if not in_reach(W, k):
            continue
        update_idle(W, k, h)
        for side in (-1, 1):
            end = limit_gap(W, k, side)
            if end >= -JOINT_TOUCH * hinge[k].unit:
                continue
            before, after = gap_rates(W, k, side)
            when = min(instant_of(max(end - 0.5 * h * (before + after), 0.0), before, after, h), h)
            if which < 0 or when < instant:
                which, at_side, instant = k, side, when
    return which, at_side, instant


@nonallocating
def least_gap(W: Workspace, k: int, side: int, h: float) -> tuple[float, float]:
    """The smallest gap of limit k within the solved step h, and the fraction of h at which it occurs; 1 if that is an
    end. For a slide it is the distance of the chord d(s) = d0 + s (d1 - d0) from 0. Others have rates that change
    uniformly from b to a: the gap is smallest at s = b/(b - a), where it has changed by b s h/2."""
    hinge = W.J.HINGE[k]
    end = limit_gap(W, k, side)
    if not end < math.inf:
        return end, 1.0
    if W.link[k].kind == SLIDE:
        x, y = hinge.span[0], hinge.span[1]
        way_x, way_y = 2.0 * (hinge.measure * hinge.rows[0, 3] - x), 2.0 * (hinge.measure * hinge.rows[0, 4] - y)
        along_way, squared = -(x * way_x + y * way_y), way_x * way_x + way_y * way_y
        if side > 0 or not 0.0 < along_way < squared:
            return end, 1.0
        across = x * way_y - y * way_x
        return end - hinge.measure + math.sqrt(across * across / squared), along_way / squared
    before, after = gap_rates(W, k, side)
    if not before * h < 0.0 < after * h:
        return end, 1.0
    start, part = max(end - 0.5 * h * (before + after), 0.0), before / (before - after)
    return start + 0.5 * before * part * h, part


@nonallocating
def passed_within(W: Workspace, h: float) -> float:
    """The first instant, from the start of the solved step h, at which an inactive limit is farthest beyond a bound
    although it ends within it; h if there is none. Only after `first_bound`, which computes the rows of limits."""
    first = 1.0
    for k in range(W.joints):
        if not in_reach(W, k):
            continue
        for side in (-1, 1):
            least, part = least_gap(W, k, side, h)
            if part < first and least < -JOINT_TOUCH * W.J.HINGE[k].unit:
                first = part
    return first * h

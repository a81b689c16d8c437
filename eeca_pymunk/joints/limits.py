"""Limits of slides, grooves, rotary limits and ratchets: met at their instant without bounce, acting while they push.

A limit is a row that is inactive, or acts (side = -1 on the lower, 1 on the upper bound): g = bound, lam side <= 0. If
a step would end beyond a bound, it is taken again to the instant at which the bound is reached (secant on the end of
the implicit step). There velocities into the bound vanish, and the loss enters the ledger. A row that would pull is
released from the start of the part on. If another limit is met within that part, and the released row does not leave
its bound until then, its force changes sign later: it acts up to there. The number of parts of a step is bounded,
and so is the work for them (`in_haste`); then limits *land*: the rows of all that were passed act from the present
place on, g reaches the bound at the end of the part, and their work enters the ledger.

A part is solved to the end of the step (`at_end`), or to the instant at which a limit is searched (`at_limit`):

    at_end    a row pulls: it is released (`release`)                  GOES_ON, to the same instant
              a limit is passed (`first_bound`): searched, or lands    GOES_ON, to its instant, or to the end
              one is left and passed again (`hops`): held from the     GOES_ON, to the end
              start of the part
              none is passed: the part ends (`end_part`)               ENDS, or GOES_ON if time is left
              one is passed and passed back (`passed_within`)          GOES_ON, to an instant in between
              either, in a step as a `whole`                           FAILS
    at_limit  its gap is not closed yet: the next secant (`seek`)      GOES_ON, to another instant
              another limit is passed before: that is searched first   GOES_ON, to its instant
              that one's force acts up to there (`held_till_then`),    GOES_ON: it stands at once
              or there is no work for its search (`late`)
              the last solution met it (`foreseen`), this one does not GOES_ON, to the end
              not found after all secants: it lands                    GOES_ON, to the end
              its gap is closed                                        MEETS: `meet_limit`, and the next part

Each solution of an interval first tries the limits, and their instants, that the one before has met (`parts`).
"""

from __future__ import annotations

from ..compiled import inlined, nonallocating
from ..model.joint_steps import SPEEDS, STEP, Parts
from ..model.joints import Workspace
from ..model.parameters import joints
from ..newton.motion import accept_part
from ..newton.solve import drop_impulses, solve, solve_linearly
from . import bounds
from .correct import loss_of_projection, project, release
from .ledger import account_part
from .parts import begin_as_before, begin_next, meets_limit, note_part

GOES_ON, MEETS, ENDS, FAILS = 0, 1, 2, 3  # what follows a solve


@nonallocating
def stop_at(W: Workspace, k: int, side: int, at_once: bool, stays: bool) -> None:
    """Let joint k stand on its limit at this side: velocities into the bound vanish, and the loss enters RUNG_LEDGER.
    The next part begins without impulses.

    Args:
        at_once: the part before is empty but for round-off.  stays: velocities out of the bound vanish as well, and no
            joint that stands on a limit is released.
    """
    link = W.link
    bounds.stand(W, k, side)
    for i in range(W.joints):
        link[i].let_go = link[i].side if stays else 0
    project(W, SPEEDS)
    bounds.begin_part(W)
    if at_once:
        bounds.stand(W, k, side)  # a velocity that released it is round-off: forces press it to its bound at once
    W.J.RUNG_LEDGER.limited += loss_of_projection(W, W.J.RUNG_LEDGER)
    drop_impulses(W)


@nonallocating
def search_for(S: Parts, k: int, side: int, when: float, high: float) -> None:
    """Begin the search for the instant at which joint k meets its limit at this side: at `when`, below `high`."""
    S.limit, S.side, S.when, S.low, S.high, S.secants = k, side, when, 0.0, high, 0


@inlined
def in_haste(W: Workspace) -> bool:
    """Whether joints have taken more than HASTE of the work of this step of the scene. Slack nets meet so many limits
    that their instants take all of it, and motion none."""
    return bool(W.J.PROGRESS.effort > joints.HASTE * W.J.PROGRESS.budget)


@nonallocating
def late(W: Workspace, S: Parts) -> bool:
    """Whether instants are no longer searched: limits that are met then land."""
    return bool(S.events >= joints.LIMIT_EVENTS or in_haste(W))


@nonallocating
def end_part(W: Workspace, S: Parts, linear: bool, h: float, whole: bool) -> int:
    """End a part at whose end no limit is passed; or, if a limit was passed and passed back within it, solve again to
    an instant in between. Arguments as of `step_with_limits`."""
    component = W.J.COMPONENT[W.s]
    within = S.when if linear or late(W, S) else bounds.passed_within(W, S.when)
    if within != S.when:
        if whole:
            return FAILS
        S.when, S.events, component.parts_within = within, S.events + 1, 0.0
        return GOES_ON
    account_part(W, S.when)
    accept_part(W, S.when)
    if component.parts_within == h:
        note_part(W, S.part, -1, 0, S.when)
    S.left -= S.when
    if S.left == 0.0:
        return ENDS
    S.when, S.solved = S.left, 0.0
    bounds.begin_part(W)
    drop_impulses(W)
    return GOES_ON


@nonallocating
def at_end(W: Workspace, S: Parts, linear: bool, h: float, whole: bool) -> int:
    """Decide what follows a solve to the end of the step. Arguments as of `step_with_limits`."""
    # After these none is released or searched: each joint may be met and released once, the others are for searches.
    most = joints.LIMIT_SOLVES if linear else 2 * W.joints + joints.LIMIT_SEARCHES
    if S.solves < most and release(W, STEP):
        return GOES_ON
    k, side, instant = bounds.first_bound(W, S.when)
    if k < 0 or linear:
        return end_part(W, S, linear, h, whole)
    if whole:
        return FAILS
    lands = late(W, S) or S.solves >= most
    S.events += 1
    if S.hopped < W.joints and bounds.hops(W, k, side, instant, S.when):
        S.solved, S.hopped = 0.0, S.hopped + 1
        stop_at(W, k, side, True, True)
    elif lands:
        bounds.hold_passed(W)
    else:
        search_for(S, k, side, instant, S.left)
    return GOES_ON


@nonallocating
def seek(W: Workspace, S: Parts, gap_now: float) -> None:
    """Choose the next instant of the search from the gap at the present one: by a secant, or the middle."""
    if gap_now > 0.0:
        S.low = S.when
    else:
        S.high = S.when
    _, rate = bounds.gap_rates(W, S.limit, S.side)
    # From beyond the bound, a flat secant (of a gap that opens first) hardly moves: the rate is used instead.
    if S.secants > 1 and S.when != S.last:
        secant = (gap_now - S.gap) / (S.when - S.last)
        rate = secant if gap_now > 0.0 or secant < 0.5 * rate else rate
    S.last, S.gap = S.when, gap_now
    step = S.when - gap_now / rate if rate < 0.0 else 0.5 * (S.low + S.high)
    S.when = step if S.low < step < S.high else 0.5 * (S.low + S.high)


@nonallocating
def at_limit(W: Workspace, S: Parts) -> int:
    """Decide what follows a solve to the instant of a limit: MEETS if that is met, and no other one before."""
    bounds.update_idle(W, S.limit, S.when)
    gap_now, touch = bounds.limit_gap(W, S.limit, S.side), joints.JOINT_TOUCH * W.J.HINGE[S.limit].unit
    S.secants += 1
    if S.foreseen > 0:  # met by the last solution, perhaps not by this one
        _, rate = bounds.gap_rates(W, S.limit, S.side)
        if not (rate < 0.0 and 0.0 < S.when - gap_now / rate < S.left):
            S.limit, S.when, S.secants, S.events, S.foreseen = -1, S.left, 0, S.events - 1, 0
            return GOES_ON
    most = joints.LIMIT_SECANTS_HASTE if in_haste(W) else joints.LIMIT_SECANTS
    if abs(gap_now) > 0.1 * touch and S.secants < most:  # the rest of `touch` is for round-off of the next solve
        seek(W, S, gap_now)
        return GOES_ON
    if abs(gap_now) > touch:  # not found: land
        bounds.stand(W, S.limit, S.side)
        S.limit, S.when = -1, S.left
        return GOES_ON
    k, side, instant = bounds.first_bound(W, S.when)
    if k < 0 or k == S.limit:
        return MEETS
    if bounds.held_till_then(W, k, side, instant) or late(W, S):
        bounds.stand(W, k, side)  # holds, or lands
        search_for(S, S.limit, S.side, S.when, S.left)
    else:
        S.events += 1
        search_for(S, k, side, instant, S.when)
    return GOES_ON


@nonallocating
def meet_limit(W: Workspace, S: Parts, h: float) -> None:
    """Let the joint stand on the limit that it meets at the end of the part; bodies move there unless the way is
    round-off."""
    at_once = not is_solved(S, h)
    if not at_once:
        rate, after = bounds.gap_rates(W, S.limit, S.side)
        near = rate < 0.0 and -S.when * min(rate, after) <= joints.LIMIT_WAY * W.J.HINGE[S.limit].unit
        at_once = near or S.when <= joints.MEET_INSTANT * abs(h)
    if not at_once:  # else round-off of places, over S.when, would become velocities
        account_part(W, S.when)
        accept_part(W, S.when)
        note_part(W, S.part, S.limit, S.side, S.when)
        S.part += 1
        S.left -= S.when
        # In a short part most accelerations by joints correct velocities that violate these, and are no forces.
        for i in range(W.bodies if S.when < S.left else 0):
            for c in range(3):
                W.J.LOCAL[i].lead[c] *= S.when / S.left
    stop_at(W, S.limit, S.side, at_once, False)


@inlined
def is_solved(S: Parts, h: float) -> bool:
    """Whether the part is longer than round-off of the step h: only then it is solved."""
    return bool(S.when > joints.PART_ROUND_OFF * abs(h) or h < 0.0)


@nonallocating
def step_with_limits(W: Workspace, linear: bool, h: float, extent: float, cold: bool, give: float, whole: bool) -> bool:
    """Take the step h in parts between instants at which limits are met; False if a solve fails.

    Args:
        linear: whether by linear systems, which pass limits.  extent: size of the component.
        cold: whether rows are redundant and begin without impulses.  give: compliance over h², see `..newton.systems`.
        whole: whether the step must not meet any limit: False if it would.
    """
    S, component = W.J.PARTS, W.J.COMPONENT[W.s]
    S.left = h
    S.part = S.events = S.solves = 0
    bounds.begin_part(W)
    if component.parts_within != h or linear or whole:
        component.parts, component.parts_within = 0, 0.0 if linear or whole else h
    component.parts = component.parts if meets_limit(component) else 0
    begin_next(W, S, cold)
    while True:
        if is_solved(S, h):
            redundant = cold or bounds.standing(W)
            if S.solved != 0.0 and not linear:
                begin_as_before(W, S.solved, S.when)
            if not (solve_linearly(W, S.when, extent) if linear else solve(W, S.when, extent, redundant, give)):
                return False
            S.solves, S.solved = S.solves + 1, S.when
            verdict = at_limit(W, S) if S.limit >= 0 else at_end(W, S, linear, h, whole)
            if verdict == GOES_ON:
                continue
            if verdict != MEETS:
                return verdict == ENDS
        meet_limit(W, S, h)
        if S.left <= joints.PART_ROUND_OFF * h:
            return True
        begin_next(W, S, cold)

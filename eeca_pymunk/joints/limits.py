"""Limits of slides, grooves, rotary limits and ratchets: met at their instant without bounce, held while they push.

A limit is a row that is either held (side = -1 on the lower, 1 on the upper bound), g = bound, lam side <= 0, or free.
When a step would end beyond a bound, it is taken anew to the instant at which the bound is reached (secant on the end
of the implicit step); there velocities into the bound vanish, and what that costs in kinetic energy enters the ledger.
A held row that would pull is let go from the start of the part. Where another limit is met within that, and up to its
instant the row does not leave its bound, its force changes sign later: it is held up to there. The number of parts of a
step is bounded; past it, rows land: they are held from where they are, g reaches its bound at the end of the part, and
their work enters the ledger.

The solutions of one interval differ by little: each looks first for the limits that the one before has met, at their
instants (`parts`).
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import SPEEDS, JointLedger
from ..model.joints import Workspace
from ..model.parameters.joints import (
    JOINT_TOUCH,
    LIMIT_EVENTS,
    LIMIT_SECANTS,
    LIMIT_SECANTS_HASTE,
    LIMIT_SOLVES,
    LIMIT_WAY,
    MEET_INSTANT,
)
from ..newton.motion import advance
from ..newton.solve import drop_impulses, solve, solve_linearly
from .bounds import (
    begin_part,
    first_bound,
    gap,
    gap_rates,
    held_till_then,
    hold_limits,
    hops,
    look,
    passed_within,
    release,
    standing,
)
from .correct import correct, fitting_loss
from .ledger import book
from .parts import begin_as_known, meets_limit, note_part


@nonallocating
def begin_as_before(W: Workspace, before: float, h: float) -> None:
    """Let the solve of a part h begin with the mean accelerations and forces of the last solve, of a part `before` from
    the same start: `lead` and `lam`."""
    local, hinge, longer = W.J.LOCAL, W.J.HINGE, h / before
    for i in range(W.bodies):
        for c in range(3):
            local[i].lead[c] = (local[i].v1[c] - local[i].v0[c]) / before - local[i].acceleration[c]
    for k in range(W.joints):
        hinge[k].lam[0] *= longer
        hinge[k].lam[1] *= longer


@nonallocating
def weaken_lead(W: Workspace, share: float) -> None:
    """Let the next part begin with this share of the accelerations by joints in the part before: the shorter that was,
    the more they tell of velocities that did not fit, and the less of forces."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].lead[c] *= share


@nonallocating
def stop_at(W: Workspace, k: int, side: int, at_once: bool, stays: bool, ledger: JointLedger) -> None:
    """Let joint k stand on its limit at this side, where it is: velocities into the bound vanish, and what that costs
    enters `ledger`. The next part begins without impulses.

    Args:
        at_once: the part before is empty but for round-off.  stays: velocities out of the bound vanish, too, and none
            that stands is let go.
    """
    link = W.link
    link[k].side = side
    for i in range(W.joints):
        link[i].let_go = link[i].side if stays else 0
    correct(W, SPEEDS)
    begin_part(link, W.joints)
    if at_once:
        link[k].side = side  # the velocity that lets go is round-off: forces press it to its bound at once
    ledger.limited += fitting_loss(W.J.LOCAL, W.bodies, ledger)
    drop_impulses(W)
    hold_limits(W)


@nonallocating
def step_with_limits(
    W: Workspace, linear: bool, h: float, length: float, loops: bool, give: float, whole: bool, ledger: JointLedger
) -> bool:
    """Take the step h in parts between instants at which limits are met; False if a solve fails.

    Args:
        linear: whether by linear systems, which pass limits.  length: size of the component.
        loops: whether rows may be redundant.  give: compliance over h², see `..newton.systems`.
        whole: whether the step must not meet any limit: False if it would.  ledger: energies are added to it.
    """
    hinge, link, local, progress, component = W.J.HINGE, W.link, W.J.LOCAL, W.J.PROGRESS, W.J.COMPONENT[W.s]
    # What is left of the step; the length of the next solve; instants before and after that at which a limit is met.
    left, when, low, high = h, h, 0.0, h
    solved = 0.0  # length of the last solve from the present start
    # The limit whose instant is searched, -1 for none, and its side.
    events, solves, secants, meeting, side = 0, 0, 0, -1, 0
    last, before = 0.0, 0.0  # the last instant of the search, and the gap there
    part, foreseen, hopped = 0, False, 0
    most_solves = LIMIT_SOLVES if linear else 2 * W.joints + 100  # more of them neither let go nor search
    begin_part(link, W.joints)
    if component.parts_within != h or linear or whole:
        component.parts, component.parts_within = 0, 0.0 if linear or whole else h
    if meets_limit(component):
        meeting, side, when = begin_as_known(W, 0, h, loops)
        foreseen, events = meeting >= 0, 1
    while True:
        redundant, at_once = loops or standing(link, W.joints), True
        if when > 1e-13 * abs(h) or h < 0.0:
            if solved != 0.0 and not linear:
                begin_as_before(W, solved, when)
            if not (solve_linearly(W, when, length) if linear else solve(W, when, length, redundant, give)):
                return False
            solves, solved = solves + 1, when
            if meeting < 0:  # a step to the end
                if solves < most_solves and release(W):
                    continue
                k, other, instant = first_bound(W, when)
                if k < 0 or linear:
                    may_end = not linear and events < LIMIT_EVENTS and progress.effort <= progress.hurry
                    within = passed_within(W, when) if may_end else when
                    if within != when:  # a limit is passed, and passed again: the part ends between
                        if whole:
                            return False
                        when, events, component.parts_within = within, events + 1, 0.0
                        continue
                    book(W, when, ledger)
                    advance(local, W.bodies, when)
                    if component.parts_within == h:
                        note_part(W, part, -1, 0, when)
                    if when == left:
                        return True
                    left -= when
                    when, solved = left, 0.0
                    begin_part(link, W.joints)
                    drop_impulses(W)
                    continue
                if whole:
                    return False
                side, events = other, events + 1
                if hopped < W.joints and hops(W, k, other, instant, when):
                    solved, hopped = 0.0, hopped + 1
                    stop_at(W, k, other, True, True, ledger)
                    continue
                if events > LIMIT_EVENTS or solves >= most_solves or progress.effort > progress.hurry:  # land
                    link[k].side = side
                    continue
                meeting, when, low, high, secants = k, instant, 0.0, left, 0
                continue
            look(W, meeting, when)
            distance = gap(W.J.JOINT, hinge, link, meeting, side)
            secants += 1
            if foreseen:  # perhaps it is not met now
                _, rate = gap_rates(W, meeting, side)
                if not (rate < 0.0 and 0.0 < when - distance / rate < left):
                    meeting, when, secants, events, foreseen = -1, left, 0, events - 1, False
                    continue
            most = LIMIT_SECANTS if progress.effort <= progress.hurry else LIMIT_SECANTS_HASTE
            if abs(distance) > 0.1 * JOINT_TOUCH * hinge[meeting].size and secants < most:
                if distance > 0.0:
                    low = when
                else:
                    high = when
                _, rate = gap_rates(W, meeting, side)
                # Not the secant from beyond the bound to before a gap that opens first: it hardly moves.
                if secants > 1 and when != last:
                    secant = (distance - before) / (when - last)
                    rate = secant if distance > 0.0 or secant < 0.5 * rate else rate
                last, before = when, distance
                step = when - distance / rate if rate < 0.0 else 0.5 * (low + high)
                when = step if low < step < high else 0.5 * (low + high)
                continue
            if abs(distance) > JOINT_TOUCH * hinge[meeting].size:  # not found: land
                link[meeting].side = side
                meeting, when = -1, left
                continue
            k, other, instant = first_bound(W, when)
            if k >= 0 and k != meeting:  # another one is passed before
                if held_till_then(W, k, other, instant) or events >= LIMIT_EVENTS or progress.effort > progress.hurry:
                    link[k].side, low, high, secants = other, 0.0, left, 0  # holds, or lands
                else:
                    meeting, side, low, high, secants, events = k, other, 0.0, when, 0, events + 1
                    when = instant
                continue
            rate, after = gap_rates(W, meeting, side)
            near = rate < 0.0 and -when * min(rate, after) <= LIMIT_WAY * hinge[meeting].size
            at_once = near or when <= MEET_INSTANT * abs(h)
            if not at_once:  # round-off of places would be velocities
                book(W, when, ledger)
                advance(local, W.bodies, when)
                note_part(W, part, meeting, side, when)
                part += 1
                left -= when
                if when < left:
                    weaken_lead(W, when / left)
        solved, hopped = 0.0, 0
        stop_at(W, meeting, side, at_once, False, ledger)
        if left <= 1e-13 * h:
            return True
        meeting, side, when = begin_as_known(W, part, left, loops)
        foreseen, low, high, secants = meeting >= 0, 0.0, left, 0
        events += 1 if foreseen else 0

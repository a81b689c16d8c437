"""Energies of a part of a step: every impulse times the mean velocity of its row, so that the ledger closes.

`..model.joint_steps.JointLedger` defines the entries.
"""

from __future__ import annotations

from ..compiled import inlined, nonallocating
from ..model.joint_steps import JointLedger
from ..model.joints import MOTOR, ROTARY_SPRING, SPRING, Workspace
from ..newton.entries import acts
from .frame import account_frame, move_apart


@inlined
def clear_ledger(ledger: JointLedger) -> None:
    """Set the energies of a step to 0."""
    ledger.stored = ledger.damped = ledger.limited = ledger.clamped = ledger.projected = 0.0
    ledger.motors = ledger.supports = ledger.frame_work = ledger.closed = 0.0


@inlined
def clear_interval(ledger: JointLedger) -> None:
    """Set all energies of an interval, and its status, to 0."""
    clear_ledger(ledger)
    ledger.turned_work = ledger.lifted = ledger.misfit = ledger.misfit_added = 0.0
    ledger.status = 0


@inlined
def add_ledger(ledger: JointLedger, part: JointLedger) -> None:
    """Add the energies of a part of a step."""
    ledger.stored += part.stored
    ledger.damped += part.damped
    ledger.limited += part.limited
    ledger.clamped += part.clamped
    ledger.projected += part.projected
    ledger.motors += part.motors
    ledger.supports += part.supports
    ledger.frame_work += part.frame_work
    ledger.closed += part.closed


@nonallocating
def account_part(W: Workspace, h: float) -> None:
    """Add the works of a solved part h of the step to RUNG_LEDGER, and its impulses to `total`.

    A joint's impulse F = J^T lam does the work F . x / h on its bodies; what it does on supports, they have done.
    """
    hinge, link, ledger = W.J.HINGE, W.link, W.J.RUNG_LEDGER
    account_frame(W, h)
    per = 1.0 / h
    for k in range(W.joints):
        kind = link[k].kind
        spring = kind in (SPRING, ROTARY_SPRING)
        if not spring and not acts(link, k, 0):
            continue
        total = 0.0
        for end in range(2):
            i = link[k].body[end]
            for c in range(3):
                work = hinge[k].force[3 * end + c] * W.J.LOCAL[i].way[c] * per
                total += work
                if not W.J.LOCAL[i].mobility[c] > 0.0:
                    ledger.supports -= work
        hinge[k].total[0] += hinge[k].lam[0]
        hinge[k].total[1] += hinge[k].lam[1]
        if spring:
            began, ended = hinge[k].began, hinge[k].ended
            stretch = ended - began if kind == SPRING else began - ended
            lost = (hinge[k].measure - hinge[k].lam[0] / h) * stretch
            ledger.stored -= hinge[k].measure * stretch
            ledger.damped += lost
            ledger.closed += total - hinge[k].measure * stretch + lost
        elif kind == MOTOR or link[k].bounded != 0:
            if kind == MOTOR or total > 0.0:
                ledger.motors += total
            else:
                ledger.clamped -= total
        elif link[k].side != 0 and total < 0.0:
            ledger.limited -= total
        else:
            ledger.closed += total


@nonallocating
def unexplained(W: Workspace) -> float:
    """The change of energy, from the saved state to the present one, that springs, motors and losses other than at
    limits do not explain (RUNG_LEDGER)."""
    part, gained = W.J.RUNG_LEDGER, 0.0
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        for c in range(3):
            if body.mobility[c] > 0.0:
                before, after = body.saved_velocity[c], body.v0[c]
                way = body.travel[c] - body.shift[c]
                specific = 0.5 * (after * after - before * before) - body.acceleration[c] * way
                gained += specific / body.mobility[c]
    return gained + part.stored + part.damped + part.clamped + part.projected - part.motors


@nonallocating
def close_ledger(W: Workspace) -> None:
    """Close RUNG_LEDGER for a step whose joints did not hold, by the change of energy that is `unexplained`. The work
    of supports is that by the balance of momentum, and the rest is `closed` if it is a gain, else `limited`; without a
    `frame` supports can do any work, and all of it is theirs.

    This includes the works of limits: the impulses of contradictory rows grow without bound, and their works cancel up
    to round-off, so that only the sum is known.
    """
    part, change = W.J.RUNG_LEDGER, unexplained(W)
    part.supports = change if move_apart(W) else part.frame_work
    part.closed, part.limited = max(change - part.supports, 0.0), max(part.supports - change, 0.0)

"""The start of a step after edits: joints are closed, velocities are made to fit them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiled import nonallocating
from ..model.joint_steps import POSES, SPEEDS, STEP, JointLedger
from ..model.joints import APART, EDITED, GIVES_WAY, LEFT_APART, TAKEN_OVER, Workspace
from ..model.parameters.joints import JOINT_APART, TAKEN_OVER_LEFT
from ..newton.entries import acts
from ..newton.motion import go_back, save
from ..newton.rows import joint_rows, shared_part, shares_point
from .bounds import hold_passed, limit_gap, passed_side
from .correct import BEFORE, CHANGE, NOW, kinetic_of, loss_of_projection, project, restore_speeds, speeds_fit
from .frame import move_apart, work_of_shift
from .lock import lock_energy, restore_momenta
from .start import closing_share, compute_rows, springs_of


class Apart(NamedTuple):
    """How the joints of a component stand at the start of a step."""

    edited: bool  # whether any was EDITED since the last step
    unknown: bool  # whether any is TAKEN_OVER
    closes: bool  # whether any is to be closed
    own: bool  # whether none is apart by an edit, and no body was edited


@nonallocating
def error_of(W: Workspace, k: int) -> float:
    """|g| of joint k, of its rows that act. Rows must be those of the present poses."""
    error = 0.0
    for r in range(W.link[k].rows):
        if acts(W.link, k, r):
            error += W.J.HINGE[k].value[r] ** 2
    return float(np.sqrt(error))


@nonallocating
def set_targets(W: Workspace, h: float) -> Apart:
    """Before joints are closed: set the targets of those that are apart to the part of their error that remains after
    this step, and set or release limits that are passed or left.

    Rows must be those of the present poses. Joints that will still be apart are marked APART, or LEFT_APART if a step
    has left them so; they keep the rest of their error over the step, so that it does no work. Elastic joints
    (GIVES_WAY) stay as they are.
    """
    joint, hinge, link = W.J.JOINT, W.J.HINGE, W.link
    edited, unknown, apart, own = False, False, False, True
    for k in range(W.joints):
        j, rows = link[k].joint, link[k].rows
        edited, unknown = edited or joint[j].touched == EDITED, unknown or joint[j].touched == TAKEN_OVER
        was = joint[j].touched
        joint[j].touched = 0
        if link[k].bounded != 0 or rows == 0:
            continue
        passed = passed_side(W, k, JOINT_APART)
        if passed != 0:
            link[k].side = passed
        elif link[k].side != 0 and limit_gap(W, k, link[k].side) > JOINT_APART * hinge[k].unit:
            link[k].side = 0
        joint_rows(W, k, 2.0, False)
        error = error_of(W, k)
        if error > JOINT_APART * hinge[k].unit and was == GIVES_WAY:
            joint[j].touched = GIVES_WAY
        elif error > JOINT_APART * hinge[k].unit:
            apart = True
            left = 1.0 - closing_share(joint, j, error, h)
            for r in range(rows):
                hinge[k].target[r] = hinge[k].value[r] * left if acts(link, k, r) else 0.0
            joint[j].touched = 0 if not left > 0.0 else LEFT_APART if was == LEFT_APART else APART
            own = own and was == LEFT_APART
    return Apart(edited, unknown, apart, own and not (edited or unknown))


@nonallocating
def farthest(W: Workspace) -> float:
    """The largest error of an exact joint by its own formula, over the size of the component or in rad. Rows must be
    those of the present poses."""
    worst = 0.0
    for k in range(W.joints):
        if W.link[k].bounded == 0:
            worst = max(worst, error_of(W, k) / W.J.HINGE[k].unit)
    return worst


@nonallocating
def closing_work(W: Workspace) -> float:
    """The work of closing, from the saved to the present poses, against the bodies' accelerations."""
    local, work = W.J.LOCAL, 0.0
    for i in range(W.bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                work -= local[i].acceleration[c] * (local[i].pose[c] - local[i].saved_pose[c]) / local[i].mobility[c]
    return work


@nonallocating
def close_poses(W: Workspace) -> None:
    """Project poses onto the joints, and onto the limits that this passes."""
    project(W, POSES)
    for _ in range(W.joints):
        compute_rows(W)
        if not hold_passed(W):
            return
        project(W, POSES)


@nonallocating
def keep_closed(W: Workspace) -> None:
    """Store how far closing has shifted the bodies, and set the targets of joints to the values it has reached, which
    the step can keep without work; pivots that remain apart hold one point of both bodies (`shares_point`)."""
    hinge, link, local = W.J.HINGE, W.link, W.J.LOCAL
    for i in range(W.bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                local[i].shift[c] = local[i].pose[c] - local[i].saved_pose[c]
    for k in range(W.joints):
        a, b, joint = local[link[k].body[0]], local[link[k].body[1]], W.J.JOINT[link[k].joint]
        shared = shares_point(joint, STEP) and shared_part(a, b) >= 0.0
        for r in range(link[k].rows):
            if hinge[k].target[r] != 0.0 and link[k].bounded == 0 and acts(link, k, r):
                hinge[k].target[r] = 0.0 if shared else hinge[k].value[r]


@nonallocating
def close_joints(W: Workspace, h: float, ledger: JointLedger) -> bool:
    """Close joints that are apart by the share of one step, and make velocities fit them after an edit. The costs enter
    the ledger of the step. Returns `Apart.own`."""
    stored = springs_of(W)
    edited, unknown, closes, own = set_targets(W, h)
    if closes:
        before, supports, carried = farthest(W), ledger.supports, ledger.frame_work
        project(W, POSES)
        taken = springs_of(W) - stored
        cost, turned = taken + closing_work(W), work_of_shift(W) if own else 0.0
        # Closing what a step left apart keeps angular momentum, which displacements change; the motion pays for it.
        cost += restore_momenta(W, 0.0, False) if own else 0.0
        locked = lock_energy(W, cost - turned, ledger) if own and cost > turned else 0.0
        # Rows that contradict one another are not closed, nor those whose closing the motion cannot pay, to the
        # round-off of the lock.
        if not farthest(W) <= before or (own and locked < cost - turned - 1e-9 * abs(cost)):
            go_back(W)
            compute_rows(W)
            taken = cost = turned = locked = 0.0
            ledger.supports, ledger.frame_work = supports, carried
        keep_closed(W)
        ledger.closed += cost - turned - locked
        ledger.supports, ledger.frame_work = ledger.supports + turned, ledger.frame_work + turned
        ledger.stored += taken
        save(W)
    if (edited or unknown) and fit_speeds(W, 0.0 if edited else TAKEN_OVER_LEFT):
        ledger.projected += loss_of_projection(W, ledger)
        save(W)
    return own


@nonallocating
def fit_speeds(W: Workspace, left: float) -> bool:
    """Project velocities onto the joints, from `v_before`, if more than the part `left` of the kinetic energy is across
    them, as steps may leave; whether they have changed. Rows must be those of the present poses."""
    if speeds_fit(W):
        return False
    project(W, SPEEDS)
    if kinetic_of(W, CHANGE) <= left * kinetic_of(W, BEFORE):
        restore_speeds(W)
        return False
    return True


@nonallocating
def fit_to_supports(W: Workspace) -> bool:
    """At the end of a step: if supports without a frame lead the bodies, make velocities fit the joints, unless little
    of their energy is across these; what that takes or gives is work of the supports. Returns whether it has.

    The mean of the velocities at both ends of a step follows the joints: what one end is off alternates from step to
    step. Nothing conserves energy here, so that this would grow wherever the supports change their speed within a step,
    as those of a crank do at its dead centres.
    """
    if not move_apart(W):
        return False
    compute_rows(W)
    if not fit_speeds(W, TAKEN_OVER_LEFT):
        return False
    W.J.RUNG_LEDGER.supports += kinetic_of(W, NOW) - kinetic_of(W, BEFORE)
    return True

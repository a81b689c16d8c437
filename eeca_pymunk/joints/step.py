"""One step of an island of jointed bodies without contacts, and its ladder when Newton's method does not converge.

Order 2 (midpoint with discrete gradients), or 4 by Suzuki's composition (s, s, 1 - 4s, s, s) h, s = 1/(4 - 4^(1/3)),
where nothing in the island dissipates, drives or meets a limit. The ladder: the step whole, in 2, 4, 7 parts; whole and
in 7 with joints that give way elastically, by 1e-9, 1e-8, 1e-7, 1e-6, 1e-4; one linear system. The work of
all rungs together is bounded. What gives way does so in later steps with the same compliance, until it is closed.
Energy that elastic joints take and give back enters the ledger as `closed`, and they give back no more than they took;
what linear rows gain is taken from what moves (`lock`).
"""

from __future__ import annotations

import numpy as np

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import ELASTIC, EXACT, HALVED, LINEAR, LINEAR_STEP, POSES, SPEEDS, STEP, BodyStep, JointLedger
from ..model.joints import APART, GIVES_WAY, LEFT_APART, RATCHET, ROTARY_SPRING, SPRING, Workspace
from ..model.parameters.joints import (
    COMPONENT_BUDGET,
    ELASTIC_PARTS,
    HASTE,
    LEAST_SOLUTIONS,
    LINEAR_APART,
    NEARLY_HELD,
    REPAID,
)
from .correct import fits, fitting_loss
from .foresight import foretell, forget, recalls, remember
from .ledger import add, clear, close_ledger, springs_hold
from .limits import step_with_limits
from .lock import lock_energy, move_rigidly, stands
from .motion import advance, move
from .rows import start_joint
from .solve import effort, solve
from .start import closing_work, farthest, find_apart, keep_closed, look, read_joints, soft_targets
from .taut import taut

SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
FIRST_RUNG, ELASTIC_RUNG, LAST_RUNG = 0, 4, 10  # rung -1 is order 4


@nonallocating
def save(local: Rows[BodyStep], bodies: int) -> None:
    """Keep the start of the step."""
    for i in range(bodies):
        for c in range(3):
            local[i].saved_pose[c], local[i].saved_velocity[c] = local[i].pose[c], local[i].v0[c]
            local[i].travel[c] = local[i].shift[c]
        local[i].mean[0] = local[i].mean[1] = 0.0


@nonallocating
def back(local: Rows[BodyStep], bodies: int) -> None:
    """Back to the poses and velocities at the start of the step."""
    for i in range(bodies):
        for c in range(3):
            local[i].pose[c], local[i].v0[c] = local[i].saved_pose[c], local[i].saved_velocity[c]
            local[i].travel[c] = local[i].shift[c]
        local[i].mean[0] = local[i].mean[1] = 0.0
        local[i].cos, local[i].sin = np.cos(local[i].pose[2]), np.sin(local[i].pose[2])


@nonallocating
def restore(W: Workspace) -> None:
    """Back to the start of the step, without impulses."""
    hinge, link = W.J.HINGE, W.link
    back(W.J.LOCAL, W.bodies)
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].lead[c] = 0.0
    for k in range(W.joints):
        hinge[k].lam[0] = hinge[k].lam[1] = hinge[k].total[0] = hinge[k].total[1] = 0.0
        W.J.JOINT[link[k].joint].work = 0.0
        link[k].side = W.J.JOINT[link[k].joint].side


@nonallocating
def smooth(W: Workspace) -> bool:
    """Whether order 4 may be had: no damping, no motor, no finite max_force, nobody on a limit."""
    link = W.link
    for k in range(W.joints):
        spring = link[k].kind in (SPRING, ROTARY_SPRING)
        if link[k].soft != 0 or link[k].side != 0 or (spring and W.J.JOINT[link[k].joint].damping != 0.0):
            return False
    return True


@nonallocating
def gives_way(W: Workspace) -> bool:
    """Whether a joint of the island gives way elastically since an earlier step."""
    some = False
    for k in range(W.joints):
        some = some or W.J.JOINT[W.link[k].joint].touched == GIVES_WAY
    return some


@nonallocating
def write_joints(W: Workspace, h: float, loose: int) -> None:
    """Leave impulses, limits and notches in the joints' own rows."""
    joint, hinge, link, local = W.J.JOINT, W.J.HINGE, W.link, W.J.LOCAL
    for k in range(W.joints):
        j = link[k].joint
        joint[j].impulse[0], joint[j].impulse[1] = hinge[k].total[0], hinge[k].total[1]
        joint[j].last_step = h
        joint[j].length_1 = hinge[k].ended
        joint[j].side = link[k].side
        for end in range(2):
            for c in range(3):
                joint[j].led[end, c] = local[link[k].body[end]].lead[c]
        if loose > 0:
            joint[j].touched = APART if joint[j].touched == APART else loose
        if link[k].kind == RATCHET:
            tooth, phase = joint[j].tooth, joint[j].tooth_phase
            turned = local[link[k].body[1]].pose[2] - local[link[k].body[0]].pose[2]
            notch = np.floor((turned - phase) / tooth) * tooth + phase
            if (notch - joint[j].notch) * tooth > 1e-12 * tooth * tooth:
                joint[j].notch = notch
                joint[j].side = 0


@nonallocating
def stop_joints(W: Workspace, h: float) -> None:
    """The step of an island that nothing else can do: see `move_rigidly`; what that loses enters the ledger in
    `part`."""
    local, part = W.J.LOCAL, W.J.PART
    back(local, W.bodies)
    look(W)
    stored = springs_hold(W)
    move_rigidly(local, W.bodies, h)
    look(W)
    clear(part)
    part.stored = springs_hold(W) - stored
    close_ledger(local, W.bodies, part)
    part.projected, part.closed = max(-part.closed, 0.0), max(part.closed, 0.0)
    for i in range(W.bodies):
        for c in range(3):
            local[i].lead[c] = 0.0
    for k in range(W.joints):
        W.J.JOINT[W.link[k].joint].work = 0.0
        for r in range(2):
            W.J.HINGE[k].lam[r] = W.J.HINGE[k].total[r] = 0.0


@nonallocating
def repaid(W: Workspace, part: JointLedger, owed: float) -> bool:
    """Whether exact rows, which close at once what an earlier step left apart, give no more than that has taken, or
    little beside what moved before, which is taken back."""
    gain, had = part.closed - owed, 0.0
    if not gain > 0.0 or not stands(W.J.LOCAL, W.bodies):
        return True
    for i in range(W.bodies):
        for c in range(3):
            if W.J.LOCAL[i].mobility[c] > 0.0:
                had += 0.5 * W.J.LOCAL[i].saved_velocity[c] ** 2 / W.J.LOCAL[i].mobility[c]
    if not gain <= REPAID * had:
        return False
    part.closed -= lock_energy(W.J.LOCAL, W.bodies, gain)
    return True


@nonallocating
def island_step(W: Workspace, h: float, order: int, length: float, ledger: JointLedger) -> int:
    """Step one component by h; its status: EXACT, HALVED, ELASTIC or LINEAR.

    LOCAL holds poses, velocities, accelerations and mobilities at the start and, on return, poses and velocities (v0)
    at the end. `ledger` is that of the step; `length` is the size of the component.
    """
    joint, hinge, link, local = W.J.JOINT, W.J.HINGE, W.link, W.J.LOCAL
    component, progress, part = W.J.COMPONENT[W.s], W.J.PROGRESS, W.J.PART
    clear(ledger)
    component.factored = 0
    loops = component.loops > 0
    needs = read_joints(W, h, length, component.boxes)
    # Redundant rows begin without impulse, unless it is what holds bodies.
    component.taut = 1 if loops and taut(W, h) else 0
    cold = loops and component.taut == 0
    for k in range(W.joints if cold else 0):
        hinge[k].lam[0] = hinge[k].lam[1] = 0.0
    for i in range(W.bodies):
        for c in range(3):
            local[i].shift[c] = 0.0
    save(local, W.bodies)
    own, owed = False, joint[link[0].joint].owed
    if needs % 2 == 1:
        look(W)
        stored = springs_hold(W)
        changes = find_apart(W, h)
        own = changes >= 4
        apart = farthest(W)
        for what in (POSES, SPEEDS):
            if (what == POSES and changes % 4 < 2) or (what == SPEEDS and changes % 2 == 0):
                continue
            if what == SPEEDS and fits(W):
                continue
            solve(W, what, 2.0, length, loops, 0.0)
            if what == POSES:
                look(W)
                taken = springs_hold(W) - stored
                cost = taken + closing_work(local, W.bodies)
                # What a step left apart closes at the cost of what moves.
                locked = lock_energy(local, W.bodies, cost) if own and cost > 0.0 else 0.0
                # Rows that contradict each other stay.
                if not farthest(W) <= apart or (own and locked < cost - 1e-9 * abs(cost)):
                    back(local, W.bodies)
                    look(W)
                    taken, cost, locked = 0.0, 0.0, 0.0
                keep_closed(W)
                ledger.closed += cost - locked
                ledger.stored += taken
            else:
                ledger.projected += fitting_loss(local, W.bodies, ledger)
        save(local, W.bodies)
    if needs >= 2:
        look(W)
        soft_targets(W, h)
    for k in range(W.joints):
        j = link[k].joint
        joint[j].side = link[k].side
        if link[k].rows == 0:
            start_joint(W, k, h)
            joint[j].length_0 = hinge[k].began
    status, stored, before_it = LINEAR, 0.0, 0.0
    # What no longer has a share of the work can still be solved where it is not hard.
    least = LEAST_SOLUTIONS * effort(component.system, True, component.boxes, W.joints, component)
    progress.limit = progress.effort + max((progress.budget - progress.effort) * COMPONENT_BUDGET, least)
    progress.hurry = progress.effort + HASTE * (progress.limit - progress.effort)
    yields = gives_way(W)
    rung = ELASTIC_RUNG if yields else -1 if order == 4 and smooth(W) else FIRST_RUNG
    if rung >= 0 or needs % 2 == 1:
        forget(W)
    known = recalls(W, h)
    while rung <= LAST_RUNG:
        if progress.effort > progress.limit:
            rung = LAST_RUNG
        parts = 5 if rung < 0 else 1 << rung if rung < 3 else ELASTIC_PARTS
        if rung in (ELASTIC_RUNG, LAST_RUNG):
            parts = 1
        compliance = 0.0
        if ELASTIC_RUNG <= rung < LAST_RUNG:
            steps = max(rung - ELASTIC_RUNG - 1, 0)
            relative = 1e-4 if rung + 1 == LAST_RUNG else 1e-9 * 10.0**steps
            compliance = relative * (h / ELASTIC_PARTS) ** 2
            if yields:
                compliance = max(compliance if relative > 1e-9 else 0.0, joint[link[0].joint].compliance)
        give = compliance / (h / parts) ** 2
        what = LINEAR_STEP if rung == LAST_RUNG else STEP
        clear(part)
        if rung == LAST_RUNG:
            look(W)
            stored, before_it = springs_hold(W), farthest(W)
        done, before = True, h
        for p in range(parts):
            piece = h / parts if rung >= 0 else (1.0 - 4.0 * SUZUKI) * h if p == 2 else SUZUKI * h
            for k in range(W.joints):
                warm = 0.0 if cold or rung == LAST_RUNG else piece / before
                hinge[k].lam[0] *= warm
                hinge[k].lam[1] *= warm
            before = piece
            if rung < 0 and known:
                foretell(W, p, piece, cold)
            done = step_with_limits(W, what, piece, length, cold, give, rung < 0, part)
            if not done:
                break
            if rung < 0:
                remember(W, piece)
                known = recalls(W, h)
        if done and own and rung < ELASTIC_RUNG:
            done = repaid(W, part, owed)
        if done:
            joint[link[0].joint].compliance = compliance
            status = EXACT if rung <= 0 else HALVED if rung < ELASTIC_RUNG else ELASTIC if rung < LAST_RUNG else LINEAR
            break
        restore(W)
        rung += 0 if known or cold != loops else 1
        known, cold = False, loops
        forget(W)
    if status == LINEAR:
        if rung > LAST_RUNG:  # not even that: free flight
            for i in range(W.bodies):
                for c in range(3):
                    local[i].v1[c] = local[i].v0[c] + h * local[i].acceleration[c]
            move(local, W.bodies, h)
            advance(local, W.bodies, h)
        look(W)
        clear(part)
        part.stored = springs_hold(W) - stored
    if status >= ELASTIC:
        close_ledger(local, W.bodies, part)
        stopped = False
        if part.closed > owed:
            gain = part.closed - owed
            taken = lock_energy(local, W.bodies, gain)
            part.closed -= taken
            if gain - taken > 1e-9 * gain + 1e-12 * owed and stands(local, W.bodies):
                status, stopped = LINEAR, True
        if status == LINEAR and not farthest(W) <= before_it + LINEAR_APART:
            stopped = stands(local, W.bodies)
        if stopped:
            stop_joints(W, h)
        # What elastic joints hold they may give back; linear rows hold nothing.
        spent = part.closed if status == ELASTIC else max(part.closed, 0.0)
        joint[link[0].joint].owed = max(owed - spent, 0.0)
    elif needs % 2 == 0:
        joint[link[0].joint].owed = 0.0
    add(ledger, part)
    write_joints(W, h, GIVES_WAY if status == ELASTIC else LEFT_APART if status == LINEAR else 0)
    if status == ELASTIC and farthest(W) <= NEARLY_HELD:
        status = HALVED
    return status

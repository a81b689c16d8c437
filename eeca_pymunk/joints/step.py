"""One step of a component without contacts.

Joints that are apart, by an edit or by earlier steps, are closed. The ladder (`ladder`) takes the step, or one linear
system if it fails (`unheld`). Energy that joints have given is taken from the motion (`gains`). Joints store what the
next step begins with.
"""

from __future__ import annotations

import math

import numpy as np

from ..compiled import nonallocating
from ..model.joint_steps import ELASTIC, NEARLY, POSES, SPEEDS, UNHELD, JointLedger
from ..model.joints import (
    APART,
    DEPENDENT,
    DUAL,
    GIVES_WAY,
    INDEPENDENT,
    LEFT_APART,
    PIN,
    PIVOT,
    RATCHET,
    SLIDE,
    UNTESTED,
    Workspace,
)
from ..model.parameters.joints import NEARLY_HELD, TAUT
from ..newton.dual import are_independent, factor_dual
from ..newton.motion import save
from ..newton.rows import start_joint
from ..newton.solve import drop_impulses
from ..newton.systems import assemble, first_iterate
from .bounds import closes_on_limit, standing
from .closing import close_joints, farthest
from .correct import loss_of_projection, project
from .gains import take_gain
from .ladder import climb, limit_work
from .ledger import add_ledger, clear_ledger
from .start import bounded_targets, compute_rows, read_joints
from .unheld import step_linearly


@nonallocating
def is_taut(W: Workspace, h: float) -> bool:
    """Whether joints pull so hard that bodies hardly move across them: a string, a bridge as long as its gap. To first
    order such joints allow motion across. Only their pull, whose direction turns with the motion, prevents it: a
    solution has to begin with that pull.

    That is (h/4) dF/dx > TAUT of a body's inertia, for the impulse F of a joint between points that pulls; this is the
    entry of STIFF (`..newton.response.inertia_taken`). `turn` is -dF/dx for the body's angle, arm . F; `per` that
    across a pin or slide, F over its length."""
    hinge, link = W.J.HINGE, W.link
    for k in range(W.joints):
        kind = link[k].kind
        if link[k].bounded != 0 or (kind != PIVOT and kind != PIN and kind != SLIDE):
            continue
        start_joint(W, k, POSES, h)
        rax, ray, rbx, rby = hinge[k].arm_a[0], hinge[k].arm_a[1], hinge[k].arm_b[0], hinge[k].arm_b[1]
        fx, fy, per = hinge[k].lam[0], hinge[k].lam[1], 0.0
        if kind != PIVOT:
            dx, dy = hinge[k].span[0], hinge[k].span[1]
            length = math.sqrt(dx * dx + dy * dy)
            if length > 0.0:
                per = hinge[k].lam[0] / length
            fx, fy, per = per * dx, per * dy, max(-per, 0.0)
        for end in range(2):
            body = W.J.LOCAL[link[k].body[end]]
            turn = -(rax * fx + ray * fy) if end == 0 else rbx * fx + rby * fy
            if 0.25 * abs(h) * max(turn * body.mobility[2], per * body.mobility[0]) > TAUT:
                return True
    return False


@nonallocating
def rows_depend(W: Workspace) -> bool:
    """Whether rows that act depend on one another, or nearly so (`..newton.dual.are_independent`), at the present
    poses. Most cycles of joints, as in linkages and rings, have no redundant row: their impulses are unique, and a step
    begins with those of the last one."""
    first_iterate(W, SPEEDS, 2.0)
    assemble(W, SPEEDS, 2.0, 0.0, True, DUAL, True)
    independent = factor_dual(W, False, 0.0) and are_independent(W)
    for k in range(W.joints):
        W.J.HINGE[k].scale[0] = 0.0  # a step scales rows by its first iterate
    return not independent


@nonallocating
def write_joints(W: Workspace, h: float, loose: int) -> None:
    """Store what the next step begins with in the rows of the joints: impulses, limits, notches, accelerations.

    loose: how the step has left joints that it did not hold, GIVES_WAY or LEFT_APART; 0 if it held them.
    """
    joint, hinge, link, local = W.J.JOINT, W.J.HINGE, W.link, W.J.LOCAL
    for k in range(W.joints):
        j = link[k].joint
        joint[j].impulse[0], joint[j].impulse[1] = hinge[k].total[0], hinge[k].total[1]
        joint[j].last_step = h
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
            if (notch - joint[j].notch) * tooth > 1e-12 * tooth * tooth:  # farther on, by more than round-off
                joint[j].notch = notch
                joint[j].side = 0


@nonallocating
def take_step(W: Workspace, h: float, order: int, extent: float, ledger: JointLedger) -> int:
    """Step one component by h; its status: EXACT, NEARLY, ELASTIC or UNHELD.

    LOCAL holds poses, velocities, accelerations and mobilities at the start and, on return, poses and velocities (v0)
    at the end.

    Args:
        order: 4 or 2, as of `ladder`.  extent: size of the component (`..newton.motion.size_up`).
        ledger: out, that of the step.
    """
    local, component = W.J.LOCAL, W.J.COMPONENT[W.s]
    clear_ledger(ledger)
    touched, bounded = read_joints(W, h, extent)
    enough = limit_work(W)
    # Redundant rows begin without impulses, unless their pull holds bodies; others, too, if there is no work to try.
    component.taut = 1 if component.cycles > 0 and is_taut(W, h) else 0
    if component.cycles > 0 and component.dependence == UNTESTED:
        component.dependence = INDEPENDENT if enough and not rows_depend(W) else DEPENDENT
    component.factored = 1 if W.J.PROGRESS.factors_of == W.s + 1 and component.dependence != DEPENDENT else 0
    if component.dependence == DEPENDENT and component.taut == 0:
        drop_impulses(W)
    for i in range(W.bodies):
        for c in range(3):
            local[i].shift[c] = 0.0
    save(W)
    own = touched and close_joints(W, h, ledger)
    stands = standing(W)
    if bounded or stands:
        compute_rows(W)
    if bounded:
        bounded_targets(W, h)
    if stands and closes_on_limit(W, h):
        # An impact has left velocities into a bound on which a joint stands: it is met at once.
        project(W, SPEEDS)
        ledger.limited += loss_of_projection(W, ledger)
        save(W)
    for k in range(W.joints):
        W.J.JOINT[W.link[k].joint].side = W.link[k].side  # to which the ladder returns
    order = order if enough else 2
    ledger.misfit = farthest(W)
    status = climb(W, h, order, extent, touched, own)
    before = step_linearly(W, h, extent) if status == UNHELD else 0.0
    status = take_gain(W, h, extent, status, own, before)
    if status >= ELASTIC:
        compute_rows(W)  # they were those before the last correction
    ledger.misfit_added = max(farthest(W) - ledger.misfit, 0.0) if status >= ELASTIC else 0.0
    add_ledger(ledger, W.J.RUNG_LEDGER)
    write_joints(W, h, GIVES_WAY if status == ELASTIC else LEFT_APART if status == UNHELD else 0)
    return NEARLY if status == ELASTIC and farthest(W) <= NEARLY_HELD else status

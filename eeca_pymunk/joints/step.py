"""One step of an island of jointed bodies without contacts, and its ladder when Newton's method does not converge.

Order 2 (midpoint with discrete gradients), or 4 by Suzuki's composition (s, s, 1 - 4s, s, s) h, s = 1/(4 - 4^(1/3)),
where nothing in the island dissipates, drives or meets a limit. The ladder: the step whole, in 2, 4, 7 parts; whole and
in 7 with joints that give way elastically, by 1e-9, 1e-8, 1e-7, 1e-6, 1e-4; one linear system. The work of
all rungs together is bounded. What gives way does so in later steps with the same compliance, until it is closed.
Energy that elastic joints take and give back is booked as CLOSED, and they give back no more than they took; what
linear rows gain is taken from what moves (`lock`).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .correct import book_fit, fits
from .foresight import foretell, forget, recalls, remember
from .layout import (
    CLOSED,
    COMPLIANCE,
    DAMPING,
    ELASTIC,
    EXACT,
    HALVED,
    IMPULSE_1,
    IMPULSE_2,
    LAST_STEP,
    LED,
    LEDGER_COLUMNS,
    LENGTH_0,
    LENGTH_1,
    LINEAR,
    NOTCH,
    OWED,
    PROJECTED,
    RATCHET,
    ROTARY_SPRING,
    SIDE,
    SPRING,
    STORED,
    TOOTH,
    TOOTH_PHASE,
    TOUCHED,
    WORK,
)
from .ledger import close_ledger, springs_hold
from .limits import step_with_limits
from .lock import lock_energy, move_rigidly, stands
from .motion import advance, move
from .rows import start_joint
from .scratch import (
    AFTER,
    BEFORE,
    BEGAN,
    BOXES,
    BUDGET,
    COS,
    EFFORT,
    ENDED,
    FREE,
    HURRY,
    L_A,
    L_B,
    L_JOINT,
    L_KIND,
    L_ROWS,
    L_SIDE,
    L_SOFT,
    LAM,
    LEAD,
    LIMIT,
    LINEAR_STEP,
    LOOPS,
    MEAN,
    POSE,
    POSES,
    SAVED,
    SHIFT,
    SIN,
    SPEEDS,
    STEP,
    TAUT,
    TOTAL,
    TRAVEL,
)
from .solve import solve
from .start import closing_work, farthest, find_apart, keep_closed, look, read_joints, soft_targets
from .taut import taut

SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
FIRST_RUNG, ELASTIC_RUNG, LAST_RUNG = 0, 4, 10  # rung -1 is order 4
_ELASTIC_PARTS = 7
_BEFORE_HURRY = 0.25  # of this
_PART_OF_BUDGET = 0.5  # of what is left of it, that one step of an island may take
_NEARLY = 1e-8  # error of joints over the size of an island, up to which one that gives way counts as one that holds


@uncounted
def save(local: FloatArray, bodies: int) -> None:
    """Keep the start of the step."""
    for i in range(bodies):
        for c in range(6):
            local[i, SAVED + c] = local[i, POSE + c]
        for c in range(3):
            local[i, TRAVEL + c] = local[i, SHIFT + c]
        local[i, MEAN] = local[i, MEAN + 1] = 0.0


@uncounted
def back(local: FloatArray, bodies: int) -> None:
    """Back to the poses and velocities at the start of the step."""
    for i in range(bodies):
        for c in range(6):
            local[i, POSE + c] = local[i, SAVED + c]
        for c in range(3):
            local[i, TRAVEL + c] = local[i, SHIFT + c]
        local[i, MEAN] = local[i, MEAN + 1] = 0.0
        local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])


@uncounted
def restore(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int
) -> None:
    """Back to the start of the step, without impulses."""
    back(local, bodies)
    for i in range(bodies):
        for c in range(3):
            local[i, LEAD + c] = 0.0
    for k in range(joints):
        hinge[k, LAM] = hinge[k, LAM + 1] = hinge[k, TOTAL] = hinge[k, TOTAL + 1] = 0.0
        joint[link[k, L_JOINT], WORK] = 0.0
        link[k, L_SIDE] = tie[link[k, L_JOINT], SIDE]


@uncounted
def smooth(joint: FloatArray, link: IntArray, joints: int) -> bool:
    """Whether order 4 may be had: no damping, no motor, no finite max_force, nobody on a limit."""
    for k in range(joints):
        spring = link[k, L_KIND] in (SPRING, ROTARY_SPRING)
        if link[k, L_SOFT] != 0 or link[k, L_SIDE] != 0 or (spring and joint[link[k, L_JOINT], DAMPING] != 0.0):
            return False
    return True


@uncounted
def gives_way(tie: IntArray, link: IntArray, joints: int) -> bool:
    """Whether a joint of the island gives way elastically since an earlier step."""
    some = False
    for k in range(joints):
        some = some or tie[link[k, L_JOINT], TOUCHED] == 4
    return some


@uncounted
def write_joints(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float,
    loose: int,
) -> None:  # fmt: skip
    """Leave impulses, limits and notches in the joints' own rows."""
    for k in range(joints):
        j = link[k, L_JOINT]
        joint[j, IMPULSE_1], joint[j, IMPULSE_2] = hinge[k, TOTAL], hinge[k, TOTAL + 1]
        joint[j, LAST_STEP] = h
        joint[j, LENGTH_1] = hinge[k, ENDED]
        tie[j, SIDE] = link[k, L_SIDE]
        for end in range(2):
            for c in range(3):
                joint[j, LED + 3 * end + c] = local[link[k, L_A + end], LEAD + c]
        if loose > 0:
            tie[j, TOUCHED] = 2 if tie[j, TOUCHED] == 2 else loose
        if link[k, L_KIND] == RATCHET:
            tooth, phase = joint[j, TOOTH], joint[j, TOOTH_PHASE]
            turned = local[link[k, L_B], POSE + 2] - local[link[k, L_A], POSE + 2]
            notch = np.floor((turned - phase) / tooth) * tooth + phase
            if (notch - joint[j, NOTCH]) * tooth > 1e-12 * tooth * tooth:
                joint[j, NOTCH] = notch
                tie[j, SIDE] = 0


@uncounted
def stop_joints(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, stiff: FloatArray, part: FloatArray,
) -> None:  # fmt: skip
    """The step of an island that nothing else can do: see `move_rigidly`; what that loses is booked in `part`."""
    back(local, bodies)
    look(joint, hinge, link, joints, local, node, bodies, stiff)
    stored = springs_hold(joint, hinge, link, joints)
    move_rigidly(local, node, bodies, h)
    look(joint, hinge, link, joints, local, node, bodies, stiff)
    for c in range(LEDGER_COLUMNS):
        part[c] = 0.0
    part[STORED] = springs_hold(joint, hinge, link, joints) - stored
    close_ledger(local, bodies, part)
    part[PROJECTED], part[CLOSED] = max(-part[CLOSED], 0.0), max(part[CLOSED], 0.0)
    for i in range(bodies):
        for c in range(3):
            local[i, LEAD + c] = 0.0
    for k in range(joints):
        joint[link[k, L_JOINT], WORK] = 0.0
        for r in range(2):
            hinge[k, LAM + r] = hinge[k, TOTAL + r] = 0.0


@uncounted
def island_step(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray,
    node: IntArray, bodies: int, h: float, order: int, length: float, span: IntArray, matrix: FloatArray,
    right: FloatArray, more: FloatArray, pivots: IntArray, stiff: FloatArray, found: FloatArray, part: FloatArray,
    ledger: FloatArray,
) -> int:  # fmt: skip
    """Step one island by h; its status (see `layout`).

    `local` holds poses, velocities, accelerations and mobilities at the start and, on return, poses and velocities
    (BEFORE) at the end. `ledger` (LEDGER_COLUMNS,) is that of the step, `part` scratch for another; `length` is the
    size of the island, `span` its row of SPAN.
    """
    for c in range(LEDGER_COLUMNS):
        ledger[c] = 0.0
    loops = span[LOOPS] > 0
    needs = read_joints(joint, tie, hinge, link, joints, local, h, length, span[BOXES])
    # Redundant rows begin without impulse, unless it is what holds bodies.
    span[TAUT] = 1 if loops and taut(joint, hinge, link, joints, local, h) else 0
    cold = loops and span[TAUT] == 0
    for k in range(joints if cold else 0):
        hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
    for i in range(bodies):
        for c in range(3):
            local[i, SHIFT + c] = 0.0
    save(local, bodies)
    if needs % 2 == 1:
        look(joint, hinge, link, joints, local, node, bodies, stiff)
        stored = springs_hold(joint, hinge, link, joints)
        changes = find_apart(joint, tie, hinge, link, joints, local, h, stiff)
        apart = farthest(hinge, link, joints)
        for what in (POSES, SPEEDS):
            if (what == POSES and changes % 4 < 2) or (what == SPEEDS and changes % 2 == 0):
                continue
            if what == SPEEDS and fits(hinge, link, joints, local):
                continue
            solve(
                what, joint, hinge, link, joints, local, node, bodies, 2.0, length, loops, 0.0, span, matrix, right,
                more, pivots, stiff, found,
            )  # fmt: skip
            if what == POSES:
                look(joint, hinge, link, joints, local, node, bodies, stiff)
                taken = springs_hold(joint, hinge, link, joints) - stored
                cost = taken + closing_work(local, bodies)
                # What a step left apart closes at the cost of what moves.
                own = changes >= 4
                locked = lock_energy(local, node, bodies, cost) if own and cost > 0.0 else 0.0
                # Rows that contradict each other stay.
                if not farthest(hinge, link, joints) <= apart or (own and locked < cost - 1e-9 * abs(cost)):
                    back(local, bodies)
                    look(joint, hinge, link, joints, local, node, bodies, stiff)
                    taken, cost, locked = 0.0, 0.0, 0.0
                keep_closed(hinge, link, joints, local, bodies)
                ledger[CLOSED] += cost - locked
                ledger[STORED] += taken
            else:
                book_fit(local, bodies, ledger, int(PROJECTED))
        save(local, bodies)
    if needs >= 2:
        look(joint, hinge, link, joints, local, node, bodies, stiff)
        soft_targets(joint, hinge, link, joints, local, h)
    for k in range(joints):
        j = link[k, L_JOINT]
        tie[j, SIDE] = link[k, L_SIDE]
        if link[k, L_ROWS] == 0:
            start_joint(joint, hinge, link, k, local, h)
            joint[j, LENGTH_0] = hinge[k, BEGAN]
    status, stored = LINEAR, 0.0
    found[LIMIT] = found[EFFORT] + max(found[BUDGET] - found[EFFORT], 0.0) * _PART_OF_BUDGET
    found[HURRY] = found[EFFORT] + _BEFORE_HURRY * (found[LIMIT] - found[EFFORT])
    yields = gives_way(tie, link, joints)
    rung = ELASTIC_RUNG if yields else -1 if order == 4 and smooth(joint, link, joints) else FIRST_RUNG
    if rung >= 0 or needs % 2 == 1:
        forget(joint, link, joints)
    known = recalls(joint, link, joints, h)
    while rung <= LAST_RUNG:
        if found[EFFORT] > found[LIMIT]:
            rung = LAST_RUNG
        parts = 5 if rung < 0 else 1 << rung if rung < 3 else _ELASTIC_PARTS
        if rung in (ELASTIC_RUNG, LAST_RUNG):
            parts = 1
        compliance = 0.0
        if ELASTIC_RUNG <= rung < LAST_RUNG:
            steps = max(rung - ELASTIC_RUNG - 1, 0)
            relative = 1e-4 if rung + 1 == LAST_RUNG else 1e-9 * 10.0**steps
            compliance = relative * (h / _ELASTIC_PARTS) ** 2
            if yields:
                compliance = max(compliance if relative > 1e-9 else 0.0, joint[link[0, L_JOINT], COMPLIANCE])
        give = compliance / (h / parts) ** 2
        what = LINEAR_STEP if rung == LAST_RUNG else STEP
        for c in range(LEDGER_COLUMNS):
            part[c] = 0.0
        if rung == LAST_RUNG:
            look(joint, hinge, link, joints, local, node, bodies, stiff)
            stored = springs_hold(joint, hinge, link, joints)
        done, before = True, h
        for p in range(parts):
            piece = h / parts if rung >= 0 else (1.0 - 4.0 * SUZUKI) * h if p == 2 else SUZUKI * h
            for k in range(joints):
                warm = 0.0 if cold or rung == LAST_RUNG else piece / before
                hinge[k, LAM] *= warm
                hinge[k, LAM + 1] *= warm
            before = piece
            if rung < 0 and known:
                foretell(joint, p, piece, cold, hinge, link, joints, local)
            done = step_with_limits(
                what, joint, hinge, link, joints, local, node, bodies, piece, length, cold, give, rung < 0, span,
                matrix, right, more, pivots, stiff, found, part,
            )  # fmt: skip
            if not done:
                break
            if rung < 0:
                remember(joint, piece, hinge, link, joints, local)
                known = recalls(joint, link, joints, h)
        if done:
            joint[link[0, L_JOINT], COMPLIANCE] = compliance
            status = EXACT if rung <= 0 else HALVED if rung < ELASTIC_RUNG else ELASTIC if rung < LAST_RUNG else LINEAR
            break
        restore(joint, tie, hinge, link, joints, local, bodies)
        rung += 0 if known or cold != loops else 1
        known, cold = False, loops
        forget(joint, link, joints)
    if status == LINEAR:
        if rung > LAST_RUNG:  # not even that: free flight
            for i in range(bodies):
                for c in range(3):
                    local[i, AFTER + c] = local[i, BEFORE + c] + h * local[i, FREE + c]
            move(local, bodies, h)
            advance(local, bodies, h)
        look(joint, hinge, link, joints, local, node, bodies, stiff)
        for c in range(LEDGER_COLUMNS):
            part[c] = 0.0
        part[STORED] = springs_hold(joint, hinge, link, joints) - stored
    if status >= ELASTIC:
        close_ledger(local, bodies, part)
        owed = joint[link[0, L_JOINT], OWED]
        if part[CLOSED] > owed:
            gain = part[CLOSED] - owed
            taken = lock_energy(local, node, bodies, gain)
            part[CLOSED] -= taken
            if gain - taken > 1e-9 * gain + 1e-12 * owed and stands(local, node, bodies):
                status = LINEAR
                stop_joints(joint, hinge, link, joints, local, node, bodies, h, stiff, part)
        # What elastic joints hold they may give back; linear rows hold nothing.
        spent = part[CLOSED] if status == ELASTIC else max(part[CLOSED], 0.0)
        joint[link[0, L_JOINT], OWED] = max(owed - spent, 0.0)
    elif needs % 2 == 0:
        joint[link[0, L_JOINT], OWED] = 0.0
    for c in range(LEDGER_COLUMNS):
        ledger[c] += part[c]
    write_joints(joint, tie, hinge, link, joints, local, h, 4 if status == ELASTIC else 3 if status == LINEAR else 0)
    if status == ELASTIC and farthest(hinge, link, joints) <= _NEARLY:
        status = HALVED
    return status

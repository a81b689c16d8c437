"""One step of an island of jointed bodies without contacts, and its ladder when Newton's method does not converge.

Order 2 (midpoint with discrete gradients), or 4 by Suzuki's composition (s, s, 1 - 4s, s, s) h, s = 1/(4 - 4^(1/3)),
where nothing in the island dissipates, drives or stands on a limit. The ladder: the step in 2, 4, 8 parts; joints that
give way elastically, by 1e-6 and 1e-4 of their stiffest; one linear system. No rung takes unbounded work.
"""

from __future__ import annotations

import numpy as np

from ..compiled import kernel
from .correct import kinetic, stand_still
from .layout import (
    CLAMPED,
    CLOSED,
    DAMPED,
    DAMPING,
    ELASTIC,
    EXACT,
    HALVED,
    IMPULSE_1,
    IMPULSE_2,
    LAST_STEP,
    LEDGER_COLUMNS,
    LENGTH_0,
    LENGTH_1,
    LIMITED,
    LINEAR,
    MOTORS,
    NOTCH,
    PROJECTED,
    RATCHET,
    ROTARY_SPRING,
    SIDE,
    SPRING,
    STORED,
    SUPPORTS,
    TOOTH,
    TOOTH_PHASE,
    TOUCHED,
)  # fmt: skip
from .ledger import book
from .limits import TOUCH, bounded, gap, step_with_limits
from .motion import advance
from .scratch import (
    AFTER,
    BEFORE,
    BEGAN,
    COS,
    ENDED,
    FREE,
    L_A,
    L_B,
    L_JOINT,
    L_KIND,
    L_SIDE,
    L_SOFT,
    LAM,
    MOBILITY,
    POSE,
    SAVED,
    SIN,
    SIZE,
    TOTAL,
    WAY,
    FloatArray,
    IntArray,
)  # fmt: skip
from .solve import linear_step, newton_step
from .start import fit, read_joints, soft_targets

SHARE = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))


@kernel
def save(local: FloatArray, bodies: int) -> None:
    """Keep the start of the step."""
    for i in range(bodies):
        for c in range(6):
            local[i, SAVED + c] = local[i, POSE + c]


@kernel
def restore(tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int) -> None:
    """Back to the start of the step, without impulses."""
    for i in range(bodies):
        for c in range(6):
            local[i, POSE + c] = local[i, SAVED + c]
        local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
    for k in range(joints):
        hinge[k, LAM] = hinge[k, LAM + 1] = hinge[k, TOTAL] = hinge[k, TOTAL + 1] = 0.0
        if link[k, L_SOFT] == 0:
            link[k, L_SIDE] = tie[link[k, L_JOINT], SIDE]


@kernel
def smooth(joint: FloatArray, link: IntArray, joints: int) -> bool:
    """Whether order 4 may be had: no damping, no motor, no finite max_force, nobody on a limit."""
    for k in range(joints):
        spring = link[k, L_KIND] == SPRING or link[k, L_KIND] == ROTARY_SPRING
        if link[k, L_SOFT] != 0 or link[k, L_SIDE] != 0 or (spring and joint[link[k, L_JOINT], DAMPING] != 0.0):
            return False
    return True


@kernel
def passes_bound(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float, one: FloatArray
) -> bool:
    """Whether a free limit is passed at the end of the present iterate."""
    for k in range(joints):
        for side in (-1, 1):
            if (
                bounded(joint, link, k, side)
                and gap(joint, hinge, link, k, side, local, h, one) < -TOUCH * hinge[k, SIZE]
            ):
                return True
    return False


@kernel
def fourth_order_step(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, length: float, loops: bool, band: int, size: int, matrix: FloatArray, right: FloatArray,
    one: FloatArray, ledger: FloatArray,
) -> bool:  # fmt: skip
    """Suzuki's five parts of a step; False if one fails or passes a limit (the state is then that of a part)."""
    last = h
    for part in range(5):
        step = (1.0 - 4.0 * SHARE) * h if part == 2 else SHARE * h
        for k in range(joints):
            warm = 0.0 if loops else step / last
            hinge[k, LAM] *= warm
            hinge[k, LAM + 1] *= warm
        last = step
        if (
            newton_step(
                joint,
                hinge,
                link,
                joints,
                local,
                node,
                bodies,
                step,
                length,
                loops,
                0.0,
                band,
                size,
                matrix,
                right,
                one,
            )
            < 0
        ):
            return False
        if passes_bound(joint, hinge, link, joints, local, step, one):
            return False
        book(joint, hinge, link, joints, local, bodies, step, one, ledger)
        advance(local, bodies)
    return True


@kernel
def linear_rung(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    h: float, band: int, size: int, matrix: FloatArray, right: FloatArray, one: FloatArray, ledger: FloatArray,
) -> None:  # fmt: skip
    """The linear step; what its work misses is booked as CLOSED. If even that fails, free flight."""
    if not linear_step(joint, hinge, link, joints, local, node, bodies, h, band, size, matrix, right, one):
        for i in range(bodies):
            for c in range(3):
                local[i, AFTER + c] = local[i, BEFORE + c] + h * local[i, FREE + c]
        for k in range(joints):
            hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
    book(joint, hinge, link, joints, local, bodies, h, one, ledger)
    gained = kinetic(local, bodies, AFTER) - kinetic(local, bodies, BEFORE)
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                gained -= local[i, FREE + c] * local[i, WAY + c] / local[i, MOBILITY + c]
    known = ledger[MOTORS] + ledger[SUPPORTS] + ledger[CLOSED] - ledger[STORED]
    known -= ledger[DAMPED] + ledger[LIMITED] + ledger[CLAMPED] + ledger[PROJECTED]
    ledger[CLOSED] += gained - known
    advance(local, bodies)


@kernel
def write_joints(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float,
    loose: bool,
) -> None:  # fmt: skip
    """Leave impulses, limits and notches in the joints' own rows."""
    for k in range(joints):
        j = link[k, L_JOINT]
        joint[j, IMPULSE_1], joint[j, IMPULSE_2] = hinge[k, TOTAL], hinge[k, TOTAL + 1]
        joint[j, LAST_STEP] = h
        joint[j, LENGTH_1] = hinge[k, ENDED]
        tie[j, SIDE] = link[k, L_SIDE]
        if loose:
            tie[j, TOUCHED] = 2
        if link[k, L_KIND] == RATCHET:
            tooth, phase = joint[j, TOOTH], joint[j, TOOTH_PHASE]
            turned = local[link[k, L_B], POSE + 2] - local[link[k, L_A], POSE + 2]
            notch = np.floor((turned - phase) / tooth) * tooth + phase
            if (notch - joint[j, NOTCH]) * tooth > 1e-12 * tooth * tooth:
                joint[j, NOTCH] = notch
                tie[j, SIDE] = 0


@kernel
def island_step(
    joint: FloatArray, tie: IntArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray,
    node: IntArray, bodies: int, h: float, order: int, length: float, loops: bool, band: int, size: int,
    matrix: FloatArray, right: FloatArray, one: FloatArray, found: FloatArray, ledger: FloatArray,
) -> int:  # fmt: skip
    """Step one island by h; its status (see `layout`).

    `local` holds poses, velocities, accelerations and mobilities at the start and, on return, poses and velocities
    (BEFORE) at the end. `ledger` (LEDGER_COLUMNS,) is that of the step, `length` the size of the island.
    """
    for c in range(LEDGER_COLUMNS):
        ledger[c] = 0.0
    touched = read_joints(joint, tie, hinge, link, joints, h, length, loops)
    save(local, bodies)
    if touched:
        fit(joint, tie, hinge, link, joints, local, node, bodies, h, band, size, matrix, right, one, ledger)
        save(local, bodies)
    stand_still(joint, hinge, link, joints, local, bodies)
    soft_targets(joint, hinge, link, joints, local, h, one)
    for k in range(joints):
        tie[link[k, L_JOINT], SIDE] = link[k, L_SIDE]
        joint[link[k, L_JOINT], LENGTH_0] = hinge[k, BEGAN]
    before = ledger.copy()
    status = EXACT
    if order == 4 and smooth(joint, link, joints):
        if fourth_order_step(
            joint, hinge, link, joints, local, node, bodies, h, length, loops, band, size, matrix, right, one, ledger
        ):
            write_joints(joint, tie, hinge, link, joints, local, h, False)
            return EXACT
        restore(tie, hinge, link, joints, local, bodies)
        ledger[:] = before
    for rung in range(7):
        parts = 1 << rung if rung < 4 else 8
        give = 0.0 if rung < 4 else 1e-6 if rung == 4 else 1e-4
        status = EXACT if rung == 0 else HALVED if rung < 4 else ELASTIC if rung < 6 else LINEAR
        if rung == 6:
            linear_rung(joint, hinge, link, joints, local, node, bodies, h, band, size, matrix, right, one, ledger)
            break
        left = 0.0
        for part in range(parts):
            if part > 0 and loops:
                for k in range(joints):
                    hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
            left = step_with_limits(
                joint, hinge, link, joints, local, node, bodies, h / parts, length, loops, give, band, size, matrix,
                right, one, found, ledger,
            )  # fmt: skip
            if left != 0.0:
                break
        if left == 0.0:
            break
        restore(tie, hinge, link, joints, local, bodies)
        ledger[:] = before
    write_joints(joint, tie, hinge, link, joints, local, h, status >= ELASTIC)
    return status

"""How an island of joints answers impulses on its bodies: the change of velocities per impulse.

About a solved step, d v1 = S p for impulses p spread over the step, S the inverse of Newton's matrix with springs and
bounded joints. Rows turn as bodies move, and the force of joints that pull with them: without that what is taut would
give way across. Of joints that press it is left out: S would not be positive. At one instant (an impact),
S = M^-1 - M^-1 G^T (G M^-1 G^T)^-1 G M^-1: joints that hold exactly let no velocity through, and all others no impulse.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .condensed import PASSES
from .layout import COMPLIANCE
from .motion import move
from .newton import assemble
from .rows import joint_rows, start_joint
from .scratch import (
    AFTER,
    BEFORE,
    BOUNDED,
    BOXED,
    COLUMN,
    CONDENSED,
    COS,
    DUAL,
    FREEDOMS,
    FULL_BEND,
    L_A,
    L_B,
    L_JOINT,
    L_ROW,
    L_ROWS,
    L_SOFT,
    LAM,
    LOOPS,
    MOBILITY,
    NO_BEND,
    POSE,
    RIGID,
    ROOT,
    ROWS_OF,
    SAVED,
    SIN,
    STEP,
    SYSTEM,
    TOTAL,
    UNKNOWNS,
)
from .solve import LEAST_EPSILON, back, begin, decompose

_REFINE = 2  # passes that take back what epsilon, for rows that may be redundant, has changed


@uncounted
def bend_if_taut(
    joint: FloatArray, hinge: FloatArray, link: IntArray, k: int, local: FloatArray, h: float, stiff: FloatArray
) -> None:
    """Let joint k have the impulse of the whole step if it pulls, so that its rows take their force along as they turn;
    none if it presses."""
    hinge[k, LAM], hinge[k, LAM + 1] = hinge[k, TOTAL], hinge[k, TOTAL + 1]
    bend = joint_rows(joint, hinge, link, k, local, h, True, stiff)
    pulls = bend != NO_BEND
    for c in range(6):
        # What does not move adds nothing.
        at = link[k, L_A] if c < 3 else link[k, L_B]
        if local[at, MOBILITY + c % 3] > 0.0 and (bend == FULL_BEND or c % 3 == 2):
            pulls = pulls and stiff[c, c] <= 0.0
    if not pulls:
        hinge[k, LAM] = hinge[k, LAM + 1] = 0.0


@uncounted
def prepare(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray,
    stiff: FloatArray, pivots: IntArray,
) -> int:  # fmt: skip
    """Factors of the matrix that `respond` needs, in `matrix` and `pivots`; their system, -1 if there are none.

    `what` is STEP, after `island_step` (whose start becomes that of `local` again), or SPEEDS, at the present poses.
    """
    boxed = unbox(link, joints)
    system = factors(
        what, joint, hinge, link, joints, local, node, bodies, h, span, matrix, right, more, stiff, pivots
    )  # fmt: skip
    for k in range(joints if boxed else 0):
        if link[k, L_SOFT] == BOUNDED:
            link[k, L_SOFT] = BOXED
    return int(system)


@uncounted
def unbox(link: IntArray, joints: int) -> bool:
    """Let rows that are boxed be in the matrix: those inside of their bounds hold. Whether there are any."""
    some = False
    for k in range(joints):
        if link[k, L_SOFT] == BOXED:
            link[k, L_SOFT] = BOUNDED
            some = True
    return some


@uncounted
def factors(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray,
    stiff: FloatArray, pivots: IntArray,
) -> int:  # fmt: skip
    """See `prepare`."""
    if what == STEP:
        for i in range(bodies):
            for c in range(3):
                local[i, AFTER + c] = local[i, BEFORE + c]
                local[i, POSE + c], local[i, BEFORE + c] = local[i, SAVED + c], local[i, SAVED + 3 + c]
            local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
        for k in range(joints):
            start_joint(joint, hinge, link, k, local, h)
        move(local, bodies, h)
        for k in range(joints):
            if link[k, L_ROWS] > 0 and link[k, L_SOFT] == 0:
                bend_if_taut(joint, hinge, link, k, local, h, stiff)
    else:
        begin(what, joint, hinge, link, joints, local, node, bodies, h)
    system = DUAL if span[RIGID] > (1 if what == STEP else 0) else span[SYSTEM]
    give = joint[link[0, L_JOINT], COMPLIANCE] / h**2 if what == STEP else 0.0
    epsilon = LEAST_EPSILON if span[LOOPS] > 0 and give == 0.0 else 0.0
    while True:
        for i in range(span[UNKNOWNS] + span[ROWS_OF]):
            right[i] = 0.0
        assemble(
            what, joint, hinge, link, joints, local, node, bodies, h, give, True, system, True, span, matrix, right,
            stiff,
        )  # fmt: skip
        if decompose(
            what, hinge, link, joints, local, node, bodies, system, epsilon, give, span, matrix, more, pivots
        ):  # fmt: skip
            return int(system)
        if epsilon == 0.0:
            epsilon = LEAST_EPSILON
        elif system != DUAL:
            return -1
        else:
            system = span[SYSTEM]


@uncounted
def respond(
    what: int, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    system: int, span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray, pivots: IntArray,
    push: FloatArray, gives: bool,
) -> None:  # fmt: skip
    """push (bodies, 3): impulses in (mass length/time, mass length²/time), changes of velocity out. `more`: scratch.

    Args:
        system: that of the factors, from `prepare`.  gives: whether joints give way elastically.
    """
    size = span[UNKNOWNS] + span[ROWS_OF]
    for i in range(size):
        right[i] = 0.0
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            right[node[i, COLUMN] + c] = push[i, c] * local[i, ROOT + c]
    back(
        what,
        hinge,
        link,
        joints,
        local,
        node,
        bodies,
        system,
        1 if gives else PASSES,
        span,
        matrix,
        right,
        more,
        pivots,
    )
    # (A + epsilon) x = b leaves b - A x = epsilon x in the rows, and each correction d leaves epsilon d.
    for turn in range(0 if system == CONDENSED or span[LOOPS] == 0 or gives else _REFINE):
        rest = right[size : 2 * size] if turn > 0 else right[:size]
        for i in range(size):
            right[size + i] = rest[i]
        rest = right[size : 2 * size]
        for i in range(bodies):
            for c in range(node[i, FREEDOMS]):
                rest[node[i, COLUMN] + c] = 0.0
        for k in range(joints):
            for r in range(link[k, L_ROWS]):
                rest[link[k, L_ROW] + r] *= LEAST_EPSILON
        back(what, hinge, link, joints, local, node, bodies, system, PASSES, span, matrix, rest, more, pivots)
        for i in range(size):
            right[i] += rest[i]
    for i in range(bodies):
        for c in range(3):
            if c < node[i, FREEDOMS]:
                push[i, c] = right[node[i, COLUMN] + c] * local[i, ROOT + c]
            else:
                push[i, c] *= local[i, MOBILITY + c]

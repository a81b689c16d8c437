"""Bodies that joints cannot move and the program may: their poses and velocities into the rows of PARTNER."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import EDITED, Joint

PARTNER_NOT_FINITE = -1


@kernel
def read_partners(
    MOTION: FloatArray, ROWS: IntArray, FIXED: FloatArray, KNOWN: FloatArray, PARTNER: Rows[Body], JOINT: Rows[Joint],
    n: int,
) -> int:  # fmt: skip
    """Write what has changed into PARTNER, and mark the joints of these bodies as EDITED. The centre of mass is
    c = x + R(angle) k; the velocities of bodies that are not kinematic count as 0, as under pymunk.

    Args:
        MOTION: of each body of ROWS its position x (2), angle, velocity (2) and spin, one after the other.
        ROWS (m,): their rows of PARTNER.
        FIXED (x, 3): the centre of gravity k in coordinates of the body, and 1 for a kinematic, -1 for a static one.
        KNOWN (x, 6): as MOTION, as last read; nan if the row is to be written in any case.
        JOINT (j,): whose bodies n + i are those of PARTNER.

    Returns:
        how many of them are static and have moved. PARTNER_NOT_FINITE, with KNOWN[i, 0] = nan for rows with such a
        number, and all others read.
    """
    moved, failed = 0, False
    for k in range(len(ROWS)):
        i, at = ROWS[k], 6 * k
        moves = FIXED[i, 2] > 0.0
        same, finite = True, math.isfinite(FIXED[i, 0] + FIXED[i, 1])
        for column in range(6):
            value = MOTION[at + column] if column < 3 or moves else 0.0
            finite = finite and math.isfinite(value)
            same = same and value == KNOWN[i, column]
            KNOWN[i, column] = value
        if same:
            continue
        if not finite:
            failed, KNOWN[i, 0] = True, math.nan
            continue
        one, known, c, s = PARTNER[i], KNOWN[i], math.cos(KNOWN[i, 2]), math.sin(KNOWN[i, 2])
        one.x, one.y = known[0] + c * FIXED[i, 0] - s * FIXED[i, 1], known[1] + s * FIXED[i, 0] + c * FIXED[i, 1]
        one.angle, one.vx, one.vy, one.spin = known[2], known[3], known[4], known[5]
        moved += FIXED[i, 2] < 0.0
        for j in range(len(JOINT)):
            if n + i in (JOINT[j].body[0], JOINT[j].body[1]):
                JOINT[j].touched = EDITED
    return PARTNER_NOT_FINITE if failed else moved

"""Targets of contacts in an interval: b of 0 <= lam _|_ u_n+ - b >= 0, the normal velocities at its end.

Let u = u_n now, g the gap, h the length of the interval, a_n the acceleration of the gap without impulses, lam_w the
impulse over h of the load that the contact carried in the last solve, A_nn the change of u by a unit impulse. The
bounce is e max(-u, 0) for e < 1, -u for e = 1.

* e < 1 and the bounce below (1/2) max(-a_n h, A_nn lam_w): it would return within the interval. The contact persists:
  its bounce is 0 (the rest of the bounces enters the ledger as restitution at once).
* e = 1 with a gap, or u < -2 |a| h: an impact. b is the bounce, if the gap would close without it: the contact is
  inactive while u_n+ is above its activation velocity `activation`, with which the gap is just closed at the end.
* Else the surfaces meet softly at the end of the interval: b = min(bounce, -u - 2 max(g, 0)/h).

Where a wall turns (`turning_walls.py`, c = c_0), u is less by c than with the geometry of the start, and u+ more by c
than with that of the end: u + c bounces, for c >= 0 and up to -u, and c is added to the bounce. So a body that the wall
carries along neither sinks nor loses energy, to second order; with the bounce 0 it would follow the tangent of the
middle, through the wall. 2 c/h is an acceleration, too.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.intervals import IMPACT_SPEED


@inlined
def hardly_bounces(e: float, u: float, press: float) -> bool:
    """Whether a contact with elasticity e and gap rate u would bounce with less than half of `press`, the velocity by
    which forces close it in the interval: it would return within that."""
    return -e * min(u, 0.0) < 0.5 * press


@nonallocating
def target(ROWS: Rows[Row], m: int, ACC: FloatArray, EXPECTED: FloatArray, pull: float, h: float) -> None:
    """Set the targets and activation velocities (`target`, `activation`) of m rows, from their gaps and velocities u_n.

    Args:
        ACC: (k, 3) accelerations without impulses.  pull: |a|, the largest of them.  h: length of the interval.
        EXPECTED: (m,) normal impulses lam_w of loads.
    """
    for i in range(m):
        a, b, u, e = ROWS[i].a, ROWS[i].b, ROWS[i].un, ROWS[i].elasticity
        close = -u - 2.0 * ROWS[i].gap / h  # end velocity that closes the gap
        begins = u + min(ROWS[i].turned, max(-u, 0.0))
        bounce = -e * begins if begins < 0.0 else 0.0
        ROWS[i].activation = np.inf
        if e >= 1.0:
            bounce = -u
        else:
            along = ROWS[i].nx * (ACC[b, 0] - ACC[a, 0]) + ROWS[i].ny * (ACC[b, 1] - ACC[a, 1])
            if hardly_bounces(e, begins, max(-along * h, EXPECTED[i] / ROWS[i].k_n)):
                bounce = 0.0
            bounce += begins - u
        if begins < -IMPACT_SPEED * (pull * h + 2.0 * ROWS[i].turned) or (e >= 1.0 and ROWS[i].gap > 0.0):
            ROWS[i].target = bounce
            ROWS[i].activation = close
        else:
            ROWS[i].target = min(bounce, min(-u, close))

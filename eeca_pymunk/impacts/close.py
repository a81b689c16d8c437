"""The end of a step: paths come to its last instant, islands and the work of forces enter the ledger."""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import nonallocating
from ..geometry.flight import move_to
from ..geometry.gap import gap_at
from ..islands.accounting import account_contact, apply_correction, hold_sides
from ..islands.at_rest import report_at_rest, store_rest
from ..model.bodies import AT_REST
from ..model.scene import Scene
from ..rows.energy import offset_gain
from .begin import energy_of, kinetic_of_damped


@nonallocating
def close(A: Scene, IDS: IntArray) -> None:
    """Move all bodies to the end of the step, end islands' intervals, enter the work of forces and the energy in the
    ledger, and compute the gaps at the start of the step of logged impulses."""
    BODY, PAR, LOG, BEGAN, COUNT = A.BODY, A.PAR, A.LOG, A.BEGAN, A.COUNT
    end = PAR.dt
    even = COUNT.even > 0  # no islands
    COUNT.quiet = COUNT.quiet + 1 if even else 0
    for c in range(COUNT.pushes):
        root = A.PUSHED_BY[c].root
        if root >= 0 and A.MEMBER[root].rest == AT_REST:
            report_at_rest(A, c)
        elif root >= 0:
            account_contact(A, c, end)
    gx, gy = PAR.gravity_x, PAR.gravity_y
    for i in range(BODY.shape[0] - 1):
        move_to(BODY, i, end)
    for i in range(BODY.shape[0] - 1 if len(A.SIDE) > 0 and not even else 0):
        hold_sides(A, i, end)
    for i in range(BODY.shape[0] - 1 if not even else 0):
        if A.STATE[i].island == i:
            apply_correction(A, i, end)
    for i in range(BODY.shape[0] - 1):
        fx, fy, twist = A.PULL[i, 0] - gx, A.PULL[i, 1] - gy, A.PULL[i, 2]
        if BODY[i].inv_mass > 0.0 and (fx != 0.0 or fy != 0.0 or twist != 0.0):
            work = (fx * (BODY[i].x - BEGAN[i, 0]) + fy * (BODY[i].y - BEGAN[i, 1])) / BODY[i].inv_mass
            if BODY[i].inv_inertia > 0.0:
                work += twist * (BODY[i].angle - BEGAN[i, 2]) / BODY[i].inv_inertia
            PAR.external += work
    PAR.restitution, PAR.frictional = offset_gain(PAR.restitution, PAR.frictional)
    PAR.after = energy_of(A) + PAR.stored
    half_damping = PAR.half_damping
    if half_damping != 1.0:
        lost = kinetic_of_damped(A, IDS) * (1.0 - half_damping * half_damping)
        PAR.damped += lost
        PAR.after -= lost
    PAR.last = end
    for n in range(COUNT.logged):
        if not math.isnan(LOG[n].gap):
            continue
        a, b = int(LOG[n].first), int(LOG[n].second)
        if max(a, b) < COUNT.disks:
            dx, dy = BEGAN[a, 0] - BEGAN[b, 0], BEGAN[a, 1] - BEGAN[b, 1]
            LOG[n].gap = math.sqrt(dx * dx + dy * dy) - BODY[min(a, b)].extent - BODY[max(a, b)].extent
            continue
        i, j = A.LINK[a].owner, A.LINK[b].owner
        LOG[n].gap = gap_at(A, a, BEGAN[i, 0], BEGAN[i, 1], BEGAN[i, 2], b, BEGAN[j, 0], BEGAN[j, 1], BEGAN[j, 2])[0]
    if not even:
        store_rest(A)

"""A step's beginning: who is forecast anew, and the energy that there is."""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import uncounted
from ..contacts.energy import total, unsteered
from ..geometry.sides import forget_sides
from ..islands.accounting import flag_pairs
from ..islands.at_rest import note_motion, stays_at_rest
from ..layout import ANEW
from ..model.bodies import ASKED, AT_REST, MOVED
from ..model.parameters.rest import REST_RETRY
from ..model.scene import Scene


@uncounted
def begin(A: Scene, WALK: IntArray) -> None:
    """Count from the start of this step; forecast the bodies that were edited, and all that is due."""
    BODY, STATE, PAR, COUNT = A.BODY, A.STATE, A.PAR, A.COUNT
    COUNT.heap, COUNT.logged, COUNT.impacts, COUNT.blocks, COUNT.forecasts, COUNT.stale = 0, 0, 0, 0, 0, 0
    COUNT.solves, COUNT.solved, COUNT.ignored, COUNT.sweeps, COUNT.direct, COUNT.work = 0, 0, 0, 0, 0, 0
    if COUNT.unmet > 0:
        A.FLAG[:] = 0
        COUNT.unmet = 0
        # Pairs that were passed over are in nobody's forecast.
        for i in range(BODY.shape[0] - 1):
            BODY[i].due, A.RESTING[i].still_due = min(BODY[i].due, 0.0), 0.0
        flag_pairs(A)
    PAR.restitution, PAR.frictional, PAR.external, PAR.damped = 0.0, 0.0, 0.0, 0.0
    PAR.lock, PAR.stored = 1.0, 0.0
    PAR.before = total(A)
    left = PAR.left_over
    if left != 1.0:
        # `take` has damped velocities already, by half a step's worth.
        PAR.damped = unsteered(A, WALK) * (1.0 / (left * left) - 1.0)
        PAR.before += PAR.damped
    PAR.stamp += 1.0
    COUNT.waiting, COUNT.phase = 0, 0
    n, last = BODY.shape[0] - 1, PAR.last
    quiet = COUNT.quiet > REST_RETRY
    COUNT.closing, fixed = 0, 1 if A.SHAPE.shape[0] > A.LIST.shape[0] else 0
    pulled, even, carries = 0.0, True, A.RULE.shape[0] == 0 and not quiet
    for i in range(n):
        STATE[i].events = 0
        carries = carries and A.MEMBER[i].tied < 0
        if not quiet:
            A.MEMBER[i].busy = max(A.MEMBER[i].busy - 1, 0)
        if not quiet and A.MEMBER[i].rest == AT_REST and stays_at_rest(A, i, last):
            pulled = max(pulled, A.PULL[i, 0] * A.PULL[i, 0] + A.PULL[i, 1] * A.PULL[i, 1])
            even = False
            continue
        if BODY[i].inv_mass == 0.0:
            note_motion(A, i)
            fixed += 1
            if BODY[i].vx != 0.0 or BODY[i].vy != 0.0 or BODY[i].spin != 0.0:
                COUNT.closing = 1
        ax, ay = BODY[i].ax, BODY[i].ay
        A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2] = ax, ay, BODY[i].angular
        pulled = max(pulled, ax * ax + ay * ay)
        A.BEGAN[i, 0], A.BEGAN[i, 1], A.BEGAN[i, 2] = BODY[i].x, BODY[i].y, BODY[i].angle
        if BODY[i].due < 0.0:
            STATE[i].version += 1
            if BODY[i].due == -math.inf:
                forget_sides(A, i)
                A.MEMBER[i].put, COUNT.crammed = MOVED, 1
            elif BODY[i].due <= ANEW:
                A.MEMBER[i].put, COUNT.crammed = max(A.MEMBER[i].put, ASKED), 1
        else:
            BODY[i].due = max(BODY[i].due - last, 0.0)
        alike = BODY[i].inv_mass == 0.0 or (ax == BODY[0].ax and ay == BODY[0].ay)
        even = even and alike and STATE[i].island < 0
    PAR.pulled = math.sqrt(pulled)
    if fixed < 2:
        COUNT.closing = 0
    COUNT.even = 1 if even else 0
    COUNT.carries = 1 if carries else 0

"""The start of a step: which bodies have to be predicted again, and the energy at the start."""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import nonallocating
from ..contacts.works import kinetic
from ..geometry.flight import moves
from ..geometry.sides import forget_pair, forget_sides
from ..islands.accounting import flag_pairs
from ..islands.at_rest import stays_at_rest, unchanged
from ..layout import BODY_ROW, FLAGS, PLACED, SHIFTED, STEERED
from ..model.bodies import AT_REST, AWAKE, CHANGED, MOVED, UNMOVED
from ..model.parameters.events import BUSY_STEPS
from ..model.scene import Scene
from ..prediction.sides import find_sides


@nonallocating
def energy_of(A: Scene) -> float:
    """Kinetic energy of all bodies, and potential energy -m g.x in uniform gravity, without bodies that impulses do not
    move."""
    BODY, gx, gy, whole = A.BODY, A.PAR.gravity_x, A.PAR.gravity_y, 0.0
    for i in range(BODY.shape[0] - 1):
        if BODY[i].inv_mass != 0.0:
            whole += kinetic(BODY, i) - (gx * BODY[i].x + gy * BODY[i].y) / BODY[i].inv_mass
    return whole


@nonallocating
def kinetic_of_damped(A: Scene, IDS: IntArray) -> float:
    """Kinetic energy of the bodies that the space's damping acts on: those without a velocity function of the
    program."""
    whole = 0.0
    for k in range(IDS.shape[1]):
        i = IDS[BODY_ROW, k]
        if i >= 0 and not IDS[FLAGS, k] & STEERED:
            whole += kinetic(A.BODY, i)
    return whole


@nonallocating
def note_placed(A: Scene, i: int) -> None:
    """Let body i count as placed by the program, with the sides of its shapes forgotten if it was moved far."""
    due, member = A.BODY[i].due, A.MEMBER[i]
    if due < SHIFTED:
        forget_sides(A, i, (SHIFTED - due) * A.BODY[i].extent)
    member.placed = MOVED if due <= SHIFTED else max(member.placed, UNMOVED)
    A.COUNT.any_placed = max(A.COUNT.any_placed, 1)


@nonallocating
def begin(A: Scene, IDS: IntArray) -> None:
    """Reset counters and ledger for a new step, and count `Body.due` from its start; compute the energy there, and the
    flags of the step (`even`, `closing`, `may_support`). Edited bodies begin a new path version, and the islands at
    rest for which something has changed are set CHANGED. The sides of thin shapes that pass through each other are
    forgotten, and those of placed ones noted."""
    BODY, STATE, PAR, COUNT = A.BODY, A.STATE, A.PAR, A.COUNT
    COUNT.heap, COUNT.logged, COUNT.blocks, COUNT.room = 0, 0, 0, 0
    COUNT.solves, COUNT.solved, COUNT.direct, COUNT.work = 0, 0, 0, 0.0
    COUNT.event_bodies, COUNT.present_bodies, COUNT.events_work, COUNT.work_before = 0, 0, 0.0, 0.0
    if COUNT.unmet > 0:
        A.FLAG[:] = 0
        COUNT.unmet = 0
        # Pairs that were passed over are in no prediction.
        for i in range(BODY.shape[0] - 1):
            BODY[i].due, A.RESTING[i].rest_due = min(BODY[i].due, 0.0), 0.0
        flag_pairs(A)
    PAR.restitution, PAR.frictional, PAR.external, PAR.damped = 0.0, 0.0, 0.0, 0.0
    PAR.lock, PAR.stored = 1.0, 0.0
    PAR.before = energy_of(A)
    half_damping = PAR.half_damping
    if half_damping != 1.0:
        # `read_states` has damped velocities by half a step already.
        PAR.damped = kinetic_of_damped(A, IDS) * (1.0 / (half_damping * half_damping) - 1.0)
        PAR.before += PAR.damped
    PAR.stamp += 1.0
    COUNT.waiting, COUNT.phase = 0, 0
    n, last = BODY.shape[0] - 1, PAR.last
    # After so many steps without islands no body is at rest, and every `busy` has become 0: both are left out below.
    quiet = COUNT.quiet > BUSY_STEPS
    # Two bodies without mobility are needed to squeeze others; all static shapes together count as one.
    COUNT.closing, fixed = 0, 1 if A.SHAPE.shape[0] > A.LIST.shape[0] else 0
    pulled, even, may_support = 0.0, True, A.RULE.shape[0] == 0 and not quiet
    for i in range(n):
        STATE[i].impacts = 0
        may_support = may_support and A.MEMBER[i].tied < 0
        if not quiet:
            A.MEMBER[i].busy = max(A.MEMBER[i].busy - 1, 0)
        if BODY[i].due <= PLACED:
            note_placed(A, i)
        if not quiet and A.MEMBER[i].rest == AT_REST and stays_at_rest(A, i, last):
            pulled = max(pulled, A.PULL[i, 0] * A.PULL[i, 0] + A.PULL[i, 1] * A.PULL[i, 1])
            even = False
            continue
        if BODY[i].inv_mass == 0.0:
            fixed += 1
            COUNT.closing = 1 if moves(BODY[i]) else COUNT.closing
            # One that joints hold from now on may be the root of an island at rest, which then is CHANGED.
            still = unchanged(A, i) and not moves(BODY[i]) and STATE[i].island < 0
            A.MEMBER[i].rest = AWAKE if still else CHANGED
        ax, ay = BODY[i].ax, BODY[i].ay
        A.PULL[i, 0], A.PULL[i, 1], A.PULL[i, 2] = ax, ay, BODY[i].angular
        pulled = max(pulled, ax * ax + ay * ay)
        A.BEGAN[i, 0], A.BEGAN[i, 1], A.BEGAN[i, 2] = BODY[i].x, BODY[i].y, BODY[i].angle
        if BODY[i].due < 0.0:
            STATE[i].version += 1
        else:
            BODY[i].due = max(BODY[i].due - last, 0.0)
        alike = BODY[i].inv_mass == 0.0 or (ax == BODY[0].ax and ay == BODY[0].ay)
        even = even and alike and STATE[i].island < 0
    if A.SIDE.shape[0] > 0:
        for r in range(A.RULE.shape[0]):
            if A.RULE[r, 2] < 0.0:
                forget_pair(A, int(A.RULE[r, 0]), int(A.RULE[r, 1]))
        if COUNT.any_placed > 0:
            find_sides(A, COUNT.any_placed > 1)
    PAR.pulled = math.sqrt(pulled)
    if fixed < 2:
        COUNT.closing = 0
    COUNT.even = 1 if even else 0
    COUNT.may_support = 1 if may_support else 0

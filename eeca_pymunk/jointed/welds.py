"""Impulses of the joints of welded bodies (`..joints.welds`), by the balance of momentum over a step.

These bodies do not move. With P the sum of all impulses on a body (gravity, forces, contacts, bodies welded to it) and
L that of their moments about its pivot:

    impulse of the pivot = -P,      impulse of the gear = -L.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..joints.pinned import mass_of
from ..joints.straight import anchor_at
from ..layout import ACCELERATION_X, ACCELERATION_Y, ANGULAR_ACCELERATION, BODY_ROW, FLAGS, READ, STEERED
from ..model.joints import WELDED, Joints, Pinned
from ..model.scene import Scene
from ..model.values import Reading


@nonallocating
def pinned_row(J: Joints, body: int) -> int:
    """The row of a body in PINNED, which is sorted; -1 if it has none."""
    PINNED, pinned = J.PINNED, J.TALLY.pinned
    low, high = 0, pinned
    while low < high:
        middle = (low + high) // 2
        if PINNED[middle].body < body:
            low = middle + 1
        else:
            high = middle
    return low if low < pinned and PINNED[low].body == body else -1


@nonallocating
def pivot_place(J: Joints, pinned: Pinned) -> tuple[float, float]:
    """The place of a welded body's pivot."""
    return anchor_at(J.JOINT[pinned.weld[0] // 2], pinned.weld[0] % 2, pinned.x, pinned.y, pinned.angle)


@nonallocating
def push_weld(J: Joints, pinned: Pinned, x: float, y: float, px: float, py: float, twist: float) -> None:
    """Add the reaction to an impulse (px, py) at (x, y), and to an angular one `twist`, to the impulses of a welded
    body's joints; nothing for other bodies."""
    if pinned.kind != WELDED:
        return
    pivot, gear = J.JOINT[pinned.weld[0] // 2], J.JOINT[pinned.weld[1] // 2]
    at_x, at_y = pivot_place(J, pinned)
    side = 1.0 if pinned.weld[0] % 2 == 0 else -1.0  # the impulse of a joint acts on its body b
    pivot.impulse[0], pivot.impulse[1] = pivot.impulse[0] + side * px, pivot.impulse[1] + side * py
    turn = twist + (x - at_x) * py - (y - at_y) * px
    gear.impulse[0] += -turn if pinned.weld[1] % 2 == 1 else turn * gear.ratio


@nonallocating
def pass_on(J: Joints, pinned: Pinned) -> None:
    """Apply the impulses of a welded body's joints to the bodies that it is welded to."""
    pivot, gear = J.JOINT[pinned.weld[0] // 2], J.JOINT[pinned.weld[1] // 2]
    under = pinned_row(J, pivot.body[1 - pinned.weld[0] % 2])
    beside = pinned_row(J, gear.body[1 - pinned.weld[1] % 2])
    if under >= 0:
        x, y = pivot_place(J, pinned)
        side = -1.0 if pinned.weld[0] % 2 == 1 else 1.0
        push_weld(J, J.PINNED[under], x, y, side * pivot.impulse[0], side * pivot.impulse[1], 0.0)
    if beside >= 0:
        turn = gear.impulse[0] * (-1.0 / gear.ratio if pinned.weld[1] % 2 == 1 else 1.0)
        push_weld(J, J.PINNED[beside], 0.0, 0.0, 0.0, 0.0, turn)


@nonallocating
def load_welds(A: Scene, J: Joints, R: Reading) -> None:
    """At the end of a step, write the impulses of welded bodies' joints: gravity, other forces and contacts push each
    body, then those farthest from the fixed bodies pass on what they carry, link by link. If the step was cut short,
    forces are kept, as by `ledger.account_joints`."""
    IDS, now = R.IDS, R.STATES[READ]
    PINNED, BODY, dt, links = J.PINNED, A.BODY, A.PAR.planned, 0
    for k in range(J.TALLY.pinned):
        pinned = PINNED[k]
        for c in range(2 if pinned.kind == WELDED else 0):
            joint = J.JOINT[pinned.weld[c] // 2]
            joint.impulse[0], joint.impulse[1], joint.last_step = 0.0, 0.0, A.PAR.planned
        links = max(links, pinned.link)
    for i in range(IDS.shape[1] if links > 0 else 0):
        row = IDS[BODY_ROW, i]
        k = pinned_row(J, row) if row >= 0 and BODY[row].inv_mass == 0.0 else -1
        if k >= 0:
            pinned = PINNED[k]
            mass, moment = dt * mass_of(pinned.inv_mass), dt * mass_of(pinned.inv_inertia)
            px, py = mass * A.PAR.gravity_x + dt * now[i, 6], mass * A.PAR.gravity_y + dt * now[i, 7]
            twist = dt * now[i, 8]
            if IDS[FLAGS, i] & STEERED:
                px, py = mass * R.EXTRA[i, ACCELERATION_X], mass * R.EXTRA[i, ACCELERATION_Y]
                twist = moment * R.EXTRA[i, ANGULAR_ACCELERATION]
            push_weld(J, pinned, pinned.x, pinned.y, px, py, twist)
    for e in range(A.COUNT.logged if links > 0 else 0):
        one = A.LOG[e]
        px, py = one.normal * one.nx - one.tangential * one.ny, one.normal * one.ny + one.tangential * one.nx
        longer = dt / A.PAR.dt if one.duration > 0.0 else 1.0
        for end in range(2):
            row, side = A.LINK[int(one.first if end == 0 else one.second)].owner, (2.0 * end - 1.0) * longer
            k = pinned_row(J, row) if BODY[row].inv_mass == 0.0 else -1
            if k >= 0:
                push_weld(J, PINNED[k], one.px, one.py, side * px, side * py, 0.0)
    for link in range(links, 1, -1):
        for k in range(J.TALLY.pinned):
            if PINNED[k].link == link:
                pass_on(J, PINNED[k])

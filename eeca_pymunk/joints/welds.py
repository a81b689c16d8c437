"""Welded bodies: a closed pivot and a closed gear of unlimited force hold each on static or other welded bodies.

They have no joints but these, and those of bodies welded to them. As they do not move, the impulses of both joints
follow from the balance of momentum over a step. With P the sum of all impulses on the body (gravity, forces, contacts,
bodies welded to it) and L that of their moments about the pivot:

    impulse of the pivot = -P,      impulse of the gear = -L.
"""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import FREE, GEAR, PIVOT, WELDED, Joint, Joints, Pinned
from ..model.parameters.joints import STRAIGHT_CHAIN
from .straight import anchor, anchor_at


@nonallocating
def closed(bodies: Rows[Body], joint: Joint) -> bool:
    """Whether a pivot or gear is closed, to round-off."""
    if joint.kind == GEAR:
        a, b = bodies[joint.body[0]].angle, joint.ratio * bodies[joint.body[1]].angle
        return bool(abs(b - a - joint.phase) <= STRAIGHT_CHAIN * max(1.0, abs(a), abs(b)))
    ax, ay = anchor(bodies, joint, 0)
    bx, by = anchor(bodies, joint, 1)
    return bool(abs(ax - bx) + abs(ay - by) <= STRAIGHT_CHAIN * max(abs(ax), abs(ay), abs(bx), abs(by)))


@nonallocating
def grow(
    bodies: Rows[Body], joint: Rows[Joint], still: IntArray, loose: IntArray, pinned: IntArray, welds: IntArray
) -> int:  # fmt: skip
    """Weld bodies that are not `loose` (n,) to still or welded ones, layer by layer; how many there are. See `weld`."""
    count, layer, found = 0, 0, 1
    while found > 0:
        found, layer = 0, layer + 1
        for j in range(len(joint)):
            for end in range(2):
                i, other = joint[j].body[end], joint[j].body[1 - end]
                fixed = still[other] > 0 or (pinned[other] == WELDED and welds[other, 2] < layer)
                k = 1 if joint[j].kind == GEAR else 0
                free = still[i] == 0 and loose[i] == 0 and pinned[i] == FREE and welds[i, k] < 0
                exact = joint[j].bounded == 0 and joint[j].kind in (PIVOT, GEAR)
                if fixed and free and exact and closed(bodies, joint[j]):
                    welds[i, k] = 2 * j + end
        for i in range(len(bodies)):
            if pinned[i] == FREE and welds[i, 0] >= 0 and welds[i, 1] >= 0:
                pinned[i], welds[i, 2] = WELDED, layer
                found += 1
        count += found
    return count


@kernel
def weld(bodies: Rows[Body], joint: Rows[Joint], still: IntArray, pinned: IntArray, welds: IntArray) -> int:
    """Find the welded bodies: pinned (n,) becomes WELDED, and welds (n, 3) has `Pinned.weld` and `Pinned.link`; how
    many there are. A body is only welded if it has no other joints than its weld and those of bodies welded to it,
    since their impulses would be unknown."""
    loose, spare = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    while True:
        welds[:] = -1
        count, others = grow(bodies, joint, still, loose, pinned, welds), 0
        spare[:] = 0
        for j in range(len(joint)):
            for end in range(2):
                i, other, k = joint[j].body[end], joint[j].body[1 - end], 1 if joint[j].kind == GEAR else 0
                own = welds[i, k] == 2 * j + end
                spare[i] += 0 if own or (pinned[other] == WELDED and welds[other, k] == 2 * j + 1 - end) else 1
        for i in range(len(bodies)):
            if pinned[i] == WELDED and spare[i] > 0:
                loose[i] = 1
                others += 1
        if others == 0:
            return count
        for i in range(len(bodies)):
            pinned[i] = FREE if pinned[i] == WELDED else pinned[i]


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

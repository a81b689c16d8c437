"""Welded bodies: a closed pivot and a closed gear of unlimited force hold each on static or other welded bodies.

They have no joints but these, and those of bodies welded to them, so that the impulses of both joints follow from the
balance of momentum (`..jointed.welds`).
"""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import FREE, GEAR, PIVOT, WELDED, Joint
from ..model.parameters.joints import STRAIGHT_CHAIN
from .straight import anchor, is_round_off, size_of_anchor


@nonallocating
def closed(bodies: Rows[Body], joint: Joint) -> bool:
    """Whether a pivot or gear is closed, to round-off."""
    if joint.kind == GEAR:
        a, b = bodies[joint.body[0]].angle, joint.ratio * bodies[joint.body[1]].angle
        return bool(abs(b - a - joint.phase) <= STRAIGHT_CHAIN * max(1.0, abs(a), abs(b)))
    ax, ay = anchor(bodies, joint, 0)
    bx, by = anchor(bodies, joint, 1)
    size = max(size_of_anchor(bodies, joint, 0), size_of_anchor(bodies, joint, 1))
    return bool(is_round_off(ax - bx, ay - by, size))


@nonallocating
def grow(
    bodies: Rows[Body], joint: Rows[Joint], still: IntArray, loose: IntArray, kinds: IntArray, welds: IntArray
) -> int:  # fmt: skip
    """Weld bodies that are not `loose` (n,) to still or welded ones, layer by layer; how many there are. See `weld`."""
    count, layer, found = 0, 0, 1
    while found > 0:
        found, layer = 0, layer + 1
        for j in range(len(joint)):
            for end in range(2):
                i, other = joint[j].body[end], joint[j].body[1 - end]
                fixed = still[other] > 0 or (kinds[other] == WELDED and welds[other, 2] < layer)
                k = 1 if joint[j].kind == GEAR else 0
                free = still[i] == 0 and loose[i] == 0 and kinds[i] == FREE and welds[i, k] < 0
                exact = joint[j].finite_force == 0 and joint[j].kind in (PIVOT, GEAR)
                if fixed and free and exact and closed(bodies, joint[j]):
                    welds[i, k] = 2 * j + end
        for i in range(len(bodies)):
            if kinds[i] == FREE and welds[i, 0] >= 0 and welds[i, 1] >= 0:
                kinds[i], welds[i, 2] = WELDED, layer
                found += 1
        count += found
    return count


@kernel
def weld(bodies: Rows[Body], joint: Rows[Joint], still: IntArray, kinds: IntArray, welds: IntArray) -> int:
    """Find the welded bodies: kinds (n,) becomes WELDED, and welds (n, 3) has `Pinned.weld` and `Pinned.link`; how
    many there are. A body is only welded if it has no other joints than its weld and those of bodies welded to it,
    since their impulses would be unknown."""
    loose, spare = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    while True:
        welds[:] = -1
        count, others = grow(bodies, joint, still, loose, kinds, welds), 0
        spare[:] = 0
        for j in range(len(joint)):
            for end in range(2):
                i, other, k = joint[j].body[end], joint[j].body[1 - end], 1 if joint[j].kind == GEAR else 0
                own = welds[i, k] == 2 * j + end
                spare[i] += 0 if own or (kinds[other] == WELDED and welds[other, k] == 2 * j + 1 - end) else 1
        for i in range(len(bodies)):
            if kinds[i] == WELDED and spare[i] > 0:
                loose[i] = 1
                others += 1
        if others == 0:
            return count
        for i in range(len(bodies)):
            kinds[i] = FREE if kinds[i] == WELDED else kinds[i]

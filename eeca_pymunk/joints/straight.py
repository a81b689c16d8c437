"""Straight chains of joints between fixed points, whose bodies cannot move: a bridge as long as its gap.

A chain of bodies and joints from point A to point B, both fixed, is at most

    L = sum of the distances of a body's two anchors, of the lengths of pins and of the upper limits of slides

long. If L = |AB| there is one place for each of its points, on the line at its distance along the chain, and a body
with two of them is fixed. The equations of such joints are singular: to first order they let the bodies go across, and
any force across would need an infinite pull. So these bodies count as bodies that nothing moves, like static ones.

A chain from A is straight as far as its length does not exceed the distance from A by more than round-off; by the
triangle inequality one that is bent anywhere stays longer than the distance, so that it need not be followed.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import FREE, PIN, PIVOT, SLIDE, WHOLLY, Joint
from ..model.parameters.joints import STRAIGHT_CHAIN


@nonallocating
def reach(joint: Joint) -> float:
    """The largest distance of a joint's two points, or infinity."""
    if joint.finite_force == 0 and joint.kind == PIVOT:
        return 0.0
    if joint.finite_force == 0 and joint.kind == PIN:
        return joint.length
    return joint.upper if joint.finite_force == 0 and joint.kind == SLIDE else math.inf


@nonallocating
def anchor_at(joint: Joint, end: int, x: float, y: float, angle: float) -> tuple[float, float]:
    """The point of a joint on its body a (end 0) or b (1), which is at this pose."""
    rx, ry = joint.anchor_a[0], joint.anchor_a[1]
    if end == 1:
        rx, ry = joint.anchor_b[0], joint.anchor_b[1]
    c, s = math.cos(angle), math.sin(angle)
    return x + c * rx - s * ry, y + s * rx + c * ry


@nonallocating
def anchor(bodies: Rows[Body], joint: Joint, end: int) -> tuple[float, float]:
    """`anchor_at` the pose of that body."""
    body = bodies[joint.body[end]]
    return anchor_at(joint, end, body.x, body.y, body.angle)


@nonallocating
def size_of_anchor(bodies: Rows[Body], joint: Joint, end: int) -> float:
    """The size of the numbers whose sum is an `anchor`: its round-off is relative to these, also at the origin."""
    body, x, y = bodies[joint.body[end]], joint.anchor_a[0], joint.anchor_a[1]
    if end == 1:
        x, y = joint.anchor_b[0], joint.anchor_b[1]
    return float(abs(body.x) + abs(body.y) + abs(x) + abs(y))


@inlined
def is_round_off(dx: float, dy: float, size: float) -> bool:
    """Whether the distance of two points is round-off; `size`: the larger `size_of_anchor`."""
    return abs(dx) + abs(dy) <= STRAIGHT_CHAIN * size


@nonallocating
def list_points(bodies: Rows[Body], joint: Rows[Joint], X: FloatArray, HEAD: IntArray, NEXT: IntArray) -> None:
    """Fill in the places X[:, :2], and their `size_of_anchor` X[:, 2], of the points (2 j,) of all joints: point 2 i of
    joint i on its body a, 2 i + 1 on its body b, so that p ^ 1 is the other point of a joint. Points of joints that may
    be straight are listed by body: HEAD (n,) the first one, NEXT (2 j,) the following one, -1 for none, which both
    contain."""
    for j in range(len(joint)):
        for end in range(2):
            p, i = 2 * j + end, joint[j].body[end]
            X[p, 0], X[p, 1] = anchor(bodies, joint[j], end)
            X[p, 2] = size_of_anchor(bodies, joint[j], end)
            if reach(joint[j]) < math.inf:
                NEXT[p], HEAD[i] = HEAD[i], p


@nonallocating
def straight(X: FloatArray, first: int, p: int, length: float) -> bool:
    """Whether a chain of this length from the point `first` to p is straight."""
    dx, dy = X[p, 0] - X[first, 0], X[p, 1] - X[first, 1]
    size = length + max(abs(X[p, 0]), abs(X[p, 1]), abs(X[first, 0]), abs(X[first, 1]))
    return bool(abs(length - math.sqrt(dx * dx + dy * dy)) <= STRAIGHT_CHAIN * size)


@inlined
def in_one_place(X: FloatArray, p: int, q: int) -> bool:
    """Whether two points are one, but for round-off."""
    return is_round_off(X[q, 0] - X[p, 0], X[q, 1] - X[p, 1], max(X[p, 2], X[q, 2]))


@nonallocating
def fix_chain(
    joint: Rows[Joint], X: FloatArray, FROM: IntArray, p: int, first: int, spins: IntArray, kinds: IntArray
) -> int:
    """Hold the bodies of the straight chain from `first` that ends in p, on a fixed body; how many of them were free.

    FROM (2 j,): the point from which the chain has come to a point.
    """
    count, q = 0, p
    while FROM[q] != first:
        out, q = FROM[q], FROM[FROM[q]]
        i = joint[q // 2].body[q % 2]
        count += 1 if kinds[i] == FREE else 0
        if kinds[i] != WHOLLY:
            kinds[i] = spins[i] if in_one_place(X, q, out) else WHOLLY
    return count


@kernel
def hold_chains(bodies: Rows[Body], joint: Rows[Joint], still: IntArray, spins: IntArray, kinds: IntArray) -> int:
    """Hold the bodies of straight chains between fixed points, which are still or held; how many there are.

    A chain does not lead through a body whose points on it are in one place, if joints may turn it about that.

    Args:
        bodies (n,): at their present poses.  joint (j,).
        still (n,): 1 for bodies that never move, 0 for those that may be held, -1 for others.
        spins (n,): how a body is held whose points on the chain are in one place: CENTRE, WHOLLY if contacts may turn
            it, FREE, which is not at all, if joints may.
        kinds (n,): in and out, FREE, WHOLLY or CENTRE.
    """
    points, n = 2 * len(joint), len(bodies)
    X, LENGTH = np.empty((points, 3)), np.empty(points)
    HEAD, NEXT = np.full(n, -1, np.int64), np.full(points, -1, np.int64)
    FROM, SEEN, STACK = np.empty(points, np.int64), np.full(points, -1, np.int64), np.empty(points, np.int64)
    list_points(bodies, joint, X, HEAD, NEXT)
    total, found = 0, 1
    while found > 0:
        # Bodies held in one round hold others in the next.
        found, stamp = 0, -1
        SEEN[:] = -1
        for first in range(points):
            begin, across = joint[first // 2].body[first % 2], reach(joint[first // 2])
            if across == math.inf or (still[begin] <= 0 and kinds[begin] == FREE):
                continue
            stamp += 1
            FROM[first ^ 1], LENGTH[first ^ 1], STACK[0], room = first, across, first ^ 1, 1
            SEEN[first] = SEEN[first ^ 1] = stamp
            while room > 0:
                room -= 1
                p = STACK[room]
                i = joint[p // 2].body[p % 2]
                if still[i] < 0 or not straight(X, first, p, LENGTH[p]):
                    continue
                if still[i] > 0 or kinds[i] != FREE:
                    # Pivots that repeat one another at one point let bodies turn; none of them is singular.
                    found += 0 if in_one_place(X, first, p) else fix_chain(joint, X, FROM, p, first, spins, kinds)
                    continue
                q = HEAD[i]
                while q >= 0:
                    length = LENGTH[p] + math.sqrt((X[q, 0] - X[p, 0]) ** 2 + (X[q, 1] - X[p, 1]) ** 2)
                    leads = SEEN[q] < stamp and not (spins[i] == FREE and in_one_place(X, p, q))
                    if leads and straight(X, first, q, length):
                        SEEN[q] = SEEN[q ^ 1] = stamp  # 2^n chains of n doubled joints, else
                        FROM[q], FROM[q ^ 1], LENGTH[q ^ 1] = p, q, length + reach(joint[q // 2])
                        STACK[room] = q ^ 1
                        room += 1
                    q = NEXT[q]
        total += found
    return total

"""Who hangs together by joints, and in which order the unknowns of each island stand in its banded matrix.

A plan stays valid while the set of bodies and joints, their kinds, anchors and bodies, and what moves, stay the same.
Bodies that joints cannot move bind nothing: they are partners of several islands. Nodes of an island's graph are its
moved bodies (two or three unknowns) and its joints with impulses; they are ordered by reverse Cuthill-McKee.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..compiled.records import Rows
from ..model.bodies import Body
from .boxes import MANY
from .boxes import ROOM as BOX_ROOM
from .dual import STRIDE
from .layout import ANCHOR_AX, ANCHOR_AY, ANCHOR_BX, ANCHOR_BY, BODY_A, BODY_B, GEAR, GROOVE, KIND, MOTOR, SOFT
from .ordering import order_rows, order_unknowns
from .rows import row_count
from .scratch import (
    BAND,
    BODY_0,
    BODY_1,
    BOXES,
    DUAL_BAND,
    DUAL_SIZE,
    JOINT_0,
    JOINT_1,
    L_A,
    L_B,
    L_JOINT,
    L_KIND,
    L_ROWS,
    LOOPS,
    M_BODY,
    M_CAYLEY,
    M_FREEDOMS,
    RIGID,
    ROWS_OF,
    UNKNOWNS,
)

WIDE = 14  # half-width of the band from which on an island is condensed


@kernel
def root(parent: IntArray, i: int) -> int:
    """The representative of i in a forest, whose paths it halves."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel
def find_islands(bodies: Rows[Body], tie: IntArray, parent: IntArray, island: IntArray, joints: int) -> int:
    """Number the islands by their first joint; island[j] = -1 for a joint between bodies that nothing moves.

    `parent` (bodies,) and `island` (joints,) are filled in.
    """
    for i in range(len(parent)):
        parent[i] = i
    for j in range(joints):
        a, b = tie[j, BODY_A], tie[j, BODY_B]
        if moved(bodies, a) and moved(bodies, b):
            p, q = root(parent, a), root(parent, b)
            if p != q:
                parent[max(p, q)] = min(p, q)
    number = np.full(len(parent), -1, np.int64)
    count = 0
    for j in range(joints):
        a, b = tie[j, BODY_A], tie[j, BODY_B]
        island[j] = -1
        if moved(bodies, a) or moved(bodies, b):
            top = root(parent, a if moved(bodies, a) else b)
            if number[top] < 0:
                number[top] = count
                count += 1
            island[j] = number[top]
    return count


@kernel
def moved(bodies: Rows[Body], i: int) -> bool:
    """Whether joints can move body i."""
    return bool(bodies[i].inv_mass > 0.0 or bodies[i].inv_inertia > 0.0)


@kernel
def turning(
    bodies: Rows[Body], joint: FloatArray, tie: IntArray, joints: int, turns: IntArray, cayley: IntArray
) -> None:
    """Which bodies joints turn, and which of them take Cayley's turn: those held off their centre, and who is bound
    to one of these by its angle."""
    for j in range(joints):
        a, b, kind = tie[j, BODY_A], tie[j, BODY_B], tie[j, KIND]
        off_a = kind == GROOVE or (kind < GEAR and (joint[j, ANCHOR_AX] != 0.0 or joint[j, ANCHOR_AY] != 0.0))
        off_b = kind < GEAR and (joint[j, ANCHOR_BX] != 0.0 or joint[j, ANCHOR_BY] != 0.0)
        if bodies[a].inv_inertia > 0.0 and (off_a or kind >= GEAR):
            turns[a] = 1
            cayley[a] = max(cayley[a], 1 if off_a else 0)
        if bodies[b].inv_inertia > 0.0 and (off_b or kind >= GEAR):
            turns[b] = 1
            cayley[b] = max(cayley[b], 1 if off_b else 0)
    changed = True
    while changed:
        changed = False
        for j in range(joints):
            a, b = tie[j, BODY_A], tie[j, BODY_B]
            if tie[j, KIND] > GEAR and turns[a] == 1 and turns[b] == 1 and cayley[a] != cayley[b]:
                cayley[a] = cayley[b] = 1
                changed = True


@kernel
def make_plan(
    bodies: Rows[Body], joint: FloatArray, tie: IntArray, span: IntArray, member: IntArray, link: IntArray
) -> int:
    """Fill in `span` (joints, SPAN_COLUMNS), `member` (2 joints, ...), `link` (joints, ...); the number of islands."""
    joints = len(tie)
    parent, island = np.empty(len(bodies), np.int64), np.empty(joints, np.int64)
    count = find_islands(bodies, tie, parent, island, joints)
    turns, cayley = np.zeros(len(bodies), np.int64), np.zeros(len(bodies), np.int64)
    turning(bodies, joint, tie, joints, turns, cayley)
    room = np.zeros(count + 1, np.int64)
    for j in range(joints):
        if island[j] >= 0:
            room[island[j] + 1] += 1
    for s in range(count):
        room[s + 1] += room[s]
        span[s, JOINT_0], span[s, JOINT_1] = room[s], room[s]
    for j in range(joints):
        if island[j] >= 0:
            s = island[j]
            link[span[s, JOINT_1], L_JOINT] = j
            span[s, JOINT_1] += 1
    place = np.full(len(bodies), -1, np.int64)
    used = 0
    for s in range(count):
        span[s, BODY_0] = used
        binding, free = 0, 0
        for k in range(span[s, JOINT_0], span[s, JOINT_1]):
            j = link[k, L_JOINT]
            link[k, L_KIND], link[k, L_ROWS] = tie[j, KIND], row_count(tie[j, KIND])
            kind = tie[j, KIND]
            if row_count(kind) > 0:
                binding += 1
            for end in range(2):
                body = tie[j, BODY_A + end]
                if place[body] < span[s, BODY_0]:
                    place[body] = used
                    member[used, M_BODY], member[used, M_CAYLEY] = body, cayley[body]
                    freedoms = 3 if turns[body] == 1 else 2
                    member[used, M_FREEDOMS] = freedoms if moved(bodies, body) else 0
                    if moved(bodies, body):
                        free += 1
                    used += 1
                link[k, L_A + end] = place[body] - span[s, BODY_0]
        span[s, BODY_1] = used
        span[s, LOOPS] = cycles(link, member, span, s)
        for way in range(2):
            if way == 0 or (span[s, BAND] > WIDE and not discs(tie, link, span, s)):
                order_unknowns(span, member, link, s, way > 0)
        order_rows(span, member, link, s)
        cost = span[s, UNKNOWNS] * span[s, BAND] ** 2
        pays = 0 < span[s, DUAL_SIZE] * span[s, DUAL_BAND] ** 2 <= cost
        span[s, RIGID] = 0 if not pays else 2 if hard(tie, link, span, s) else 1
        bounded = 0
        for k in range(span[s, JOINT_0], span[s, JOINT_1]):
            if tie[link[k, L_JOINT], KIND] == MOTOR or tie[link[k, L_JOINT], SOFT] != 0:
                bounded += link[k, L_ROWS]
        span[s, BOXES] = bounded if bounded <= MANY else 0
    return count


@kernel
def discs(tie: IntArray, link: IntArray, span: IntArray, s: int) -> bool:
    """Whether a joint with two bounded impulses is in island s: condensed systems do not have those."""
    for k in range(span[s, JOINT_0], span[s, JOINT_1]):
        if tie[link[k, L_JOINT], SOFT] != 0 and link[k, L_ROWS] == 2:
            return True
    return False


@kernel
def hard(tie: IntArray, link: IntArray, span: IntArray, s: int) -> bool:
    """Whether all joints of island s hold exactly, those with limits included."""
    for k in range(span[s, JOINT_0], span[s, JOINT_1]):
        j = link[k, L_JOINT]
        if link[k, L_ROWS] == 0 or tie[j, KIND] == MOTOR or tie[j, SOFT] != 0:
            return False
    return True


@kernel
def cycles(link: IntArray, member: IntArray, span: IntArray, s: int) -> int:
    """Joints with impulses that close a cycle of the island's graph, all bodies that nothing moves being one node."""
    b0, n = span[s, BODY_0], span[s, BODY_1] - span[s, BODY_0]
    parent = np.arange(n + 1)
    count = 0
    for k in range(span[s, JOINT_0], span[s, JOINT_1]):
        if link[k, L_ROWS] == 0:
            continue
        a = link[k, L_A] if member[b0 + link[k, L_A], M_FREEDOMS] > 0 else n
        b = link[k, L_B] if member[b0 + link[k, L_B], M_FREEDOMS] > 0 else n
        p, q = root(parent, a), root(parent, b)
        if p == q:
            count += 1
        else:
            parent[p] = q
    return count


class Room(NamedTuple):
    """The most of anything that an island of a plan needs: bodies, joints, rows of a matrix, its entries, entries of a
    right side, and of scratch."""

    bodies: int
    joints: int
    rows: int
    matrix: int
    right: int
    scratch: int


def room_for(span: IntArray) -> Room:
    """Room for the largest islands of SPAN rows."""
    whole = span[:, UNKNOWNS] * (3 * span[:, BAND] + 1)
    n = span[:, BOXES]
    boxes = (n > 0) * (n + 1) * (span[:, UNKNOWNS] + span[:, ROWS_OF] + 2 * n + BOX_ROOM)
    dual = span[:, DUAL_SIZE] * (2 * span[:, DUAL_BAND] + 1)
    return Room(
        int((span[:, BODY_1] - span[:, BODY_0]).max(initial=1)),
        int((span[:, JOINT_1] - span[:, JOINT_0]).max(initial=1)),
        int(np.maximum(span[:, UNKNOWNS], span[:, DUAL_SIZE]).max(initial=1)),
        int(np.where(span[:, RIGID] > 0, np.maximum(whole, dual), whole).max(initial=1)),
        int(2 * (span[:, UNKNOWNS] + span[:, ROWS_OF]).max(initial=1)),
        int((STRIDE * span[:, DUAL_SIZE] + boxes).max(initial=1)),
    )

"""Who hangs together by joints, and in which order the unknowns of each island stand in its banded matrix.

A plan stays valid while the set of bodies and joints, their kinds, anchors and bodies, and what moves, stay the same.
Bodies that joints cannot move bind nothing: they are partners of several islands. Nodes of an island's graph are its
moved bodies (two or three unknowns) and its joints with impulses; they are ordered by reverse Cuthill-McKee.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel
from ..layout import II, IM
from .layout import ANCHOR_AX, ANCHOR_AY, ANCHOR_BX, ANCHOR_BY, BODY_A, BODY_B, GEAR, GROOVE, KIND, PIVOT, SOFT
from .rows import row_count
from .scratch import L_A, L_B, L_JOINT, L_KIND, L_ROW, L_ROWS

# SPAN: one row per island.
BODY_0, BODY_1, JOINT_0, JOINT_1 = 0, 1, 2, 3  # its slices of MEMBER and LINK
UNKNOWNS, BAND, LOOPS = 4, 5, 6  # size and half-width of its matrix; number of independent cycles of its graph
CONDENSED = 7  # 1 if the matrix has the bodies' unknowns alone
ROWS_OF = 8  # number of unknowns beside the matrix
SPAN_COLUMNS = 9
# MEMBER: one row per body of each island.
M_BODY, M_COLUMN, M_FREEDOMS, M_CAYLEY = 0, 1, 2, 3
MEMBER_COLUMNS = 4
WIDE = 14  # half-width of the band from which on an island is condensed


@kernel
def root(parent: IntArray, i: int) -> int:
    """The representative of i in a forest, whose paths it halves."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel
def find_islands(bodies: FloatArray, tie: IntArray, parent: IntArray, island: IntArray, joints: int) -> int:
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
def moved(bodies: FloatArray, i: int) -> bool:
    """Whether joints can move body i."""
    return bool(bodies[i, IM] > 0.0 or bodies[i, II] > 0.0)


@kernel
def turning(
    bodies: FloatArray, joint: FloatArray, tie: IntArray, joints: int, turns: IntArray, cayley: IntArray
) -> None:
    """Which bodies joints turn, and which of them take Cayley's turn: those held off their centre, and who is bound
    to one of these by its angle."""
    for j in range(joints):
        a, b, kind = tie[j, BODY_A], tie[j, BODY_B], tie[j, KIND]
        off_a = kind == GROOVE or (kind < GEAR and (joint[j, ANCHOR_AX] != 0.0 or joint[j, ANCHOR_AY] != 0.0))
        off_b = kind < GEAR and (joint[j, ANCHOR_BX] != 0.0 or joint[j, ANCHOR_BY] != 0.0)
        if bodies[a, II] > 0.0 and (off_a or kind >= GEAR):
            turns[a] = 1
            cayley[a] = max(cayley[a], 1 if off_a else 0)
        if bodies[b, II] > 0.0 and (off_b or kind >= GEAR):
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
def order_nodes(start: IntArray, near: IntArray, nodes: int, order: IntArray) -> None:
    """Reverse Cuthill-McKee order of a graph in compressed rows, from a node far out, ties by number."""
    level = np.empty(nodes, np.int64)
    placed = np.zeros(nodes, np.int64)
    count = 0
    for seed in range(nodes):
        if placed[seed] == 1:
            continue
        first = seed
        for sweep in range(4):  # the last sweep places
            for i in range(nodes):
                level[i] = -1
            head, tail = count, count + 1
            order[count] = first
            level[first] = 0
            while head < tail:
                i = order[head]
                head += 1
                begin = tail
                for s in range(start[i], start[i + 1]):
                    n = near[s]
                    if level[n] < 0:
                        level[n] = level[i] + 1
                        order[tail] = n
                        tail += 1
                for x in range(begin + 1, tail):  # by degree
                    n, y = order[x], x
                    while y > begin and start[order[y - 1] + 1] - start[order[y - 1]] > start[n + 1] - start[n]:
                        order[y] = order[y - 1]
                        y -= 1
                    order[y] = n
            if sweep == 3:
                for x in range(count, tail):
                    placed[order[x]] = 1
                count = tail
            else:
                first = order[tail - 1]
    for x in range(nodes // 2):
        keep = order[x]
        order[x] = order[nodes - 1 - x]
        order[nodes - 1 - x] = keep


@kernel
def order_unknowns(span: IntArray, member: IntArray, link: IntArray, s: int, condensed: bool) -> None:
    """Give the bodies and joints of island s their unknowns; fill in its size and band.

    In a condensed system the bodies come first, and joints are the edges between them.
    """
    b0, b1, j0, j1 = span[s, BODY_0], span[s, BODY_1], span[s, JOINT_0], span[s, JOINT_1]
    bodies, joints = b1 - b0, j1 - j0
    nodes = bodies if condensed else bodies + joints
    width = np.zeros(bodies + joints, np.int64)
    for i in range(bodies):
        width[i] = member[b0 + i, M_FREEDOMS]
    for k in range(joints):
        width[bodies + k] = link[j0 + k, L_ROWS]
    start = np.zeros(nodes + 1, np.int64)
    near = np.empty(6 * joints, np.int64)
    for fill in range(2):
        at = start.copy()
        for k in range(joints):
            a, b = link[j0 + k, L_A], link[j0 + k, L_B]
            for p in range(2 if condensed else 0, 3):
                u, v = (a, b) if p == 2 else (bodies + k, a if p == 0 else b)
                uncoupled = p == 2 and not condensed and link[j0 + k, L_KIND] == PIVOT
                if width[u] == 0 or width[v] == 0 or uncoupled:
                    continue
                if fill == 0:
                    start[u + 1] += 1
                    start[v + 1] += 1
                else:
                    near[at[u]], near[at[v]] = v, u
                    at[u] += 1
                    at[v] += 1
        if fill == 0:
            for i in range(nodes):
                start[i + 1] += start[i]
    order = np.empty(nodes, np.int64)
    order_nodes(start, near, nodes, order)
    first = np.zeros(bodies + joints, np.int64)
    total = 0
    for x in range(nodes):
        first[order[x]] = total
        total += width[order[x]]
    band = 2
    for u in range(nodes):
        for t in range(start[u], start[u + 1]):
            v = near[t]
            band = max(band, max(first[u] + width[u], first[v] + width[v]) - 1 - min(first[u], first[v]))
    span[s, UNKNOWNS], span[s, BAND], span[s, CONDENSED] = total, band, 1 if condensed else 0
    if condensed:
        for k in range(joints):
            first[bodies + k] = total
            total += width[bodies + k]
    for i in range(bodies):
        member[b0 + i, M_COLUMN] = first[i]
    for k in range(joints):
        link[j0 + k, L_ROW] = first[bodies + k]
    span[s, ROWS_OF] = total - span[s, UNKNOWNS]


@kernel
def make_plan(
    bodies: FloatArray, joint: FloatArray, tie: IntArray, span: IntArray, member: IntArray, link: IntArray
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
    return count


@kernel
def discs(tie: IntArray, link: IntArray, span: IntArray, s: int) -> bool:
    """Whether a joint with two bounded impulses is in island s: condensed systems do not have those."""
    for k in range(span[s, JOINT_0], span[s, JOINT_1]):
        if tie[link[k, L_JOINT], SOFT] != 0 and link[k, L_ROWS] == 2:
            return True
    return False


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

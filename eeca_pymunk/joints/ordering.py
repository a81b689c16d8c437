"""The order of a component's unknowns in its banded matrix: reverse Cuthill-McKee of the graph of bodies and joints."""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import kernel
from ..model.joints import CONDENSED, PIVOT, WHOLE, Joints
from ..rows.dissection import neighbours


@kernel
def order_nodes(start: IntArray, near: IntArray) -> IntArray:
    """The reverse Cuthill-McKee order (nodes,) of a graph (`..rows.dissection.neighbours`), from a node far out, ties
    by number."""
    nodes = len(start) - 1
    order = np.empty(nodes, np.int64)
    level = np.empty(nodes, np.int64)
    placed = np.zeros(nodes, np.int64)
    count = 0
    for seed in range(nodes):
        if placed[seed] == 1:
            continue
        first = seed
        for sweep in range(4):  # by breadth; each begins at the last node of the one before, the last one places
            level[:] = -1
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
        order[x], order[nodes - 1 - x] = order[nodes - 1 - x], order[x]
    return order


@kernel
def order_unknowns(J: Joints, s: int, condensed: bool) -> None:
    """Number the unknowns of the bodies and joints of component s (`column`, `first_row`); set the number of unknowns,
    the half-width of the band, and the number of unknowns outside the matrix (`impulses`).

    In a condensed system only bodies are nodes, and joints are the edges between them.
    """
    component, member, link = J.COMPONENT, J.JOINED, J.COUPLING
    b0, b1, j0, j1 = component[s].first_body, component[s].end_body, component[s].first_joint, component[s].end_joint
    bodies, joints = b1 - b0, j1 - j0
    nodes = bodies if condensed else bodies + joints
    width = np.zeros(bodies + joints, np.int64)
    for i in range(bodies):
        width[i] = member[b0 + i].freedoms
    for k in range(joints):
        width[bodies + k] = link[j0 + k].rows
    EDGE, edges = np.empty((3 * joints, 2), np.int64), 0
    for k in range(joints):
        a, b = link[j0 + k].body[0], link[j0 + k].body[1]
        for p in range(2 if condensed else 0, 3):
            u, v = (a, b) if p == 2 else (bodies + k, a if p == 0 else b)
            # A pivot bends by the turn of each body alone: its bodies are coupled by its rows only.
            uncoupled = p == 2 and not condensed and link[j0 + k].kind == PIVOT
            if width[u] > 0 and width[v] > 0 and not uncoupled:
                EDGE[edges, 0], EDGE[edges, 1] = u, v
                edges += 1
    start, near = neighbours(EDGE, edges, nodes)
    order = order_nodes(start, near)
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
    component[s].unknowns, component[s].band, component[s].system = total, band, CONDENSED if condensed else WHOLE
    if condensed:
        for k in range(joints):
            first[bodies + k] = total
            total += width[bodies + k]
    for i in range(bodies):
        member[b0 + i].column = first[i]
    for k in range(joints):
        link[j0 + k].first_row = first[bodies + k]
    component[s].impulses = total - component[s].unknowns


@kernel
def order_rows(J: Joints, s: int) -> None:
    """Number the unknowns of the joints of component s in a system of rows alone, in which joints on one body are
    coupled; set its size and band, and the lists of the joints on each body."""
    component, member, link = J.COMPONENT, J.JOINED, J.COUPLING
    b0, b1, j0, j1 = component[s].first_body, component[s].end_body, component[s].first_joint, component[s].end_joint
    joints = j1 - j0
    for i in range(b0, b1):
        member[i].first = -1
    for k in range(joints - 1, -1, -1):
        for end in range(2):
            i = b0 + link[j0 + k].body[end]
            link[j0 + k].following[end] = -1
            if link[j0 + k].rows > 0 and member[i].freedoms > 0:
                link[j0 + k].following[end] = member[i].first
                member[i].first = 2 * k + end
    EDGE, edges = np.empty((0, 2), np.int64), 0
    for fill in range(2):
        if fill == 1:
            EDGE, edges = np.empty((edges, 2), np.int64), 0
        for i in range(b0, b1):
            one = member[i].first
            while one >= 0:
                other = link[j0 + (one >> 1)].following[one & 1]
                while other >= 0:
                    if fill == 1:
                        EDGE[edges, 0], EDGE[edges, 1] = one >> 1, other >> 1
                    edges += 1
                    other = link[j0 + (other >> 1)].following[other & 1]
                one = link[j0 + (one >> 1)].following[one & 1]
    start, near = neighbours(EDGE, edges, joints)
    order = order_nodes(start, near)
    total, band = 0, 1
    for x in range(joints):
        link[j0 + order[x]].first_dual = total
        total += link[j0 + order[x]].rows
    for k in range(joints):
        for t in range(start[k], start[k + 1]):
            one, other = j0 + k, j0 + near[t]
            reach = link[one].first_dual + link[one].rows - 1 - link[other].first_dual
            band = max(band, reach)
    component[s].dual_size, component[s].dual_band = total, band

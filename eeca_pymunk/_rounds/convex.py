"""Distances between convex cores as pure array kernels: m pairs of polygons of up to K vertices each.

Vertices run counter-clockwise; shorter outlines repeat their last vertex, which adds edges of no length and changes
nothing. One vertex is a point, two are a segment. Lengths in the unit of the vertices; normals point from a to b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, rotated

_CLOSE = 1e-11  # distance relative to that of the shapes
_WIDTH = 1e-6  # of a common face relative to the shapes, below which it is one point


class Closest(NamedTuple):
    """`distance` (m,) of the cores, negative in overlap; `normal` (m, 2) unit; `point` (m, 2) of a's core.

    `axis_a`, `axis_b` (m, 2) are the outward normals of the edges along which the cores are farthest apart, and
    `apart_a`, `apart_b` (m,) how far; -inf for a core without edges.
    """

    distance: FloatArray
    normal: FloatArray
    point: FloatArray
    axis_a: FloatArray
    axis_b: FloatArray
    apart_a: FloatArray
    apart_b: FloatArray


def place(local: FloatArray, pose: FloatArray) -> FloatArray:
    """(m, K, 2) world vertices of outlines `local` (m, K, 2) about centres of mass at `pose` (m, 3): x, y, angle."""
    return pose[:, None, :2] + rotated(local, pose[:, 2, None])


def closest(a: FloatArray, b: FloatArray) -> Closest:
    """The closest points of cores a and b (m, K, 2), or where they overlap the way out that is shortest.

    Apart, some vertex is closest to some edge of the other: to its inside, where the normal is that of the edge, or to
    an end of it. In overlap the separating axes, normals of edges, give the depth: the largest of
    min_i (v_i - e_j) . n_j over the edges j of both.
    """
    of_b, of_a = _vertices_edges(a, b), _vertices_edges(b, a)
    m, K = a.shape[:2]
    rows = np.arange(m)
    squared = np.concatenate((of_b.squared.reshape(m, -1), of_a.squared.reshape(m, -1)), axis=1)
    which = np.argmin(squared, axis=1)
    least = squared[rows, which]
    mine = which < K * K  # a's vertex to b's edge
    distance = np.sqrt(least)
    normal, point = np.empty((m, 2)), np.empty((m, 2))
    for chosen, edges, sign in ((mine, of_b, -1.0), (~mine, of_a, 1.0)):
        r = np.flatnonzero(chosen)
        if len(r) == 0:
            continue
        i, j = np.divmod(which[r] % (K * K), K)
        offset = edges.offset[r, i, j]  # from the edge to the vertex
        out = edges.outward[r, j]
        inside = edges.inside[r, i, j]
        side = np.where((offset * out).sum(axis=1) >= 0.0, 1.0, -1.0)
        unit = offset / np.where(distance[r] > 0.0, distance[r], 1.0)[:, None]
        normal[r] = sign * np.where(inside[:, None], side[:, None] * out, unit)
        point[r] = a[r, i] if sign < 0.0 else b[r, i] - offset
    depth = np.concatenate((of_b.separation, of_a.separation), axis=1)
    axis = np.argmax(depth, axis=1)
    deepest = depth[rows, axis]
    # So close that round-off would tell the side, the axis does.
    size = np.abs(a[:, 0] - b[:, 0]).max(axis=1)
    over = np.flatnonzero(((deepest < 0.0) & (deepest > -np.inf)) | (distance <= _CLOSE * size))
    if len(over):
        j = axis[over]
        known = deepest[over] > -np.inf
        of = j < K
        n = np.where(of[:, None], -of_b.outward[over, j % K], of_a.outward[over, j % K])
        n[~known] = (1.0, 0.0)  # two points at one place
        normal[over] = n
        distance[over] = np.where(known, deepest[over], distance[over])
        # The vertex of a that is deepest in b, or the place of a's edge that b's deepest vertex is behind.
        height = np.einsum("mki,mi->mk", np.where(of[:, None, None], a[over], -b[over]), n)
        vertex = np.argmax(height, axis=1)
        r = np.arange(len(over))
        point[over] = np.where(of[:, None], a[over][r, vertex], b[over][r, vertex] - distance[over][:, None] * n)
    e_a, e_b = np.argmax(of_a.separation, axis=1), np.argmax(of_b.separation, axis=1)
    return Closest(
        distance, normal, point, of_a.outward[rows, e_a], of_b.outward[rows, e_b],
        of_a.separation[rows, e_a], of_b.separation[rows, e_b],
    )  # fmt: skip


class _Edges(NamedTuple):
    """Vertices i against edges j: offset (m, K, K, 2) from the edge, its square, whether the foot is inside the edge,
    the outward normals (m, K, 2), and (m, K) the separation of all vertices along each; -inf without length."""

    offset: FloatArray
    squared: FloatArray
    inside: BoolArray
    outward: FloatArray
    separation: FloatArray


def _vertices_edges(vertex: FloatArray, outline: FloatArray) -> _Edges:
    edge = np.roll(outline, -1, axis=1) - outline
    squared = (edge * edge).sum(axis=2)
    real = squared > 0.0
    length = np.sqrt(np.where(real, squared, 1.0))
    outward = np.stack((edge[..., 1], -edge[..., 0]), axis=2) / length[..., None]
    rel = vertex[:, :, None] - outline[:, None]
    along = np.einsum("mijk,mjk->mij", rel, edge) / np.where(real, squared, 1.0)[:, None]
    offset = rel - np.clip(along, 0.0, 1.0)[..., None] * edge[:, None]
    inside = (along > 0.0) & (along < 1.0) & real[:, None]
    height = np.einsum("mijk,mjk->mij", rel, outward).min(axis=1)
    return _Edges(offset, (offset * offset).sum(axis=3), inside, outward, np.where(real, height, -np.inf))


def common_face(
    a: FloatArray, b: FloatArray, normal: FloatArray, tolerance: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """The pairs (k,) whose cores face each other in parallel, within `tolerance` (m,), and the two ends (k, 2) of the
    part of a's face that b's is opposite to."""
    tangent = np.stack((-normal[:, 1], normal[:, 0]), axis=1)
    low = np.full(len(a), -np.inf)
    high = np.full(len(a), np.inf)
    top = np.zeros(len(a))
    size = np.zeros(len(a))
    for core, sign in ((a, 1.0), (b, -1.0)):
        height = sign * np.einsum("mki,mi->mk", core, normal)
        along = np.einsum("mki,mi->mk", core, tangent)
        most = height.max(axis=1)
        on = height >= (most - tolerance)[:, None]
        low = np.maximum(low, np.where(on, along, np.inf).min(axis=1))
        high = np.minimum(high, np.where(on, along, -np.inf).max(axis=1))
        size = np.maximum(size, np.ptp(along, axis=1))
        top = most if sign > 0.0 else top
    k = np.flatnonzero(high - low > _WIDTH * size)
    base = top[k, None] * normal[k]
    return k, base + low[k, None] * tangent[k], base + high[k, None] * tangent[k]

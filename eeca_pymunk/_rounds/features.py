"""Features of walls, and lengths: what distances of disks from static outlines are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..space.shapes import Shapes, Walls


def length(vectors: FloatArray) -> FloatArray:
    """(m,) Euclidean length of (m, 2) vectors; by columns, which numpy does faster than reductions over pairs."""
    result: FloatArray = np.sqrt(vectors[:, 0] * vectors[:, 0] + vectors[:, 1] * vectors[:, 1])
    return result


def distance_from_axes(points: FloatArray) -> FloatArray:
    """(m,) the larger of |x| and |y|: what the round-off of a coordinate is relative to."""
    result: FloatArray = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1]))
    return result


@dataclass(frozen=True)
class Feature:
    """What of a wall is nearest to a disk's centre, for m disks.

    Attributes:
        distance: (m,) signed, of the centre from the outline, negative inside.
        away: (m, 2) unit vector from the outline to the centre (out of the outline where the centre is inside).
        edge: (m,) flat index into `Walls` of the edge.  along: (m,) where on it, 0 at its start, 1 at its end.
        side: (m,) whether the edge's side is nearest; otherwise a vertex is.
    """

    distance: FloatArray
    away: FloatArray
    edge: IntArray
    along: FloatArray
    side: BoolArray


def nearest_feature(walls: Walls, wall: IntArray, center: FloatArray) -> Feature:
    """The side (exact normal of the edge) or the vertex (direction to it) of every wall nearest to a centre (m, 2).

    A centre inside a polygon leaves through the nearest side.
    """
    which, inside = _nearest_edge(walls, wall, center)
    rel = center - walls.flat_start.take(which, axis=0)
    edge, outward = walls.flat_edge.take(which, axis=0), walls.flat_outward.take(which, axis=0)
    height = rel[:, 0] * outward[:, 0] + rel[:, 1] * outward[:, 1]
    along = (rel[:, 0] * edge[:, 0] + rel[:, 1] * edge[:, 1]) / walls.flat_length_squared[which]
    side = inside | ((along > 0.0) & (along < 1.0))
    # The first of a segment's two edges serves both its sides: the sign of the height tells which.
    sign = np.where(inside | (height >= 0.0), 1.0, -1.0)
    distance = sign * height
    away = sign[:, None] * outward
    corner = np.flatnonzero(~side)
    if len(corner):
        offset = rel[corner] - np.clip(along[corner], 0.0, 1.0)[:, None] * edge[corner]
        to_vertex = length(offset)
        distance[corner] = to_vertex
        off = to_vertex > 0.0
        away[corner[off]] = offset[off] / to_vertex[off, None]
    return Feature(distance, away, which, along, side)


def disk_wall(shapes: Shapes, wall: IntArray, center: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Signed distance (m,) of a centre from an outline, negative inside, and unit vector (m, 2) toward the outline."""
    feature = nearest_feature(shapes.walls, wall, center)
    return feature.distance, -feature.away


def _nearest_edge(walls: Walls, wall: IntArray, center: FloatArray) -> tuple[IntArray, BoolArray]:
    """Flat index (m,) of the outline's edge nearest to the centre, and whether (m,) the centre is inside."""
    width = walls.start.shape[1]
    if width == 2:
        return width * wall, np.zeros(len(wall), bool)
    rel = center[:, None, :] - walls.start[wall]
    edge = walls.edge[wall]
    height = (rel * walls.outward[wall]).sum(axis=2)
    along = (rel * edge).sum(axis=2) / walls.length_squared[wall]
    offset = rel - np.clip(along, 0.0, 1.0)[..., None] * edge
    highest = np.argmax(height, axis=1)
    inside: BoolArray = height[np.arange(len(wall)), highest] < 0.0
    nearest = np.argmin((offset * offset).sum(axis=2), axis=1)
    return width * wall + np.where(inside, highest, nearest), inside

"""Pairs, gaps, normals and points of contact. Sole owner of the sign convention.

The normal n points from body a to body b (pymunk's arbiters do the same), the gap is negative in overlap. Row a is
the disk wherever the other shape is a wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymunk

from .bodies import BoolArray, FloatArray, IntArray
from .shapes import Shapes, Walls

ROUND_OFF = 1e-12  # of lengths, relative to positions and radii


@dataclass(frozen=True)
class Contacts:
    """The contacts of one step as a struct of arrays; m contacts.

    `body_a` and `body_b` are rows of `bodies`, the pymunk bodies. Normal, point and gap are those of the
    instant `time` inside the step at which the impulse acts; `gap` is that of the start of the step.
    """

    bodies: tuple[pymunk.Body, ...]
    body_a: IntArray  # (m,) rows of bodies
    body_b: IntArray  # (m,) rows of bodies
    normal: FloatArray  # (m, 2) unit, from a to b
    point: FloatArray  # (m, 2) length, halfway between the two surfaces
    gap: FloatArray  # (m,) length, at the start of the step, negative in overlap
    time: FloatArray  # (m,) time of the impulse after the start of the step

    def __len__(self) -> int:
        return len(self.gap)


@dataclass(frozen=True)
class Geometry:
    """Gap (m,) length and normal (m, 2) from a to b of every pair at one configuration; `center` (m, 2) is that of a.

    `radius` (m,) is that of a.
    """

    gap: FloatArray
    normal: FloatArray
    center: FloatArray
    radius: FloatArray

    @property
    def point(self) -> FloatArray:
        """(m, 2) length, halfway between the two surfaces."""
        result: FloatArray = self.center + (self.radius + 0.5 * self.gap)[:, None] * self.normal
        return result

    def take(self, which: IntArray) -> Geometry:
        """The geometry of the pairs `which`."""
        return Geometry(self.gap[which], self.normal[which], self.center[which], self.radius[which])


class Pairs:
    """The pairs of shapes that may touch, disk-disk first, then disk-wall.

    Args:
        shapes: the shapes of the space.
        first, second: (m,) indices of shapes; where one is a wall it is `second`.
    """

    def __init__(self, shapes: Shapes, first: IntArray, second: IntArray) -> None:
        self.shapes, self.first, self.second = shapes, first, second
        self.row_a: IntArray = shapes.row[first]
        self.row_b: IntArray = shapes.row[second]
        self.radius_a: FloatArray = shapes.radius[first]
        self.extent: FloatArray = self.radius_a + shapes.radius[second]
        self.wall: IntArray = shapes.wall[second]
        self.disks = int(np.count_nonzero(self.wall < 0))

    def __len__(self) -> int:
        return len(self.first)

    @property
    def elasticity(self) -> FloatArray:
        """(m,) the product of the two shapes' elasticities, as in pymunk."""
        result: FloatArray = self.shapes.elasticity[self.first] * self.shapes.elasticity[self.second]
        return result

    def take(self, which: BoolArray | IntArray) -> Pairs:
        """The pairs selected by a mask or by increasing indices."""
        return Pairs(self.shapes, self.first[which], self.second[which])

    @property
    def key(self) -> IntArray:
        """(m,) one number per pair, the same in every list of these shapes."""
        return pair_key(self.shapes, self.first, self.second)

    def at(self, position: FloatArray) -> Geometry:
        """Geometry with the bodies at (N, 2) `position`."""
        return self.between(position[self.row_a], position[self.row_b])

    def between(self, center_a: FloatArray, center_b: FloatArray) -> Geometry:
        """Geometry with the bodies of every pair at its own (m, 2) centres; walls stay where they are."""
        k = self.disks
        if k == len(self):
            distance, toward = _disk_disk(center_a, center_b)
        elif k == 0:
            distance, toward = _disk_wall(self.shapes, self.wall, center_a)
        else:
            d_disk, n_disk = _disk_disk(center_a[:k], center_b[:k])
            d_wall, n_wall = _disk_wall(self.shapes, self.wall[k:], center_a[k:])
            distance, toward = np.concatenate((d_disk, d_wall)), np.concatenate((n_disk, n_wall))
        return Geometry(distance - self.extent, toward, center_a, self.radius_a)


def pair_key(shapes: Shapes, first: IntArray, second: IntArray) -> IntArray:
    """(m,) one number per pair of shapes; every disk-disk pair comes before every disk-wall pair."""
    count = len(shapes)
    key: IntArray = first * count + second + np.where(shapes.is_disk[second], 0, count * count)
    return key


def length(vectors: FloatArray) -> FloatArray:
    """(m,) Euclidean length of (m, 2) vectors; by columns, which numpy does faster than reductions over pairs."""
    result: FloatArray = np.sqrt(vectors[:, 0] * vectors[:, 0] + vectors[:, 1] * vectors[:, 1])
    return result


def distance_from_axes(points: FloatArray) -> FloatArray:
    """(m,) the larger of |x| and |y|: what the round-off of a coordinate is relative to."""
    result: FloatArray = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1]))
    return result


def _disk_disk(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distance (m,) of two centres and unit vector (m, 2) from a to b; coincident centres get the x axis."""
    d = b - a
    distance = length(d)
    coincident = distance == 0.0
    if coincident.any():
        d[coincident] = (1.0, 0.0)
        return distance, d / np.where(coincident, 1.0, distance)[:, None]
    return distance, d / distance[:, None]


def touching(pairs: Pairs, position: FloatArray) -> FloatArray:
    """(m,) length below which a gap is round-off of positions and radii: the pair touches exactly."""
    return ROUND_OFF * (distance_from_axes(position[pairs.row_a]) + pairs.extent)


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
    rel = center - walls.flat_start[which]
    edge, outward = walls.flat_edge[which], walls.flat_outward[which]
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


def _disk_wall(shapes: Shapes, wall: IntArray, center: FloatArray) -> tuple[FloatArray, FloatArray]:
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

"""Pairs, gaps, normals and points of contact. Sole owner of the sign convention.

The normal n points from body a to body b (pymunk's arbiters do the same), the gap is negative in overlap. Body a is
dynamic.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..space.shapes import Shapes
from . import convex
from .features import disk_wall, distance_from_axes, length
from .geometry import Axis, Geometry

ROUND_OFF = 1e-12  # of lengths, relative to positions and radii
_CORNERS = 4.0  # times that, of corners placed by their angle
_ROCKING = 1e-6  # of the size, by which they may where the contact is not elastic
_PARALLEL = 16.0  # times the round-off, by which the ends of parallel faces may differ


class Pairs:
    """The pairs of shapes that may touch: disk-disk first, then disk-wall, then the others.

    Args:
        shapes: the shapes of the space.
        first, second: (m,) indices of shapes; the first one's body is dynamic.

    Attributes:
        disks, flat: number of the disk-disk pairs, and of these and the disk-wall pairs.
    """

    def __init__(self, shapes: Shapes, first: IntArray, second: IntArray) -> None:
        self.shapes, self.first, self.second = shapes, first, second
        # The list that `merged` made this one of, and where its pairs are.
        self._older: tuple[Callable[[], Pairs | None], IntArray] = (lambda: None), first
        self.row_a: IntArray = shapes.row[first]
        self.row_b: IntArray = shapes.row[second]
        self.radius_a: FloatArray = shapes.radius[first]
        self.extent: FloatArray = self.radius_a + shapes.radius[second]
        self.wall: IntArray = shapes.wall[second]
        if shapes.general:
            kind = _kind(shapes, first, second)
            self.disks, self.flat = int(np.count_nonzero(kind == 0)), int(np.count_nonzero(kind < 2))
        else:
            self.disks, self.flat = int(np.count_nonzero(self.wall < 0)), len(first)

    def __len__(self) -> int:
        return len(self.first)

    @property
    def elasticity(self) -> FloatArray:
        """(m,) the product of the two shapes' elasticities, as in pymunk, unless a collision handler says otherwise."""
        result: FloatArray = self.shapes.elasticity[self.first] * self.shapes.elasticity[self.second]
        for (i, j), restitution in self.shapes.rules.restitution.items():
            result[((self.first == i) & (self.second == j)) | ((self.first == j) & (self.second == i))] = restitution
        return result

    def take(self, which: BoolArray | IntArray) -> Pairs:
        """The pairs selected by a mask or by increasing indices."""
        return Pairs(self.shapes, self.first[which], self.second[which])

    @cached_property
    def key(self) -> IntArray:
        """(m,) one number per pair, the same in every list of these shapes."""
        return pair_key(self.shapes, self.first, self.second)

    def places_in(self, other: Pairs) -> IntArray:
        """(m,) where these pairs are in another list with increasing keys; -1 where it lacks one."""
        older, place = other._older
        if older() is self:
            return place
        if len(other) == 0:
            return np.full(len(self), -1)
        place = np.minimum(np.searchsorted(other.key, self.key), len(other) - 1)
        return np.where(other.key[place] == self.key, place, -1)

    def merged(self, more: Pairs) -> Pairs:
        """These pairs and those of `more` that are new, keys increasing as they do in both."""
        new = np.flatnonzero(more.places_in(self) < 0)
        at = np.searchsorted(self.key, more.key[new])
        first, second = np.insert(self.first, at, more.first[new]), np.insert(self.second, at, more.second[new])
        result = Pairs(self.shapes, first, second)
        result.key = np.insert(self.key, at, more.key[new])
        place = np.arange(len(self)) + np.cumsum(np.bincount(at, minlength=len(self)))[: len(self)]
        result._older = weakref.ref(self), place
        return result

    def at(self, position: FloatArray) -> Geometry:
        """Geometry with the bodies at (N, d) `position`."""
        return self.between(position.take(self.row_a, axis=0), position.take(self.row_b, axis=0))

    def between(self, pose_a: FloatArray, pose_b: FloatArray) -> Geometry:
        """Geometry with the bodies of every pair at its own (m, d) places; walls stay where they are."""
        k, n = self.disks, self.flat
        center = pose_a[:, :2]
        if k == len(self):
            distance, toward = _disk_disk(center, pose_b[:, :2])
        elif k == 0 and n == len(self):
            distance, toward = disk_wall(self.shapes, self.wall, center)
        else:
            distance, toward, center = np.empty(len(self)), np.empty((len(self), 2)), center.copy()
            distance[:k], toward[:k] = _disk_disk(center[:k], pose_b[:k, :2])
            distance[k:n], toward[k:n] = disk_wall(self.shapes, self.wall[k:n], center[k:n])
            if n < len(self):
                a, b = self.cores(n, pose_a[n:], pose_b[n:])
                distance[n:], toward[n:], center[n:] = convex.closest(a, b)[:3]
        return Geometry(distance - self.extent, toward, center, self.radius_a)

    def cores(self, start: int, pose_a: FloatArray, pose_b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(k, K, 2) world vertices of both shapes of the pairs from number `start` on, bodies at (k, 3) poses."""
        core = self.shapes.core
        return convex.place(core[self.first[start:]], pose_a), convex.place(core[self.second[start:]], pose_b)

    def axes(
        self, pose_a: FloatArray, pose_b: FloatArray, rate_a: FloatArray, rate_b: FloatArray, tolerance: FloatArray
    ) -> list[Axis]:
        """Three axes along which general pairs may be apart: the normal as it stands in space, and the normals of the
        edges of a and of b along which they are farthest apart, which turn with their bodies."""
        a, b = self.cores(0, pose_a, pose_b)
        near = convex.closest(a, b)
        r_a, r_b = a - pose_a[:, None, :2], b - pose_b[:, None, :2]
        v_a, v_b = (
            rate[:, None, :2] + rate[:, None, 2:] * np.stack((-r[..., 1], r[..., 0]), axis=2)
            for r, rate in ((r_a, rate_a), (r_b, rate_b))
        )

        def along(vectors: FloatArray, axis: FloatArray) -> FloatArray:
            result: FloatArray = np.einsum("mki,mi->mk", vectors, axis)
            return result

        n = near.normal
        gap = along(b, n)[:, None, :] - along(a, n)[:, :, None] - self.extent[:, None, None]
        rate = along(v_b, n)[:, None, :] - along(v_a, n)[:, :, None]
        m = len(self)
        found = [Axis(gap.reshape(m, -1), rate.reshape(m, -1), np.ones(m, bool))]
        least = np.minimum(near.distance - self.extent, 0.0) - tolerance
        for axis, apart, other, speed, base, own in (
            (near.axis_a, near.apart_a, b, v_b, pose_a, rate_a),
            (near.axis_b, near.apart_b, a, v_a, pose_b, rate_b),
        ):
            away = other - base[:, None, :2]
            height = along(away, axis)
            # The vertex that is nearest is `apart` from the edge; the others by so much more.
            gap = height - height.min(axis=1)[:, None] + (np.maximum(apart, -1e300) - self.extent)[:, None]
            turning = own[:, 2, None] * np.stack((-axis[:, 1], axis[:, 0]), axis=1)
            rate = along(speed - own[:, None, :2], axis) + along(away, turning)
            found.append(Axis(gap, rate, apart - self.extent >= least))
        return found

    def directions(self, at: Geometry, pose_a: FloatArray, pose_b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m, d) what a unit normal impulse is to bodies a (with the minus sign left out) and b: the normal and, with
        d = 3, its arm about the centre of mass. The relative velocity is u = J_b . v_b - J_a . v_a."""
        if pose_a.shape[1] == 2:
            return at.normal, at.normal
        point = at.point
        found = []
        for pose, shape in ((pose_a, self.first), (pose_b, self.second)):
            r = point - pose[:, :2]
            arm = r[:, 0] * at.normal[:, 1] - r[:, 1] * at.normal[:, 0]
            arm[self.shapes.is_disk[shape]] = 0.0  # up to round-off it is
            found.append(np.column_stack((at.normal, arm)))
        return found[0], found[1]

    def faces(self, at: Geometry, pose_a: FloatArray, pose_b: FloatArray) -> tuple[IntArray, Geometry]:
        """The pairs (k,) that face each other in parallel, up to round-off, and touch at two points.

        `at` is changed to the one end of the face; returns the geometry at the other end.
        """
        n = self.flat
        if n == len(self):
            return np.zeros(0, np.intp), at.take(np.zeros(0, np.intp))
        a, b = self.cores(n, pose_a[n:], pose_b[n:])
        size = self.larger_size[n:]
        tolerance = ROUND_OFF * _PARALLEL * (distance_from_axes(pose_a[n:]) + size)
        # A rocking that is lost anyway ends here; else it would end after infinitely many bounces.
        tolerance = np.where(self.elasticity[n:] < 1.0, np.maximum(tolerance, _ROCKING * size), tolerance)
        # In overlap every corner that is inside acts.
        tolerance += np.maximum(-at.gap[n:], 0.0)
        k, low, high = convex.common_face(a, b, at.normal[n:], tolerance)
        k = k + n
        at.center[k] = low
        return k, Geometry(at.gap[k], at.normal[k], high, at.radius[k])

    @property
    def larger_size(self) -> FloatArray:
        """(m,) the larger of the two shapes."""
        return np.maximum(self.shapes.size[self.first], self.shapes.size[self.second])


def _kind(shapes: Shapes, first: IntArray, second: IntArray) -> IntArray:
    """(m,) 0 for two disks, 1 for a disk and a wall, 2 for others."""
    disk = shapes.is_disk[first]
    kind: IntArray = np.where(disk & shapes.is_disk[second], 0, np.where(disk & (shapes.wall[second] >= 0), 1, 2))
    return kind


def pair_key(shapes: Shapes, first: IntArray, second: IntArray) -> IntArray:
    """(m,) one number per pair of shapes, ordered as `Pairs` are."""
    count = len(shapes)
    return first * count + second + _kind(shapes, first, second) * count**2


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
    size = pairs.extent
    if pairs.flat < len(pairs):
        size = np.where(np.arange(len(pairs)) < pairs.flat, size, _CORNERS * (size + pairs.larger_size))
    return ROUND_OFF * (distance_from_axes(position.take(pairs.row_a, axis=0)) + size)

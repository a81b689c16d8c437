"""Outlines of shapes in body coordinates, as steps use them; and those of a space as plain arrays, for drawing them at
the poses of a recording."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray, rotate_all
from ..errors import UnsupportedFeature
from .private import shapes as private_shapes

# Largest distance of a collinear vertex from the line of its neighbours, over the largest coordinate.
_STRAIGHT = 1e-12


@dataclass
class Outlines:
    """S shapes: the convex hulls of their vertices, rounded by their radius. One vertex is a disk, two a segment.

    Attributes:
        row: (S,) place of the shape's body among the recorded ones, -1 for static shapes.
        radius: (S,) length.  sensor: (S,) bool.
        count: (S,) vertices of each shape.
        vertex: (sum of count, 2) of all shapes one after the other, in body coordinates; in world ones if static.
    """

    row: IntArray = field(default_factory=lambda: np.zeros(0, np.intp))
    radius: FloatArray = field(default_factory=lambda: np.zeros(0))
    sensor: BoolArray = field(default_factory=lambda: np.zeros(0, bool))
    count: IntArray = field(default_factory=lambda: np.zeros(0, np.intp))
    vertex: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))

    def __len__(self) -> int:
        return len(self.row)

    @staticmethod
    def of(space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> Outlines:
        """The shapes of a space now; those of `bodies` move with them, all others stay."""
        place = {body: i for i, body in enumerate(bodies)}
        shapes = [(s, s.body) for s in space.shapes if s.body is not None]
        vertices: list[FloatArray] = []
        for shape, body in shapes:
            local = np.array(local_outline(shape), float)
            if body not in place:
                local = np.array([body.local_to_world((float(x), float(y))) for x, y in local])
            vertices.append(local)
        return Outlines(
            np.array([place.get(body, -1) for _, body in shapes], np.intp),
            np.array([getattr(shape, "radius", 0.0) for shape, _ in shapes], float),
            np.array([shape.sensor for shape, _ in shapes], bool),
            np.array([len(v) for v in vertices], np.intp),
            np.concatenate(vertices) if vertices else np.zeros((0, 2)),
        )

    @property
    def owner(self) -> IntArray:
        """The `row` of every vertex."""
        return np.repeat(self.row, self.count)

    def place(self, position: FloatArray, angle: FloatArray) -> FloatArray:
        """World coordinates of all vertices with the bodies at (N, 2) positions and (N,) angles."""
        return to_world(self.vertex, self.owner, position, angle)


def to_world(local: FloatArray, owner: IntArray, position: FloatArray, angle: FloatArray) -> FloatArray:
    """(V, 2) world coordinates of points of the bodies `owner` (V,); points of owner -1 are in world coordinates
    already."""
    world = local.copy()
    moved = np.flatnonzero(owner >= 0)
    row = owner[moved]
    world[moved] = position[row] + rotate_all(local[moved], angle[row])
    return world


def local_outline(shape: pymunk.Shape) -> list[tuple[float, ...]]:
    """Vertices in body coordinates, counter-clockwise: one of a circle (its centre), two of a segment, more of a
    polygon. UnsupportedFeature for other shapes."""
    outline = private_shapes.outline(shape)
    if outline is None:
        raise UnsupportedFeature(f"{shape} is neither a Circle, a Segment nor a Poly; replace it by one of them")
    return outline if len(outline) < 3 else corners(outline)


def corners(outline: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """A convex outline without vertices that are collinear with their neighbours, up to round-off. With two collinear
    edges, round-off would decide on which of them a point is nearest."""
    limit = _STRAIGHT * max([abs(c) for v in outline for c in v])
    kept: list[tuple[float, ...]] = []
    (ax, ay), ahead = outline[-1], (*outline[1:], outline[0])
    for (x, y), (bx, by) in zip(outline, ahead, strict=True):
        along = math.hypot(bx - ax, by - ay)
        if abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) > limit * along:
            kept.append((x, y))
            ax, ay = x, y
    return kept if len(kept) > 2 else outline

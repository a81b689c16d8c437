"""Shapes: arrays of a space's shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import UnsupportedFeature
from .bodies import Bodies
from .checks import check_friction, check_shape, shape_body, shape_radius


class Walls:
    """Static convex outlines, as padded arrays of edges in world coordinates; a segment is an outline of two edges.

    Outlines with fewer edges than the widest one repeat their first edge, which changes no distance.

    Attributes:
        start, edge, outward: (W, k, 2) first vertex, edge vector (length) and outward unit normal of every edge.
        length_squared: (W, k) length².  The same, prefixed `flat_`, as (W k,) edges.
    """

    def __init__(self, outlines: list[FloatArray]) -> None:
        width = max((len(o) for o in outlines), default=1)
        start = np.zeros((len(outlines), width, 2))
        end = np.zeros_like(start)
        for i, outline in enumerate(outlines):
            start[i], end[i] = outline[0], outline[1]
            start[i, : len(outline)], end[i, : len(outline)] = outline, np.roll(outline, -1, axis=0)
        self.start: FloatArray = start
        self.edge: FloatArray = end - start
        self.length_squared: FloatArray = np.maximum(np.sum(self.edge**2, axis=2), np.finfo(float).tiny)
        length = np.sqrt(self.length_squared)[..., None]
        # Counter-clockwise outlines (pymunk's hulls) have their outside on the right of every edge.
        self.outward: FloatArray = np.stack((self.edge[..., 1], -self.edge[..., 0]), axis=2) / length
        self.flat_start, self.flat_edge, self.flat_outward = (
            x.reshape(-1, 2) for x in (self.start, self.edge, self.outward)
        )
        self.flat_length_squared = self.length_squared.ravel()


@dataclass(frozen=True)
class Rules:
    """What collision handlers decide about pairs of shapes, for one step; pairs as (smaller, larger) index.

    `ignored`: pairs that do not collide.  `restitution`: of pairs that have another one than their shapes say.
    """

    ignored: frozenset[tuple[int, int]] = frozenset()
    restitution: Mapping[tuple[int, int], float] = field(default_factory=dict)


class Shapes:
    """The solid shapes of a space, one index each.

    Attributes:
        items: the pymunk shapes, by index.  rules: of this step.
        smooth: whether no pair has friction; if one has, it was to be ignored.
        row: (S,) the row of the shape's body in `Bodies`.
        radius: (S,) length; the rounding radius of a segment or polygon.
        elasticity: (S,).  lossy: whether any is below 1.
        is_disk: (S,) whether it is a circle about the centre of mass of a dynamic body.
        wall: (S,) index into `walls`, the outlines of static shapes; -1 for others.
        turning: (S,) whether it moves and is not such a disk.  general: whether any is: contacts then have arms.
        rank: (S,) 0 disks, 1 other dynamic shapes, 2 kinematic and 3 static ones.
        size: (S,) length, from the centre of mass to the farthest point.
        core: (S, K, 2) vertices about the centre of mass, shorter outlines repeat their last one; K = 0 if not general.
    """

    def __init__(self, space: pymunk.Space, bodies: Bodies, ignore: Sequence[str] = ()) -> None:
        self.rules = Rules()
        self.key: list[pymunk.Shape] = list(space.shapes)
        self.items: list[pymunk.Shape] = [s for s in self.key if not s.sensor]
        for shape in self.items:
            check_shape(shape, bodies)
        self.smooth = not check_friction(self.items, "friction" in ignore)
        owners = [shape_body(s) for s in self.items]
        self.row: IntArray = np.array([bodies.row[b] for b in owners], np.intp)
        self.radius: FloatArray = np.array([shape_radius(s) for s in self.items], float)
        self.elasticity: FloatArray = np.array([s.elasticity for s in self.items], float)
        self.lossy = bool((self.elasticity < 1.0).any())
        static, dynamic = bodies.static[self.row], bodies.dynamic[self.row]
        self.wall: IntArray = np.where(static, np.cumsum(static) - 1, -1)
        cores = [local_outline(s) for s in self.items]
        placed = zip(cores, owners, static, strict=True)
        self.walls = Walls([_in_world(core, owner) for core, owner, still in placed if still])
        cores = [core - bodies.center_of_gravity[row] for core, row in zip(cores, self.row, strict=True)]
        self.is_disk: BoolArray = dynamic & np.array([len(c) == 1 and not c.any() for c in cores], bool)
        self.rank: IntArray = np.where(self.is_disk, 0, np.where(dynamic, 1, np.where(static, 3, 2)))
        self.turning: BoolArray = (self.rank == 1) | (self.rank == 2)
        self.general = bool(self.turning.any())
        away = [np.hypot(*c.T).max() for c in cores]
        self.size: FloatArray = self.radius + np.array(away, float)
        width = max(len(c) for c in cores) if self.general else 0
        self.core: FloatArray = np.zeros((len(self.items), width, 2))
        if self.general:
            for padded, core in zip(self.core, cores, strict=True):
                padded[: len(core)], padded[len(core) :] = core, core[-1]

    def __len__(self) -> int:
        return len(self.items)


def local_outline(shape: pymunk.Shape) -> FloatArray:
    """(k, 2) vertices in body coordinates, counter-clockwise: k = 1 for a circle's centre, 2 for a segment's ends."""
    if isinstance(shape, pymunk.Circle):
        vertices = [shape.offset]
    elif isinstance(shape, pymunk.Segment):
        vertices = [shape.a, shape.b]
    elif isinstance(shape, pymunk.Poly):
        vertices = list(shape.get_vertices())
    else:
        raise UnsupportedFeature(f"{shape}: only circles, segments and polygons are known")
    return np.array(vertices, float)


def _in_world(local: FloatArray, owner: pymunk.Body) -> FloatArray:
    """(k, 2) world vertices of at least two; a circle is its centre twice."""
    local = np.repeat(local, 2, axis=0) if len(local) == 1 else local
    return np.array([owner.local_to_world((float(x), float(y))) for x, y in local], float)

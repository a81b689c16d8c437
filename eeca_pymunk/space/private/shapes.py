"""Private names of pymunk's shapes, read and moved; see `spaces`. The public properties take two to three times as
long."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import pymunk
from pymunk._chipmunk_cffi import lib

OF_LIBRARY = (
    "cpShapeGetElasticity", "cpShapeGetFriction", "cpShapeGetSurfaceVelocity", "cpShapeGetFilter",
    "cpShapeGetCollisionType",
    "cpSpaceReindexShapesForBody", "cpBodyUpdatePosition", "cpCircleShapeGetOffset", "cpSegmentShapeGetA",
    "cpSegmentShapeGetB", "cpPolyShapeGetCount", "cpPolyShapeGetVert", "cpShapeUpdate", "cpShapeCacheBB",
    "cpShapesCollide",
)  # fmt: skip


# Number of reindexings in a row at most: each leaves unused handles in a spatial hash, which a step of pymunk clears.
REINDEXINGS = 32


def surface(shape: Any) -> tuple[float, float, float, float, float]:
    """Radius, elasticity, friction and surface velocity of a shape."""
    c = shape._shape
    velocity = lib.cpShapeGetSurfaceVelocity(c)
    return float(shape.radius), lib.cpShapeGetElasticity(c), lib.cpShapeGetFriction(c), velocity.x, velocity.y


def filter_of(shape: pymunk.Shape) -> tuple[int, int, int]:
    """Group, categories and mask of a shape."""
    found = lib.cpShapeGetFilter(shape._shape)
    return found.group, found.categories, found.mask


def collision_types(shapes: Iterable[pymunk.Shape]) -> list[int]:
    """The collision types of shapes."""
    get = lib.cpShapeGetCollisionType
    return [get(shape._shape) for shape in shapes]


def outline(shape: pymunk.Shape) -> list[tuple[float, ...]] | None:
    """The vertices of a shape in body coordinates: of a circle its centre, of a segment two; None for other kinds."""
    c: Any = shape._shape
    if isinstance(shape, pymunk.Poly):
        vertex = lib.cpPolyShapeGetVert
        found = [vertex(c, i) for i in range(lib.cpPolyShapeGetCount(c))]
    elif isinstance(shape, pymunk.Circle):
        found = [lib.cpCircleShapeGetOffset(c)]
    elif isinstance(shape, pymunk.Segment):
        found = [lib.cpSegmentShapeGetA(c), lib.cpSegmentShapeGetB(c)]
    else:
        return None
    return [(v.x, v.y) for v in found]


def reindex(space: pymunk.Space, bodies: Iterable[Any]) -> None:
    """Move the shapes of bodies, given as `pointers`, to the poses of the bodies. See `REINDEXINGS`."""
    c, move = space._space, lib.cpSpaceReindexShapesForBody
    for body in bodies:
        move(c, body)


def forget_corrections(bodies: Iterable[Any]) -> None:
    """Clear pymunk's corrections of overlaps of bodies, given as `pointers`. pymunk stores each as a velocity, applies
    it when it moves the body next, and then sets it to 0; a move over dt = 0 therefore only clears it."""
    for body in bodies:
        lib.cpBodyUpdatePosition(body, 0.0)


def overlap(shapes: tuple[Any, Any], poses: Sequence[Sequence[float]]) -> bool:
    """Whether two shapes touch at these poses (x, y, angle, ...) of their bodies, which stay where they are."""
    for shape, (x, y, angle, *_) in zip(shapes, poses, strict=True):
        c, s = math.cos(angle), math.sin(angle)
        lib.cpShapeUpdate(shape._shape, pymunk.Transform(c, s, -s, c, x, y))
    count: int = lib.cpShapesCollide(shapes[0]._shape, shapes[1]._shape).count
    for shape in shapes:
        lib.cpShapeCacheBB(shape._shape)
    return count > 0

"""Packing: bodies and shapes of pymunk as the rows of BODY, SHAPE, LINK and VERTEX (`..model`)."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray, side_by_side
from ..compiled.records import Rows, from_bytes
from ..laying import lay_rows
from ..model.bodies import Body
from ..model.given import GivenShape
from ..model.shapes import Link, Shape
from .bodies import Bodies
from .checks import check_shape, shape_body, shape_radius
from .shapes import local_outline

_WORD = (1 << 64) - 1  # of a filter's numbers as 64 bits: equality and `&` ask for no more
_GIVEN = struct.Struct("2q3Q5dq")


class Record(NamedTuple):
    """What a shape says of itself, read once.

    Attributes:
        body: its own; the static one of the space if its own is not in the space, as `outside` says.
        vertices: in coordinates of `body`, counter-clockwise.
        numbers: rounding, elasticity, friction, surface velocity (2).  filter: group, categories, mask.
        given, points: the memory of a `GivenShape` of all that, and of its vertices.
    """

    body: pymunk.Body
    vertices: list[tuple[float, ...]]
    numbers: tuple[float, ...]
    filter: tuple[int, int, int]
    outside: bool
    given: bytes
    points: bytes


def read(shape: pymunk.Shape, ground: pymunk.Body | None = None) -> Record:
    """The record of a shape; one that stands where it is as a shape of `ground`, if given.

    Raises:
        ValueError, UnsupportedFeature: see `check_shape`.
    """
    numbers = (shape_radius(shape), shape.elasticity, shape.friction, *shape.surface_velocity)
    if shape.body is None or not all(map(isfinite, numbers)) or min(numbers[:3]) < 0.0:
        check_shape(shape)
    group, categories, mask = shape.filter
    words = group & _WORD, categories & _WORD, mask & _WORD
    body, outline = shape_body(shape), local_outline(shape)
    if ground is not None:
        place, taken = body.local_to_world, ground.world_to_local
        outline = [tuple(taken(place((v[0], v[1])))) for v in outline]
        body = ground
    given = _GIVEN.pack(0, len(outline), *words, *numbers, 0)
    points = struct.pack(f"{2 * len(outline)}d", *(c for v in outline for c in v))
    return Record(body, outline, numbers, words, ground is not None, given, points)


class Packed(NamedTuple):
    """Rows of a space's bodies and solid shapes.

    Attributes:
        shapes: the pymunk shapes, by row of SHAPE.  owner: (k,) places of their bodies in pymunk's order.
        row: (N,) row of BODY of each body in pymunk's order, -1 for static ones.
        BODY, SHAPE, LINK, VERTEX: see `..model`; poses and velocities are still 0.
        disks, dynamic: rows of BODY below which there are lone disks, and dynamic bodies.
    """

    shapes: tuple[pymunk.Shape, ...]
    owner: IntArray
    row: IntArray
    BODY: Rows[Body]
    SHAPE: Rows[Shape]
    LINK: Rows[Link]
    VERTEX: FloatArray
    disks: int
    dynamic: int


def pack(bodies: Bodies, state: FloatArray, shapes: Sequence[pymunk.Shape], records: Sequence[Record]) -> Packed:
    """The rows of `bodies` in the (N, 9) `state` and of their solid `shapes`."""
    GIVEN, k, N = bodies.placed(state), len(shapes), len(bodies)
    given = from_bytes(GivenShape, [record.given for record in records])
    given["owner"] = [bodies.row[record.body] for record in records]
    POINT: FloatArray = np.frombuffer(bytearray().join([record.points for record in records])).reshape(-1, 2)
    moving = N - int(np.count_nonzero(bodies.static))
    BODY, SHAPE, LINK, VERTEX, order = side_by_side(
        ((moving + 1,), Body.TYPE), ((k,), Shape.TYPE), ((k,), Link.TYPE), ((len(POINT), 4), np.float64),
        ((k + N + 2,), np.int64),
    )  # fmt: skip
    disks = lay_rows(GIVEN, given, POINT, BODY, SHAPE, LINK, VERTEX, order)
    used = int(LINK[k - 1].first + LINK[k - 1].vertices) if k else 0
    ordered = tuple([shapes[i] for i in order[:k].tolist()])
    dynamic = int(np.count_nonzero(bodies.dynamic))
    return Packed(
        ordered, given["owner"][order[:k]], GIVEN["row"].copy(), BODY, SHAPE, LINK, VERTEX[:used], disks, dynamic
    )

"""Packing: bodies and shapes of pymunk as the rows of BODY, SHAPE, LINK and VERTEX (`..model`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray, rotated, side_by_side
from ..compiled.records import Rows, put
from ..model.bodies import Body
from ..model.shapes import Link, Shape
from .bodies import ANGLE, POSITION, Bodies
from .checks import check_shape, shape_body, shape_radius
from .shapes import local_outline

_WORD = (1 << 64) - 1  # of a filter's numbers as 64 bits: equality and `&` ask for no more


class Record(NamedTuple):
    """What a shape says of itself, read once.

    `vertices`: in body coordinates, counter-clockwise.  `numbers`: the columns of SHAPE from ROUNDING to SURFACE_Y,
    SIZE still 0.  `filter`: those of LINK from GROUP to MASK.  `outside`: whether its body is not in the space, so that
    the vertices are in coordinates of the space's static body.
    """

    vertices: list[tuple[float, ...]]
    numbers: tuple[float, ...]
    filter: tuple[int, int, int]
    outside: bool = False


def read(shape: pymunk.Shape, ground: pymunk.Body | None = None) -> Record:
    """The record of a shape; one that stands where it is as a shape of `ground`, if given.

    Raises:
        ValueError, UnsupportedFeature: see `check_shape`.
    """
    numbers = (shape_radius(shape), 0.0, shape.elasticity, shape.friction, *shape.surface_velocity)
    if shape.body is None or not all(map(isfinite, numbers)) or min(numbers[:4]) < 0.0:
        check_shape(shape)
    group, categories, mask = shape.filter
    outline = local_outline(shape)
    if ground is not None:
        place, taken = shape_body(shape).local_to_world, ground.world_to_local
        outline = [tuple(taken(place((v[0], v[1])))) for v in outline]
    return Record(outline, numbers, (group & _WORD, categories & _WORD, mask & _WORD), ground is not None)


# Fields of a shape that its record gives, in the order of `Record.numbers`.
GIVEN = ("rounding", "extent", "elasticity", "friction", "surface_x", "surface_y")


@dataclass(frozen=True)
class Packed:
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
    ground_itself = bodies.row[bodies.space.static_body]
    owner: IntArray = np.array([bodies.row.get(shape_body(s), ground_itself) for s in shapes], np.intp)
    vertex, of_shape = outlines(bodies, state, owner, records)
    count = np.bincount(of_shape, minlength=len(shapes))
    first = np.cumsum(count) - count
    centred = (count == 1) & ~vertex[first].any(axis=1) if len(shapes) else np.zeros(0, bool)
    row, disks = _rows(bodies, owner, centred)
    ground = int(row.max(initial=-1)) + 1
    body_of = np.where(row[owner] < 0, ground, row[owner])
    order = np.argsort(body_of, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    by_row = np.argsort(rank[of_shape], kind="stable")
    k = len(order)
    BODY, SHAPE, LINK = side_by_side(((ground + 1,), Body.TYPE), ((k,), Shape.TYPE), ((k,), Link.TYPE))
    LINK["owner"], LINK["vertices"] = body_of[order], count[order]
    LINK["first"] = np.cumsum(count[order]) - count[order]
    filters = np.array([r.filter for r in records], np.uint64).reshape(-1, 3)
    put(LINK, filters.view(np.int64)[order], "group", "categories", "mask")
    VERTEX = with_normals(vertex[by_row], LINK)
    numbers = np.array([r.numbers for r in records], float).reshape(-1, len(GIVEN))[order]
    put(SHAPE, numbers, *GIVEN)
    bound(VERTEX[:, :2], LINK, SHAPE)
    moving = np.flatnonzero(row >= 0)
    BODY["inv_mass"][row[moving]], BODY["inv_inertia"][row[moving]] = (
        bodies.inverse_mass[moving],
        bodies.inverse_moment[moving],
    )
    BODY["due"] = -np.inf
    np.maximum.at(BODY["extent"], LINK["owner"], SHAPE["extent"])
    BODY["elasticity"][:disks], BODY["friction"][:disks] = SHAPE["elasticity"][:disks], SHAPE["friction"][:disks]
    ordered = tuple(shapes[i] for i in order.tolist())
    dynamic = int(np.count_nonzero(bodies.dynamic))
    return Packed(ordered, owner[order], row, BODY, SHAPE, LINK, VERTEX, disks, dynamic)


def outlines(
    bodies: Bodies, state: FloatArray, owner: IntArray, records: Sequence[Record]
) -> tuple[FloatArray, IntArray]:
    """(v, 2) vertices about the centres of mass, of static shapes in world coordinates, and (v,) their shapes."""
    vertex = np.array([v for r in records for v in r.vertices], float).reshape(-1, 2)
    of_shape = np.repeat(np.arange(len(records)), [len(r.vertices) for r in records])
    body = owner[of_shape]
    still = np.flatnonzero(bodies.static[body])
    placed = state[body[still]]
    world = placed[:, POSITION] + rotated(vertex[still], placed[:, ANGLE])
    vertex = vertex - bodies.center_of_gravity[body]
    vertex[still] = world
    # A segment of no length is a disk.
    repeats = (vertex[1:] == vertex[:-1]).all(axis=1) & (of_shape[1:] == of_shape[:-1])
    keep = np.flatnonzero(~np.concatenate((np.zeros(min(len(vertex), 1), bool), repeats)))
    return vertex[keep], of_shape[keep]


def _rows(bodies: Bodies, owner: IntArray, centred: BoolArray) -> tuple[IntArray, int]:
    """(N,) rows: lone disks, other dynamic bodies, kinematic ones, each in the order in which the space got them; and
    how many lone disks."""
    lone: BoolArray = bodies.dynamic & (np.bincount(owner, minlength=len(bodies)) == 1)
    lone[owner[~centred]] = False
    rank = np.where(lone, 0, np.where(bodies.dynamic, 1, 2))
    walk = np.flatnonzero(~bodies.static)
    if bodies.fixed:
        # pymunk walks them in another order once some have slept.
        place = {body: i for i, body in enumerate(bodies.space.bodies)}
        walk = walk[np.argsort([place[bodies.items[i]] for i in walk])] if len(walk) else walk
    row: IntArray = np.full(len(bodies), -1, np.int64)
    row[walk[np.argsort(rank[walk], kind="stable")]] = np.arange(len(walk))
    return row, int(np.count_nonzero(lone))


def with_normals(vertex: FloatArray, LINK: Rows[Link]) -> FloatArray:
    """(v, 4) vertices and the outward unit normals of the edges that begin there."""
    following = np.arange(1, len(vertex) + 1)
    following[LINK["first"] + LINK["vertices"] - 1] = LINK["first"]
    edge = vertex[following] - vertex
    length = np.hypot(edge[:, 0], edge[:, 1])
    # Counter-clockwise outlines (pymunk's hulls) have their outside on the right of every edge.
    normal = np.stack((edge[:, 1], -edge[:, 0]), axis=1) / np.where(length > 0, length, 1.0)[:, None]
    return np.concatenate((vertex, normal), axis=1)


def bound(vertex: FloatArray, LINK: Rows[Link], SHAPE: Rows[Shape]) -> None:
    """Fill in the sizes of shapes and the circles about the boxes of their vertices."""
    if len(SHAPE) == 0:
        return
    first = LINK["first"]
    centre = 0.5 * (np.minimum.reduceat(vertex, first) + np.maximum.reduceat(vertex, first))
    away = vertex - np.repeat(centre, LINK["vertices"], axis=0)
    put(SHAPE, centre, "centre_x", "centre_y")
    SHAPE["bound"] = SHAPE["rounding"] + np.maximum.reduceat(np.hypot(away[:, 0], away[:, 1]), first)
    SHAPE["extent"] = SHAPE["rounding"] + np.maximum.reduceat(np.hypot(vertex[:, 0], vertex[:, 1]), first)

"""Packing: bodies and shapes of pymunk as the rows of BODY, SHAPE, LINK and VERTEX (`layout.py`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray
from ..layout import (
    BODY_COLUMNS,
    BOUNCE,
    BOUND,
    CATEGORIES,
    CENTRE_X,
    CENTRE_Y,
    COUNT,
    DUE,
    ELASTICITY,
    EXTENT,
    FIRST,
    FRICTION,
    GRIP,
    GROUP,
    II,
    IM,
    LINK_COLUMNS,
    MASK,
    OWNER,
    ROUNDING,
    SHAPE_COLUMNS,
    SIZE,
    SURFACE_X,
    SURFACE_Y,
)  # fmt: skip
from .bodies import Bodies
from .checks import shape_body, shape_radius
from .shapes import local_outline

_WORD = (1 << 64) - 1  # of a filter's numbers as 64 bits: equality and `&` ask for no more


@dataclass(frozen=True)
class Packed:
    """Rows of a space's bodies and solid shapes.

    Attributes:
        shapes: the pymunk shapes, by row of SHAPE.
        row: (N,) row of BODY of each body in pymunk's order, -1 for static ones.
        BODY, SHAPE, LINK, VERTEX: see `layout.py`; poses and velocities are still 0.
        disks, dynamic: rows of BODY below which there are lone disks, and dynamic bodies.
    """

    shapes: tuple[pymunk.Shape, ...]
    row: IntArray
    BODY: FloatArray
    SHAPE: FloatArray
    LINK: IntArray
    VERTEX: FloatArray
    disks: int
    dynamic: int


def pack(bodies: Bodies, shapes: Sequence[pymunk.Shape]) -> Packed:
    """The rows of `bodies` and of their solid `shapes`, which have been checked."""
    owner: IntArray = np.array([bodies.row[shape_body(s)] for s in shapes], np.intp)
    outlines = [_outline(s, bodies, int(i)) for s, i in zip(shapes, owner, strict=True)]
    row, disks = _rows(bodies, owner, outlines)
    ground = int(row.max(initial=-1)) + 1
    body_of = np.where(row[owner] < 0, ground, row[owner])
    order = np.argsort(body_of, kind="stable")
    ordered = tuple(shapes[i] for i in order.tolist())
    outlines = [outlines[i] for i in order.tolist()]
    SHAPE, LINK = np.zeros((len(order), SHAPE_COLUMNS)), np.zeros((len(order), LINK_COLUMNS), np.int64)
    LINK[:, OWNER] = body_of[order]
    LINK[:, COUNT] = [len(o) for o in outlines]
    LINK[:, FIRST] = np.cumsum(LINK[:, COUNT]) - LINK[:, COUNT]
    VERTEX = np.concatenate([_edges(o) for o in outlines]) if outlines else np.zeros((0, 4))
    _describe(ordered, outlines, SHAPE, LINK)
    BODY = np.zeros((ground + 1, BODY_COLUMNS))
    moving = np.flatnonzero(row >= 0)
    BODY[row[moving], IM], BODY[row[moving], II] = bodies.inverse_mass[moving], bodies.inverse_moment[moving]
    BODY[:, DUE] = -np.inf
    np.maximum.at(BODY[:, EXTENT], LINK[:, OWNER], SHAPE[:, SIZE])
    BODY[:disks, BOUNCE], BODY[:disks, GRIP] = SHAPE[:disks, ELASTICITY], SHAPE[:disks, FRICTION]
    return Packed(ordered, row, BODY, SHAPE, LINK, VERTEX, disks, int(np.count_nonzero(bodies.dynamic)))


def _rows(bodies: Bodies, owner: IntArray, outlines: list[FloatArray]) -> tuple[IntArray, int]:
    """(N,) rows: lone disks, other dynamic bodies, kinematic ones, each in pymunk's order; and how many lone disks."""
    centred = np.array([len(o) == 1 and not o.any() for o in outlines], bool)
    lone: BoolArray = bodies.dynamic & (np.bincount(owner, minlength=len(bodies)) == 1)
    lone[owner[~centred]] = False
    rank = np.where(lone, 0, np.where(bodies.dynamic, 1, 2))
    walk = np.flatnonzero(~bodies.static)
    row: IntArray = np.full(len(bodies), -1, np.int64)
    row[walk[np.argsort(rank[walk], kind="stable")]] = np.arange(len(walk))
    return row, int(np.count_nonzero(lone))


def _outline(shape: pymunk.Shape, bodies: Bodies, i: int) -> FloatArray:
    """(k, 2) vertices, counter-clockwise, about the centre of mass of body number i; in world coordinates if static."""
    local = local_outline(shape)
    if bodies.static[i]:
        owner = bodies.items[i]
        return _simple(np.array([owner.local_to_world((float(x), float(y))) for x, y in local]))
    return _simple(local - bodies.center_of_gravity[i])


def _simple(outline: FloatArray) -> FloatArray:
    """Without vertices that stand on the one before: a segment of no length is a disk."""
    if len(outline) == 1:
        return outline
    return outline[[True, *(outline[1:] != outline[:-1]).any(axis=1)]]


def _edges(outline: FloatArray) -> FloatArray:
    """(k, 4) vertices and the outward unit normals of the edges that begin there."""
    edge = np.roll(outline, -1, axis=0) - outline
    length = np.hypot(edge[:, 0], edge[:, 1])
    # Counter-clockwise outlines (pymunk's hulls) have their outside on the right of every edge.
    normal = np.stack((edge[:, 1], -edge[:, 0]), axis=1) / np.where(length > 0, length, 1.0)[:, None]
    return np.concatenate((outline, normal), axis=1)


def _describe(shapes: Sequence[pymunk.Shape], outlines: list[FloatArray], SHAPE: FloatArray, LINK: IntArray) -> None:
    """Fill in what the shapes themselves say."""
    filters = [s.filter for s in shapes]
    for column, name in ((GROUP, "group"), (CATEGORIES, "categories"), (MASK, "mask")):
        LINK[:, column] = np.array([getattr(f, name) & _WORD for f in filters], np.uint64).view(np.int64)
    SHAPE[:, ROUNDING] = [shape_radius(s) for s in shapes]
    SHAPE[:, ELASTICITY] = [s.elasticity for s in shapes]
    SHAPE[:, FRICTION] = [s.friction for s in shapes]
    SHAPE[:, SURFACE_X : SURFACE_Y + 1] = np.array([s.surface_velocity for s in shapes], float).reshape(-1, 2)
    for i, outline in enumerate(outlines):
        centre = 0.5 * (outline.min(axis=0) + outline.max(axis=0))
        SHAPE[i, CENTRE_X : CENTRE_Y + 1] = centre
        SHAPE[i, BOUND] = SHAPE[i, ROUNDING] + np.hypot(*(outline - centre).T).max()
        SHAPE[i, SIZE] = SHAPE[i, ROUNDING] + np.hypot(*outline.T).max()

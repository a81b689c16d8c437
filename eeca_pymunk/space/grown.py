"""The grown space: a private pymunk space whose shapes are larger, so that pymunk reports what is near (design 7)."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import pymunk
from pymunk import batch

from .._rounds.contacts import Pairs, pair_key
from ..arrays import FloatArray, IntArray
from .checks import shape_body
from .shapes import Shapes, local_outline

Solid: TypeAlias = pymunk.Circle | pymunk.Segment | pymunk.Poly

_MOST_STATIC_CELLS = 200_000
_KINEMATIC, _STATIC = 2, 3  # ranks of shapes
_TABLE = 64  # entries per id up to which a table beats bisection


class GrownSpace:
    """A copy of every solid shape of a space, one body each, its radius grown by a margin of its own.

    Args:
        shapes: the shapes to copy.  moving: (D,) indices of those that move.  offset: (S, 2) of their centres of mass.
        pose: (D, 2) centres of mass, or (D, 3) with the angle.
        cell: length of the cells of a spatial hash; 0 for pymunk's tree.

    Attributes:
        hashed: whether pymunk indexes what moves by a hash; a hash that walls would fill is not made.
    """

    def __init__(self, shapes: Shapes, moving: IntArray, offset: FloatArray, pose: FloatArray, cell: float) -> None:
        self.shapes, self._moving = shapes, moving
        space = pymunk.Space()
        space.iterations = 1
        space.collision_persistence = 1  # no memory of old contacts
        self._space = space
        self._copies: dict[int, Solid] = {}
        of_body: dict[int, int] = {}
        self._walls: IntArray = np.flatnonzero(shapes.rank == _STATIC)
        for i in (*moving[_along_space(pose, cell)], *self._walls):
            shape = shapes.items[i]
            if shapes.rank[i] == _STATIC:
                owner = shape_body(shape)
                body = pymunk.Body(body_type=pymunk.Body.STATIC)
                body.position, body.angle = owner.position, owner.angle
                copy = _copy(shape, body, np.zeros(2))
            else:
                # pymunk drops pairs of two bodies of infinite mass: kinematic ones are carried by dynamic ones here.
                copy = _copy(shape, pymunk.Body(1.0, 1.0), offset[i])
                body = copy.body  # type: ignore[assignment]
            self._copies[int(i)] = copy
            copy.filter = shape.filter
            copy.sensor = True  # found, but not solved for
            space.add(body, copy)
            of_body[body.id] = int(i)
        self.hashed = cell > 0.0 and self._use_hash(cell)
        self._buffer, self._out = batch.Buffer(), batch.Buffer()
        self._fields = batch.BodyFields.POSITION
        if pose.shape[1] == 3:
            self._fields |= batch.BodyFields.ANGLE
        batch.get_space_bodies(space, batch.BodyFields.BODY_ID | self._fields, self._buffer)
        ids = np.frombuffer(self._buffer.int_buf(), dtype=np.uintp).astype(np.intp)
        self._poses: FloatArray = np.frombuffer(self._buffer.float_buf()).reshape(-1, pose.shape[1]).copy()
        order = np.array([of_body.get(int(i), -1) for i in ids], np.intp)
        # Where each moving shape stands in pymunk's walk over the bodies.
        slot = {shape: place for place, shape in enumerate(order)}
        self._slot: IntArray = np.array([slot[int(i)] for i in moving], np.intp)
        self._shape_of = _Lookup(ids, order)

    def _use_hash(self, cell: float) -> bool:
        boxes = [self._copies[int(i)].bb for i in self._walls]
        cells = sum(((b.right - b.left) / cell + 1.0) * ((b.top - b.bottom) / cell + 1.0) for b in boxes)
        # A hash puts a wall into every cell of its bounding box; where that is too many the tree is the better index.
        if cells >= _MOST_STATIC_CELLS:
            return False
        self._space.use_spatial_hash(cell, 4 * len(self._moving))
        return True

    def grow(self, which: IntArray, margin: FloatArray) -> None:
        """Give the moving shapes number `which` (m,) margins (m,), length."""
        index = self._moving[which]
        radius = self.shapes.radius[index] + margin
        for i, r in zip(index.tolist(), radius.tolist(), strict=True):
            self._copies[i].unsafe_set_radius(r)

    def grow_walls(self, margin: float) -> None:
        """Give all walls one margin, length."""
        for i in self._walls.tolist():
            # Added anew: pymunk's tree pairs a static shape that grew in place with no disk that stays in its leaf.
            wall = self._copies[i]
            self._space.remove(wall)
            wall.unsafe_set_radius(float(self.shapes.radius[i]) + margin)
            self._space.add(wall)

    def find(self, pose: FloatArray) -> Pairs:
        """The pairs of overlapping grown shapes, those that move at `pose` (D, 2 or 3), sorted by `Pairs.key`."""
        self._poses[self._slot] = pose
        self._out.set_float_buf(self._poses.reshape(-1))
        batch.set_space_bodies(self._space, self._fields, self._out)
        self._space.step(1.0)
        self._buffer.clear()
        fields = batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID
        batch.get_space_arbiters(self._space, fields, self._buffer)
        ids = np.frombuffer(self._buffer.int_buf(), dtype=np.uintp).astype(np.intp)
        found = self._shape_of(ids).reshape(-1, 2)
        # What moves by itself comes before what does not, and the lower index before the higher; walls never meet.
        shapes = self.shapes
        low, high = np.minimum(found[:, 0], found[:, 1]), np.maximum(found[:, 0], found[:, 1])
        first = np.where(shapes.rank[low] <= shapes.rank[high], low, high)
        second = low + high - first
        keep = shapes.row[first] != shapes.row[second]
        if shapes.general:
            keep &= shapes.rank[first] < _KINEMATIC
        keep = np.flatnonzero(keep)
        # pymunk lists arbiters by memory address, and results must not depend on it.
        order = keep[np.argsort(pair_key(shapes, first[keep], second[keep]))]
        return Pairs(shapes, first[order], second[order])


class _Lookup:
    """Maps pymunk's body ids to values. Ids are addresses: a table where they lie close together, else bisection."""

    def __init__(self, ids: IntArray, values: IntArray) -> None:
        order = np.argsort(ids)
        self._ids, self._values = ids[order], values[order]
        self._low = int(ids.min()) if len(ids) else 0
        steps = ids - self._low
        self._stride = max(int(np.gcd.reduce(steps)), 1) if len(ids) else 1
        self._table: IntArray | None = None
        size = int(steps.max(initial=0)) // self._stride + 1
        if size <= _TABLE * (len(ids) + 1000):
            self._table = np.zeros(size, np.intp)
            self._table[steps // self._stride] = values

    def __call__(self, ids: IntArray) -> IntArray:
        if self._table is not None:
            return self._table[(ids - self._low) // self._stride]
        return self._values[np.searchsorted(self._ids, ids)]


def _along_space(center: FloatArray, cell: float) -> IntArray:
    """(D,) an order in which neighbours in a hash are neighbours in memory, which its cache is for."""
    if cell == 0.0:
        return np.arange(len(center))
    column, row = np.floor(center[:, :2] / (4.0 * cell)).T
    return np.lexsort((column, row))


def _copy(shape: pymunk.Shape, body: pymunk.Body, offset: FloatArray) -> Solid:
    """The shape on another body, moved by minus `offset` in body coordinates."""
    vertices = [(float(x), float(y)) for x, y in local_outline(shape) - offset]
    if isinstance(shape, pymunk.Circle):
        return pymunk.Circle(body, shape.radius, vertices[0])
    if isinstance(shape, pymunk.Segment):
        return pymunk.Segment(body, vertices[0], vertices[1], shape.radius)
    assert isinstance(shape, pymunk.Poly)  # check_shape let nothing else through
    return pymunk.Poly(body, vertices, radius=shape.radius)

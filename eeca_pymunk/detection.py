"""Detection: pymunk finds the pairs that may touch, in a private space with grown shapes (design section 7).

pymunk reports a contact only where shapes overlap. The margin twin holds a copy of every solid shape, one twin body
each, its radius grown by a margin of its own; the arbiters of the twin are then the pairs whose gap is below the sum
of their margins. The list is a Verlet list: it stays complete until some shape has used its margin up.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import pymunk
from pymunk import batch

from .bodies import Bodies, FloatArray, IntArray
from .contacts import Pairs, distance_from_axes, length, pair_key
from .shapes import Shapes, shape_body

Solid: TypeAlias = pymunk.Circle | pymunk.Segment | pymunk.Poly

_HASH_FROM = 200  # moving shapes from which a spatial hash pays (measured: equal cost near 150)
_MOST_STATIC_CELLS = 200_000
_FOLLOWED_BY = 16  # walls up to which growing them costs less than following the mean motion saves
_LARGEST_TABLE = 1_000_000
_WIDEST = 20.0  # cells that the margin of one disk may span in a hash


class MarginTwin:
    """Candidate pairs of a space's shapes. Rebuild it when shapes come, go or change.

    Margins are powers of sqrt(2) times a thousandth of the radius, and a disk's margin follows its own speed, so that
    one fast disk does not make neighbours of everybody.
    """

    steps_ahead = 6.0  # steps a list should last where that asks for less than `lazy` radii
    lazy = 0.05

    def __init__(self, bodies: Bodies, shapes: Shapes, state: FloatArray) -> None:
        self.bodies, self.shapes = bodies, shapes
        self.detections = 0
        self._static = state[bodies.static, :3]
        self._disk: IntArray = np.flatnonzero(shapes.is_disk)
        self._row: IntArray = shapes.row[self._disk]
        self._unit: FloatArray = 1e-3 * np.maximum(shapes.radius[self._disk], np.finfo(float).tiny)
        self._follows = len(shapes) - len(self._disk) <= _FOLLOWED_BY < len(self._disk)
        # The disk of every body that has one; of several on one body the one whose margin is used up first is unknown,
        # so all of them share the smallest.
        self._disk_of: IntArray = np.zeros(len(bodies), np.intp)
        self._disk_of[self._row] = np.arange(len(self._row))
        self._center: FloatArray | None = None
        self._drift: FloatArray = np.zeros(2)
        self._reach: FloatArray = np.zeros(len(self._row))
        self._room = self._reach
        self._pairs = Pairs(shapes, np.zeros(0, np.intp), np.zeros(0, np.intp))
        self._buffer, self._out = batch.Buffer(), batch.Buffer()
        self._hashed = len(self._disk) >= _HASH_FROM
        self._cell = 5.0 * float(np.median(self.shapes.radius[self._disk])) if self._hashed else 0.0
        self._build()

    def _build(self) -> None:
        self._margin: FloatArray = np.zeros(len(self._disk))
        self._wall_margin = 0.0
        self._walls: list[tuple[int, Solid]] = []
        space = pymunk.Space()
        space.iterations = 1
        # No push-out and no memory of old contacts: a step of the twin moves nothing and keeps only what it found.
        space.collision_bias = 1.0
        space.collision_persistence = 1
        self._circles: list[pymunk.Circle] = []
        of_body: dict[int, int] = {}
        for i, shape in enumerate(self.shapes.items):
            owner = shape_body(shape)
            disk = bool(self.shapes.is_disk[i])
            twin = pymunk.Body(1.0, 1.0) if disk else pymunk.Body(body_type=pymunk.Body.STATIC)
            twin.position, twin.angle = owner.position, owner.angle
            copy = _copy(shape, twin)
            copy.filter = shape.filter
            space.add(twin, copy)
            of_body[twin.id] = i
            if disk:
                assert isinstance(copy, pymunk.Circle)  # check_shape lets only circles move
                self._circles.append(copy)
            else:
                self._walls.append((i, copy))
        if self._hashed:
            self._hashed = self._use_hash(space)
        self._space = space
        self._buffer.clear()
        batch.get_space_bodies(space, batch.BodyFields.BODY_ID | batch.BodyFields.POSITION, self._buffer)
        ids = np.frombuffer(self._buffer.int_buf(), dtype=np.uintp).astype(np.intp)
        self._positions: FloatArray = np.frombuffer(self._buffer.float_buf()).reshape(-1, 2).copy()
        order = np.array([of_body.get(int(i), -1) for i in ids], np.intp)
        # Where each disk stands in pymunk's walk over the twin's bodies.
        slot = {shape: place for place, shape in enumerate(order)}
        self._slot: IntArray = np.array([slot[int(i)] for i in self._disk], np.intp)
        self._shape_of = _Lookup(ids, order)

    def _use_hash(self, space: pymunk.Space) -> bool:
        cell = self._cell
        boxes = [s.bb for s, disk in zip(self.shapes.items, self.shapes.is_disk, strict=True) if not disk]
        cells = sum(((b.right - b.left) / cell + 1.0) * ((b.top - b.bottom) / cell + 1.0) for b in boxes)
        # A hash puts a wall into every cell of its bounding box; where that is too many the tree is the better index.
        if cells >= _MOST_STATIC_CELLS:
            return False
        space.use_spatial_hash(cell, 4 * len(self._disk))
        return True

    def is_current(self, state: FloatArray) -> bool:
        """False when a static body was moved since the twin was built."""
        return bool(np.array_equal(self._static, state[self.bodies.static, :3]))

    def candidates(self, position: FloatArray, displacement: FloatArray, slack: FloatArray) -> Pairs:
        """Every pair whose gap can close within a step, sorted by `Pairs.key`.

        Gaps close by relative motion alone: reaches and margins are taken in the frame that moves with the disks on
        average, in which a falling crowd hardly moves and the walls do.

        Args:
            position: (N, 2) of the bodies at the start of the step.
            displacement: (N, 2) of the bodies over the step.
            slack: (N,) length by which a path may leave the straight line of its displacement.
        """
        center, moving = position[self._row], displacement[self._row]
        self._drift = moving.mean(axis=0) if self._follows and len(moving) else np.zeros(2)
        self._reach = length(moving - self._drift) + slack[self._row]
        if self._used_up(center):
            self._detect(center)
        return self._pairs

    def covers(self, rows: IntArray, displacement: FloatArray, slack: FloatArray) -> bool:
        """Whether the list stays complete when the bodies `rows` (m,) take other paths in the step it was asked for.

        Args:
            displacement: (m, 2) of these bodies over the step.  slack: (m,) length, as in `candidates`.
        """
        disk = self._disk_of[rows]
        reach = length(displacement - self._drift) + slack
        self._reach[disk] = np.maximum(self._reach[disk], reach)
        return bool((reach <= self._room[disk]).all())

    def widen(self, position: FloatArray) -> Pairs:
        """The candidates of the step, bodies at `position` (N, 2) at its start, for all that `covers` was asked."""
        self._detect(position[self._row])
        return self._pairs

    def _used_up(self, center: FloatArray) -> bool:
        if self._center is None:
            return True
        moved = center - self._center
        frame = moved.mean(axis=0) if self._follows and len(moved) else np.zeros(2)
        walls = math.hypot(*frame) + math.hypot(*self._drift)
        # What is left of every margin for the paths of this step.
        self._room = self._margin - length(moved - frame)
        return walls > self._wall_margin or bool((self._reach > self._room).any())

    def _detect(self, center: FloatArray) -> None:
        reach, radius = self._reach, self.shapes.radius[self._disk]
        need = np.maximum(reach, np.minimum(self.steps_ahead * reach, self.lazy * radius))
        # The relative 1e-9 keeps a pair that exactly reaches its margin, and covers round-off of far-away positions.
        floor = 1e-9 * (distance_from_axes(center) + radius)
        need = np.maximum(need + floor, self._unit)
        level = self._unit * np.exp2(0.5 * np.ceil(2.0 * np.log2(need / self._unit)))
        if self._hashed and level.max(initial=0.0) > _WIDEST * self._cell:
            # A hash would put a disk this fast into more cells than there is time for.
            self._hashed = False
            self._build()
        changed = (level > self._margin) | (level < 0.25 * self._margin)
        for i in np.flatnonzero(changed):
            self._circles[i].unsafe_set_radius(float(radius[i] + level[i]))
        self._margin[changed] = level[changed]
        self._grow_walls(math.hypot(*self._drift))
        self._positions[self._slot] = center
        self._out.set_float_buf(self._positions.reshape(-1))
        batch.set_space_bodies(self._space, batch.BodyFields.POSITION, self._out)
        self._space.step(1.0)
        self._pairs = self._read_pairs()
        self._center, self._room = center.copy(), self._margin
        self.detections += 1

    def _grow_walls(self, drift: float) -> None:
        """Give the walls the margin that the moving frame asks of them, for some steps of `drift` (length)."""
        if 4.0 * drift <= self._wall_margin <= 64.0 * drift:
            return
        self._wall_margin = 16.0 * drift
        for i, wall in self._walls:
            # Added anew: pymunk's tree pairs a static shape that grew in place with no disk that stays in its leaf.
            self._space.remove(wall)
            wall.unsafe_set_radius(float(self.shapes.radius[i]) + self._wall_margin)
            self._space.add(wall)

    def _read_pairs(self) -> Pairs:
        self._buffer.clear()
        fields = batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID
        batch.get_space_arbiters(self._space, fields, self._buffer)
        ids = np.frombuffer(self._buffer.int_buf(), dtype=np.uintp).astype(np.intp).reshape(-1, 2)
        found = self._shape_of(ids)
        # A disk comes before a wall, and the lower index before the higher; walls never meet.
        is_disk = self.shapes.is_disk
        low, high = np.minimum(found[:, 0], found[:, 1]), np.maximum(found[:, 0], found[:, 1])
        first = np.where(is_disk[low], low, high)
        second = low + high - first
        keep = np.flatnonzero(self.shapes.row[first] != self.shapes.row[second])
        # pymunk lists arbiters by memory address, and results must not depend on it.
        order = keep[np.argsort(pair_key(self.shapes, first[keep], second[keep]))]
        return Pairs(self.shapes, first[order], second[order])


class _Lookup:
    """Maps pymunk's body ids to values. Ids are addresses: a table where they lie close together, else bisection."""

    def __init__(self, ids: IntArray, values: IntArray) -> None:
        order = np.argsort(ids)
        self._ids, self._values = ids[order], values[order]
        self._low = int(ids.min()) if len(ids) else 0
        steps = ids - self._low
        self._stride = max(int(np.gcd.reduce(steps)), 1) if len(ids) else 1
        self._table: IntArray | None = None
        if int(steps.max(initial=0)) // self._stride < _LARGEST_TABLE:
            self._table = np.zeros(int(steps.max(initial=0)) // self._stride + 1, np.intp)
            self._table[steps // self._stride] = values

    def __call__(self, ids: IntArray) -> IntArray:
        if self._table is not None:
            return self._table[(ids - self._low) // self._stride]
        return self._values[np.searchsorted(self._ids, ids)]


def _copy(shape: pymunk.Shape, twin: pymunk.Body) -> Solid:
    if isinstance(shape, pymunk.Circle):
        return pymunk.Circle(twin, shape.radius, shape.offset)
    if isinstance(shape, pymunk.Segment):
        return pymunk.Segment(twin, shape.a, shape.b, shape.radius)
    assert isinstance(shape, pymunk.Poly)  # check_shape let nothing else through
    return pymunk.Poly(twin, shape.get_vertices(), radius=shape.radius)

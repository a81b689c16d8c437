"""HandledPairs: pairs of shapes that have collision handlers, as rows for the kernel `rehearsing.any_near`.

pymunk calls handlers of pairs that overlap at the end of free flight, or whose arbiters it keeps from earlier steps. If
there are neither, a rehearsal would call no handler.
"""

from __future__ import annotations

import math
from itertools import chain, product
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import pymunk

from ..arrays import IntArray
from ..compiled.records import Rows, from_bytes, packer
from ..layout import BODY_ROW
from ..model.shapes import HandledShape
from .edits import type_changes
from .packing import ShapeRecord
from .private import arbiters as private_arbiters
from .private import batch as private_batch
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions

if TYPE_CHECKING:
    from .world import World

_MOST = 1024  # pairs; with more of them a test of all in each step saves no time
_HANDLED = packer(HandledShape)
# Values of a shape; centre of gravity of its body, and the pose of a static one; the bytes of its `HandledShape`, with
# body 0.
_Known: TypeAlias = "tuple[ShapeRecord | None, list[float], bytes]"
_WIDER = 0.01  # part of its size by which a box is wider than the shape, so that round-off hides no pair


class HandledPairs:
    """The pairs of a world that have handlers, sensors included.

    Attributes:
        type_changes: `edits.type_changes` when the pairs were found.  handled: pairs of types with handlers then.
        arrays: HANDLED (m,) and PAIRS (p, 2) of `rehearsing.any_near`; None if there are more than `_MOST` pairs, or
            a body is not in the space.
    """

    def __init__(self, world: World, past: HandledPairs | None) -> None:
        """`past`: the pairs found before in this space, or None; boxes of shapes that have not changed are kept."""
        self._space, self.type_changes = world.space, type_changes()
        self.handled = private_versions.handled(world.space)
        pairs = self._pairs(list(world.records))
        place = {shape: k for k, shape in enumerate(dict.fromkeys(chain.from_iterable(pairs or ())))}
        self.arrays: tuple[Rows[HandledShape], IntArray] | None = None
        self._boxes: dict[pymunk.Shape, _Known] = {} if past is None else past._boxes
        for gone in self._boxes.keys() - world.records.keys():
            del self._boxes[gone]
        known, bodies, rows = self._boxes, world.bodies, world.IDS[BODY_ROW].tolist()
        centres, states, ids = bodies.center_of_gravity.tolist(), world.state.tolist(), bodies.ids.tolist()
        of: list[int] = []  # rows of the bodies
        for shape in place:
            record = world.records[shape]
            if record is not None and record.outside:
                record = None
            body: Any = shape.body if record is None else record.body
            if (row := bodies.row.get(body)) is None:
                return
            at = centres[row] if rows[row] >= 0 else centres[row] + states[row][:3]
            before = known.get(shape)
            if before is None or record is None or before[0] is not record or before[1] != at:
                box = _box(shape, record, at)
                if box is None:
                    return
                known[shape] = record, at, _HANDLED.pack(0, *box)
            of.append(row)
        if pairs is not None:
            owner = [row if rows[row] >= 0 else -1 for row in of]
            HANDLED = from_bytes(HandledShape, [known[shape][2] for shape in place])
            HANDLED["body"] = owner
            # Static shapes do not meet each other, nor do those of one body.
            found = [(i, j) for a, b in pairs if owner[i := place[a]] != owner[j := place[b]]]
            self.arrays = HANDLED, np.array(found, np.int64).reshape(-1, 2)
            self._bodies = {ids[of[i]] ^ ids[of[j]] for i, j in found}  # see `private_batch.arbiter_bodies`

    def _pairs(self, shapes: list[pymunk.Shape]) -> list[tuple[pymunk.Shape, pymunk.Shape]] | None:
        """All pairs of shapes whose types have handlers; None if there are more than `_MOST`."""
        of: dict[int | None, list[pymunk.Shape]] = {kind: [] for kinds in self.handled for kind in kinds}
        for shape, kind in zip(shapes, private_shapes.collision_types(shapes), strict=True):
            if kind in of:
                of[kind].append(shape)
        of[None] = shapes
        found: list[tuple[pymunk.Shape, pymunk.Shape]] = []
        for first, second in self.handled:
            one, two = of[first], of[second]
            if len(found) + len(one) * len(two) > _MOST:
                return None
            found += product(one, two)
        return found

    def remembered(self) -> bool:
        """Whether pymunk keeps an arbiter of a pair from earlier steps. Bodies of arbiters are read in one call, and
        types one by one only if bodies of a pair may be among them."""
        if self._bodies.isdisjoint(private_batch.arbiter_bodies(self._space)):
            return False
        found = {private_arbiters.kinds(arbiter) for arbiter in private.raw_arbiters(self._space)}
        swapped = {(b, a) for a, b in found}
        return any(one in (None, a) and two in (None, b) for a, b in found | swapped for one, two in self.handled)


def _box(shape: Any, record: ShapeRecord | None, at: list[float]) -> tuple[float, ...] | None:
    """The fields of the `HandledShape` of a shape after `body`; None if its kind is unknown. `record`: its values, None
    if they are to be read. `at`: centre of gravity of its body; of static bodies, also position and angle."""
    if record is None:
        points, radius = private_shapes.outline(shape), shape.radius
    else:
        points, radius = record.vertices, record.numbers[0]
    if points is None:
        return None
    xs, ys = zip(*points, strict=True)
    left, right, low, high = min(xs), max(xs), min(ys), max(ys)
    x, y, tilt, half_x, half_y = 0.5 * (right + left), 0.5 * (high + low), 0.0, 0.5 * (right - left), 0.5 * (high - low)
    if len(points) == 2:
        dx, dy = xs[1] - xs[0], ys[1] - ys[0]
        tilt, half_x, half_y = math.atan2(dy, dx), 0.5 * math.hypot(dx, dy), 0.0
    cx, cy, *pose = at
    arm_x, arm_y, c, s = x - cx, y - cy, math.cos(tilt), math.sin(tilt)
    size = math.hypot(half_x, half_y) + radius
    rounding, extent = radius + _WIDER * size, math.hypot(arm_x, arm_y) + size
    box = c * arm_x + s * arm_y, c * arm_y - s * arm_x, tilt, half_x, half_y, rounding, extent
    if not pose:
        return *box, 0.0, 0.0, 0.0, 0.0, 0.0
    to_x, to_y, turn = pose
    c, s, angle = math.cos(turn), math.sin(turn), turn + tilt
    return *box, to_x + c * x - s * y, to_y + s * x + c * y, math.cos(angle), math.sin(angle), rounding

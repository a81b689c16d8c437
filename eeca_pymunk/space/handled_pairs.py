"""HandledPairs: pairs of shapes that have collision handlers, as rows for the kernel `rehearsing.any_near`.

pymunk calls handlers of pairs that overlap at the end of free flight, or whose arbiters it keeps from earlier steps. If
there are neither, a rehearsal would call no handler.
"""

from __future__ import annotations

import math
from itertools import chain, product
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from ..arrays import IntArray
from ..compiled.records import Rows, from_bytes, packer
from ..layout import BODY_ROW
from ..model.shapes import HandledShape
from .edits import type_changes
from .private import arbiters as private_arbiters
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions

if TYPE_CHECKING:
    from .world import World

_MOST = 1024  # pairs; with more of them a test of all in each step saves no time
_HANDLED = packer(HandledShape)
_WIDER = 0.01  # part of its size by which a box is wider than the shape, so that round-off hides no pair


class HandledPairs:
    """The pairs of a world that have handlers, sensors included.

    Attributes:
        type_changes: `edits.type_changes` when the pairs were found.  handled: pairs of types with handlers then.
        arrays: HANDLED (m,) and PAIRS (p, 2) of `rehearsing.any_near`; None if there are more than `_MOST` pairs, or
            a body is not in the space.
    """

    def __init__(self, world: World) -> None:
        self._space, self.type_changes = world.space, type_changes()
        self.handled = private_versions.handled(world.space)
        pairs = self._pairs(list(world.records))
        place = {shape: k for k, shape in enumerate(dict.fromkeys(chain.from_iterable(pairs or ())))}
        self.arrays: tuple[Rows[HandledShape], IntArray] | None = None
        values = world.bodies.center_of_gravity.tolist(), world.state.tolist(), world.IDS[BODY_ROW].tolist()
        boxes = [box for shape in place if (box := _box(world, shape, *values)) is not None]
        if pairs is not None and len(boxes) == len(place):
            HANDLED: Rows[HandledShape] = from_bytes(HandledShape, boxes)
            # Static shapes do not meet each other, nor do those of one body.
            body = HANDLED["body"].tolist()
            found = [(place[a], place[b]) for a, b in pairs if body[place[a]] != body[place[b]]]
            self.arrays = HANDLED, np.array(found, np.int64).reshape(-1, 2)

    def _pairs(self, shapes: list[pymunk.Shape]) -> list[tuple[pymunk.Shape, pymunk.Shape]] | None:
        """All pairs of shapes whose types have handlers; None if there are more than `_MOST`."""
        of: dict[int, list[pymunk.Shape]] = {}
        for shape, kind in zip(shapes, private_shapes.collision_types(shapes), strict=True):
            of.setdefault(kind, []).append(shape)
        found: list[tuple[pymunk.Shape, pymunk.Shape]] = []
        for kinds in self.handled:
            one, two = (shapes if kind is None else of.get(kind, []) for kind in kinds)
            if len(found) + len(one) * len(two) > _MOST:
                return None
            found += product(one, two)
        return found

    def remembered(self) -> bool:
        """Whether pymunk keeps an arbiter of a pair from earlier steps."""
        found = {private_arbiters.kinds(arbiter) for arbiter in private.raw_arbiters(self._space)}
        swapped = {(b, a) for a, b in found}
        return any(one in (None, a) and two in (None, b) for a, b in found | swapped for one, two in self.handled)


def _box(
    world: World, shape: Any, centres: list[list[float]], states: list[list[float]], rows: list[int]
) -> bytes | None:
    """The `HandledShape` of a shape; None if its body is not in the space, or its kind is unknown. Of each body:
    `centres`, its centre of gravity; `states`, its state; `rows`, its row in BODY."""
    record = world.records[shape]
    if record is None or record.outside:
        body, points, radius = shape.body, private_shapes.outline(shape), shape.radius
    else:
        body, points, radius = record.body, record.vertices, record.numbers[0]
    row = world.bodies.row.get(body)
    if row is None or points is None:
        return None
    xs, ys = zip(*points, strict=True)
    left, right, low, high = min(xs), max(xs), min(ys), max(ys)
    x, y, tilt, half_x, half_y = 0.5 * (right + left), 0.5 * (high + low), 0.0, 0.5 * (right - left), 0.5 * (high - low)
    if len(points) == 2:
        dx, dy = xs[1] - xs[0], ys[1] - ys[0]
        tilt, half_x, half_y = math.atan2(dy, dx), 0.5 * math.hypot(dx, dy), 0.0
    cx, cy = centres[row]
    arm_x, arm_y, c, s = x - cx, y - cy, math.cos(tilt), math.sin(tilt)
    size = math.hypot(half_x, half_y) + radius
    rounding, extent = radius + _WIDER * size, math.hypot(arm_x, arm_y) + size
    box = c * arm_x + s * arm_y, c * arm_y - s * arm_x, tilt, half_x, half_y, rounding, extent
    if rows[row] >= 0:
        return _HANDLED.pack(row, *box, 0.0, 0.0, 0.0, 0.0, 0.0)
    to_x, to_y, turn, *_ = states[row]
    c, s, angle = math.cos(turn), math.sin(turn), turn + tilt
    at = to_x + c * x - s * y, to_y + s * x + c * y
    return _HANDLED.pack(-1, *box, *at, math.cos(angle), math.sin(angle), rounding)

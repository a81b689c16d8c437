"""HandledPairs: pairs of shapes that have collision handlers, as rows for the kernel `rehearsing.any_near`.

pymunk calls handlers of pairs that overlap at the end of free flight, or whose arbiters it keeps from earlier steps. If
there are neither, a rehearsal would call no handler.
"""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from ..arrays import IntArray
from ..compiled.records import Rows, rows
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
        place = {shape: k for k, shape in enumerate(dict.fromkeys(shape for pair in pairs or () for shape in pair))}
        self.arrays: tuple[Rows[HandledShape], IntArray] | None = None
        HANDLED = rows(HandledShape, len(place))
        if pairs is not None and all(_put_box(HANDLED[k], world, shape) for shape, k in place.items()):
            # Static shapes do not meet each other, nor do those of one body.
            body = HANDLED["body"].tolist()
            found = [(place[a], place[b]) for a, b in pairs if body[place[a]] != body[place[b]]]
            self.arrays = HANDLED, np.array(found, np.int64).reshape(-1, 2)

    def _pairs(self, shapes: list[pymunk.Shape]) -> list[tuple[pymunk.Shape, pymunk.Shape]] | None:
        """All pairs of shapes whose types have handlers; None if there are more than `_MOST`."""
        of: dict[int, list[pymunk.Shape]] = {}
        for shape in shapes:
            of.setdefault(shape.collision_type, []).append(shape)
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


def _put_box(box: HandledShape, world: World, shape: Any) -> bool:
    """Set the box of a shape; False if its body is not in the space, or its kind is unknown."""
    record = world.records[shape]
    if record is None or record.outside:
        body, points, radius = shape.body, private_shapes.outline(shape), shape.radius
    else:
        body, points, radius = record.body, record.vertices, record.numbers[0]
    row = world.bodies.row.get(body)
    if row is None or points is None:
        return False
    xs, ys = [x for x, _ in points], [y for _, y in points]
    if len(points) == 2:
        along = xs[1] - xs[0], ys[1] - ys[0]
        box.angle, box.half_x = math.atan2(along[1], along[0]), 0.5 * math.hypot(*along)
    else:
        box.half_x, box.half_y = 0.5 * (max(xs) - min(xs)), 0.5 * (max(ys) - min(ys))
    middle = pymunk.Vec2d(0.5 * (max(xs) + min(xs)), 0.5 * (max(ys) + min(ys)))
    size, arm = math.hypot(box.half_x, box.half_y) + radius, middle - body.center_of_gravity
    box.rounding, box.extent = radius + _WIDER * size, arm.length + size
    box.x, box.y = arm.rotated(-box.angle)
    if world.IDS[BODY_ROW, row] >= 0:
        box.body = row
        return True
    at, angle = body.local_to_world(middle), body.angle + box.angle
    box.body, box.at_x, box.at_y, box.reach = -1, at.x, at.y, box.rounding
    box.cos, box.sin = math.cos(angle), math.sin(angle)
    return True

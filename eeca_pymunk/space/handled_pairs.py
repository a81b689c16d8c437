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

from ..arrays import FloatArray, IntArray
from ..layout import BODY_ROW
from ..rehearsing import HANDLED_COLUMNS
from .edits import type_changes
from .private import arbiters as private_arbiters
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions

if TYPE_CHECKING:
    from .world import World

_MOST = 1024  # pairs; with more of them a test of all in each step saves no time
_WIDER = 1.01  # factor on sizes of shapes, so that round-off hides no pair


class HandledPairs:
    """The pairs of a world that have handlers, sensors included.

    Attributes:
        type_changes: `edits.type_changes` when the pairs were found.  handled: pairs of types with handlers then.
        arrays: HANDLED (m, 7) and PAIRS (p, 2) of `rehearsing.any_near`; None if there are more than `_MOST` pairs, or
            a body is not in the space.
    """

    def __init__(self, world: World) -> None:
        self._space, self.type_changes = world.space, type_changes()
        self.handled = private_versions.handled(world.space)
        pairs = self._pairs(list(world.records))
        place = {shape: k for k, shape in enumerate(dict.fromkeys(shape for pair in pairs or () for shape in pair))}
        rows = [_handled_row(world, shape) for shape in place]
        self.arrays: tuple[FloatArray, IntArray] | None = None
        if pairs is not None and None not in rows:
            HANDLED: FloatArray = np.array(rows, float).reshape(-1, HANDLED_COLUMNS)
            # Static shapes do not meet each other, nor do those of one body.
            body = [-1.0 if row is None else row[0] for row in rows]
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


def _handled_row(world: World, shape: Any) -> tuple[float, ...] | None:
    """The row of HANDLED of a shape, see `rehearsing.any_near`; None if its body is not in the space, or its kind is
    unknown."""
    record = world.records[shape]
    if record is None or record.outside:
        body, points, rounding = shape.body, private_shapes.outline(shape), shape.radius
    else:
        body, points, rounding = record.body, record.vertices, record.numbers[0]
    row = world.bodies.row.get(body)
    if row is None or points is None:
        return None
    radius = _WIDER * rounding
    if world.IDS[BODY_ROW, row] >= 0:
        return row, 0.0, 0.0, 0.0, 0.0, 0.0, _WIDER * max([math.hypot(x, y) for x, y in points]) + radius
    at, angle = body.position, body.angle
    c, s = math.cos(angle), math.sin(angle)
    xs, ys = [at.x + c * x - s * y for x, y in points], [at.y + s * x + c * y for x, y in points]
    left, right, bottom, top = min(xs), max(xs), min(ys), max(ys)
    middle = 0.5 * (left + right), 0.5 * (bottom + top)
    return -1.0, *middle, 0.5 * (right - left), 0.5 * (top - bottom), radius, radius

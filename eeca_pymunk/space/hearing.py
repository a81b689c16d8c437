"""Hearing: pairs of shapes that have collision handlers, and whether one of them may meet in a step.

pymunk calls handlers of pairs that overlap at the end of free flight, or that it remembers from earlier steps. If there
are neither, a rehearsal would call none.
"""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..layout import BODY_ROW
from ..rehearsing import HEARD_COLUMNS
from .edits import typings
from .private import arbiters as private_arbiters
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions

if TYPE_CHECKING:
    from .world import World

_MOST = 1024  # pairs that are looked at in a step; more are not worth it
_WIDER = 1.01  # factor of sizes, for round-off


class Hearing:
    """The pairs of a world that have handlers, sensors included.

    Attributes:
        typings: `edits.typings` when they were found.  handled: the pairs of types that had handlers.
        arrays: HEARD and PAIRS of `rehearsing.nears`; None if they are many, or a body is not in the space.
    """

    def __init__(self, world: World) -> None:
        self._space, self.typings = world.space, typings()
        self.handled = private_versions.handled(world.space)
        pairs = self._pairs(list(world.records))
        place = {shape: k for k, shape in enumerate(dict.fromkeys(shape for pair in pairs or () for shape in pair))}
        heard = [_heard(world, shape) for shape in place]
        self.arrays: tuple[FloatArray, IntArray] | None = None
        if pairs is not None and None not in heard:
            HEARD: FloatArray = np.array(heard, float).reshape(-1, HEARD_COLUMNS)
            # Static shapes do not meet each other, nor do those of one body.
            body = [-1.0 if row is None else row[0] for row in heard]
            found = [(place[a], place[b]) for a, b in pairs if body[place[a]] != body[place[b]]]
            self.arrays = HEARD, np.array(found, np.int64).reshape(-1, 2)

    def _pairs(self, shapes: list[pymunk.Shape]) -> list[tuple[pymunk.Shape, pymunk.Shape]] | None:
        """All pairs of types that have handlers; None if they are too many."""
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
        """Whether pymunk remembers that a pair has touched."""
        found = {private_arbiters.kinds(arbiter) for arbiter in private.raw_arbiters(self._space)}
        turned = {(b, a) for a, b in found}
        return any(one in (None, a) and two in (None, b) for a, b in found | turned for one, two in self.handled)


def _heard(world: World, shape: Any) -> tuple[float, ...] | None:
    """The row of HEARD of a shape, see `rehearsing.nears`; None if its body is not in the space."""
    record = world.records[shape]
    if record is None or record.outside:
        body, points, rounding = shape.body, private_shapes.outline(shape), shape.radius
    else:
        body, points, rounding = record.body, record.vertices, record.numbers[0]
    row = world.bodies.row.get(body)
    if row is None or points is None:
        return None
    radius = _WIDER * rounding
    if world.WALK[BODY_ROW, row] >= 0:
        return row, 0.0, 0.0, 0.0, 0.0, 0.0, _WIDER * max([math.hypot(x, y) for x, y in points]) + radius
    at, angle = body.position, body.angle
    c, s = math.cos(angle), math.sin(angle)
    xs, ys = [at.x + c * x - s * y for x, y in points], [at.y + s * x + c * y for x, y in points]
    left, right, bottom, top = min(xs), max(xs), min(ys), max(ys)
    middle = 0.5 * (left + right), 0.5 * (bottom + top)
    return -1.0, *middle, 0.5 * (right - left), 0.5 * (top - bottom), radius, radius

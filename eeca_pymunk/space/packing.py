"""Packing: bodies and shapes of pymunk as the rows of BODY, SHAPE, LINK and VERTEX (`..model`)."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Mapping
from functools import cache, cached_property
from itertools import chain
from math import isfinite
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..compiled.layouts import ROWS, Layout, Plan
from ..compiled.records import Rows, packer
from ..impacts.scene_memory import measure_scene
from ..layout import EXTRA_COLUMNS, HOOKED_TABLES, STATE_COLUMNS
from ..model.bodies import Body
from ..model.shapes import Link, Shape
from ..model.values import CORNERS, STATIC, TOTALS_KEPT, Reading, ShapeValues
from ..world_rows import read_space, write_rows
from .bodies import Bodies
from .body_states import BodyStates
from .checks import check_shape, shape_body
from .outlines import local_outline
from .private import shapes as private_shapes

_WORD = (1 << 64) - 1  # of a filter's numbers the lowest 64 bits are packed, which suffice for equality and `&`
_VALUES = packer(ShapeValues, "group", "categories", "mask")
_POINT = 16  # bytes of a row of POINT


class ShapeRecord(NamedTuple):
    """The values of a shape, read once.

    Attributes:
        body: its body, or the static body of the space if its own is not in the space (`outside`).
        vertices: (x, y) in coordinates of `body`, counter-clockwise: length.
        numbers: rounding (length), elasticity, friction, surface velocity (2; length/time).
        filter: group, categories, mask.
        packed, points: the bytes of its `ShapeValues`, and of its vertices.
    """

    body: pymunk.Body
    vertices: list[tuple[float, ...]]
    numbers: tuple[float, ...]
    filter: tuple[int, int, int]
    outside: bool
    packed: bytes
    points: bytes


ShapeRecords: TypeAlias = dict[pymunk.Shape, ShapeRecord | None]


def read(shape: pymunk.Shape, ground: pymunk.Body | None = None) -> ShapeRecord:
    """The record of a shape. If `ground` is given, the record of an equal shape of `ground` at the same place.

    Raises:
        ValueError: see `shape_body` and `check_shape`.  UnsupportedFeature: see `local_outline`.
    """
    body = shape_body(shape)
    outline, (numbers, words) = local_outline(shape), _surface(shape)
    if ground is not None:
        to_world, to_ground = body.local_to_world, ground.world_to_local
        outline = [tuple(to_ground(to_world((v[0], v[1])))) for v in outline]
        body = ground
    packed = _VALUES.pack(0, len(outline), *words, *numbers, 0, 0)
    points = array("d", chain.from_iterable(outline)).tobytes()
    return ShapeRecord(body, outline, numbers, words, ground is not None, packed, points)


def read_surface(shape: pymunk.Shape, record: ShapeRecord) -> ShapeRecord:
    """The record of a shape whose body and vertices are still those of `record`."""
    numbers, words = _surface(shape)
    packed = _VALUES.pack(0, len(record.vertices), *words, *numbers, 0, 0)
    return record._replace(numbers=numbers, filter=words, packed=packed)


def _surface(shape: pymunk.Shape) -> tuple[tuple[float, ...], tuple[int, int, int]]:
    """`numbers` and `filter` of the record of a shape."""
    numbers = private_shapes.surface(shape)
    rounding, elasticity, friction, *_ = numbers
    if not (rounding >= 0.0 and elasticity >= 0.0 and friction >= 0.0 and isfinite(sum(numbers))):
        check_shape(shape)  # raises with the name of the value; the test above costs less
    group, categories, mask = private_shapes.filter_of(shape)
    return numbers, (group & _WORD, categories & _WORD, mask & _WORD)


def records_of(
    space: pymunk.Space, bodies: Bodies, known: ShapeRecords, stale: Collection[Any]
) -> tuple[ShapeRecords, int]:
    """The records of all shapes, None for sensors, and how many shapes were read. `known` records are used again unless
    their shape is in `stale`, or its body is not in the space.

    A shape whose body was removed from the space becomes a static shape at its present place, where pymunk detects it.
    """
    shapes, row = space.shapes, bodies.row
    records: ShapeRecords = dict(zip(shapes, map(known.get, shapes), strict=True))
    unknown = records.keys() - known.keys()
    unknown.update(s for s, r in records.items() if r is not None and (r.outside or r.body not in row))
    unknown.update(thing for thing in stale if thing in records)
    for shape in shapes if unknown else ():
        if shape in unknown:
            here = (body := shape.body) is None or body in row
            records[shape] = None if shape.sensor else read(shape, None if here else space.static_body)
    return records, len(unknown)


def shape_counts(bodies: Bodies, records: ShapeRecords) -> dict[Any, int]:
    """The number of shapes of each body that is not static."""
    still = bodies.static.tolist()
    count = dict.fromkeys((body for body, rests in zip(bodies.items, still, strict=True) if not rests), 0)
    for shape, record in records.items():
        if (body := shape.body if record is None else record.body) in count:
            count[body] += 1
    return count


@cache
def _arrays() -> Plan[Reading]:
    return Plan(
        Reading,
        (
            "TOTALS", "BODY", "SHAPE", "LINK", "VERTEX", "ORDER", "SHAPES", "OWNER", "POINT", "POINT_PLACED",
            "MEASURED",
        ), 6,
        ("BODIES", "STATES", "IDS", "EXTRA", "ENDS", "HOOKED"), {},
        {
            "VERTEX": (ROWS, 4), "POINT": (ROWS, 2), "POINT_PLACED": (ROWS, 2), "STATES": (2, ROWS, STATE_COLUMNS),
            "IDS": (4, ROWS), "EXTRA": (ROWS, EXTRA_COLUMNS), "HOOKED": (HOOKED_TABLES, ROWS, STATE_COLUMNS),
        },
    )  # fmt: skip


class Packed:
    """Rows of a space's bodies and solid shapes.

    Args:
        bodies: in the order of `states`.  records: of all shapes of the space, in pymunk's order, None for sensors.
        past: the rows before, which are lost.

    Attributes:
        shapes: the pymunk shapes, by row of SHAPE.  owner: (k,) places of their bodies in pymunk's order.
        BODY, SHAPE, LINK, VERTEX: see `..model`.  totals: see `Reading`.  status: see `read_space`.
        table: all arrays.  bound: see `Layout`.
    """

    _layout: Layout[Reading]

    def __init__(self, bodies: Bodies, states: BodyStates, records: ShapeRecords, past: Packed | None) -> None:
        solid = [shape for shape, record in records.items() if record is not None]
        known = [record for record in records.values() if record is not None]
        k, N = len(solid), len(bodies)
        self._solid = solid
        row, points = bodies.row, b"".join([record.points for record in known])
        owner = [row[record.body] for record in known]
        moving, v = N - bodies.VALUES["kind"].tolist().count(STATIC), len(points) // _POINT
        self._layout = layout = Layout(_arrays()) if past is None else past._layout
        counts = {
            "TOTALS": TOTALS_KEPT, "MEASURED": 1, "BODY": moving + 1, "SHAPE": k, "LINK": k, "VERTEX": v,
            "ORDER": k + N + 2, "BODIES": N, "SHAPES": k, "OWNER": k, "POINT": v, "POINT_PLACED": v, "STATES": N,
            "IDS": N, "EXTRA": N,
            "ENDS": len(states.ENDS), "HOOKED": N,
        }  # fmt: skip
        self.table = layout.lay(
            counts, bodies.VALUES, states.STATES, states.IDS, states.EXTRA, states.ENDS, states.HOOKED
        )
        layout.write("SHAPES", b"".join([record.packed for record in known]))
        layout.write("OWNER", array("q", owner).tobytes())
        layout.write("POINT", points)
        self.bound = layout.bound
        self._write, read = layout.bound(write_rows, read_space)
        self.status = read(bodies.arranged)
        self._measured: list[int] | None = None
        self.totals: list[int] = layout.integers("TOTALS").tolist()
        self.BODY: Rows[Body] = layout.array("BODY")
        self.SHAPE: Rows[Shape] = layout.array("SHAPE")
        self.LINK: Rows[Link] = layout.array("LINK")
        self.VERTEX: FloatArray = layout.array("VERTEX")[: self.totals[CORNERS]]
        order = layout.integers("ORDER")[:k].tolist()
        self.shapes = tuple([solid[i] for i in order])
        self.owner: IntArray = np.array([owner[i] for i in order], np.int64)

    def measured(self) -> list[int]:
        """The `Measures` of the present rows; places of static bodies do not matter."""
        if self._measured is None:
            (measure,) = self.bound(measure_scene)
            measure()
            self._measured = self._layout.integers("MEASURED").tolist()
        return self._measured

    @cached_property
    def _counted(self) -> bytes:
        """The numbers of vertices of the rows, which must not change."""
        return self.LINK["vertices"].tobytes()

    @cached_property
    def _place(self) -> dict[pymunk.Shape, int]:
        """The place of each shape in SHAPES."""
        return {shape: k for k, shape in enumerate(self._solid)}

    def write_edited(self, records: Mapping[pymunk.Shape, ShapeRecord]) -> None:
        """Write the values of edited shapes, for `write_again`."""
        if records:
            self._measured = None
        for shape, record in records.items():
            self._layout.write("SHAPES", record.packed, self._place[shape] * _VALUES.size)

    def write_again(self, moved: bool) -> bool:
        """Write the rows again, in place, after changes of numbers, filters and masses (`write_edited`), and, if
        `moved`, of poses of static bodies.

        Returns:
            False, with invalid rows, if shapes have another number of vertices than before.
        """
        counted = self._counted if moved else b""
        self._layout.write("BODY", bytes(self.BODY.nbytes))
        self._write()
        # Two vertices of a static shape may become one in world coordinates, by round-off.
        return not moved or self.LINK["vertices"].tobytes() == counted

"""Shapes: their outlines, and what collision handlers decide about pairs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import pymunk

from ..compiled.records import Rows
from ..errors import UnsupportedFeature
from ..model.shapes import Shape
from .private_versions import processed

_STRAIGHT = 1e-12  # of its coordinates: how far round-off may have moved a vertex off the line of its neighbours
_SAME = 1e-9  # part of a surface velocity by which the one that pymunk makes of it may differ
Pair = tuple[int, int]
Law = tuple[float, float, float, float]  # elasticity, friction, surface velocity (x, y) of b relative to a


@dataclass(frozen=True)
class Rules:
    """What collision handlers decide about pairs of shapes, for one step; pairs as (smaller, larger) index.

    `ignored`: pairs that do not collide.  `changed`: the law of pairs that have another than their shapes say.
    """

    ignored: frozenset[Pair] = frozenset()
    changed: Mapping[Pair, Law] = field(default_factory=dict)

    @property
    def some(self) -> bool:
        """Whether there are any."""
        return bool(self.ignored or self.changed)

    @classmethod
    def said(
        cls, arbiters: Iterable[pymunk.Arbiter], places: Mapping[pymunk.Shape, int], SHAPE: Rows[Shape], smooth: bool
    ) -> Rules:
        """What these arbiters say of pairs of shapes, which have these rows of SHAPE; nothing of friction if
        `smooth`."""
        ignored, changed = set(), {}
        for arbiter in arbiters:
            a, b = (places.get(shape, -1) for shape in arbiter.shapes)
            if min(a, b) < 0:
                continue
            pair = (min(a, b), max(a, b))
            if not processed(arbiter):
                ignored.add(pair)
                continue
            own = _law(SHAPE, *pair)
            mu = 0.0 if smooth else arbiter.friction
            told = (arbiter.restitution, mu, *_surface(arbiter, own[2:], a < b))
            if told != own:
                changed[pair] = told
        return cls(frozenset(ignored), changed)

    def of_pairs(self, SHAPE: Rows[Shape], parted: Iterable[Pair] = ()) -> dict[Pair, Law]:
        """By pair of rows of SHAPE, in their order: elasticity (-1: they pass), friction, surface velocity of b
        relative to a. `parted` pairs pass, whatever handlers say."""
        told: dict[Pair, Law] = {}
        never = self.ignored.union(parted)
        for pair in sorted(never.union(self.changed)):
            told[pair] = (-1.0, 0.0, *_law(SHAPE, *pair)[2:]) if pair in never else self.changed[pair]
        return told


def _law(SHAPE: Rows[Shape], a: int, b: int) -> Law:
    """What two shapes say of each other: pymunk's products, and b's surface velocity relative to a's."""
    e, mu = (float(SHAPE[k][a] * SHAPE[k][b]) for k in ("elasticity", "friction"))
    return (
        e,
        mu,
        float(SHAPE["surface_x"][b] - SHAPE["surface_x"][a]),
        float(SHAPE["surface_y"][b] - SHAPE["surface_y"][a]),
    )


def _surface(arbiter: pymunk.Arbiter, own: tuple[float, float], ordered: bool) -> tuple[float, float]:
    """The surface velocity that an arbiter has, `own` if nobody has set another one: pymunk takes the part of that
    along the contact. `ordered`: whether its first shape is that with the smaller index."""
    found = arbiter.surface_velocity
    x, y = found if ordered else -found
    if (x, y) == own:
        return own
    n = arbiter.normal
    away = own[0] * n.x + own[1] * n.y
    off = math.hypot(own[0] - away * n.x - x, own[1] - away * n.y - y)
    return own if off <= _SAME * (math.hypot(*own) + math.hypot(x, y)) else (x, y)


def local_outline(shape: pymunk.Shape) -> list[tuple[float, ...]]:
    """Vertices in body coordinates, counter-clockwise: one, a circle's centre, or two, a segment's ends, or more."""
    if isinstance(shape, pymunk.Circle):
        return [tuple(shape.offset)]
    if isinstance(shape, pymunk.Segment):
        return [tuple(shape.a), tuple(shape.b)]
    if isinstance(shape, pymunk.Poly):
        return corners([tuple(v) for v in shape.get_vertices()])
    raise UnsupportedFeature(f"{shape}: only circles, segments and polygons are known")


def corners(outline: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """A convex outline without the vertices that lie on the line of their neighbours, up to round-off: of the normals
    of two edges in one line, round-off would tell which of them something is beside."""
    limit = _STRAIGHT * max(abs(c) for v in outline for c in v)
    kept: list[tuple[float, ...]] = []
    for i, (x, y) in enumerate(outline):
        ax, ay = kept[-1] if kept else outline[-1]
        bx, by = outline[(i + 1) % len(outline)]
        along = math.hypot(bx - ax, by - ay)
        if abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) > limit * along:
            kept.append((x, y))
    return kept if len(kept) > 2 else outline

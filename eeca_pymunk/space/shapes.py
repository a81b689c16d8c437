"""Shapes: their outlines, and the decisions of collision handlers about pairs of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import pymunk

from ..compiled.records import Rows
from ..errors import UnsupportedFeature
from ..model.shapes import Shape
from . import private_shapes
from .private_versions import processed

if TYPE_CHECKING:
    from .world import World

_STRAIGHT = 1e-12  # of its coordinates: distance of a vertex from the line of its neighbours that is round-off
_SAME = 1e-9  # relative difference of a surface velocity and pymunk's tangential part of it that is round-off
Pair = tuple[int, int]
Law = tuple[float, float, float, float]  # elasticity, friction, surface velocity (x, y) of b relative to a


@dataclass(frozen=True)
class Rules:
    """Decisions of collision handlers about pairs of shapes, for one step; pairs as (smaller, larger) index.

    `ignored`: pairs that do not collide.  `changed`: the law of pairs for which it is not that of their shapes.
    """

    ignored: frozenset[Pair] = frozenset()
    changed: Mapping[Pair, Law] = field(default_factory=dict)

    @property
    def some(self) -> bool:
        """Whether there are any."""
        return bool(self.ignored or self.changed)

    @classmethod
    def of_arbiters(cls, arbiters: Iterable[pymunk.Arbiter], world: World) -> Rules:
        """Those that arbiters have."""
        ignored, changed = set(), {}
        for arbiter in arbiters:
            a, b = (world.places.get(shape, -1) for shape in arbiter.shapes)
            if min(a, b) < 0:
                continue
            pair = (min(a, b), max(a, b))
            if not processed(arbiter):
                ignored.add(pair)
                continue
            own = _law(world.SHAPE, *pair)
            mu = 0.0 if world.frictionless else arbiter.friction
            law = (arbiter.restitution, mu, *_surface(arbiter, own[2:], a < b))
            if law != own:
                changed[pair] = law
        return cls(frozenset(ignored), changed)

    def of_pairs(self, SHAPE: Rows[Shape], parted: Iterable[Pair] = ()) -> dict[Pair, Law]:
        """The law by pair of rows of SHAPE, sorted: elasticity (-1: no collision), friction, surface velocity of b
        relative to a. `parted` pairs do not collide, for any handlers."""
        never = self.ignored.union(parted)
        return {
            pair: (-1.0, 0.0, *_law(SHAPE, *pair)[2:]) if pair in never else self.changed[pair]
            for pair in sorted(never.union(self.changed))
        }


def _law(SHAPE: Rows[Shape], a: int, b: int) -> Law:
    """The law of two shapes: pymunk's products, and b's surface velocity relative to a's."""
    e, mu = (float(SHAPE[k][a] * SHAPE[k][b]) for k in ("elasticity", "friction"))
    x, y = (float(SHAPE[k][b] - SHAPE[k][a]) for k in ("surface_x", "surface_y"))
    return e, mu, x, y


def _surface(arbiter: pymunk.Arbiter, own: tuple[float, float], ordered: bool) -> tuple[float, float]:
    """The surface velocity of an arbiter, `own` if no function has set another one: pymunk stores the tangential part.
    `ordered`: whether its first shape has the smaller index."""
    found = arbiter.surface_velocity
    x, y = found if ordered else -found
    if (x, y) == own:
        return own
    n = arbiter.normal
    away = own[0] * n.x + own[1] * n.y
    off = math.hypot(own[0] - away * n.x - x, own[1] - away * n.y - y)
    return own if off <= _SAME * (math.hypot(*own) + math.hypot(x, y)) else (x, y)


def local_outline(shape: pymunk.Shape) -> list[tuple[float, ...]]:
    """Vertices in body coordinates, counter-clockwise: one of a circle (its centre), two of a segment, more of a
    polygon."""
    outline = private_shapes.outline(shape)
    if outline is None:
        raise UnsupportedFeature(f"{shape}: only circles, segments and polygons are known")
    return outline if len(outline) < 3 else corners(outline)


def corners(outline: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """A convex outline without vertices that are collinear with their neighbours, up to round-off: for two collinear
    edges round-off would decide to which of them a point belongs."""
    limit = _STRAIGHT * max([abs(c) for v in outline for c in v])
    kept: list[tuple[float, ...]] = []
    (ax, ay), ahead = outline[-1], (*outline[1:], outline[0])
    for (x, y), (bx, by) in zip(outline, ahead, strict=True):
        along = math.hypot(bx - ax, by - ay)
        if abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) > limit * along:
            kept.append((x, y))
            ax, ay = x, y
    return kept if len(kept) > 2 else outline

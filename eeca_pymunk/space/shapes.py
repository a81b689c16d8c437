"""Shapes: their outlines, and what collision handlers decide about pairs of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import pymunk

from ..arrays import FloatArray
from ..errors import UnsupportedFeature
from ..layout import SURFACE_X, SURFACE_Y


@dataclass(frozen=True)
class Rules:
    """What collision handlers decide about pairs of shapes, for one step; pairs as (smaller, larger) index.

    `ignored`: pairs that do not collide.  `changed`: elasticity and friction of pairs that have others than their
    shapes say.
    """

    ignored: frozenset[tuple[int, int]] = frozenset()
    changed: Mapping[tuple[int, int], tuple[float, float]] = field(default_factory=dict)

    def of_pairs(
        self, SHAPE: FloatArray, parted: Iterable[tuple[int, int]] = ()
    ) -> dict[tuple[int, int], tuple[float, float, float, float]]:
        """By pair of rows of SHAPE, in their order: elasticity (-1: they pass), friction, surface velocity of b
        relative to a. `parted` pairs pass, whatever handlers say."""
        told = {}
        never = self.ignored.union(parted)
        for pair in sorted(never.union(self.changed)):
            a, b = (SHAPE[i] for i in pair)
            e, mu = (-1.0, 0.0) if pair in never else self.changed[pair]
            told[pair] = (e, mu, float(b[SURFACE_X] - a[SURFACE_X]), float(b[SURFACE_Y] - a[SURFACE_Y]))
        return told


def local_outline(shape: pymunk.Shape) -> list[tuple[float, ...]]:
    """Vertices in body coordinates, counter-clockwise: one, a circle's centre, or two, a segment's ends, or more."""
    if isinstance(shape, pymunk.Circle):
        return [tuple(shape.offset)]
    if isinstance(shape, pymunk.Segment):
        return [tuple(shape.a), tuple(shape.b)]
    if isinstance(shape, pymunk.Poly):
        return [tuple(v) for v in shape.get_vertices()]
    raise UnsupportedFeature(f"{shape}: only circles, segments and polygons are known")

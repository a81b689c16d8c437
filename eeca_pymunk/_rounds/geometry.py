"""Geometry of contacts: gaps, normals and points. Normals point from body a to body b, gaps are negative in overlap."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Geometry:
    """Gap (m,) length and normal (m, 2) from a to b of every pair at one configuration; `center` (m, 2) is the point of
    a's core, which `radius` (m,) rounds, that is nearest to b: of a disk its centre.
    """

    gap: FloatArray
    normal: FloatArray
    center: FloatArray
    radius: FloatArray

    @property
    def point(self) -> FloatArray:
        """(m, 2) length, halfway between the two surfaces."""
        result: FloatArray = self.center + (self.radius + 0.5 * self.gap)[:, None] * self.normal
        return result

    def take(self, which: IntArray) -> Geometry:
        """The geometry of the pairs number `which`."""
        normal, center = self.normal.take(which, axis=0), self.center.take(which, axis=0)
        return Geometry(self.gap[which], normal, center, self.radius[which])

    def joined(self, other: Geometry) -> Geometry:
        """This geometry, and then the other."""
        return Geometry(*(np.concatenate((getattr(self, f.name), getattr(other, f.name))) for f in fields(self)))


class Axis(NamedTuple):
    """A direction along which shapes may be apart: `gap` (m, q) of some points there, length, and their `rate`; the
    least one bounds the gap of the shapes from below. `valid` (m,) where it is positive or the shapes touch along it.
    """

    gap: FloatArray
    rate: FloatArray
    valid: BoolArray

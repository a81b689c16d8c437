"""Contacts that act at one instant, and contacts that rest on forces."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, rotated
from ..energy.delassus import Delassus, operator
from .contacts import Pairs
from .geometry import Geometry


@dataclass(frozen=True)
class Touching:
    """k contacts between bodies that act at one instant: a pair of shapes has two where faces meet.

    Attributes:
        pairs: of the contacts.  pair: (k,) number of the pair in the block's list.  at: their geometry.
        row_a, row_b: (k,) of the bodies among those of the block.  face: (k,) whether the pair has two contacts.
        direction_a, direction_b: (k, d).
    """

    pairs: Pairs
    pair: IntArray
    at: Geometry
    row_a: IntArray
    row_b: IntArray
    face: BoolArray
    direction_a: FloatArray
    direction_b: FloatArray

    @staticmethod
    def of(pairs: Pairs, at: Geometry, pair: IntArray, rows: tuple[IntArray, IntArray], pose: FloatArray) -> Touching:
        """The contacts of `pairs` (m,) with geometry `at`, bodies `rows` (m,), (m,) at poses (R, d)."""
        (row_a, row_b), single = rows, np.arange(len(pairs))
        again, other = pairs.faces(at, pose[row_a], pose[row_b])
        face = np.zeros(len(pairs), bool)
        if len(again):
            face[again] = True
            which = np.concatenate((single, again))
            order = np.argsort(which, kind="stable")
            which = which[order]
            at = at.joined(other).take(order)
            pairs, pair, row_a, row_b, face = pairs.take(which), pair[which], row_a[which], row_b[which], face[which]
        return Touching(pairs, pair, at, row_a, row_b, face, *pairs.directions(at, pose[row_a], pose[row_b]))

    def moved(self, before: FloatArray, after: FloatArray) -> Touching:
        """The same contacts when the bodies have gone from poses `before` to `after` (R, d)."""
        a, b = self.row_a, self.row_b
        at = self.pairs.between(after[a], after[b])
        k = np.flatnonzero(self.face)
        if len(k):
            # The ends of a face stay with both bodies: with the mean of both where these slide on each other.
            point = self.at.point[k]
            mean = 0.5 * sum(_carried(point, before[r[k]], after[r[k]]) for r in (a, b))
            at.center[k] = mean - (at.radius[k] + 0.5 * at.gap[k])[:, None] * at.normal[k]
        directions = self.pairs.directions(at, after[a], after[b])
        return Touching(self.pairs, self.pair, at, a, b, self.face, *directions)

    def take(self, which: IntArray) -> Touching:
        """The contacts number `which`, increasing."""
        return Touching(
            self.pairs.take(which), self.pair[which], self.at.take(which), self.row_a[which], self.row_b[which],
            self.face[which], self.direction_a[which], self.direction_b[which],
        )  # fmt: skip

    def operator(self, mobility: FloatArray) -> Delassus:
        """The contacts as an operator on bodies of mobility (R, d or 1)."""
        return operator(self.row_a, self.row_b, (self.direction_a, self.direction_b), mobility)


@dataclass
class Resting:
    """The k contacts that rest on forces now; each lasts from `since` until `until` unless an impact ends it.

    Attributes:
        key: (k,) of the pair, not decreasing.  first, second: (k,) shapes.
        since, until: (k,) instants in the step.  force: (k,) mass length/time².
        normal: (k, 2) its direction.  point: (k, 2).  change: (k,) of the velocity by a unit impulse.
        direction_a, direction_b: (k, d) of the force on the bodies.  pose_a, pose_b: (k, d) at `since`.
    """

    key: IntArray
    first: IntArray
    second: IntArray
    since: FloatArray
    until: FloatArray
    force: FloatArray
    normal: FloatArray
    point: FloatArray
    change: FloatArray
    direction_a: FloatArray
    direction_b: FloatArray
    pose_a: FloatArray
    pose_b: FloatArray

    @staticmethod
    def none(columns: int) -> Resting:
        """No contact of bodies with so many coordinates."""
        i, x, v, w = np.zeros(0, np.intp), np.zeros(0), np.zeros((0, 2)), np.zeros((0, columns))
        return Resting(i, i, i, x, x, x, v, v, x, w, w, w, w)

    def take(self, which: IntArray) -> Resting:
        """The contacts number `which`."""
        return Resting(*(getattr(self, f.name)[which] for f in fields(self)))

    def joined(self, other: Resting) -> Resting:
        """Both, ordered by key."""
        both = Resting(*(np.concatenate((getattr(self, f.name), getattr(other, f.name))) for f in fields(self)))
        return both.take(np.argsort(both.key, kind="stable"))

    def work(self, pose_a: FloatArray, pose_b: FloatArray) -> FloatArray:
        """(k,) energy that the forces have given, bodies now at (k, d)."""
        way = (self.direction_b * (pose_b - self.pose_b)).sum(axis=1)
        way -= (self.direction_a * (pose_a - self.pose_a)).sum(axis=1)
        result: FloatArray = self.force * way
        return result


def _carried(point: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """(k, 2) where points of bodies get when these go from poses `before` to `after` (k, d)."""
    r = point - before[:, :2]
    if before.shape[1] == 3:
        r = rotated(r, after[:, 2] - before[:, 2])
    result: FloatArray = after[:, :2] + r
    return result

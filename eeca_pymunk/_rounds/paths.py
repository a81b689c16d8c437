"""Paths: where bodies are at every instant of a step, parabolas that impulses kink (design section 4)."""

from __future__ import annotations

import copy

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, put_rows
from ..closures.motion import Start


class Paths:
    """x(t) = origin + velocity t + acceleration t^2 / 2 of N bodies, t from the start of the step.

    An impulse at tau leaves x(tau) where it is and changes the branch that holds from then on, so that no instant of
    the step needs a substep of its own.

    Attributes:
        origin, velocity, acceleration: (N, 2) of the latest branch, extrapolated to the start of the step.
        since: (N,) time of the latest kink, from which the branch holds.
        pulled: whether any body has an acceleration.  uneven: whether two bodies' accelerations may differ.
        before: the paths with the branches that the latest kinks ended.
    """

    before: Paths

    def __init__(self, start: Start, moves: IntArray) -> None:
        self.origin, self.velocity = start.position.copy(), start.velocity.copy()
        self.since: FloatArray = np.zeros(len(start.position))
        self.pulled = start.pulled
        self.acceleration = start.acceleration.copy() if self.pulled else start.acceleration
        self.uneven = self.pulled and bool((start.acceleration[moves] != start.acceleration[moves[0]]).any())
        self.before = self.copy()

    def copy(self) -> Paths:
        """The paths as they are now, without what was before."""
        other = copy.copy(self)
        other.origin, other.velocity, other.since = self.origin.copy(), self.velocity.copy(), self.since.copy()
        if self.pulled:
            other.acceleration = self.acceleration.copy()
        return other

    def assign(self, other: Paths) -> None:
        """Take over the branches of `other`."""
        self.origin[:], self.velocity[:], self.since[:] = other.origin, other.velocity, other.since
        if self.pulled:
            self.acceleration[:] = other.acceleration
        self.uneven = other.uneven

    def changed(self, origin: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> BoolArray:
        """(N,) whether the latest branch is another one than that with these (N, d)."""
        other: BoolArray = np.zeros(len(origin), bool)
        for own, given in ((self.origin, origin), (self.velocity, velocity), (self.acceleration, acceleration)):
            for k in range(origin.shape[1]):
                other |= own[:, k] != given[:, k]
        return other

    def position(self, rows: IntArray, t: FloatArray) -> FloatArray:
        """(m, 2) positions of rows (m,) at (m,) instants."""
        t = t[:, None]
        at: FloatArray = self.origin.take(rows, axis=0) + t * self.velocity.take(rows, axis=0)
        if self.pulled:
            at += (0.5 * t * t) * self.acceleration.take(rows, axis=0)
        return at

    def rate(self, rows: IntArray, t: FloatArray) -> FloatArray:
        """(m, 2) velocities of rows (m,) at (m,) instants."""
        result: FloatArray = self.velocity.take(rows, axis=0)
        if self.pulled:
            result += t[:, None] * self.acceleration.take(rows, axis=0)
        return result

    def kick(self, rows: IntArray, t: FloatArray, change: FloatArray) -> None:
        """Change the velocities of distinct rows (m,) by (m, 2) at (m,) instants."""
        before = self.before
        origin, velocity = self.origin.take(rows, axis=0), self.velocity.take(rows, axis=0)
        put_rows(before.origin, rows, origin)
        put_rows(before.velocity, rows, velocity)
        before.since[rows] = self.since[rows]
        if self.pulled:
            put_rows(before.acceleration, rows, self.acceleration.take(rows, axis=0))
        put_rows(self.velocity, rows, velocity + change)
        put_rows(self.origin, rows, origin - t[:, None] * change)
        self.since[rows] = t

    def pull(self, rows: IntArray, t: FloatArray, acceleration: FloatArray) -> None:
        """Give distinct rows (m,) accelerations (m, 2) from (m,) instants on."""
        t, change = t[:, None], acceleration - self.acceleration[rows]
        self.acceleration[rows] = acceleration
        self.velocity[rows] -= t * change
        self.origin[rows] += (0.5 * t * t) * change
        self.uneven = self.uneven or bool(change.any())

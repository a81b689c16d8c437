"""The operator A = G M^-1 G^T of contacts of centred disks, which have no arms."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray


def restrict(row_a: IntArray, row_b: IntArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """The rows, out of `count`, that occur in both arrays, in increasing order, and both arrays renumbered to them."""
    occurs = np.zeros(count, bool)
    occurs[row_a] = occurs[row_b] = True
    rows = np.flatnonzero(occurs)
    number = np.empty(count, np.intp)
    number[rows] = np.arange(len(rows))
    return rows, number[row_a], number[row_b]


def islands(row_a: IntArray, row_b: IntArray, inverse_mass: FloatArray) -> IntArray:
    """(m,) label of the island of every contact; bodies of infinite mass do not connect."""
    moves = inverse_mass > 0
    label = np.arange(len(moves))  # (R,) of the bodies
    both = moves[row_a] & moves[row_b]
    a, b = row_a[both], row_b[both]
    while True:
        before = label.copy()
        lowest = np.minimum(before[a], before[b])
        # Hook the roots, not only the ends, so that labels travel along whole trees at once.
        np.minimum.at(label, before[a], lowest)
        np.minimum.at(label, before[b], lowest)
        label = label[label]
        if np.array_equal(label, before):
            return np.where(moves[row_a], label[row_a], label[row_b])


class Delassus:
    """The operator A = G M^-1 G^T of m contacts between R bodies, never assembled.

    G maps body velocities to normal relative velocities, u = n . (v_b - v_a); its transpose maps normal impulses
    to body impulses, +lam n on b and -lam n on a.

    Args:
        row_a, row_b: (m,) rows of the bodies of each contact.
        normal: (m, 2) vectors from a to b; unit normals, or the shorter discrete ones of the penalty steppers.
        inverse_mass: (R,) 1/mass, 0 for bodies that do not move.
    """

    def __init__(self, row_a: IntArray, row_b: IntArray, normal: FloatArray, inverse_mass: FloatArray) -> None:
        self.row_a, self.row_b, self.normal = row_a, row_b, normal
        self.inverse_mass = inverse_mass
        self._rows = np.concatenate((row_b, row_a))
        self._x, self._y = np.ascontiguousarray(normal[:, 0]), np.ascontiguousarray(normal[:, 1])

    @property
    def size(self) -> int:
        return len(self.row_a)

    def relative(self, velocity: FloatArray) -> FloatArray:
        """G v: (m,) normal relative velocity of (R, 2) velocities, negative when approaching."""
        difference = velocity[self.row_b] - velocity[self.row_a]
        result: FloatArray = self._x * difference[:, 0] + self._y * difference[:, 1]
        return result

    def impulse(self, lam: FloatArray) -> FloatArray:
        """G^T lam: (R, 2) impulse on every body."""
        x, y = self._x * lam, self._y * lam
        count = len(self.inverse_mass)
        total = np.empty((count, 2))
        total[:, 0] = np.bincount(self._rows, np.concatenate((x, -x)), count)
        total[:, 1] = np.bincount(self._rows, np.concatenate((y, -y)), count)
        return total

    def change(self, lam: FloatArray) -> FloatArray:
        """M^-1 G^T lam: (R, 2) change of the velocities."""
        return self.impulse(lam) * self.inverse_mass[:, None]

    def __matmul__(self, lam: FloatArray) -> FloatArray:
        return self.relative(self.change(lam))

    def dense(self) -> FloatArray:
        """A as an (m, m) array."""
        a, b = self.row_a, self.row_b
        # A_ij = (n_i . n_j) times the inverse mass of the bodies both contacts share, negative between a and b.
        shared = self.inverse_mass[a][:, None] * ((a[:, None] == a) * 1.0 - (a[:, None] == b))
        shared += self.inverse_mass[b][:, None] * ((b[:, None] == b) * 1.0 - (b[:, None] == a))
        result: FloatArray = shared * (self.normal @ self.normal.T)
        return result

    def take(self, which: IntArray) -> Delassus:
        """The operator of the contacts `which`, on the bodies they touch."""
        rows, row_a, row_b = restrict(self.row_a[which], self.row_b[which], len(self.inverse_mass))
        return Delassus(row_a, row_b, self.normal[which], self.inverse_mass[rows])

    def diagonal(self) -> FloatArray:
        """(m,) the diagonal of A, 1/mass."""
        square = self._x * self._x + self._y * self._y
        result: FloatArray = square * (self.inverse_mass[self.row_a] + self.inverse_mass[self.row_b])
        return result

    def shares_body(self) -> BoolArray:
        """(m,) whether a moving body of the contact has other contacts too."""
        degree = np.bincount(self._rows, minlength=len(self.inverse_mass)) * (self.inverse_mass > 0)
        result: BoolArray = (degree[self.row_a] > 1) | (degree[self.row_b] > 1)
        return result

    def row_bound(self) -> FloatArray:
        """(m,) a bound of sum_j |A_ij|: diag(row_bound) - A is positive semi-definite (Gershgorin)."""
        degree = np.bincount(self._rows, minlength=len(self.inverse_mass)) * self.inverse_mass
        result: FloatArray = degree[self.row_a] + degree[self.row_b]
        return result

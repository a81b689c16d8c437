"""The operator A = G M^-1 G^T of contacts, without and with arms (design sections 1, 6)."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .graph import restrict


class Delassus:
    """The operator A = G M^-1 G^T of m contacts between R bodies, never assembled.

    G maps body velocities to normal relative velocities, u = n . (v_b - v_a); its transpose maps normal impulses
    to body impulses, +lam n on b and -lam n on a (design section 1).

    Args:
        row_a, row_b: (m,) rows of the bodies of each contact.
        normal: (m, 2) vectors from a to b of length <= 1.
        inverse_mass: (R,) 1/mass, 0 for bodies that do not move.
    """

    def __init__(self, row_a: IntArray, row_b: IntArray, normal: FloatArray, inverse_mass: FloatArray) -> None:
        self.row_a, self.row_b, self.normal = row_a, row_b, normal
        self.inverse_mass = inverse_mass
        self.mobility: FloatArray = inverse_mass[:, None]
        self._rows = np.concatenate((row_b, row_a))
        self._x, self._y = np.ascontiguousarray(normal[:, 0]), np.ascontiguousarray(normal[:, 1])

    @property
    def size(self) -> int:
        return len(self.row_a)

    def relative(self, velocity: FloatArray) -> FloatArray:
        """G v: (m,) normal relative velocity of (R, d) velocities, negative when approaching."""
        difference = velocity[self.row_b] - velocity[self.row_a]
        result: FloatArray = self._x * difference[:, 0] + self._y * difference[:, 1]
        return result

    def impulse(self, lam: FloatArray) -> FloatArray:
        """G^T lam: (R, d) impulse on every body."""
        x, y = self._x * lam, self._y * lam
        count = len(self.inverse_mass)
        total = np.empty((count, 2))
        total[:, 0] = np.bincount(self._rows, np.concatenate((x, -x)), count)
        total[:, 1] = np.bincount(self._rows, np.concatenate((y, -y)), count)
        return total

    def change(self, lam: FloatArray) -> FloatArray:
        """M^-1 G^T lam: (R, d) change of the velocities."""
        return self.impulse(lam) * self.mobility

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


class ArmedDelassus(Delassus):
    """The same with arms: u = J_b . v_b - J_a . v_a with J = (n, r x n) and v = (velocity, angular velocity).

    Args:
        row_a, row_b: (m,).
        directions: J_a and J_b, (m, 3) each.
        mobility: (R, 3) 1/mass twice, and 1/moment; 0 for bodies that do not move.
    """

    def __init__(
        self, row_a: IntArray, row_b: IntArray, directions: tuple[FloatArray, FloatArray], mobility: FloatArray
    ) -> None:
        super().__init__(row_a, row_b, directions[0][:, :2], mobility[:, 0])
        self.mobility = mobility
        self.direction_a, self.direction_b = directions

    def relative(self, velocity: FloatArray) -> FloatArray:
        along_b = np.einsum("ij,ij->i", self.direction_b, velocity[self.row_b])
        result: FloatArray = along_b - np.einsum("ij,ij->i", self.direction_a, velocity[self.row_a])
        return result

    def impulse(self, lam: FloatArray) -> FloatArray:
        both = np.concatenate((lam[:, None] * self.direction_b, -lam[:, None] * self.direction_a))
        count = len(self.inverse_mass)
        return np.stack([np.bincount(self._rows, column, count) for column in both.T], axis=1)

    def dense(self) -> FloatArray:
        a, b = self.row_a, self.row_b
        result = np.zeros((self.size, self.size))
        for rows_i, J_i, sign_i in ((a, self.direction_a, -1.0), (b, self.direction_b, 1.0)):
            weighted = J_i * self.mobility[rows_i]
            for rows_j, J_j, sign_j in ((a, self.direction_a, -1.0), (b, self.direction_b, 1.0)):
                result += (sign_i * sign_j) * (rows_i[:, None] == rows_j) * (weighted @ J_j.T)
        return result

    def take(self, which: IntArray) -> ArmedDelassus:
        rows, row_a, row_b = restrict(self.row_a[which], self.row_b[which], len(self.inverse_mass))
        return ArmedDelassus(row_a, row_b, (self.direction_a[which], self.direction_b[which]), self.mobility[rows])

    def _parts(self) -> tuple[FloatArray, FloatArray]:
        """(m,) what bodies a and b add to the diagonal."""
        a = (self.direction_a**2 * self.mobility[self.row_a]).sum(axis=1)
        b = (self.direction_b**2 * self.mobility[self.row_b]).sum(axis=1)
        return a, b

    def diagonal(self) -> FloatArray:
        a, b = self._parts()
        return a + b

    def row_bound(self) -> FloatArray:
        # |A_ij| over a shared body is at most the product of the roots of what both add to their diagonals.
        a, b = (np.sqrt(part) for part in self._parts())
        total = np.bincount(self._rows, np.concatenate((b, a)), len(self.inverse_mass))
        result: FloatArray = a * total[self.row_a] + b * total[self.row_b]
        return result


def operator(
    row_a: IntArray, row_b: IntArray, directions: tuple[FloatArray, FloatArray], mobility: FloatArray
) -> Delassus:
    """The operator of contacts with directions (m, d) on bodies of mobility (R, d or 1): with arms where d = 3."""
    if directions[0].shape[1] == 2:
        return Delassus(row_a, row_b, directions[0], mobility[:, 0])
    return ArmedDelassus(row_a, row_b, directions, mobility)

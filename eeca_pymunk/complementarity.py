"""The frictionless contact problem 0 <= lam  _|_  A lam + q >= 0 with A = G M^-1 G^T (design section 6)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .bodies import BoolArray, FloatArray, IntArray


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


@dataclass(frozen=True)
class Impulses:
    """Solution of a complementarity problem.

    `lam` (m,); the iterations taken; whether the tolerance was met; whether only round-off is left.
    """

    lam: FloatArray
    iterations: int
    converged: bool
    exact: bool


_PIVOTED = 100  # contacts up to which pivoting beats projected gradients (measured on the hopper)
_DENSE = 160  # contacts up to which a dense matrix beats the operator
_PIVOTS = 25
_ROUND_OFF = 1e-10  # residual of a direct solution relative to the largest |q|
_SINGULAR = 1e8  # growth of a solution that tells a singular matrix


def solve(
    A: Delassus,
    q: FloatArray,
    compliance: FloatArray | float = 0.0,
    start: FloatArray | None = None,
    tolerance: float = 1e-12,
    max_iterations: int = 2000,
) -> Impulses:
    """Solve 0 <= lam _|_ (A + diag(compliance)) lam + q >= 0.

    Contacts that share no moving body with another are solved in closed form, few coupled ones directly by pivoting;
    where that fails (redundant contacts make A singular), and for many, by projected gradients.

    Args:
        q: (m,) velocity.  compliance: (m,) or scalar >= 0, 1/mass.
        start: (m,) first guess of lam, 0 if None.
        tolerance: bound of the residual, a velocity, relative to max |q|.
        max_iterations: of the projected gradients.
    """
    approaching = q < 0
    if not approaching.any():
        return Impulses(np.zeros(A.size), 0, True, True)
    compliance = np.broadcast_to(compliance, A.size)
    # Exact for a contact that shares no moving body with another.
    lam = np.where(approaching, -q, 0.0) / (A.diagonal() + compliance)
    coupled = np.flatnonzero(A.shares_body())
    if len(coupled) == 0:
        return Impulses(lam, 1, True, True)
    part = A.take(coupled)
    if len(coupled) > _PIVOTED:
        # An island in which nothing approaches needs no impulse.
        label = islands(part.row_a, part.row_b, part.inverse_mass)
        pressed = np.bincount(label, approaching[coupled])[label] > 0
        coupled = coupled[pressed]
        part = A.take(coupled)
    limit = tolerance * float(np.abs(q).max())
    q_part, c_part = q[coupled], compliance[coupled]
    matrix = part.dense() + np.diag(c_part) if len(coupled) <= _DENSE else None
    result = pivot(matrix, q_part) if matrix is not None and len(coupled) <= _PIVOTED else None
    if result is None:
        first = np.zeros(len(coupled)) if start is None else np.maximum(start[coupled], 0.0)
        D = part.row_bound() + c_part
        if matrix is None:
            result = project(lambda lam: part @ lam + c_part * lam, D, q_part, first, limit, max_iterations)
        else:
            result = project(matrix.dot, D, q_part, first, limit, max_iterations)
    lam[coupled] = result.lam
    return Impulses(lam, result.iterations, result.converged, result.exact)


def pivot(A: FloatArray, q: FloatArray) -> Impulses | None:
    """Block principal pivoting (Portugal, Judice, Vicente 1994) for a dense (m, m) A; None where it fails.

    Solves on a guess of the closed contacts, then exchanges every contact whose impulse or velocity has the wrong sign.
    """
    limit = _ROUND_OFF * float(np.abs(q).max(initial=0.0))
    diagonal = A.diagonal()
    closed = q < 0
    lam = np.zeros(len(q))
    for iteration in range(1, _PIVOTS + 1):
        lam[:] = 0.0
        k = np.flatnonzero(closed)
        # The second right-hand side is generic: it shows a singular matrix, whose impulses would be arbitrary.
        right = np.stack((-q[k], diagonal[k] * np.cos(k)), axis=1)
        try:
            both = np.linalg.solve(A[k[:, None], k], right)
        except np.linalg.LinAlgError:
            return None
        if np.abs(both[:, 1]).max(initial=0.0) > _SINGULAR:
            return None
        lam[k] = both[:, 0]
        wrong = np.where(closed, lam * diagonal, A @ lam + q) < -limit
        if not wrong.any():
            # A nearly singular matrix passes the signs and fails here.
            if np.abs(np.where(closed, A @ lam + q, 0.0)).max() > limit:
                return None
            return Impulses(np.maximum(lam, 0.0), iteration, True, True)
        closed ^= wrong
    return None


def project(
    multiply: Callable[[FloatArray], FloatArray],
    D: FloatArray,
    q: FloatArray,
    start: FloatArray,
    limit: float,
    max_iterations: int,
) -> Impulses:
    """Accelerated projected gradients (Nesterov) with the gradient restart of O'Donoghue and Candes.

    The metric is diagonal, D >= A, so that every step descends. `multiply` is the product with A; `limit` bounds the
    natural residual, a velocity.
    """
    y, t, lam = start, 1.0, start
    for iteration in range(1, max_iterations + 1):
        new = np.maximum(y - (multiply(y) + q) / D, 0.0)
        step = D * (new - y)
        # The residual is that of y; `new` is at least as good.
        if np.abs(step).max() <= limit:
            return Impulses(new, iteration, True, False)
        change = new - lam
        if np.dot(step, change) < 0.0:
            t, y = 1.0, new
        else:
            t_next = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * t * t))
            y = new + ((t - 1.0) / t_next) * change
            t = t_next
        lam = new
    return Impulses(lam, max_iterations, False, False)


def restrict(row_a: IntArray, row_b: IntArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """The rows of `count` that occur, increasing, and both arrays renumbered to them: few contacts, small arrays."""
    occurs = np.zeros(count, bool)
    occurs[row_a] = occurs[row_b] = True
    rows = np.flatnonzero(occurs)
    number = np.empty(count, np.intp)
    number[rows] = np.arange(len(rows))
    return rows, number[row_a], number[row_b]


def components(row_a: IntArray, row_b: IntArray, moves: BoolArray) -> IntArray:
    """(R,) label of the connected component of every body; bodies that do not move (moves (R,) bool) do not connect."""
    label = np.arange(len(moves))
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
            return label


def islands(row_a: IntArray, row_b: IntArray, inverse_mass: FloatArray) -> IntArray:
    """(m,) label of the connected component of every contact; bodies of infinite mass do not connect."""
    label = components(row_a, row_b, inverse_mass > 0)
    return np.where(inverse_mass[row_a] > 0, label[row_a], label[row_b])

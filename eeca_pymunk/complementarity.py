"""The frictionless contact problem 0 <= lam  _|_  A lam + q >= 0 with A = G M^-1 G^T (design section 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bodies import FloatArray, IntArray


class Delassus:
    """The operator A = G M^-1 G^T of m contacts between R bodies, never assembled.

    G maps body velocities to normal relative velocities, u = n . (v_b - v_a); its transpose maps normal impulses
    to body impulses, +lam n on b and -lam n on a (design section 1).

    Args:
        row_a, row_b: (m,) rows of the bodies of each contact.
        normal: (m, 2) unit vectors from a to b.
        inverse_mass: (R,) 1/mass, 0 for bodies that do not move.
    """

    def __init__(self, row_a: IntArray, row_b: IntArray, normal: FloatArray, inverse_mass: FloatArray) -> None:
        self.row_a, self.row_b, self.normal = row_a, row_b, normal
        self.inverse_mass = inverse_mass
        self._rows = np.concatenate((row_b, row_a))
        self._nx = np.concatenate((normal[:, 0], -normal[:, 0]))
        self._ny = np.concatenate((normal[:, 1], -normal[:, 1]))

    @property
    def size(self) -> int:
        return len(self.row_a)

    def relative(self, velocity: FloatArray) -> FloatArray:
        """G v: (m,) normal relative velocity of (R, 2) velocities, negative when approaching."""
        difference = velocity[self.row_b] - velocity[self.row_a]
        result: FloatArray = np.einsum("ij,ij->i", difference, self.normal)
        return result

    def impulse(self, lam: FloatArray) -> FloatArray:
        """G^T lam: (R, 2) impulse on every body."""
        weight = np.concatenate((lam, lam))
        count = len(self.inverse_mass)
        return np.stack(
            (
                np.bincount(self._rows, self._nx * weight, count),
                np.bincount(self._rows, self._ny * weight, count),
            ),
            axis=1,
        )

    def __matmul__(self, lam: FloatArray) -> FloatArray:
        return self.relative(self.impulse(lam) * self.inverse_mass[:, None])

    def row_bound(self) -> FloatArray:
        """(m,) a bound of sum_j |A_ij|: diag(row_bound) - A is positive semi-definite (Gershgorin)."""
        degree = np.bincount(self._rows, minlength=len(self.inverse_mass)) * self.inverse_mass
        result: FloatArray = degree[self.row_a] + degree[self.row_b]
        return result


@dataclass(frozen=True)
class Impulses:
    """Solution of a complementarity problem: `lam` (m,), the iterations taken, and whether the tolerance was met."""

    lam: FloatArray
    iterations: int
    converged: bool


def solve(
    A: Delassus,
    q: FloatArray,
    compliance: FloatArray | float = 0.0,
    start: FloatArray | None = None,
    tolerance: float = 1e-12,
    max_iterations: int = 2000,
) -> Impulses:
    """Solve 0 <= lam _|_ (A + diag(compliance)) lam + q >= 0 by accelerated projected gradients.

    Nesterov's method with the diagonal metric D = row_bound + compliance (>= A, so every step descends) and the
    gradient restart of O'Donoghue and Candes. An isolated contact is solved by its first step, because D = A there.

    Args:
        q: (m,) velocity. compliance: (m,) or scalar >= 0, 1/mass.
        start: (m,) first guess of lam, 0 if None.
        tolerance: bound of the natural residual |lam - max(0, lam - D^-1 grad)| D, relative to max |q|.
    """
    m = A.size
    lam = np.zeros(m) if start is None else np.maximum(start, 0.0)
    scale = float(np.max(np.abs(q), initial=0.0))
    if start is None and (scale == 0.0 or bool((q >= 0).all())):
        return Impulses(lam, 0, True)
    D = A.row_bound() + compliance
    limit = tolerance * scale
    y, t = lam, 1.0
    for iteration in range(1, max_iterations + 1):
        gradient = A @ y + compliance * y + q
        new = np.maximum(y - gradient / D, 0.0)
        step = new - y
        residual = float(np.max(np.abs(step) * D))
        # The residual is measured at y, so y is the iterate that meets it: both differ by less than the tolerance.
        if residual <= limit:
            return Impulses(new, iteration, True)
        change = new - lam
        if float(np.dot(step * D, change)) < 0.0:
            t, y = 1.0, new
        else:
            t_next = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * t * t))
            y = new + ((t - 1.0) / t_next) * change
            t = t_next
        lam = new
    return Impulses(lam, max_iterations, False)


def restrict(row_a: IntArray, row_b: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """The rows that occur, and both arrays renumbered to them: work on a few contacts costs nothing in N."""
    rows, inverse = np.unique(np.concatenate((row_a, row_b)), return_inverse=True)
    return rows, inverse[: len(row_a)], inverse[len(row_a) :]


def islands(row_a: IntArray, row_b: IntArray, inverse_mass: FloatArray) -> IntArray:
    """(m,) label of the connected component of every contact; bodies of infinite mass do not connect."""
    label = np.arange(len(inverse_mass))
    moves_a, moves_b = inverse_mass[row_a] > 0, inverse_mass[row_b] > 0
    a, b = row_a[moves_a & moves_b], row_b[moves_a & moves_b]
    while True:
        before = label.copy()
        lowest = np.minimum(before[a], before[b])
        # Hook the roots, not only the ends, so that labels travel along whole trees at once.
        np.minimum.at(label, before[a], lowest)
        np.minimum.at(label, before[b], lowest)
        label = label[label]
        if np.array_equal(label, before):
            return np.where(moves_a, label[row_a], label[row_b])

"""The frictionless contact problem 0 <= lam  _|_  A lam + q >= 0 with A = G M^-1 G^T."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from .delassus import Delassus, islands


@dataclass(frozen=True)
class Impulses:
    """Solution of a complementarity problem: impulses (m,), iterations taken, whether the tolerance was met."""

    lam: FloatArray
    iterations: int
    converged: bool


_PIVOTED = 100  # contacts up to which pivoting is faster than projected gradients, in the hopper
_DENSE = 160  # contacts up to which a dense matrix is faster than the operator
_PIVOTS = 25  # exchanges, at most: pivoting may cycle
_ROUND_OFF = 1e-10  # residual of a direct solution relative to the largest |q|
_SINGULAR = 1e8  # size of the solution for a generic right-hand side above which the matrix counts as singular


def solve(
    A: Delassus, q: FloatArray, compliance: FloatArray | float = 0.0, start: FloatArray | None = None,
    tolerance: float = 1e-12, max_iterations: int = 2000,
) -> Impulses:  # fmt: skip
    """Solve 0 <= lam _|_ (A + diag(compliance)) lam + q >= 0.

    Contacts that share no moving body with another are solved in closed form, few coupled ones directly by pivoting;
    where that fails (redundant contacts make A singular), and for many, by projected gradients.

    Args:
        q: (m,) velocity.  compliance: (m,) or scalar >= 0, 1/mass.
        start: (m,) first guess of lam, 0 if None.
        tolerance: of projected gradients: bound of the residual, a velocity, relative to max |q|; pivoting is within
            `_ROUND_OFF`.
        max_iterations: of the projected gradients.
    """
    approaching = q < 0
    if not approaching.any():
        return Impulses(np.zeros(A.size), 0, True)
    compliance = np.broadcast_to(compliance, A.size)
    # Exact for a contact that shares no moving body with another.
    lam = np.where(approaching, -q, 0.0) / (A.diagonal() + compliance)
    coupled = np.flatnonzero(A.shares_body())
    if len(coupled) == 0:
        return Impulses(lam, 1, True)
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
    return Impulses(lam, result.iterations, result.converged)


def pivot(A: FloatArray, q: FloatArray) -> Impulses | None:
    """Block principal pivoting (Portugal, Judice, Vicente 1994) for a dense (m, m) A; None if it fails.

    Solves on a guess of the closed contacts, then exchanges every contact whose impulse or velocity has the wrong sign.
    """
    limit = _ROUND_OFF * float(np.abs(q).max(initial=0.0))
    diagonal = A.diagonal()
    closed = q < 0
    lam = np.zeros(len(q))
    for iteration in range(1, _PIVOTS + 1):
        lam[:] = 0.0
        k = np.flatnonzero(closed)
        # The second right-hand side is generic: its solution is huge if the matrix is singular and impulses are
        # arbitrary.
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
            return Impulses(np.maximum(lam, 0.0), iteration, True)
        closed ^= wrong
    return None


def project(
    multiply: Callable[[FloatArray], FloatArray], D: FloatArray, q: FloatArray, start: FloatArray, limit: float,
    max_iterations: int,
) -> Impulses:  # fmt: skip
    """Accelerated projected gradients (Nesterov 1983) with the gradient restart of O'Donoghue and Candes (2015).

    The metric is diagonal, D >= A, so that a step without acceleration descends. `multiply` is the product with A;
    `limit` bounds the natural residual, a velocity.
    """
    y, t, lam = start, 1.0, start
    for iteration in range(1, max_iterations + 1):
        new = np.maximum(y - (multiply(y) + q) / D, 0.0)
        step = D * (new - y)
        # The residual is that of y; `new` is at least as good.
        if np.abs(step).max() <= limit:
            return Impulses(new, iteration, True)
        change = new - lam
        if np.dot(step, change) < 0.0:
            t, y = 1.0, new
        else:
            t_next = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * t * t))
            y = new + ((t - 1.0) / t_next) * change
            t = t_next
        lam = new
    return Impulses(lam, max_iterations, False)

"""Contact laws of few contacts to round-off: sweeps find which act, a direct solution on these does the rest."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..joints.boxes import SINGLE
from ..model.contacts import Row
from ..model.parameters.joints import (
    COLUMN_CONTACTS,
    COLUMN_PROXIMAL,
    COLUMN_ROUNDS,
    COLUMN_SWEEPS,
    COLUMN_SWEEPS_AFTER,
)
from ..rows.build import normal_rate, tangent_rate
from ..rows.conjugate import accelerate
from ..rows.dense import back, decompose, unknowns
from ..rows.inplace import copy
from ..rows.polish import clamp, classify
from .bounded import Bounded, bounded_rate, inside, push_row
from .columns import Columns, push_columns
from .sweeping import relax_columns, sweep_columns

_BOUNDED = 2  # kind of unknown, beside 0 normal, 1 tangential


@uncounted
def clear(D: FloatArray) -> None:
    """D (k, 3) = 0."""
    for q in range(len(D)):
        for c in range(3):
            D[q, c] = 0.0


@uncounted
def entries(C: Columns, j: int, tangent: bool, slip: float, D: FloatArray, HIT: IntArray, mark: int) -> None:
    """D (k, 3): the change of velocities per tangential impulse of contact j, or per normal one with its slip; HIT (k,)
    is `mark` where there is any."""
    clear(D)
    for w in range(C.AT[j], C.AT[j + 1]):
        HIT[C.BODY[w]] = mark
        for c in range(3):
            D[C.BODY[w], c] = C.T[w, c] if tangent else C.N[w, c] + slip * C.T[w, c]


@uncounted
def bounded_entries(D: Bounded, j: int, V: FloatArray, HIT: IntArray, mark: int) -> None:
    """As `entries`, of bounded row j."""
    clear(V)
    for w in range(D.AT[j], D.AT[j + 1]):
        HIT[D.BODY[w]] = mark
        for c in range(3):
            V[D.BODY[w], c] = D.N[w, c]


@uncounted
def responses(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], slip: FloatArray, at: IntArray, kind: IntArray,
    N: int, V: FloatArray, HIT: IntArray, W: FloatArray,
) -> None:  # fmt: skip
    """W (N, N): the rate of each unknown's row per impulse of each; V (k, 3) and HIT (k,), of zeros, are scratch."""
    for j in range(N):
        if kind[j] == _BOUNDED:
            bounded_entries(D, at[j], V, HIT, j + 1)
        else:
            entries(C, at[j], kind[j] == 1, slip[at[j]], V, HIT, j + 1)
        for i in range(N):
            k = at[i]
            if kind[i] == _BOUNDED:
                W[i, j] = bounded_rate(D, k, V)
            elif HIT[A[k]] != j + 1 and HIT[B[k]] != j + 1:
                W[i, j] = 0.0
            elif kind[i] == 0:
                W[i, j] = normal_rate(A, B, ROWS, V, k)
            else:
                W[i, j] = tangent_rate(A, B, ROWS, V, k) - ROWS[k].surface
        W[j, j] += abs(W[j, j]) / COLUMN_PROXIMAL


@uncounted
def first_at_bound(
    D: Bounded, L: FloatArray, m: int, at: IntArray, kind: IntArray, N: int, x: FloatArray
) -> tuple[int, float]:  # fmt: skip
    """The first bounded row of the N unknowns that comes to a bound while impulses change by x, and the part of x by
    then; -1 and 1 if none does. Those of discs are kept in them afterwards."""
    hit, part = -1, 1.0
    for k in range(N):
        i = at[k]
        if kind[k] != _BOUNDED or D.ROWS[i].part != SINGLE or x[k] == 0.0:
            continue
        until = ((D.ROWS[i].high if x[k] > 0.0 else D.ROWS[i].low) - L[m + i, 0]) / x[k]
        if until < part:
            hit, part = k, until
    return hit, part


@kernel
def direct(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int,
    shared: bool,
) -> None:  # fmt: skip
    """Newton's step of the law on the contacts that act in L and on the bounded rows inside of their bounds, which are
    kept in their cones and bounds; V follows.

    Rows may contradict one another (motors of legs whose feet stick): impulses then grow until one of them comes to its
    bound. So the step goes as far as the first bounded row that does, which is kept there, and on without it.
    """
    held, stuck = np.empty(m, np.int64), np.empty(m, np.int64)
    slip, rest = np.empty(m), np.empty(m)
    classify(A, B, ROWS, L, V, m, held, stuck, slip, rest)
    at, kind = np.empty(2 * m + D.USED[0], np.int64), np.empty(2 * m + D.USED[0], np.int64)
    push_columns(C, L, m, -1.0, V)
    N = unknowns(ROWS, L, m, held, stuck, slip, shared, at, kind)
    push_columns(C, L, m, 1.0, V)
    for i in range(D.USED[0]):
        if inside(D, L, m, i):
            at[N], kind[N] = i, _BOUNDED
            N += 1
    W, X, order = np.empty((N, N)), np.empty_like(V), np.empty(N, np.int64)
    r, x, HIT = np.empty(N), np.empty(N), np.empty(len(V), np.int64)
    hit, whole = N, 0
    while whole < 2:
        if hit >= 0:
            for q in range(len(V)):
                HIT[q] = 0
            responses(C, D, A, B, ROWS, slip, at, kind, N, X, HIT, W)
            decompose(W, N, order)
        for k in range(N):
            i = at[k]
            if kind[k] == _BOUNDED:
                r[k] = -D.ROWS[i].speed - bounded_rate(D, i, V)
            elif kind[k] == 0:
                r[k] = ROWS[i].target - normal_rate(A, B, ROWS, V, i)
            else:
                if stuck[i] == 2 and L[i, 1] != 0.0:
                    rest[i] = -ROWS[i].ut - L[i, 0] * min(ROWS[i].un + ROWS[i].target, 0.0) / L[i, 1]
                r[k] = rest[i] - tangent_rate(A, B, ROWS, V, i)
        back(W, N, order, r, x)
        hit, part = first_at_bound(D, L, m, at, kind, N, x)
        push_columns(C, L, m, -1.0, V)
        for k in range(N):
            i = at[k]
            if kind[k] == _BOUNDED:
                change = part * x[k]
                if k == hit:
                    change = (D.ROWS[i].high if x[k] > 0.0 else D.ROWS[i].low) - L[m + i, 0]
                L[m + i, 0] += change
                push_row(D, i, change, V)
                continue
            L[i, kind[k]] += part * x[k]
            if kind[k] == 0 and stuck[i] == 0:
                L[i, 1] = slip[i] * L[i, 0]
        push_columns(C, L, m, 1.0, V)
        if hit >= 0:
            N -= 1
            for k in range(hit, N):
                at[k], kind[k] = at[k + 1], kind[k + 1]
        else:
            whole += 1
    push_columns(C, L, m, -1.0, V)
    clamp(ROWS, L, m)
    push_columns(C, L, m, 1.0, V)
    for i in range(D.USED[0]):
        change = min(max(L[m + i, 0], D.ROWS[i].low), D.ROWS[i].high) - L[m + i, 0]
        L[m + i, 0] += change
        push_row(D, i, change, V)


@kernel
def iterate_columns(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int,
    tolerance: float, most: int,
) -> float:  # fmt: skip
    """At most so many sweeps, accelerated as in `..rows.conjugate.iterate`; the change of the last, which is plain."""
    FLAT, FAST = L.reshape(L.size), V.reshape(V.size)
    size = 2 * (m + D.USED[0])
    L0, V0, PL, PV = FLAT[:size].copy(), FAST.copy(), np.zeros(size), np.zeros(V.size)
    change, worst = -1.0, np.inf
    for done in range(1, most + 1):
        worst = sweep_columns(C, D, A, B, ROWS, L, V, m)
        if worst <= tolerance or done == most:
            break
        change = accelerate(FLAT, FAST, L0, V0, PL, PV, change, done >= most - 1)
    return worst


@kernel
def solve_columns(
    C: Columns, D: Bounded, A: IntArray, B: IntArray, ROWS: Rows[Row], L: FloatArray, V: FloatArray, m: int,
    tolerance: float, most: int,
) -> float:  # fmt: skip
    """Impulses L (m contacts, then the bounded rows D) and velocities V by sweeps, at most `most`, and for few contacts
    by direct solutions between them.

    Where direct solutions stop to help, or come back to where they were, sweeps go on from the best of them.
    Returns the last sweep's largest change of a contact's velocity.
    """
    if m > COLUMN_CONTACTS:
        return iterate_columns(C, D, A, B, ROWS, L, V, m, tolerance, most)
    worst = iterate_columns(C, D, A, B, ROWS, L, V, m, tolerance, COLUMN_SWEEPS)
    best, L0, V0 = worst, L.copy(), V.copy()
    last, before_last = np.inf, np.inf
    for turn in range(COLUMN_ROUNDS):
        if worst <= tolerance:
            return worst
        direct(C, D, A, B, ROWS, L, V, m, turn % 2 == 1)
        worst = relax_columns(C, D, A, B, ROWS, L, V, m, tolerance, COLUMN_SWEEPS_AFTER)[1]
        if worst < best:
            best = worst
            copy(L0, L)
            copy(V0, V)
        elif not worst < 100.0 * best:
            break
        if abs(worst - before_last) <= 0.5 * worst:
            break
        last, before_last = worst, last
    if worst > tolerance:
        copy(L, L0)
        copy(V, V0)
        worst = iterate_columns(C, D, A, B, ROWS, L, V, m, tolerance, most)
    return worst

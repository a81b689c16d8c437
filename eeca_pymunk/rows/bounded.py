"""Rows of bounded impulses (motors, and joints with a finite max_force), as unknowns beside those of contacts.

A row is bounded alone (low <= lambda <= high), or both rows of a pivot by a disc, x^2 + y^2 <= high^2; at the end of a
groove by that half of it in which its second row pushes inwards. Inside the bounds the velocity along the row equals
its target; at a bound its difference to the target has the opposite sign of the impulse. `on_interval` and
`on_half_disc` are that law of one row and of two, all other impulses given; `sweep_bounded` applies it row by row.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, kernel, nonallocating
from ..compiled.records import zeros
from ..model.contacts import BOUNDED_ROW, Bounded
from ..model.parameters.joints import BOX_SECULAR

SINGLE, FIRST_OF_DISC, SECOND_OF_DISC = 0.0, 1.0, 2.0


@inlined
def on_interval(a: float, u: float, x: float, low: float, high: float) -> float:
    """The impulse x' in low ... high with u + a (x' - x) = 0, else the bound at which this has the other sign than x'.
    If no impulse changes the velocity u, a = 0, it is at the bound against u."""
    to = x - u / a if a > 0.0 else low if u > 0.0 else high if u < 0.0 else x
    return min(max(to, low), high)


@nonallocating
def on_disc(
    a: float, b: float, c: float, ux: float, uy: float, x: float, y: float, bound: float
) -> tuple[float, float]:  # fmt: skip
    """The impulses p = (x', y') with u + W (p - p0) = 0, where u = (ux, uy) is the velocity at
    the impulses p0 = (x, y), and W = [a b; b c] its change by unit impulses. If they are outside the disc |p| <=
    `bound`, those on its rim with u + W (p - p0) = -s p, s > 0: (W + s) p = W p0 - u, by Newton's method for s in the
    frame of W's axes."""
    turn = 0.5 * math.atan2(2.0 * b, a - c)
    co, si = math.cos(turn), math.sin(turn)
    w1 = a * co * co + 2.0 * b * co * si + c * si * si
    w2 = a * si * si - 2.0 * b * co * si + c * co * co
    w1, w2 = max(w1, 1e-300), max(w2, 1e-14 * w1, 1e-300)
    # With the same w as below, so that what these iterations end at obeys the law, whatever the error of w: W is not
    # symmetric over long intervals, and its symmetric part may have a negative eigenvalue.
    g1, g2 = w1 * (x * co + y * si) - ux * co - uy * si, w2 * (y * co - x * si) - uy * co + ux * si
    p1, p2 = g1 / w1, g2 / w2
    if p1 * p1 + p2 * p2 > bound * bound:
        s = 0.0
        for _ in range(BOX_SECULAR):
            p1, p2 = g1 / (w1 + s), g2 / (w2 + s)
            length = math.sqrt(p1 * p1 + p2 * p2)
            if not bound > 0.0 or length <= bound * (1.0 + 1e-15):
                break
            slope = p1 * p1 / (w1 + s) + p2 * p2 / (w2 + s)
            s += (length / bound - 1.0) * length * length / slope
        length = math.sqrt(p1 * p1 + p2 * p2)
        if length > bound:
            p1, p2 = p1 * bound / length, p2 * bound / length
    return p1 * co - p2 * si, p1 * si + p2 * co


@inlined
def leaves_half(y: float, half: tuple[float, float]) -> bool:
    """Whether the second impulse of a disc is outside the `half` of it (low, high), one of which is 0; never if it is a
    whole one."""
    return (y < 0.0 and half[0] >= 0.0) or (y > 0.0 and half[1] <= 0.0)


@nonallocating
def on_half_disc(
    a: float, b: float, c: float, ux: float, uy: float, x: float, y: float, bound: float, half: tuple[float, float]
) -> tuple[float, float]:  # fmt: skip
    """`on_disc`, of the half of a disc in which y' is in `half` (or of all of it): if the impulses on the disc are
    outside, the nearest ones by W are on the edge, y' = 0."""
    to, other = on_disc(a, b, c, ux, uy, x, y, bound)
    if leaves_half(other, half):
        return on_interval(a, ux - b * y, x, -bound, bound), 0.0
    return to, other


@kernel
def room_for_rows(n: int, entries: int) -> Bounded:
    """Empty bounded rows: n rows, whose columns have so many entries together."""
    # Few arrays: each allocation takes as long as a row.
    NUMBERS, PAIRS = np.zeros(n + 2 + entries, np.int64), np.zeros((2 * n, 2), np.int64)
    return Bounded(
        NUMBERS[:1], NUMBERS[1 : n + 2], NUMBERS[n + 2 :], np.zeros((entries, 3)), PAIRS[:n], np.zeros((n, 6)),
        zeros(n, BOUNDED_ROW), PAIRS[n:],
    )  # fmt: skip


@nonallocating
def bounded_rate(B: Bounded, i: int, V: FloatArray) -> float:
    """Velocity of the island's bodies along row i, at velocities V (k, 3)."""
    total = 0.0
    for end in range(2):
        if B.END[i, end] >= 0:
            for c in range(3):
                total += B.ROW[i, 3 * end + c] * V[B.END[i, end], c]
    return total


@nonallocating
def per_impulse(B: Bounded, i: int, j: int) -> float:
    """Change of the velocity along row i by a unit impulse of row j."""
    total = 0.0
    for w in range(B.AT[j], B.AT[j + 1]):
        for end in range(2):
            if B.BODY[w] == B.END[i, end]:
                for c in range(3):
                    total += B.ROW[i, 3 * end + c] * B.N[w, c]
    return total


@nonallocating
def inside_discs(B: Bounded, L: FloatArray, m: int) -> bool:
    """Whether all impulses L[m:, 0] of discs are inside these, so that all their rows have their target velocities."""
    for i in range(B.NUMBER[0]):
        if B.ROWS[i].part == FIRST_OF_DISC:
            x, y, bound = L[m + i, 0], L[m + i + 1, 0], B.ROWS[i].high
            if not (x * x + y * y < bound * bound and B.ROWS[i + 1].low < y < B.ROWS[i + 1].high):
                return False
    return True


@nonallocating
def weigh_rows(B: Bounded) -> None:
    """Set what unit impulses of the rows change along them: `a_own` and `cross`."""
    for i in range(B.NUMBER[0]):
        B.ROWS[i].a_own = per_impulse(B, i, i)
        if B.ROWS[i].part == FIRST_OF_DISC:
            B.ROWS[i].cross = 0.5 * (per_impulse(B, i, i + 1) + per_impulse(B, i + 1, i))


@nonallocating
def push_row(B: Bounded, i: int, change: float, V: FloatArray) -> None:
    """Add the change of velocities by an impulse `change` of row i to V (k, 3)."""
    if change != 0.0:
        for w in range(B.AT[i], B.AT[i + 1]):
            for c in range(3):
                V[B.BODY[w], c] += change * B.N[w, c]


@nonallocating
def sweep_bounded(B: Bounded, L: FloatArray, m: int, V: FloatArray) -> float:
    """One sweep over the bounded rows, whose impulses are L[m:, 0]; updates L and V, and returns the largest change of
    a velocity along a row."""
    worst = 0.0
    for i in range(B.NUMBER[0]):
        part, low, high = B.ROWS[i].part, B.ROWS[i].low, B.ROWS[i].high
        if part == SECOND_OF_DISC:
            continue
        a, x = B.ROWS[i].a_own, L[m + i, 0]
        if not a > 0.0:
            continue
        u = B.ROWS[i].speed + bounded_rate(B, i, V)
        if part == SINGLE:
            L[m + i, 0] = on_interval(a, u, x, low, high)
        else:
            b, c, y = B.ROWS[i].cross, B.ROWS[i + 1].a_own, L[m + i + 1, 0]
            if not c > 0.0:
                continue
            other = B.ROWS[i + 1].speed + bounded_rate(B, i + 1, V)
            half = B.ROWS[i + 1].low, B.ROWS[i + 1].high
            L[m + i, 0], L[m + i + 1, 0] = on_half_disc(a, b, c, u, other, x, y, high, half)
            push_row(B, i + 1, L[m + i + 1, 0] - y, V)
            worst = max(worst, abs(L[m + i + 1, 0] - y) * c)
        push_row(B, i, L[m + i, 0] - x, V)
        worst = max(worst, abs(L[m + i, 0] - x) * a)
    return worst

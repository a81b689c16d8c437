"""The energy that contacts of an island with joints lose; impulses scaled until that is what their laws require."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded, Row
from ..model.joints import Joints
from ..model.parameters.joints import BOUNDED_SWEEPS, LOCK_TRIES
from ..model.scene import Scene
from ..rows.bounded import sweep_bounded
from ..rows.build import normal_rate, slip_rate
from ..rows.columns import push_columns
from ..rows.energy import loss_of_scaled
from .advance import Interval, advance_aligned, farthest_apart
from .bounded_rows import with_bounded


@nonallocating
def slip_of(row: Row, WAY: FloatArray, h: float) -> float:
    """Way of the slip of a contact in h. Bodies enter by their ways WAY and not by WAY/h, whose round-off is large if h
    is short."""
    return slip_rate(row, WAY) + h * (row.surface + row.swung)


@nonallocating
def lost(interval: Interval, L: FloatArray) -> float:
    """The energy that contacts lose with impulses L in an interval; exact, as the work of L on the ways."""
    WAY, h, total = interval.motion.WAY, interval.h, 0.0
    for i in range(interval.m):
        row = interval.ROWS[i]
        total -= (L[i, 0] * normal_rate(row, WAY) + L[i, 1] * slip_of(row, WAY, h)) / h
    return total


@nonallocating
def work_error(interval: Interval, L: FloatArray, slow: float, pull: float, known: float) -> float:
    """Round-off of the energy that contacts lose: 1e-15, some spacings of numbers, of the island's energy, and `known`
    times the sum of impulses times speed. `slow`, `pull`: see `iteration.solve_contacts`."""
    isle, h = interval.isle, interval.h
    energy, pressed = 0.0, 0.0
    for q in range(interval.n):
        energy += (isle.V[q, 0] ** 2 + isle.V[q, 1] ** 2 + (pull * h) ** 2) / isle.IM[q]
    for i in range(interval.m):
        pressed += abs(L[i, 0]) + abs(L[i, 1])
    return 1e-15 * energy + known * pressed * (slow + pull * h)


@kernel
def without_contacts(interval: Interval, L: FloatArray, B: Bounded) -> FloatArray:
    """Velocities (k, 3) of the motion without the impulses L of contacts, by the columns; bounded impulses follow by
    sweeps over their rows alone."""
    V, X = interval.motion.EVEN.copy(), with_bounded(B, np.empty((0, 2)), 0)
    push_columns(interval.C, L, interval.m, -1.0, V)
    for _ in range(BOUNDED_SWEEPS if B.NUMBER[0] > 0 else 0):
        if sweep_bounded(B, X, 0, V) <= 0.0:
            break
    return V


@kernel
def scale_of_loss(interval: Interval, L: FloatArray, B: Bounded, more: float) -> tuple[float, float]:
    """Factor s of impulses L with which contacts lose `more` energy than with s = 1, from the slope p - 2 q of their
    loss there, 0 if that does not grow with less impulses; and by how much velocities then change."""
    FREE = without_contacts(interval, L, B)
    p, q = loss_of_scaled(interval.ROWS, L, interval.motion.EVEN, FREE, interval.m)
    slope = p - 2.0 * q
    s = 1.0 + more / slope if slope < 0.0 else 0.0
    return s, abs(1.0 - s) * farthest_apart(interval.motion.EVEN, FREE, interval.isle.EXTENT, interval.n)


@kernel
def lock_jointed(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool, elastic: bool, owed: float,
    error: float, bent: float,
) -> float:  # fmt: skip
    """Scale the impulses L of contacts by s until these lose at least `owed`, or if `elastic` exactly that, up to
    `error`. s follows from the slope p - 2 q at s = 1, again for each new motion; without work it does so once. Returns
    the error of the arms (`advance_aligned`), which was `bent`.

    The loss of s L is p s - q s^2, so that a step of Newton's method from s = 1 is of use near 1. Beyond 0.1 < s < 2
    the impulses are halved, if they have to lose no more than nothing: for small s the loss has the sign of p. Else,
    and for elastic ones beyond 0 < s < 2, they are dropped, as they are after the last attempt."""
    m = interval.m
    for tries in range(LOCK_TRIES + 1):
        loss = lost(interval, L)
        if loss >= owed - error and (not elastic or loss <= owed + error):
            break
        s, _ = scale_of_loss(interval, L, B, owed - loss)
        spent = J.PROGRESS.effort > J.PROGRESS.share
        if tries == LOCK_TRIES or (spent and tries > 0) or (elastic and not 0.0 < s < 2.0):
            s = 0.0
        elif not 0.1 < s < 2.0:
            s = 0.5 if owed <= 0.0 and not spent else 0.0
        for i in range(m):
            L[i, 0] = s * L[i, 0] if s > 0.0 else 0.0
            L[i, 1] = s * L[i, 1] if s > 0.0 else 0.0
        bent = advance_aligned(A, J, interval, L, B, free)
        if s == 0.0:
            break
    return bent

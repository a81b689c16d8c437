"""The energy that contacts of an island with joints lose, and impulses scaled until it is what they have to lose."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded, Row
from ..model.joints import Joints
from ..model.parameters.joints import PRESS_LOCKS
from ..model.scene import Scene
from ..rows.build import normal_rate, slip_rate, tangent_rate
from ..rows.columns import push_columns
from .advance import Interval, advance_aligned
from .bounded_rows import settle_bounded


@nonallocating
def slip_of(row: Row, WAY: FloatArray, h: float) -> float:
    """How far a contact slips in h while bodies go WAY: its surfaces move at a rate, bodies by ways, of which nothing
    may be rounded away where h is short."""
    return slip_rate(row, WAY) + h * (row.surface + row.swung)


@nonallocating
def lost(interval: Interval, L: FloatArray) -> float:
    """What contacts lose with impulses L in an interval: their part in the energy of the island, exactly."""
    WAY, h, total = interval.motion.WAY, interval.h, 0.0
    for i in range(interval.m):
        row = interval.ROWS[i]
        total -= (L[i, 0] * normal_rate(row, WAY) + L[i, 1] * slip_of(row, WAY, h)) / h
    return total


@nonallocating
def work_error(interval: Interval, L: FloatArray, slow: float, pull: float, known: float) -> float:
    """Round-off of the energy that contacts lose: of the energy of the island, and of their works, of whose impulses
    times speed it is the part `known`. `slow`, `pull`: see `press.solve_contacts`."""
    isle, h = interval.isle, interval.h
    energy, pressed = 0.0, 0.0
    for q in range(interval.n):
        energy += (isle.V[q, 0] ** 2 + isle.V[q, 1] ** 2 + (pull * h) ** 2) / isle.IM[q]
    for i in range(interval.m):
        pressed += abs(L[i, 0]) + abs(L[i, 1])
    return 1e-15 * energy + known * pressed * (slow + pull * h)


@kernel
def lock_jointed(
    A: Scene, J: Joints, interval: Interval, L: FloatArray, B: Bounded, free: bool, elastic: bool, owed: float,
    error: float,
) -> None:  # fmt: skip
    """Scale the impulses L of contacts by s until these lose `owed` at least, or if `elastic` just that, but for
    `error`. The loss is a quadratic function, D(s) = s p - s^2 q."""
    ROWS, motion, C, m = interval.ROWS, interval.motion, interval.C, interval.m
    for tries in range(PRESS_LOCKS + 1):
        loss = lost(interval, L)
        if loss >= owed - error and (not elastic or loss <= owed + error):
            break
        p, q2 = 0.0, 0.0
        FREE = motion.MEAN.copy()
        push_columns(C, L, m, -1.0, FREE)
        settle_bounded(B, FREE)
        for i in range(m):
            for tangent in range(2):
                before = ROWS[i].ut if tangent == 1 else ROWS[i].un
                if tangent == 1:
                    without, after = tangent_rate(ROWS[i], FREE), tangent_rate(ROWS[i], motion.MEAN)
                else:
                    without, after = normal_rate(ROWS[i], FREE), normal_rate(ROWS[i], motion.MEAN)
                p -= 0.5 * L[i, tangent] * (before + without)
                q2 += 0.5 * L[i, tangent] * (after - without)
        # By its slope at s = 1.
        slope = p - 2.0 * q2
        s = 1.0 + (owed - loss) / slope if slope < 0.0 else 0.0
        if tries == PRESS_LOCKS or J.PROGRESS.effort > J.PROGRESS.share or (elastic and not 0.0 < s < 2.0):
            s = 0.0
        elif not 0.1 < s < 2.0:
            # The loss of s L has the sign of s p for small s: half of them, again and again.
            s = 0.5 if owed <= 0.0 else 0.0
        for i in range(m):
            L[i, 0] = s * L[i, 0] if s > 0.0 else 0.0
            L[i, 1] = s * L[i, 1] if s > 0.0 else 0.0
        advance_aligned(A, J, interval, L, B, free)
        if s == 0.0:
            break

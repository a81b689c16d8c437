"""What the iterations between the contacts and the components of an interval change (`iteration`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..model.contacts import Bounded
from ..model.joint_steps import LONG, Agreement
from ..model.joints import Joints
from ..model.scene import Scene
from ..rows.laws import take_slips
from .advance import Interval, farthest_apart
from .bounded_rows import make_bounded
from .contact_laws import Manner, manner_of
from .groups import is_free


class Iterates(NamedTuple):
    """What the iterations of one interval change: impulses (m, 2) of its m contacts, velocities (k, 3) of its k bodies.

    L: the present impulses.  USED: those of the last motion.  BEST: those of the motion that agreed best.
    B: bounded rows of the joints; NOW: their impulses in the motion before the last one.
    BEFORE: velocities of the motion before the last one.  FORESEEN: by the contacts' laws for the next one.  UNKNOWN
    (0, 3): in its place where none are foreseen.
    SLIP: (m,) slips of the contacts before the interval, by which energy limits friction once rows have them again.
    manner: how contacts are solved.  free: whether nothing outside holds the island.
    """

    L: FloatArray
    USED: FloatArray
    BEST: FloatArray
    B: Bounded
    NOW: FloatArray
    BEFORE: FloatArray
    FORESEEN: FloatArray
    UNKNOWN: FloatArray
    SLIP: FloatArray
    manner: Manner
    free: bool


@kernel
def begin_iterates(A: Scene, J: Joints, interval: Interval, L: FloatArray) -> Iterates:
    """The iterates before the first motion, with impulses L as guesses; slips are taken from the contacts."""
    isle, groups, ROWS, _, _, m, n, _, _, few = interval
    k, B = len(isle.IM), make_bounded(J, groups, few)
    VELOCITIES = np.empty((2 * k, 3))
    return Iterates(
        L, L.copy(), L.copy(), B, np.empty(len(B.OF)), VELOCITIES[:k], VELOCITIES[k:], VELOCITIES[:0],
        take_slips(ROWS, m), manner_of(A, interval), is_free(isle, groups, n, J),
    )  # fmt: skip


@nonallocating
def begin_agreement(S: Agreement, slow: float, fast: float, pull: float, owed: float, h: float) -> None:
    """The record before the first motion in an interval h; the other arguments are its fields."""
    S.slow, S.fast, S.pull, S.owed, S.top_speed = slow, fast, pull, owed, fast + pull * h
    S.least = S.reached = np.inf
    S.residual = S.bent = 0.0
    S.of_least = S.rough = S.limited = S.filled = S.agreed = S.converged = 0


@nonallocating
def gives_up(J: Joints, more: float) -> bool:
    """Whether a long interval that is not solved is given up, as it has no work for `more` operations."""
    return bool(J.PROGRESS.attempt == LONG and J.PROGRESS.effort + more >= J.PROGRESS.share)


@nonallocating
def difference(interval: Interval, V: FloatArray) -> float:
    """The largest difference between the motion and velocities V (k, 3), of any point of its bodies."""
    return farthest_apart(interval.motion.EVEN, V, interval.isle.EXTENT, interval.n)

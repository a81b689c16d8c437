"""What pays for a penetration correction: losses of the contacts up to a cost, and beyond it what moves by itself.

A body without mobility that the program moves, or has placed into others, does the work of lifting them: that is
external. All else is deducted from what contacts have lost: in the interval, less what the island owes. What was lost
before in the step pays too

* where a contact is deeper than SLIGHT_DEPTH, as of boxes dropped on one another by a long step: once they are at rest
  nothing would lift them;
* in an island of one body, which lifts no other;
* in a free island: lifting costs kinetic energy there, as the angular momentum stays, and sinking has released it;
* in an island with joints.

Elsewhere impacts would pay for what truncated solves let sink, and stir piles again and again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..contacts.forces import shapes_of
from ..geometry.widths import depth_limit
from ..model.bodies import MOVED
from ..model.contacts import Row
from ..model.islands import Island
from ..model.parameters.intervals import SLIGHT_DEPTH
from ..model.scene import Scene
from ..rows.build import conserves, normal_rate
from .at_rest import moves_itself


class Payment(NamedTuple):
    """Energy that a correction may cost, none if below 0, and the part of its cost up to which losses pay."""

    budget: float
    payable: float


@nonallocating
def was_placed(A: Scene, isle: Island, n: int) -> bool:
    """Whether the program has moved a body without mobility into an island of n bodies."""
    for q in range(n, len(isle.WHO)):
        if A.MEMBER[isle.WHO[q]].placed == MOVED and A.BODY[isle.WHO[q]].inv_mass == 0.0:
            return True
    return False


@nonallocating
def how_deep(
    A: Scene, isle: Island, ROWS: Rows[Row], L: FloatArray, V: FloatArray, n: int, m: int
) -> tuple[bool, bool]:  # fmt: skip
    """Whether any of m contacts of an island of n bodies is deeper than SLIGHT_DEPTH; and whether one is deeper than an
    interval allows in a body that moves by itself, but for contacts that push with no impulse L (m, 2) and open at
    velocities V (k, 3), as they part without it."""
    deep = False
    for z in range(m):
        if ROWS[z].gap >= 0.0:
            continue
        a, b = shapes_of(A, ROWS[z])
        most = depth_limit(A, a, b)
        deep = deep or ROWS[z].gap < -SLIGHT_DEPTH * most
        q = max(ROWS[z].a, ROWS[z].b)  # bodies without mobility are the last ones
        if ROWS[z].gap < -most and q >= n and moves_itself(A, isle.WHO[q]):
            if L[z, 0] != 0.0 or not normal_rate(ROWS[z], V) > 0.0:
                return True, True
    return deep, False


@nonallocating
def payment(
    A: Scene, isle: Island, ROWS: Rows[Row], L: FloatArray, V: FloatArray, n: int, m: int, lost: float, before: float,
    placed: bool, jointed: bool,
) -> Payment:  # fmt: skip
    """What pays for the correction of an island of n bodies and m contacts.

    Args:
        L, V: impulses (m, 2) of the contacts, and velocities (k, 3) at the end of their interval.
        lost: energy that contacts have lost in the interval.
        before: earlier in this step; what is owed if below 0.
        placed: whether it `was_placed` into.  jointed: whether the island has joints.
    """
    deep, driven = how_deep(A, isle, ROWS, L, V, n, m)
    counts = jointed or n == 1 or len(isle.WHO) == n or deep
    # Elastic contacts have no losses; what they seem to lose is round-off.
    losses = -1.0 if conserves(ROWS, m) else lost + (before if counts else min(before, 0.0))
    payable = 0.0 if placed else max(losses, 0.0) if driven else math.inf
    return Payment(math.inf if payable < math.inf else losses, payable)

"""How far contacts may close in one interval, by their rows, which are linear, and by the poses at its end."""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..geometry.gap import gap_at
from ..geometry.manifold import half_width
from ..geometry.sides import remembers
from ..model.contacts import Row
from ..model.islands import Island
from ..model.parameters.intervals import INTERVAL_DEPTH, INTERVAL_DEPTH_LEAST, INTERVAL_DEPTH_WIDTH, INTERVAL_RETRY
from ..model.scene import Scene


@nonallocating
def depth_limit(small: float, thick: float) -> float:
    """Depth (length) by which a contact may close in one interval. small: the smaller extent of both shapes.  thick:
    the sum of their half widths."""
    return max(min(INTERVAL_DEPTH * small, INTERVAL_DEPTH_WIDTH * thick), INTERVAL_DEPTH_LEAST * small)


@nonallocating
def driven(A: Scene, isle: Island, P: IntArray, Q: IntArray, ROWS: Rows[Row], KEY: IntArray, n: int, m: int) -> bool:
    """Whether a moving body without mobility is deeper in an island of n bodies, at any of m contacts, than an interval
    allows: the work of lifting beyond what losses pay is then external."""
    shapes = A.SHAPE.shape[0]
    for z in range(m):
        q = max(P[z], Q[z])  # bodies without mobility are the last ones
        if q < n or A.BODY[isle.WHO[q]].inv_mass > 0.0:
            continue
        if isle.V[q, 0] == 0.0 and isle.V[q, 1] == 0.0 and isle.V[q, 2] == 0.0:
            continue
        a, b = (KEY[z] >> 1) // shapes, (KEY[z] >> 1) % shapes
        small = min(A.SHAPE[a].extent, A.SHAPE[b].extent)
        if ROWS[z].gap < -depth_limit(small, half_width(A, a) + half_width(A, b)):
            return True
    return False


@nonallocating
def too_deep(A: Scene, a: int, b: int, gap: float, closing: float) -> float:
    """How many times too long an interval is in which a contact of shapes a and b with this gap closes by `closing`
    (lengths); 0 if it is not."""
    small = min(A.SHAPE[a].extent, A.SHAPE[b].extent)
    if not closing > INTERVAL_DEPTH_LEAST * small:
        return 0.0
    deep = depth_limit(small, half_width(A, a) + half_width(A, b))
    room = max(gap, 0.0) + deep
    if closing > room + 0.5 * deep:
        return max(closing / room, 1.01 * INTERVAL_RETRY)
    return 0.0


@kernel
def too_deep_at_end(
    A: Scene, isle: Island, END: FloatArray, P: IntArray, Q: IntArray, ROWS: Rows[Row], KEY: IntArray, m: int,
    every: bool,
) -> float:  # fmt: skip
    """How many times too long an interval is at whose poses END (k, 3) a contact is deeper than its linear row
    predicts; 0 if it is not. `every`: of all pairs, else of thin shapes only."""
    far, shapes, last = 0.0, A.SHAPE.shape[0], -1
    for z in range(m):
        pair = KEY[z] >> 1
        a, b, p, q = pair // shapes, pair % shapes, P[z], Q[z]
        if pair == last or not (every or remembers(A, a, b)):
            continue
        last = pair
        if isle.WHO[p] != A.LINK[a].owner:
            p, q = q, p
        gap = ROWS[z].gap
        if z + 1 < m and KEY[z + 1] >> 1 == pair:
            gap = min(gap, ROWS[z + 1].gap)
        end = gap_at(A, a, END[p, 0], END[p, 1], END[p, 2], b, END[q, 0], END[q, 1], END[q, 2])[0]
        far = max(far, too_deep(A, a, b, gap, gap - end))
    # The error of linear rows grows with the square of the length, at least.
    return max(math.sqrt(far), 1.01 * INTERVAL_RETRY) if far > 0.0 else 0.0

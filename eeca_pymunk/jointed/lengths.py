"""How long spans of islands with joints are: as `..impacts.coming` has it for others.

Bodies that may meet go no farther about one another than half of the smaller one, nor turn by more than half a radian,
nor off the straight way by more than half their size; contacts go no deeper than they have room for. What slides along
a body that impulses do not move stays what it is.
"""

from __future__ import annotations

from ..arrays import IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..geometry.flight import norm
from ..geometry.manifold import half_width
from ..impacts.coming import hurried
from ..impacts.depths import sunk, too_deep
from ..model.contacts import Row
from ..model.islands import Island
from ..model.joints import Joints
from ..model.parameters.intervals import EXACT_CONTACTS, INTERVAL_ANGLE, INTERVAL_DEPTH_LEAST, INTERVAL_WAY
from ..model.scene import Scene
from ..rows.build import normal_rate
from .advance import Motion


@uncounted
def in_haste(A: Scene, J: Joints) -> bool:
    """Whether spans are to last to the end of the step, as much of its work is done."""
    return hurried(A) or J.PROGRESS.effort > J.PROGRESS.budget


@uncounted
def turns(A: Scene, i: int) -> bool:
    """Whether body i has a shape that is not round."""
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        if A.LINK[s].vertices > 1:
            return True
    return False


@uncounted
def length_ahead(A: Scene, found: IntArray, MINE: IntArray, n: int, h: float) -> float:
    """The part of a span h that the n bodies MINE, in the pairs of shapes `found`, may go with the velocities that they
    have."""
    BODY, rate = A.BODY, 0.0
    for q in range(n):
        i = MINE[q]
        if turns(A, i):
            rate = max(rate, abs(BODY[i].spin) / INTERVAL_ANGLE)
    for c in range(found.shape[0]):
        a, b = found[c, 0], found[c, 1]
        i, j = A.LINK[a].owner, A.LINK[b].owner
        if BODY[i].inv_mass > 0.0 and BODY[j].inv_mass > 0.0:
            small = min(A.SHAPE[a].extent, A.SHAPE[b].extent)
            rate = max(rate, norm(BODY[j].vx - BODY[i].vx, BODY[j].vy - BODY[i].vy) / (INTERVAL_WAY * small))
    return h if rate * h <= 1.0 else 1.0 / rate


@uncounted
def too_long(
    A: Scene, isle: Island, P: IntArray, Q: IntArray, ROWS: Rows[Row], KEY: IntArray, motion: Motion, m: int, n: int,
    h: float,
) -> float:  # fmt: skip
    """How many times too long the span h is in which n bodies move so, under m contacts."""
    far, shapes = 0.0, A.SHAPE.shape[0]
    for q in range(n):
        i = isle.WHO[q]
        if turns(A, i):
            far = max(far, abs(motion.END[q, 2] - isle.POSE[q, 2]) / INTERVAL_ANGLE)
        x, y = motion.WAY[q, 0] - h * isle.V[q, 0], motion.WAY[q, 1] - h * isle.V[q, 1]
        far = max(far, norm(x, y) / (INTERVAL_WAY * isle.EXTENT[q]))
    for z in range(m):
        pair = KEY[z] >> 1
        a, b = pair // shapes, pair % shapes
        small = min(A.SHAPE[a].extent, A.SHAPE[b].extent)
        p, q = P[z], Q[z]
        if isle.IM[p] > 0.0 and isle.IM[q] > 0.0:
            x, y = motion.WAY[q, 0] - motion.WAY[p, 0], motion.WAY[q, 1] - motion.WAY[p, 1]
            far = max(far, norm(x, y) / (INTERVAL_WAY * small))
        closing = -normal_rate(P, Q, ROWS, motion.WAY, z)
        if closing > INTERVAL_DEPTH_LEAST * small:
            thick = half_width(A.SHAPE, A.LINK, A.VERTEX, a) + half_width(A.SHAPE, A.LINK, A.VERTEX, b)
            far = max(far, too_deep(ROWS[z].gap, closing, small, thick, m <= EXACT_CONTACTS))
    return max(far, sunk(A, isle, motion.END, P, Q, ROWS, KEY, m, True))

"""What joints will do in the next part of a step of order 4, from what they did in the parts before.

The five parts of Suzuki's composition, of lengths s_k h about the instants t_k, repeat from step to step. The midpoint
rule lets rates r = G v of the rows ring where parts end, r_{k+1} = s_k^2 f(t_k) - r_k: positions fit, velocities do to
second order. So accelerations by joints are smooth in t_k but for (r_{k+1} - r_k)/s_k and what goes with s_k^2, and

    1, t, t^2, s^2, (-1)^k / s, (c_k - 2 r_k)/s_k with c_k = s_k^2/2, r_{k+1} = c_k - r_k

are six functions that six parts determine. WEIGHTS[p] foretells part p exactly for each of them, from the last part to
the sixth last; impulses over the lengths of their parts go the same way. Newton's method then begins with errors
smaller by (h rate)^2 than with the last accelerations. Sound after two steps of one length; a beginning, no more.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import merged
from .scratch import L_ROWS, LAM, LEAD

PARTS, DEPTH = 5, 6
WEIGHTS: FloatArray = np.array([
    [4.847322101863073, 5.847322101863073, 0.0, -5.847322101863073, -4.847322101863073, 1.0],
    [2.415830022234291, -2.4314920796287818, -5.847322101863073, 0.0, 3.4314920796287818, 3.4314920796287818],
    [0.6299605249474366, 0.4463784241210271, 0.0, -0.4463784241210271, 1.0, -0.6299605249474366],
    [1.5874010519681996, -0.7085815800256255, 0.0, 0.7085815800256255, 1.0, -1.5874010519681996],
    [-1.0, 0.0, 1.704017368006175, 0.7085815800256255, -0.704017368006175, 0.29141841997437445],
])  # fmt: skip

# PAST (1 + n + m, 18): of an island the first row, then one of each body, then one of each joint.
COUNTED, LENGTH_OF_STEP = 0, 1  # of the first row: parts that are known, modulo 30 from 30 on; length of their steps
NEWEST = 6  # 6-11, of the first row: weights by place, scratch
PAST_COLUMNS = 3 * DEPTH  # accelerations of a body, or impulses over time of a joint (two), by place


@merged
def forget(past: FloatArray) -> None:
    """Begin anew."""
    past[0, COUNTED] = 0.0


@merged
def recalls(past: FloatArray, h: float) -> bool:
    """Whether the parts of a step h can be foretold; if they cannot, begin anew."""
    if past[0, LENGTH_OF_STEP] != h:
        past[0, COUNTED], past[0, LENGTH_OF_STEP] = 0.0, h
    return bool(past[0, COUNTED] >= DEPTH)


@merged
def foretell(
    past: FloatArray, part: int, piece: float, loops: bool, hinge: FloatArray, link: IntArray, joints: int,
    local: FloatArray, bodies: int,
) -> None:  # fmt: skip
    """LEAD and, unless rows are redundant, LAM of this part of length `piece`."""
    count = int(past[0, COUNTED])
    for k in range(DEPTH):
        past[0, NEWEST + (count - 1 - k) % DEPTH] = WEIGHTS[part, k]
    for i in range(bodies):
        for c in range(3):
            total = 0.0
            for w in range(DEPTH):
                total += past[0, NEWEST + w] * past[1 + i, DEPTH * c + w]
            local[i, LEAD + c] = total
    for k in range(0 if loops else joints):
        for r in range(link[k, L_ROWS]):
            total = 0.0
            for w in range(DEPTH):
                total += past[0, NEWEST + w] * past[1 + bodies + k, DEPTH * r + w]
            hinge[k, LAM + r] = total * piece


@merged
def remember(
    past: FloatArray, piece: float, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int
) -> None:
    """Keep LEAD and LAM of the part of length `piece` that was taken."""
    count = int(past[0, COUNTED])
    at = count % DEPTH
    for i in range(bodies):
        for c in range(3):
            past[1 + i, DEPTH * c + at] = local[i, LEAD + c]
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            past[1 + bodies + k, DEPTH * r + at] = hinge[k, LAM + r] / piece
    past[0, COUNTED] = count + 1 if count + 1 < 2 * PARTS * DEPTH else PARTS * DEPTH

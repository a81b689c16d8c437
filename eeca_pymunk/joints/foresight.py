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
from ..compiled import merged, uncounted
from .layout import COUNTED, COUNTED_OF, PAST_LED, PAST_PUSH
from .scratch import L_A, L_B, L_JOINT, L_ROWS, LAM, LEAD

PARTS, DEPTH = 5, 6
WEIGHTS: FloatArray = np.array([
    [4.847322101863073, 5.847322101863073, 0.0, -5.847322101863073, -4.847322101863073, 1.0],
    [2.415830022234291, -2.4314920796287818, -5.847322101863073, 0.0, 3.4314920796287818, 3.4314920796287818],
    [0.6299605249474366, 0.4463784241210271, 0.0, -0.4463784241210271, 1.0, -0.6299605249474366],
    [1.5874010519681996, -0.7085815800256255, 0.0, 0.7085815800256255, 1.0, -1.5874010519681996],
    [-1.0, 0.0, 1.704017368006175, 0.7085815800256255, -0.704017368006175, 0.29141841997437445],
])  # fmt: skip


@uncounted
def forget(joint: FloatArray, link: IntArray, joints: int) -> None:
    """Begin anew."""
    for k in range(joints):
        joint[link[k, L_JOINT], COUNTED] = 0.0


@uncounted
def recalls(joint: FloatArray, link: IntArray, joints: int, h: float) -> bool:
    """Whether the parts of a step h of these joints can be foretold; where they know not the same, they begin anew."""
    count, same = joint[link[0, L_JOINT], COUNTED], True
    for k in range(joints):
        j = link[k, L_JOINT]
        same = same and joint[j, COUNTED] == count and joint[j, COUNTED_OF] == h
    if not same:
        for k in range(joints):
            joint[link[k, L_JOINT], COUNTED], joint[link[k, L_JOINT], COUNTED_OF] = 0.0, h
    return bool(same and count >= DEPTH)


@merged
def weigh(part: int, last: int, place: int) -> float:
    """The weight of what stands at a place, where the newest stands at `last`."""
    return float(WEIGHTS[part, last - place if place <= last else last - place + DEPTH])


@merged
def extrapolate(
    joint: FloatArray, j: int, column: int, w0: float, w1: float, w2: float, w3: float, w4: float, w5: float
) -> float:  # fmt: skip
    """What follows the six values at `column`, by the weights of their places."""
    old = w0 * joint[j, column] + w1 * joint[j, column + 1] + w2 * joint[j, column + 2]
    return float(old + (w3 * joint[j, column + 3] + w4 * joint[j, column + 4] + w5 * joint[j, column + 5]))


@uncounted
def foretell(
    joint: FloatArray, part: int, piece: float, loops: bool, hinge: FloatArray, link: IntArray, joints: int,
    local: FloatArray,
) -> None:  # fmt: skip
    """LEAD and, unless rows are redundant, LAM of this part of length `piece`."""
    last = (int(joint[link[0, L_JOINT], COUNTED]) - 1) % DEPTH
    w0, w1, w2 = weigh(part, last, 0), weigh(part, last, 1), weigh(part, last, 2)
    w3, w4, w5 = weigh(part, last, 3), weigh(part, last, 4), weigh(part, last, 5)
    for k in range(joints):
        j = link[k, L_JOINT]
        for c in range(6):
            i = link[k, L_A] if c < 3 else link[k, L_B]
            local[i, LEAD + c % 3] = extrapolate(joint, j, PAST_LED + DEPTH * c, w0, w1, w2, w3, w4, w5)
        for r in range(0 if loops else link[k, L_ROWS]):
            hinge[k, LAM + r] = piece * extrapolate(joint, j, PAST_PUSH + DEPTH * r, w0, w1, w2, w3, w4, w5)


@uncounted
def remember(
    joint: FloatArray, piece: float, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray
) -> None:
    """Keep LEAD and LAM of the part of length `piece` that was taken."""
    count = int(joint[link[0, L_JOINT], COUNTED])
    at = count % DEPTH
    for k in range(joints):
        j = link[k, L_JOINT]
        for c in range(6):
            i = link[k, L_A] if c < 3 else link[k, L_B]
            joint[j, PAST_LED + DEPTH * c + at] = local[i, LEAD + c % 3]
        for r in range(link[k, L_ROWS]):
            joint[j, PAST_PUSH + DEPTH * r + at] = hinge[k, LAM + r] / piece
        joint[j, COUNTED] = count + 1 if count + 1 < 2 * PARTS * DEPTH else PARTS * DEPTH

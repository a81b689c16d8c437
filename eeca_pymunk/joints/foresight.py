"""Predicted accelerations and impulses of joints for the next part of a step of order 4, from those of earlier parts.

The five parts of Suzuki's composition, of lengths s_k h at the instants t_k, repeat from step to step. With the
midpoint rule the rates r_k = G v of the rows at the start of part k alternate, r_{k+1} = s_k^2 f(t_k) - r_k with a
smooth f: positions satisfy the joints, velocities to second order. So accelerations by joints are smooth in t_k except
for (r_{k+1} - r_k)/s_k and a term in s_k^2. That difference is the one of p_k, the solution for f = 1/2, and a multiple
of the homogeneous solution (-1)^k:

    1, t, t^2, s^2, (-1)^k / s, (p_{k+1} - p_k)/s_k with p_{k+1} = s_k^2/2 - p_k

are six functions that six parts determine. WEIGHTS[p] extrapolates each of them to part p exactly, from the last part
to the sixth last (`tests/joints/test_foresight.py`); likewise impulses over the lengths of their parts. Newton's method
then begins with errors smaller by (h rate)^2 than with the last accelerations. Its result does not depend on where it
begins.

Before each part `ladder.take_parts` tests whether six parts are stored (`recalls`), begins with the extrapolated values
if so (`predict_part`), and stores each part that was solved (`remember_part`). A step of another length
(`begin_steps`), an edit, a limit, or whatever else ends the sequence calls `forget_parts`.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.joints import Workspace

SUZUKI_PARTS, DEPTH = 5, 6
WEIGHTS: FloatArray = np.array([
    [4.847322101863073, 5.847322101863073, 0.0, -5.847322101863073, -4.847322101863073, 1.0],
    [2.415830022234291, -2.4314920796287818, -5.847322101863073, 0.0, 3.4314920796287818, 3.4314920796287818],
    [0.6299605249474366, 0.4463784241210271, 0.0, -0.4463784241210271, 1.0, -0.6299605249474366],
    [1.5874010519681996, -0.7085815800256255, 0.0, 0.7085815800256255, 1.0, -1.5874010519681996],
    [-1.0, 0.0, 1.704017368006175, 0.7085815800256255, -0.704017368006175, 0.29141841997437445],
])  # fmt: skip


@nonallocating
def forget_parts(W: Workspace) -> None:
    """Forget all parts: the next six are not predicted."""
    for k in range(W.joints):
        W.J.JOINT[W.link[k].joint].known_parts = 0


@nonallocating
def begin_steps(W: Workspace, h: float) -> None:
    """Before a step h: forget all parts if the joints have stored different numbers of them, or parts of steps of
    another length."""
    joint, link = W.J.JOINT, W.link
    count, same = joint[link[0].joint].known_parts, True
    for k in range(W.joints):
        j = link[k].joint
        same = same and joint[j].known_parts == count and joint[j].known_step == h
    if not same:
        forget_parts(W)
        for k in range(W.joints):
            joint[link[k].joint].known_step = h


@nonallocating
def recalls(W: Workspace) -> bool:
    """Whether the next part can be predicted."""
    return bool(W.J.JOINT[W.link[0].joint].known_parts >= DEPTH)


@inlined
def weight_of(part: int, last: int, place: int) -> float:
    """The weight for this part of the values at a place of the ring of DEPTH parts, whose newest is at `last`."""
    return float(WEIGHTS[part, last - place if place <= last else last - place + DEPTH])


@inlined
def extrapolate(past: FloatArray, c: int, w0: float, w1: float, w2: float, w3: float, w4: float, w5: float) -> float:
    """The value that follows the six values past[c] of the ring, by the weights of their places."""
    old = w0 * past[c, 0] + w1 * past[c, 1] + w2 * past[c, 2]
    return float(old + (w3 * past[c, 3] + w4 * past[c, 4] + w5 * past[c, 5]))


@nonallocating
def predict_part(W: Workspace, part: int, piece: float, cold: bool) -> None:
    """Set `lead` of this part (0 to 4) of length `piece`, and `lam` unless it begins without (`cold`)."""
    joint, link = W.J.JOINT, W.link
    last = (joint[link[0].joint].known_parts - 1) % DEPTH
    w0, w1, w2 = weight_of(part, last, 0), weight_of(part, last, 1), weight_of(part, last, 2)
    w3, w4, w5 = weight_of(part, last, 3), weight_of(part, last, 4), weight_of(part, last, 5)
    for k in range(W.joints):
        j = link[k].joint
        for c in range(6):
            W.J.LOCAL[link[k].body[c // 3]].lead[c % 3] = extrapolate(joint[j].past_led, c, w0, w1, w2, w3, w4, w5)
        for r in range(0 if cold else link[k].rows):
            W.J.HINGE[k].lam[r] = piece * extrapolate(joint[j].past_push, r, w0, w1, w2, w3, w4, w5)


@nonallocating
def store(W: Workspace, at: int, piece: float) -> None:
    """Store `lead` and `lam` of a part of length `piece` that was taken at a place of the DEPTH there are."""
    joint, link = W.J.JOINT, W.link
    for k in range(W.joints):
        j = link[k].joint
        for c in range(6):
            joint[j].past_led[c, at] = W.J.LOCAL[link[k].body[c // 3]].lead[c % 3]
        for r in range(link[k].rows):
            joint[j].past_push[r, at] = W.J.HINGE[k].lam[r] / piece


@nonallocating
def remember_part(W: Workspace, piece: float) -> None:
    """`store` the part of length `piece` that was taken after the known ones. Their number counts up to 2 DEPTH, then
    again from DEPTH on: all are known, and its remainder by DEPTH is the place of the next."""
    joint, link = W.J.JOINT, W.link
    count = joint[link[0].joint].known_parts
    store(W, count % DEPTH, piece)
    for k in range(W.joints):
        joint[link[k].joint].known_parts = count + 1 if count + 1 < 2 * DEPTH else DEPTH

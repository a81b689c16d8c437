"""How far a joint is from its limits, and at what rate it nears them. Rows must have been computed (see `newton`)."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .entries import along
from .layout import GROOVE, LOWER, NOTCH, RATCHET, ROTARY_LIMIT, SLIDE, TOOTH, UPPER
from .scratch import AFTER, BEFORE, L_JOINT, L_KIND, L_ROWS, L_SIDE, L_SOFT, LAM, MEASURE, ROWS, SIZE, TARGET

TOUCH = 1e-12  # a gap below this, over the size of the island, is closed


@uncounted
def bounded(joint: FloatArray, link: IntArray, k: int, side: int) -> bool:
    """Whether joint k has a bound at this side."""
    kind, j = link[k, L_KIND], link[k, L_JOINT]
    if kind == RATCHET:
        return bool(side * joint[j, TOOTH] < 0.0)
    if kind == SLIDE and side < 0:
        return bool(joint[j, LOWER] > 0.0)
    if kind in (SLIDE, ROTARY_LIMIT, GROOVE):
        return bool(abs(joint[j, UPPER if side > 0 else LOWER]) < 1e300)
    return False


@uncounted
def gap(joint: FloatArray, hinge: FloatArray, link: IntArray, k: int, side: int) -> float:
    """How far joint k is from its bound at this side at the end of the present iterate, negative beyond it."""
    j = link[k, L_JOINT]
    bound = joint[j, UPPER if side > 0 else LOWER]
    if link[k, L_KIND] == RATCHET:
        bound = joint[j, NOTCH]
    return float(side * (bound - hinge[k, MEASURE]))


@uncounted
def hold(joint: FloatArray, hinge: FloatArray, link: IntArray, k: int) -> None:
    """Hold joint k, which stands on a limit, where it is for the rest of the step, however little is left of that.

    To close a gap of round-off in a part as short would take any force. Rows must be those of the present poses.
    """
    side = link[k, L_SIDE]
    at = hinge[k, MEASURE]
    bound = at + side * gap(joint, hinge, link, k, side)
    off = 0.5 * (at * at / bound - bound) if link[k, L_KIND] == SLIDE else at - bound
    hinge[k, TARGET + link[k, L_ROWS] - 1] = off


@uncounted
def approach(hinge: FloatArray, link: IntArray, k: int, side: int, local: FloatArray, column: int) -> float:
    """Rate of the gap by the discrete rows, with the velocities at `column`."""
    return -side * along(hinge, link, k, ROWS + 6 * (link[k, L_ROWS] - 1), local, column)


@uncounted
def standing(link: IntArray, joints: int) -> bool:
    """Whether a joint stands on a limit."""
    count = 0
    for k in range(joints):
        count += abs(link[k, L_SIDE])
    return count > 0


@uncounted
def release(link: IntArray, hinge: FloatArray, joints: int) -> bool:
    """Let go of the held limit that pulls most, if one does."""
    worst, which = 0.0, -1
    for k in range(joints):
        if link[k, L_SIDE] != 0 and link[k, L_SOFT] == 0:
            pull = hinge[k, LAM + link[k, L_ROWS] - 1] * link[k, L_SIDE]
            if pull > worst:
                worst, which = pull, k
    if which < 0:
        return False
    link[which, L_SIDE] = 0
    hinge[which, LAM + link[which, L_ROWS] - 1] = 0.0
    return True


@uncounted
def first_bound(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, h: float, found: FloatArray
) -> int:
    """The free limit that a step h passes first, by the mean rate of its gap; or -1.

    found[0] is its side, found[1] the estimate of the instant.
    """
    which = -1
    for k in range(joints):
        if link[k, L_SIDE] != 0 or link[k, L_SOFT] != 0:
            continue
        for side in (-1, 1):
            if not bounded(joint, link, k, side):
                continue
            end = gap(joint, hinge, link, k, side)
            if end >= -TOUCH * hinge[k, SIZE]:
                continue
            rate = approach(hinge, link, k, side, local, BEFORE) + approach(hinge, link, k, side, local, AFTER)
            start = max(end - 0.5 * h * rate, 0.0)
            when = h * start / (start - end)
            if which < 0 or when < found[1]:
                which, found[0], found[1] = k, float(side), when
    return which

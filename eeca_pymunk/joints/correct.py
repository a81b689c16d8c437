"""Velocities made to fit the joints, as an impact does at which nothing bounces; `solve` makes the passes.

Kinetic energy only falls, and momentum stays, for the change is M^-1 G^T times impulses that bring G v to 0.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .bounds import TOUCH, approach, bounded, gap
from .entries import held
from .layout import SUPPORTS
from .scratch import BEFORE, KEPT, L_A, L_B, L_ROWS, L_SIDE, L_SOFT, MOBILITY, PUSHED, ROWS, SCALE, SIZE

_ROUND_OFF = 1e-14
_STEPS_LEAVE = 1e-2  # of the speeds along a row, what is taken to be left by steps


@uncounted
def kinetic(local: FloatArray, bodies: int, column: int) -> float:
    """Kinetic energy of what joints can move, of the velocities at `column`."""
    total = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                total += 0.5 * local[i, column + c] ** 2 / local[i, MOBILITY + c]
    return total


@uncounted
def book_fit(local: FloatArray, bodies: int, ledger: FloatArray, loss: int) -> None:
    """Book the change of velocities, from KEPT to BEFORE, that made them fit their joints, as this `loss`.

    It is orthogonal to what fits, so that (1/2) dv.M dv is lost; the rest of the change of kinetic energy is the work
    of supports, which is 0 unless they move.
    """
    gained = kinetic(local, bodies, BEFORE) - kinetic(local, bodies, KEPT)
    lost, moves = 0.0, False
    for i in range(bodies):
        for c in range(3):
            if local[i, MOBILITY + c] > 0.0:
                lost += 0.5 * (local[i, BEFORE + c] - local[i, KEPT + c]) ** 2 / local[i, MOBILITY + c]
            elif local[i, BEFORE + c] != 0.0:
                moves = True
    ledger[loss] += lost if moves else -gained
    if moves:
        ledger[SUPPORTS] += gained + lost


@uncounted
def keep(hinge: FloatArray, joints: int, local: FloatArray, bodies: int, found: FloatArray) -> None:
    """Before velocities are corrected: remember them, and count passes and tries in found[3] and found[4]."""
    found[3] = found[4] = 0.0
    for i in range(bodies):
        for c in range(3):
            local[i, KEPT + c] = local[i, BEFORE + c]
    for k in range(joints):
        hinge[k, PUSHED] = hinge[k, PUSHED + 1] = 0.0


@uncounted
def goes_on(
    joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, bodies: int,
    found: FloatArray,
) -> bool:  # fmt: skip
    """After a pass of correcting velocities: whether another is due. Limits that pull are let go, closing ones held.

    The first pass shows which free limits are closed and closing; three passes take back what epsilon left; then, as
    long as a limit pulls, all begins again without it. There are at most joints + 1 tries.
    """
    found[3] += 1.0
    changed = found[3] == 1.0 and found[4] == 0.0 and touch(joint, hinge, link, joints, local)
    if not changed:
        if found[3] < 3.0 and found[2] > 0.0:
            return True
        pulling, pull = -1, 0.0
        for k in range(joints):
            last = link[k, L_ROWS] - 1
            if last < 0 or link[k, L_SIDE] == 0 or link[k, L_SOFT] != 0:
                continue
            if hinge[k, PUSHED + last] * link[k, L_SIDE] > max(pull, noise(hinge, link, k, last, local)):
                pulling, pull = k, hinge[k, PUSHED + last] * link[k, L_SIDE]
        if pulling < 0 or found[4] > joints:
            return False
        link[pulling, L_SIDE] = 0
    found[3] = 0.0
    found[4] += 1.0
    for i in range(bodies):
        for c in range(3):
            local[i, BEFORE + c] = local[i, KEPT + c]
    for k in range(joints):
        hinge[k, PUSHED] = hinge[k, PUSHED + 1] = 0.0
    return True


@uncounted
def noise(hinge: FloatArray, link: IntArray, k: int, r: int, local: FloatArray) -> float:
    """The impulse that changes the rate of row r of joint k by what is round-off of the velocities before: a limit that
    pulls no more than that is in nobody's way, and to let it go would only have it met again."""
    total = 0.0
    for c in range(3):
        total += abs(hinge[k, ROWS + 6 * r + c] * local[link[k, L_A], KEPT + c])
        total += abs(hinge[k, ROWS + 6 * r + 3 + c] * local[link[k, L_B], KEPT + c])
    return float(_ROUND_OFF * total * hinge[k, SCALE + r] ** 2)


@uncounted
def touch(joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray) -> bool:
    """Hold all free limits whose gap is closed and was closing with the kept velocities; whether there were any.

    Rows are those of the present poses.
    """
    found = False
    for k in range(joints):
        if link[k, L_SIDE] == 0 and link[k, L_SOFT] == 0:
            for side in (-1, 1):
                closed = bounded(joint, link, k, side) and gap(joint, hinge, link, k, side) <= TOUCH * hinge[k, SIZE]
                if closed and approach(hinge, link, k, side, local, KEPT) < 0.0:
                    link[k, L_SIDE] = side
                    found = True
    return found


@uncounted
def fits(hinge: FloatArray, link: IntArray, joints: int, local: FloatArray) -> bool:
    """Whether velocities fit all rows that hold, but for what steps leave: they hold places exactly, and velocities to
    second or fourth order. To project that too would take energy whenever somebody else begins to step.

    Rows are those of the present poses.
    """
    well = True
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            if link[k, L_SOFT] != 0 or not held(link, k, r):
                continue
            rate, total = 0.0, 0.0
            for c in range(3):
                one = hinge[k, ROWS + 6 * r + c] * local[link[k, L_A], BEFORE + c]
                two = hinge[k, ROWS + 6 * r + 3 + c] * local[link[k, L_B], BEFORE + c]
                rate += one + two
                total += abs(one) + abs(two)
            well = well and abs(rate) <= _STEPS_LEAVE * total
    return well

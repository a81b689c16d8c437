"""Velocities made to fit the joints, as an impact does at which nothing bounces; `solve` makes the passes.

Kinetic energy only falls, and momentum stays, for the change is M^-1 G^T times impulses that bring G v to 0.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import BodyStep, JointLedger, JointStep
from ..model.joints import Coupling, Workspace
from ..model.parameters.joints import JOINT_SPEED_LEFT, JOINT_SPEED_ROUND_OFF, JOINT_TOUCH
from .bounds import approach, bounded, gap
from .entries import held


@nonallocating
def kinetic(local: Rows[BodyStep], bodies: int, kept: bool) -> float:
    """Kinetic energy of what joints can move, of the velocities at the start, or of those that were `kept`."""
    total = 0.0
    for i in range(bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                v = local[i].v_kept[c] if kept else local[i].v0[c]
                total += 0.5 * v**2 / local[i].mobility[c]
    return total


@nonallocating
def fitting_loss(local: Rows[BodyStep], bodies: int, ledger: JointLedger) -> float:
    """The loss in the change of velocities, from `v_kept` to `v0`, that made them fit their joints.

    It is orthogonal to what fits, so that (1/2) dv.M dv is lost; the rest of the change of kinetic energy is the work
    of supports, which is 0 unless they move, and is added to the ledger.
    """
    gained = kinetic(local, bodies, False) - kinetic(local, bodies, True)
    lost, moves = 0.0, False
    for i in range(bodies):
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                lost += 0.5 * (local[i].v0[c] - local[i].v_kept[c]) ** 2 / local[i].mobility[c]
            elif local[i].v0[c] != 0.0:
                moves = True
    if moves:
        ledger.supports += gained + lost
    return lost if moves else -gained


@nonallocating
def keep(W: Workspace) -> None:
    """Before velocities are corrected: remember them, and count passes and tries anew."""
    W.J.PROGRESS.passes = W.J.PROGRESS.tries = 0
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v_kept[c] = W.J.LOCAL[i].v0[c]
    for k in range(W.joints):
        W.J.HINGE[k].pushed[0] = W.J.HINGE[k].pushed[1] = 0.0


@nonallocating
def goes_on(W: Workspace) -> bool:
    """After a pass of correcting velocities: whether another is due. Limits that pull are let go, closing ones held.

    The first pass shows which free limits are closed and closing; three passes take back what epsilon left; then, as
    long as a limit pulls, all begins again without it. There are at most joints + 1 tries.
    """
    hinge, link, local, progress = W.J.HINGE, W.link, W.J.LOCAL, W.J.PROGRESS
    progress.passes += 1
    changed = progress.passes == 1 and progress.tries == 0 and touch(W)
    if not changed:
        if progress.passes < 3 and progress.error > 0.0:
            return True
        pulling, pull = -1, 0.0
        for k in range(W.joints):
            last = link[k].rows - 1
            if last < 0 or link[k].side == 0 or link[k].soft != 0:
                continue
            if hinge[k].pushed[last] * link[k].side > max(pull, noise(hinge, link, k, last, local)):
                pulling, pull = k, hinge[k].pushed[last] * link[k].side
        if pulling < 0 or progress.tries > W.joints:
            return False
        link[pulling].side = 0
    progress.passes = 0
    progress.tries += 1
    for i in range(W.bodies):
        for c in range(3):
            local[i].v0[c] = local[i].v_kept[c]
    for k in range(W.joints):
        hinge[k].pushed[0] = hinge[k].pushed[1] = 0.0
    return True


@nonallocating
def noise(hinge: Rows[JointStep], link: Rows[Coupling], k: int, r: int, local: Rows[BodyStep]) -> float:
    """The impulse that changes the rate of row r of joint k by what is round-off of the velocities before: a limit that
    pulls no more than that is in nobody's way, and to let it go would only have it met again."""
    total = 0.0
    for c in range(3):
        total += abs(hinge[k].rows[r, c] * local[link[k].body[0]].v_kept[c])
        total += abs(hinge[k].rows[r, c + 3] * local[link[k].body[1]].v_kept[c])
    return float(JOINT_SPEED_ROUND_OFF * total * hinge[k].scale[r] ** 2)


@nonallocating
def touch(W: Workspace) -> bool:
    """Hold all free limits whose gap is closed and was closing with the kept velocities; whether there were any.

    Rows are those of the present poses.
    """
    hinge, link = W.J.HINGE, W.link
    found = False
    for k in range(W.joints):
        if link[k].side == 0 and link[k].soft == 0:
            for side in (-1, 1):
                closed = (
                    bounded(W.J.JOINT, link, k, side)
                    and gap(W.J.JOINT, hinge, link, k, side) <= JOINT_TOUCH * hinge[k].size
                )
                a, b = W.J.LOCAL[link[k].body[0]], W.J.LOCAL[link[k].body[1]]
                if closed and approach(hinge[k], link[k].rows, side, a.v_kept, b.v_kept) < 0.0:
                    link[k].side = side
                    found = True
    return found


@nonallocating
def fits(W: Workspace) -> bool:
    """Whether velocities fit all rows that hold, but for what steps leave: they hold places exactly, and velocities to
    second or fourth order. To project that too would take energy whenever somebody else begins to step.

    Rows are those of the present poses.
    """
    link = W.link
    well = True
    for k in range(W.joints):
        for r in range(link[k].rows):
            if link[k].soft != 0 or not held(link, k, r):
                continue
            rate, total = 0.0, 0.0
            for c in range(3):
                one = W.J.HINGE[k].rows[r, c] * W.J.LOCAL[link[k].body[0]].v0[c]
                two = W.J.HINGE[k].rows[r, c + 3] * W.J.LOCAL[link[k].body[1]].v0[c]
                rate += one + two
                total += abs(one) + abs(two)
            well = well and abs(rate) <= JOINT_SPEED_LEFT * total
    return well

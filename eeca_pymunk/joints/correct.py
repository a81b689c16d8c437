"""Poses and velocities projected onto the joints; for velocities this is an impact without bounce.

The change is M^-1 G^T times impulses that bring G v to 0: kinetic energy only falls, and momentum is kept.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import POSES, SPEEDS, STEP, JointLedger
from ..model.joints import Workspace
from ..model.parameters import joints
from ..newton.entries import acts, along, size_of_terms
from ..newton.systems import apply, back, factorise, first_iterate, first_system, linearise
from .bounds import inactive, limit_gap, limit_gap_rate, stand
from .frame import has_prescribed_motion, work_of_change
from .lock import restore_momenta

NOW, BEFORE, SAVED, CHANGE = 0, 1, 2, 3  # velocities of a kinetic energy


@nonallocating
def project(W: Workspace, what: int) -> None:
    """Project POSES or SPEEDS onto the joints, by the smallest change in the norm of the masses.

    POSES: until g is on its targets, at most CLOSINGS times. SPEEDS: closed limits whose gap closes act from the first
    pass on. Two passes with the same factors remove the effect of epsilon, three if rows are redundant. Then the limit
    that pulls most is released, or limits that the solution moves into act, and all begins again; at most joints + 1
    times. The result is in `pose` or `v0`, the velocities before in `v_before`, the impulses in `pushed`. Those of rows
    that contradict one another are large, and change momenta by their round-off, which is undone.
    """
    component, passes, tries = W.J.COMPONENT[W.s], 0, 0
    enough = 2 if component.cycles == 0 else 3
    first_iterate(W, what, 2.0)
    if what == SPEEDS:
        keep_speeds(W)
    component.factored = 0
    system = first_system(component, what)
    # Rows that contradict each other must not move bodies far.
    epsilon = joints.CLOSING_EPSILON if what == POSES else joints.REDUNDANT_EPSILON
    for turn in range(joints.REDUNDANT_PASSES + 3 * W.joints):
        fresh = passes == 0
        error = linearise(W, what, 2.0, 1.0, 0.0, turn == 0, system, fresh)
        if what == POSES and (error <= 1e-14 or turn == joints.CLOSINGS):
            return
        if what == SPEEDS and turn == 0 and hold_closing(W, True):
            error = linearise(W, what, 2.0, 1.0, 0.0, False, system, True)
        if fresh:
            system = factorise(W, what, 2.0, 1.0, 0.0, system, epsilon)
        if system < 0:
            return
        back(W, system, joints.CONDENSED_PASSES, W.J.RIGHT)
        apply(W, what)
        if what == SPEEDS:
            passes += 1
            if passes == enough or not error > 0.0:
                if tries > W.joints or not (release(W, SPEEDS) or hold_closing(W, False)):
                    break
                passes, tries = 0, tries + 1
                restore_speeds(W)
        if what == POSES or passes == 0:
            first_iterate(W, what, 2.0)
    if what == SPEEDS:
        restore_momenta(W, 0.0, True)


@nonallocating
def kinetic_of(W: Workspace, which: int) -> float:
    """Kinetic energy in the directions that joints can move, of the velocities v0 (NOW), `v_before` (BEFORE) or
    `saved_velocity` (SAVED), or of the CHANGE from `v_before` to v0."""
    local, total = W.J.LOCAL, 0.0
    for i in range(W.bodies):
        velocity = local[i].v_before if which == BEFORE else local[i].saved_velocity if which == SAVED else local[i].v0
        for c in range(3):
            if local[i].mobility[c] > 0.0:
                v = velocity[c] - local[i].v_before[c] if which == CHANGE else velocity[c]
                total += 0.5 * v**2 / local[i].mobility[c]
    return total


@nonallocating
def loss_of_projection(W: Workspace, ledger: JointLedger) -> float:
    """The energy lost by the projection of velocities from `v_before` to `v0`.

    It is (1/2) dv.M dv, as the projection is orthogonal. The rest of the change of kinetic energy is the work of
    supports, 0 unless they move, and enters the ledger.
    """
    gained = kinetic_of(W, NOW) - kinetic_of(W, BEFORE)
    if not has_prescribed_motion(W):
        return -gained
    lost = kinetic_of(W, CHANGE)
    ledger.supports += gained + lost
    ledger.frame_work += work_of_change(W)
    return lost


@nonallocating
def keep_speeds(W: Workspace) -> None:
    """Store the velocities before they are projected, whose impulses become 0."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v_before[c] = W.J.LOCAL[i].v0[c]
    restore_speeds(W)


@nonallocating
def restore_speeds(W: Workspace) -> None:
    """Restore the velocities before the projection, and clear its impulses."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v0[c] = W.J.LOCAL[i].v_before[c]
    for k in range(W.joints):
        W.J.HINGE[k].pushed[0] = W.J.HINGE[k].pushed[1] = 0.0


@nonallocating
def release(W: Workspace, what: int) -> bool:
    """Release the limit that pulls most, lam side > 0, by impulses over the scales of their rows, whose squares are
    energies; False if none pulls. STEP: by its impulse. SPEEDS: by that of a projection, by more than round-off, and
    unless it was released in this part of the step already."""
    hinge, link = W.J.HINGE, W.link
    which, most = -1, 0.0
    for k in range(W.joints):
        side, last = link[k].side, link[k].rows - 1
        if side == 0 or link[k].bounded != 0 or (what == SPEEDS and link[k].let_go == side):
            continue
        pull = side * (hinge[k].pushed[last] if what == SPEEDS else hinge[k].lam[last])
        weighed = pull / hinge[k].scale[last] if hinge[k].scale[last] > 0.0 else pull
        if weighed > most and pull > (noise(W, k, last) if what == SPEEDS else 0.0):
            which, most = k, weighed
    if which >= 0 and what == STEP:
        link[which].let_go = link[which].side
        hinge[which].lam[link[which].rows - 1] = 0.0
    if which >= 0:
        link[which].side = 0
    return which >= 0


@nonallocating
def noise(W: Workspace, k: int, r: int) -> float:
    """The impulse that changes the rate of row r of joint k by the round-off of the velocities before. A limit that
    pulls no more is not released: it would be met again at once."""
    hinge, a, b = W.J.HINGE[k], W.J.LOCAL[W.link[k].body[0]], W.J.LOCAL[W.link[k].body[1]]
    return float(joints.JOINT_SPEED_ROUND_OFF * size_of_terms(hinge, r, a.v_before, b.v_before) * hinge.scale[r] ** 2)


@nonallocating
def hold_closing(W: Workspace, kept: bool) -> bool:
    """Let all inactive limits act whose gap is closed and is closing: with the velocities that were kept, or by more
    than round-off with the present ones. Returns whether there are any. Rows are those of the present poses."""
    hinge, link, local = W.J.HINGE, W.link, W.J.LOCAL
    found = False
    for k in range(W.joints):
        if not inactive(link, k):
            continue
        for side in (-1, 1):
            if not limit_gap(W, k, side) <= joints.JOINT_TOUCH * hinge[k].unit:
                continue
            a, b, rows = local[link[k].body[0]], local[link[k].body[1]], link[k].rows
            if kept:
                closes = limit_gap_rate(hinge[k], rows, side, a.v_before, b.v_before) < 0.0
            else:
                least = size_of_terms(hinge[k], rows - 1, a.v_before, b.v_before) * joints.JOINT_SPEED_ROUND_OFF
                closes = limit_gap_rate(hinge[k], rows, side, a.v0, b.v0) < -least
            if closes:
                stand(W, k, side)
                found = True
    return found


@nonallocating
def hold_passed_by(W: Workspace, least: float) -> bool:
    """Let all limits act that displacements, which are in the place of the velocities, pass by more than `least` of
    the unit of their functions, or pass further by that. Returns whether there are any. Rows are those of the present
    poses."""
    hinge, link, found = W.J.HINGE, W.link, False
    for k in range(W.joints):
        if link[k].bounded != 0 or link[k].rows == 0:  # springs have no limits
            continue
        a, b = W.J.LOCAL[link[k].body[0]].v0, W.J.LOCAL[link[k].body[1]].v0
        for side in (-1, 1):
            room = max(limit_gap(W, k, side), 0.0) + least * hinge[k].unit
            if limit_gap_rate(hinge[k], link[k].rows, side, a, b) < -room:
                stand(W, k, side)
                found = True
    return found


@nonallocating
def speeds_fit(W: Workspace) -> bool:
    """Whether velocities satisfy all exact rows, except for errors of earlier steps: steps close joints exactly, but
    their velocities have errors of second or fourth order, whose projection would cost energy in every second step.
    Rows are those of the present poses."""
    link = W.link
    for k in range(W.joints):
        hinge, a, b = W.J.HINGE[k], W.J.LOCAL[link[k].body[0]].v0, W.J.LOCAL[link[k].body[1]].v0
        for r in range(link[k].rows if link[k].bounded == 0 else 0):
            least = joints.JOINT_SPEED_LEFT * size_of_terms(hinge, r, a, b)
            if acts(link, k, r) and not abs(along(hinge, r, a, b)) <= least:
                return False
    return True

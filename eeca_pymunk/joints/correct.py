"""Poses and velocities made to fit the joints; velocities as by an impact at which nothing bounces.

Kinetic energy only falls, and momentum stays, for the change is M^-1 G^T times impulses that bring G v to 0.
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import POSES, SPEEDS, BodyStep, JointLedger
from ..model.joints import DUAL, Workspace
from ..model.parameters.joints import (
    CLOSING_EPSILON,
    CLOSINGS,
    CONDENSED_PASSES,
    JOINT_SPEED_LEFT,
    JOINT_SPEED_ROUND_OFF,
    JOINT_TOUCH,
    REDUNDANT_EPSILON,
    REDUNDANT_PASSES,
)
from ..newton.entries import acts
from ..newton.systems import apply, back, factorise, first_iterate, linearise
from .bounds import has_bound, limit_gap, limit_gap_rate


@nonallocating
def project(W: Workspace, what: int) -> None:
    """Make POSES or SPEEDS fit the joints, by the least change in the measure of the masses.

    POSES: until g is on its targets, at most CLOSINGS times. SPEEDS: those before stay at `v_kept`. Free limits whose
    gap is closed and closing are held from the first pass on. Two passes with the same factors take back what epsilon
    left, three if rows are redundant; then, as long as a limit pulls, all begins again without it, and as long as the
    solution moves into others, with them. There are at most joints + 1 tries. What is solved for is `pose` or `v0`; the
    impulses are in `pushed`.
    """
    component, passes, tries = W.J.COMPONENT[W.s], 0, 0
    enough = 2 if component.loops == 0 else 3
    first_iterate(W, what, 2.0)
    if what == SPEEDS:
        keep_speeds(W)
    component.factored = 0
    system = DUAL if component.rigid > 0 else component.system
    # Rows that contradict each other must not move bodies far.
    epsilon = CLOSING_EPSILON if what == POSES else REDUNDANT_EPSILON
    for turn in range(REDUNDANT_PASSES + 3 * W.joints):
        fresh = passes == 0
        error = linearise(W, what, 2.0, 1.0, 0.0, turn == 0, system, fresh)
        if what == POSES and (error <= 1e-14 or turn == CLOSINGS):
            return
        if what == SPEEDS and turn == 0 and hold_closing(W, True):
            error = linearise(W, what, 2.0, 1.0, 0.0, False, system, True)
        if fresh:
            system = factorise(W, what, 2.0, 1.0, 0.0, system, epsilon)
        if system < 0:
            return
        back(W, system, CONDENSED_PASSES, W.J.RIGHT)
        apply(W, what)
        if what == SPEEDS:
            passes += 1
            if passes == enough or not error > 0.0:
                if tries > W.joints or not (let_go(W) or hold_closing(W, False)):
                    return
                passes, tries = 0, tries + 1
                restore_speeds(W)
        if what == POSES or passes == 0:
            first_iterate(W, what, 2.0)


@inlined
def plus_kinetic(total: float, velocity: FloatArray, mobility: FloatArray) -> float:
    """`total`, and the kinetic energy of a velocity (3,) of what joints can move of a body."""
    for c in range(3):
        if mobility[c] > 0.0:
            total += 0.5 * velocity[c] ** 2 / mobility[c]
    return total


@nonallocating
def kinetic_of_component(local: Rows[BodyStep], bodies: int, kept: bool) -> float:
    """Kinetic energy of what joints can move, of the velocities at the start, or of those that were `kept`."""
    total = 0.0
    for i in range(bodies):
        total = plus_kinetic(total, local[i].v_kept if kept else local[i].v0, local[i].mobility)
    return total


@nonallocating
def saved_energy(local: Rows[BodyStep], bodies: int) -> float:
    """Kinetic energy of what joints can move, of the velocities that were saved."""
    total = 0.0
    for i in range(bodies):
        total = plus_kinetic(total, local[i].saved_velocity, local[i].mobility)
    return total


@nonallocating
def fitting_loss(local: Rows[BodyStep], bodies: int, ledger: JointLedger) -> float:
    """The loss in the change of velocities, from `v_kept` to `v0`, that made them fit their joints.

    It is orthogonal to what fits, so that (1/2) dv.M dv is lost; the rest of the change of kinetic energy is the work
    of supports, which is 0 unless they move, and is added to the ledger.
    """
    gained = kinetic_of_component(local, bodies, False) - kinetic_of_component(local, bodies, True)
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
def keep_speeds(W: Workspace) -> None:
    """Remember the velocities before they are corrected."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v_kept[c] = W.J.LOCAL[i].v0[c]
    restore_speeds(W)


@nonallocating
def restore_speeds(W: Workspace) -> None:
    """The velocities before a correction, without impulses."""
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].v0[c] = W.J.LOCAL[i].v_kept[c]
    for k in range(W.joints):
        W.J.HINGE[k].pushed[0] = W.J.HINGE[k].pushed[1] = 0.0


@nonallocating
def let_go(W: Workspace) -> bool:
    """Let go of the limit whose impulse in the correction pulls most; False if none does. (`bounds.release` does that
    by the impulses of a step.) One that is held after it has been let go stays (`limits.stop_at`)."""
    hinge, link = W.J.HINGE, W.link
    pulling, pull = -1, 0.0
    for k in range(W.joints):
        last = link[k].rows - 1
        if last < 0 or link[k].side == 0 or link[k].bounded != 0 or link[k].let_go == link[k].side:
            continue
        if hinge[k].pushed[last] * link[k].side > max(pull, noise(W, k, last)):
            pulling, pull = k, hinge[k].pushed[last] * link[k].side
    if pulling >= 0:
        link[pulling].side = 0
    return pulling >= 0


@nonallocating
def noise(W: Workspace, k: int, r: int) -> float:
    """The impulse that changes the rate of row r of joint k by what is round-off of the velocities before: a limit that
    pulls no more than that hinders nothing, and if it were let go it would be met again at once."""
    return float(JOINT_SPEED_ROUND_OFF * terms(W, k, r) * W.J.HINGE[k].scale[r] ** 2)


@nonallocating
def terms(W: Workspace, k: int, r: int) -> float:
    """The sum of the amounts of the terms of the rate of row r of joint k, of the velocities before a correction."""
    a, b, total = W.J.LOCAL[W.link[k].body[0]], W.J.LOCAL[W.link[k].body[1]], 0.0
    for c in range(3):
        total += abs(W.J.HINGE[k].rows[r, c] * a.v_kept[c])
        total += abs(W.J.HINGE[k].rows[r, c + 3] * b.v_kept[c])
    return total


@nonallocating
def hold_closing(W: Workspace, kept: bool) -> bool:
    """Hold all free limits whose gap is closed and closing with the velocities that were kept, or by more than
    round-off with the present ones; whether there are any.

    Rows are those of the present poses.
    """
    hinge, link, local = W.J.HINGE, W.link, W.J.LOCAL
    found = False
    for k in range(W.joints):
        if link[k].side == 0 and link[k].bounded == 0:
            for side in (-1, 1):
                if not (has_bound(W, k, side) and limit_gap(W, k, side) <= JOINT_TOUCH * hinge[k].size):
                    continue
                a, b, last = local[link[k].body[0]], local[link[k].body[1]], link[k].rows - 1
                if kept:
                    closes = limit_gap_rate(hinge[k], link[k].rows, side, a.v_kept, b.v_kept) < 0.0
                else:
                    least = terms(W, k, last) * JOINT_SPEED_ROUND_OFF
                    closes = limit_gap_rate(hinge[k], link[k].rows, side, a.v0, b.v0) < -least
                if closes:
                    link[k].side = side
                    found = True
    return found


@nonallocating
def speeds_fit(W: Workspace) -> bool:
    """Whether velocities fit all rows that hold, but for what steps leave: they hold places exactly, and velocities to
    second or fourth order. To project that too would take energy at every other start of a step.

    Rows are those of the present poses.
    """
    link = W.link
    well = True
    for k in range(W.joints):
        for r in range(link[k].rows):
            if link[k].bounded != 0 or not acts(link, k, r):
                continue
            rate, total = 0.0, 0.0
            for c in range(3):
                one = W.J.HINGE[k].rows[r, c] * W.J.LOCAL[link[k].body[0]].v0[c]
                two = W.J.HINGE[k].rows[r, c + 3] * W.J.LOCAL[link[k].body[1]].v0[c]
                rate += one + two
                total += abs(one) + abs(two)
            well = well and abs(rate) <= JOINT_SPEED_LEFT * total
    return well

"""Steps whose joints did not hold: linear rows, or all bodies as one; the energy that they gain is taken back."""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import LINEAR
from ..model.joints import Workspace
from ..model.parameters.joints import GAIN_KEPT, JOINT_GAIN, JOINT_TOLERANCE, LINEAR_APART
from ..newton.motion import accept_part, go_back, move
from ..newton.solve import drop_impulses
from .closing import farthest
from .correct import NOW, SAVED, kinetic_of
from .foresight import forget_parts
from .frame import frame_of, has_prescribed_motion, relative_energy
from .ladder import gain_of_rows, restore_start, settle, undo_impulses
from .ledger import clear_ledger, close_ledger, unexplained
from .limits import step_with_limits
from .lock import lock_energy, move_rigidly
from .start import load_of, springs_of


@nonallocating
def step_linearly(W: Workspace, h: float, length: float) -> float:
    """Take the step h by linear systems, one for each limit that is released, or in free flight if they have no
    solution. Returns `farthest` at its start. PART_LEDGER has the energy that springs have stored."""
    local, part = W.J.LOCAL, W.J.PART_LEDGER
    stored, apart, carried = springs_of(W), farthest(W), 0.0
    drop_impulses(W)
    if step_with_limits(W, True, h, length, True, 0.0, False):
        W.J.JOINT[W.link[0].joint].compliance, carried = 0.0, part.carried
    else:
        restore_start(W)
        forget_parts(W)
        for i in range(W.bodies):
            for c in range(3):
                local[i].v1[c] = local[i].v0[c] + h * local[i].acceleration[c]
        move(local, W.bodies, h)
        accept_part(W, h)
    clear_ledger(part)
    part.stored, part.carried = springs_of(W) - stored, carried
    return apart


@nonallocating
def stop_joints(W: Workspace, h: float) -> None:
    """Take the step h again by `move_rigidly`, which needs no solution; the loss is `limited` in PART_LEDGER: with
    supports, all of the motion relative to their frame."""
    part = W.J.PART_LEDGER
    go_back(W)
    stored = springs_of(W)
    lost, _ = relative_energy(W, frame_of(W), -1.0)
    move_rigidly(W, h)
    clear_ledger(part)
    part.stored = springs_of(W) - stored
    if has_prescribed_motion(W):
        part.carried = unexplained(W) + lost
    close_ledger(W)
    undo_impulses(W)


@nonallocating
def keeps_gain(W: Workspace, h: float, length: float, own: bool) -> bool:
    """Whether bodies keep energy that exact rows have given in a step, as their relative motion has too little to pay
    it: more than GAIN_KEPT of what they had and of the work of forces over the size `length` of the component, and more
    than that of the velocities which round-off of places is over h. Not where joints need not be exact yet."""
    local, mass = W.J.LOCAL, 0.0
    if W.J.PROGRESS.near > 0.0:
        return False
    part = W.J.PART_LEDGER
    gain = min(gain_of_rows(W, own), unexplained(W) - part.carried)
    if not gain > 0.0 or not frame_of(W).rigid:
        return False
    for i in range(W.bodies):
        mass += 1.0 / local[i].mobility[0] if local[i].mobility[0] > 0.0 else 0.0
    noise = mass * (JOINT_TOLERANCE * length / h) ** 2
    had = kinetic_of(W, SAVED) + load_of(W, h, length)
    return bool(gain > noise + GAIN_KEPT * had)


@nonallocating
def take_gain(W: Workspace, h: float, length: float, status: int, before: float) -> int:
    """Close the ledger of an ELASTIC or LINEAR step, and take its gain from the motion; returns the status. If that is
    not enough, or joints are farther apart than `before`, all bodies move as one.

    Joints that close within a short h make bodies fast, and the lock then takes most of this, and leaves its round-off,
    of momenta too: both are put right once more. It is enough if what is left of the gain is round-off of the kinetic
    energies before and after.
    """
    part, stopped = W.J.PART_LEDGER, False
    for _ in range(2):
        settle(W, h, length)
        close_ledger(W)
        if part.closed > 0.0:
            lock_energy(W, part.closed, part)
            close_ledger(W)
    had = kinetic_of(W, SAVED) + kinetic_of(W, NOW)
    if part.closed > JOINT_GAIN * had and frame_of(W).rigid:
        status, stopped = LINEAR, True
    if status == LINEAR and not farthest(W) <= before + LINEAR_APART:
        stopped = frame_of(W).rigid
    if stopped:
        stop_joints(W, h)
    return status

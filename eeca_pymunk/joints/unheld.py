"""Steps whose joints did not hold: back to the start, then linear rows, or all bodies as one."""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joints import Workspace
from ..newton.motion import accept_part, go_back, move
from ..newton.solve import drop_impulses
from .bounds import stand_as_stepped
from .closing import farthest
from .foresight import forget_parts
from .frame import frame_of, has_prescribed_motion, relative_energy
from .ledger import clear_ledger, close_ledger, unexplained
from .limits import step_with_limits
from .lock import move_rigidly
from .start import springs_of


@nonallocating
def undo_impulses(W: Workspace) -> None:
    """Set the impulses of the step to 0, and the accelerations by joints."""
    drop_impulses(W)
    for i in range(W.bodies):
        for c in range(3):
            W.J.LOCAL[i].lead[c] = 0.0
    for k in range(W.joints):
        W.J.HINGE[k].total[0] = W.J.HINGE[k].total[1] = 0.0


@nonallocating
def restore_start(W: Workspace) -> None:
    """Return to the start of the step, without impulses."""
    go_back(W)
    undo_impulses(W)
    stand_as_stepped(W)


@nonallocating
def step_linearly(W: Workspace, h: float, extent: float) -> float:
    """Take the step h by linear systems, one for each limit that is released, or in free flight if they have no
    solution. Returns `farthest` at its start. RUNG_LEDGER has the energy that springs have stored."""
    local, part = W.J.LOCAL, W.J.RUNG_LEDGER
    stored, apart, carried = springs_of(W), farthest(W), 0.0
    drop_impulses(W)
    if step_with_limits(W, True, h, extent, True, 0.0, False):
        W.J.JOINT[W.link[0].joint].compliance, carried = 0.0, part.frame_work
    else:
        restore_start(W)
        forget_parts(W)
        for i in range(W.bodies):
            for c in range(3):
                local[i].v1[c] = local[i].v0[c] + h * local[i].acceleration[c]
        move(local, W.bodies, h)
        accept_part(W, h)
    clear_ledger(part)
    part.stored, part.frame_work = springs_of(W) - stored, carried
    return apart


@nonallocating
def stop_joints(W: Workspace, h: float) -> None:
    """Take the step h again by `move_rigidly`, which needs no solution; the loss is `limited` in RUNG_LEDGER: with
    supports, all of the motion relative to their frame."""
    part = W.J.RUNG_LEDGER
    go_back(W)
    stored = springs_of(W)
    lost, _ = relative_energy(W, frame_of(W), -1.0)
    move_rigidly(W, h)
    clear_ledger(part)
    part.stored = springs_of(W) - stored
    if has_prescribed_motion(W):
        part.frame_work = unexplained(W) + lost
    close_ledger(W)
    undo_impulses(W)

"""A step of bodies that meet at computed times of impact: its stages, between the states read from pymunk and those
written to it."""

from __future__ import annotations

from ..compiled import Table, kernel
from ..islands.loads import renew_support
from ..jointed.ledger import account_joints, note_spent, start_joints
from ..jointed.welds import load_welds
from ..joints.pinned import put_pinned
from ..model.joints import Joints, joints_of
from ..model.parameters.joints import MEET_INSTANT
from ..model.scene import Scene, scene_of
from ..model.step import DONE, EVENTS, LOG_FULL, PUSHES_FULL
from ..model.values import Reading, reading_of
from ..prediction.scheduling import predict_due
from ..transfer import read_states, write_states
from .begin import begin
from .close import close
from .intervals import start_islands
from .loop import process_events
from .midstep import act_together


@kernel
def start(A: Scene, J: Joints, R: Reading, dt: float, gx: float, gy: float, half_damping: float) -> int:
    """Take the states read from pymunk, and begin a step of length dt; returns the bits so far, or a negative code."""
    if len(J.JOINT) > 0:
        start_joints(A, J, R.STATES, R.IDS, dt)
    status = read_states(R.STATES, R.IDS, R.EXTRA, A.BODY, gx, gy, half_damping)
    if status >= 0:
        lost = put_pinned(J, A.BODY)
        A.PAR.planned = dt
        A.PAR.dt, A.PAR.gravity_x, A.PAR.gravity_y, A.PAR.half_damping = dt, gx, gy, half_damping
        A.PAR.instant = MEET_INSTANT * dt
        begin(A, R.IDS)
        # The kinetic energy that `put_pinned` has taken from held bodies is a loss of this step.
        A.PAR.before += lost
        A.PAR.restitution += lost
    A.COUNT.bits = status
    return status


@kernel
def finish(A: Scene, J: Joints, R: Reading) -> int:
    """Close the step, and write the states at its end; returns the bits of the step, or a negative code."""
    if A.PAR.share < 1.0:
        note_spent(A, J)
    account_joints(A, J)
    renew_support(A)
    close(A, R.IDS)
    if J.TALLY.pinned > 0:
        load_welds(A, J, R)
    if A.COUNT.logged > 0 or A.COUNT.unmet > 0:
        A.COUNT.bits |= EVENTS
    A.COUNT.bits = write_states(R.STATES, R.IDS, R.EXTRA, A.BODY, R.ENDS, A.PAR.half_damping, A.COUNT.bits)
    return A.COUNT.bits


@kernel
def act(A: Scene, J: Joints) -> int:
    """All impulses of a step that has begun: of all contacts together at its middle, or event by event after the
    intervals of islands have begun. DONE, or which memory is full: provide more, and call again.

    COUNT.phase: 0 until the islands are built, 1 until the first intervals of those without joints have begun, 2 until
    those of all have and all events are predicted, 3 in the event loop, 4 after it.
    """
    COUNT = A.COUNT
    if COUNT.together > 0:
        return act_together(A, J)
    if COUNT.phase < 3:
        if COUNT.pushes + COUNT.any_placed + J.TALLY.components > 0 and start_islands(A, J) != DONE:
            return PUSHES_FULL
        COUNT.phase = 3
        COUNT.work = COUNT.work_before = 0.0  # the intervals at the start of a step do not count
        predict_due(A)
    if COUNT.phase == 3:
        status = process_events(A, J, COUNT.lossy > 0 or A.PAR.pulled > 0.0)
        if status != DONE:
            return status
        COUNT.phase = 4
    return DONE


@kernel
def resume(A: Scene, J: Joints, R: Reading) -> int:
    """The rest of a step that has begun; results as of `step`."""
    status = act(A, J)
    # The impulses of contacts of intervals, and of the rotations of free islands (`..islands.turned`).
    rows = A.COUNT.pushes + (A.BODY.shape[0] if A.COUNT.even == 0 else 0)
    if status == DONE and A.COUNT.logged + rows > A.LOG.shape[0]:
        status = LOG_FULL
    return status if status != DONE else finish(A, J, R)


@kernel
def step(TABLE: Table, JOINTS: Table, READING: Table, dt: float, gx: float, gy: float, half_damping: float) -> int:
    """Take one step, from the states read from pymunk to those to be written, see `transfer.py`.

    Args:
        TABLE: `table_of` a Scene.  JOINTS: that of its Joints.  READING: that of the Reading with its BODY.
        dt: time, > 0.  gx, gy: gravity, length/time².  half_damping: factor by which half the step's damping multiplies
            velocities.

    Returns:
        the status, see `model/step.py`: after a code for more memory, provide it, and call `resume_step`.
    """
    A, J, R = scene_of(TABLE), joints_of(JOINTS), reading_of(READING)
    status = start(A, J, R, dt, gx, gy, half_damping)
    return resume(A, J, R) if status >= 0 else status


@kernel
def resume_step(TABLE: Table, JOINTS: Table, READING: Table) -> int:
    """Go on with a step that needed more memory; arguments and results as of `step`."""
    return resume(scene_of(TABLE), joints_of(JOINTS), reading_of(READING))

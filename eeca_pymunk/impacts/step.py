"""A step of bodies that meet at computed times of impact: the stages between what pymunk holds before and after."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel, uncounted
from ..islands.building import build_islands
from ..model.scene import Scene, scene_of
from ..model.step import DONE, LOG_FULL, POOL_FULL
from ..prediction.scheduling import forecast_due
from ..transfer import EVENTS as SOME
from ..transfer import give, take
from .begin import begin
from .close import close
from .loop import follow

# Answers of a step that wants more memory: give some, and `resume`.
ROOM_FOR_LISTS, ROOM_FOR_EVENTS, ROOM_FOR_CONTACTS = -10, -11, -12


@kernel
def start(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, dt: float, gx: float, gy: float, left: float
) -> int:
    """Take the states that were read, and begin a step of length dt on them; the bits so far, or a negative code."""
    status = take(STATES, WALK, EXTRA, A.BODY, gx, gy, left)
    if status >= 0:
        A.PAR.dt, A.PAR.gravity_x, A.PAR.gravity_y, A.PAR.left_over = dt, gx, gy, left
        begin(A, WALK)
    return status


@kernel
def finish(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, status: int
) -> int:  # fmt: skip
    """Close the step, and give the states at its end; the bits of the step, or a negative code."""
    close(A, WALK)
    if A.COUNT.logged > 0 or A.COUNT.unmet > 0:
        status |= SOME
    return give(STATES, WALK, EXTRA, A.BODY, ENDS, A.PAR.dt, A.PAR.left_over, status)


@uncounted
def wish(met: int) -> int:
    """The room that the loop wants, which has answered with one of its arrays being full."""
    if met == POOL_FULL:
        return ROOM_FOR_LISTS
    return ROOM_FOR_EVENTS if met == LOG_FULL else ROOM_FOR_CONTACTS


@kernel
def resume(
    A: Scene, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, lossy: bool,
    status: int,
) -> int:  # fmt: skip
    """The rest of a step, whose bits so far are `status`."""
    COUNT = A.COUNT
    if COUNT.phase == 0:
        if COUNT.pushes + COUNT.crammed > 0 and build_islands(A) != DONE:
            return ROOM_FOR_CONTACTS
        COUNT.phase = 1
        forecast_due(A)
        COUNT.work = 0  # what a step begins with has to be done
    if COUNT.phase == 1:
        met = follow(A, lossy or A.PAR.pulled > 0.0)
        if met != DONE:
            return wish(met)
        COUNT.phase = 2
    if COUNT.logged + COUNT.pushes > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    return finish(A, STATES, WALK, EXTRA, ENDS, status)


@kernel
def step(
    TABLE: Table, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float,
    gy: float, left: float, lossy: bool, bits: int,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written, see `transfer.py`.

    Args:
        TABLE: `table_of` a Scene.
        dt: time, > 0.  gx, gy: gravity, length/time².  left: what half the step's damping leaves of velocities.
        lossy: whether any shape's elasticity is below 1.
        bits: negative for a new step; those of one that wished for room and goes on.

    Returns:
        the bits EVENTS, FORCES, TURNS, a negative code of `transfer.py`, or a wish for room.
    """
    A = scene_of(TABLE)
    if bits >= 0:
        return resume(A, STATES, WALK, EXTRA, ENDS, lossy, bits)
    status = start(A, STATES, WALK, EXTRA, dt, gx, gy, left)
    if status < 0:
        return status
    return resume(A, STATES, WALK, EXTRA, ENDS, lossy, status)

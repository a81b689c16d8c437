"""Which islands are put to rest.

An island is at rest if it has no motion at all, or was slow at the start of this step and an island before it
(without losses: slower than REST_SPEED |a| dt, so that none is made), and `..contacts.statics` finds static forces.
"""

from __future__ import annotations

from ..arrays import IntArray
from ..compiled import nonallocating
from ..geometry.flight import has_velocity, point_speed
from ..model.parameters.intervals import LARGE_ISLAND
from ..model.parameters.rest import REST_CANDIDATE, REST_CANDIDATE_LARGE, REST_RETRY, REST_SPEED
from ..model.scene import Scene


@nonallocating
def spins_freely(A: Scene, i: int) -> bool:
    """Whether contacts exert no torque on body i: a single disk without friction, and without a torque."""
    return bool(i < A.COUNT.disks and A.SHAPE[i].friction == 0.0 and A.PULL[i, 2] == 0.0)


@nonallocating
def speed(A: Scene, i: int) -> float:
    """Bound of the speed (length/time) of points of body i; of its centre if it spins freely."""
    body = A.BODY[i]
    return point_speed(body.vx, body.vy, 0.0 if spins_freely(A, i) else body.spin, body.extent)


@nonallocating
def candidate_speed(bodies: int) -> float:
    """Speed relative to |a| dt below which bodies of an island of so many bodies are tested for rest."""
    return REST_CANDIDATE if bodies < LARGE_ISLAND else REST_CANDIDATE_LARGE


@nonallocating
def motionless(A: Scene, MINE: IntArray) -> bool:
    """Whether none of the bodies MINE has any velocity, as in the first step of a stack, or has failed a test lately:
    static forces are then searched at once."""
    for q in range(len(MINE)):
        if has_velocity(A.BODY[MINE[q]]) or A.RESTING[MINE[q]].rest_timer < 0.0:
            return False
    return True


@nonallocating
def postpone_test(A: Scene, MINE: IntArray) -> None:
    """Postpone the next test for static forces of the bodies MINE by REST_RETRY slow steps; a fast one ends that
    (`at_rest.restart_paths`)."""
    for q in range(len(MINE)):
        A.RESTING[MINE[q]].rest_timer = -float(REST_RETRY)


@nonallocating
def rest_threshold(A: Scene, root: int, MINE: IntArray, with_supports: int, lossy: bool, t: float) -> float:
    """Speed relative to |a| dt below which an island may be put to rest at instant t by a test for static forces; 0 if
    it is not tested. A test postpones the next one.

    Args:
        MINE: its bodies.  with_supports: number of bodies, with those of the islands that support it.
        lossy: whether any shape of the island has an elasticity below 1.
    """
    if t > 0.0 or A.PAR.pulled == 0.0 or A.COUNT.together > 0:
        return 0.0
    if not motionless(A, MINE):
        if A.MEMBER[root].hits > 0:
            return 0.0
        for q in range(len(MINE)):
            if A.RESTING[MINE[q]].rest_timer < 1.0 or A.MEMBER[MINE[q]].busy > 0:
                return 0.0
            if not lossy and speed(A, MINE[q]) > REST_SPEED * A.PAR.pulled * A.PAR.dt:
                return 0.0
    postpone_test(A, MINE)
    return candidate_speed(with_supports)

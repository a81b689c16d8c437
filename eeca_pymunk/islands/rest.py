"""Which islands are put to rest.

An island is at rest after a whole step without impacts or edits in which each of its bodies was slower than REST_SPEED
|a| dt at both ends, so that its contacts balance the loads to that accuracy, and no contact slipped or was driven; or
if it was slow at the start of two steps and `..contacts.statics` finds static forces.
"""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import nonallocating
from ..model.bodies import AWAKE, CANDIDATE
from ..model.parameters.intervals import LARGE_ISLAND
from ..model.parameters.rest import REST_CANDIDATE, REST_CANDIDATE_LARGE, REST_RETRY, REST_SPEED
from ..model.scene import Scene
from ..pairs.rules import law
from ..rows.equilibrium import point_speed


@nonallocating
def spins_freely(A: Scene, i: int) -> bool:
    """Whether contacts exert no torque on body i: a single disk without friction, on which no torque of the program
    acts."""
    return bool(i < A.COUNT.disks and A.SHAPE[i].friction == 0.0 and A.PULL[i, 2] == 0.0)


@nonallocating
def speed(A: Scene, i: int, s: float) -> float:
    """Bound of the speed (length/time) of the points of body i after a time s; of its centre if contacts exert no
    torque on it."""
    BODY = A.BODY
    vx, vy = BODY[i].vx + s * BODY[i].ax, BODY[i].vy + s * BODY[i].ay
    return point_speed(vx, vy, 0.0 if spins_freely(A, i) else BODY[i].spin + s * BODY[i].angular, BODY[i].extent)


@nonallocating
def candidate_speed(bodies: int) -> float:
    """Speed relative to |a| dt below which bodies of an island of so many bodies are tested for rest."""
    return REST_CANDIDATE if bodies < LARGE_ISLAND else REST_CANDIDATE_LARGE


@nonallocating
def slow_for_long(A: Scene, i: int) -> bool:
    """Whether the rest timer of body i allows a test for static forces."""
    return bool(A.RESTING[i].rest_timer >= 1.0)


@nonallocating
def motionless(A: Scene, MINE: IntArray, n: int) -> bool:
    """Whether none of the n bodies MINE has any velocity, as in the first step of a stack, or has failed a test lately:
    static forces are then searched at once."""
    for q in range(n):
        body = A.BODY[MINE[q]]
        if body.vx != 0.0 or body.vy != 0.0 or body.spin != 0.0 or A.RESTING[MINE[q]].rest_timer < 0.0:
            return False
    return True


@nonallocating
def postpone_test(A: Scene, MINE: IntArray, n: int) -> None:
    """Postpone the next test for static forces of the n bodies MINE by REST_RETRY steps."""
    for q in range(n):
        A.RESTING[MINE[q]].rest_timer = -float(REST_RETRY)


@nonallocating
def rest_threshold(A: Scene, root: int, MINE: IntArray, n: int, with_supports: int, t: float) -> float:
    """Speed relative to |a| dt below which an island may be put to rest at instant t by a test for static forces; 0 if
    it is not tested. A test postpones the next one.

    Args:
        MINE: its n bodies.  with_supports: number of bodies, with those of the islands that support it.
    """
    if t > 0.0 or A.PAR.pulled == 0.0 or A.COUNT.together > 0 or A.RULE.shape[0] > 0:
        return 0.0
    if not motionless(A, MINE, n):
        if A.MEMBER[root].hits > 0:
            return 0.0
        for q in range(n):
            if not slow_for_long(A, MINE[q]) or A.MEMBER[MINE[q]].busy > 0:
                return 0.0
    postpone_test(A, MINE, n)
    return candidate_speed(with_supports)


@nonallocating
def is_candidate(A: Scene, root: int) -> bool:
    """Whether all bodies of an island were slower than REST_SPEED |a| dt at both ends of this step, over which it had
    one interval without hits and without penetration correction."""
    MEMBER, dt = A.MEMBER, A.PAR.dt
    if MEMBER[root].open == 0 or MEMBER[root].jointed > 0 or MEMBER[root].hits > 0:
        return False
    if A.RESTING[root].until < math.inf:
        return False
    limit = REST_SPEED * A.PAR.pulled * dt
    i = root
    while i >= 0:
        if MEMBER[i].busy > 0:
            return False
        if max(speed(A, i, 0.0), speed(A, i, dt)) > limit:
            return False
        rest = A.RESTING[i]
        if rest.lift_x != 0.0 or rest.lift_y != 0.0 or rest.lift_angle != 0.0:
            return False
        if rest.lift_vx != 0.0 or rest.lift_vy != 0.0 or rest.lift_spin != 0.0:
            return False
        i = MEMBER[i].following
    return True


@nonallocating
def find_candidates(A: Scene) -> None:
    """At the end of a step, before contacts are accounted: set islands CANDIDATE that are slow (`is_candidate`) and
    whose contacts neither slip nor are driven by moving bodies or surfaces."""
    if A.PAR.pulled == 0.0 or A.COUNT.together > 0 or A.RULE.shape[0] > 0:
        return
    some = False
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.MEMBER[i].rest == AWAKE and is_candidate(A, i):
            A.MEMBER[i].rest = CANDIDATE
            some = True
    if not some:
        return
    limit = REST_SPEED * A.PAR.pulled * A.PAR.dt
    for c in range(A.COUNT.pushes):
        root = A.PUSHED_BY[c].root
        if root < 0 or A.MEMBER[root].rest != CANDIDATE:
            continue
        R = A.PUSHED[c]
        slips = max(abs(R.un_before), abs(R.un_after))
        if law(A.SHAPE, A.RULE, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b)[1] > 0.0:
            slips = max(slips, max(abs(R.ut_before), abs(R.ut_after)))
        driven = abs(R.work) > limit * (abs(R.normal) + abs(R.tangential))
        if R.start != 0.0 or slips > 4.0 * limit or driven:
            A.MEMBER[root].rest = AWAKE

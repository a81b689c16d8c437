"""Which islands come to a stand.

An island is at rest once, over a whole step without impacts or edits, each of its bodies was slower than
REST_SPEED |a| dt at both ends, so that its contacts bear its weight to that accuracy, and no contact slipped or was
driven; or once it was slow at the starts of two steps and `..contacts.statics` finds the forces that hold it.
"""

from __future__ import annotations

import math

from ..arrays import IntArray
from ..compiled import uncounted
from ..model.bodies import AWAKE, CANDIDATE
from ..model.parameters.intervals import LARGE_ISLAND
from ..model.parameters.rest import (
    REST_CANDIDATE,
    REST_CANDIDATE_LARGE,
    REST_RETRY,
    REST_SPEED,
)
from ..model.scene import Scene
from ..pairs.rules import law
from ..rows.equilibrium import point_speed


@uncounted
def spins_freely(A: Scene, i: int) -> bool:
    """Whether body i turns as it will, whatever touches it: a lone disk without friction, which nothing twists."""
    return bool(i < A.COUNT.disks and A.SHAPE[i].friction == 0.0 and A.PULL[i, 2] == 0.0)


@uncounted
def speed(A: Scene, i: int, s: float) -> float:
    """A bound on the speed of the points of body i in s; of its centre, where its turning moves nothing."""
    BODY = A.BODY
    vx, vy = BODY[i].vx + s * BODY[i].ax, BODY[i].vy + s * BODY[i].ay
    return point_speed(vx, vy, 0.0 if spins_freely(A, i) else BODY[i].spin + s * BODY[i].angular, BODY[i].extent)


@uncounted
def candidate_speed(bodies: int) -> float:
    """Speed relative to |a| dt below which an island of so many bodies hardly moves."""
    return REST_CANDIDATE if bodies < LARGE_ISLAND else REST_CANDIDATE_LARGE


@uncounted
def slow_for_long(A: Scene, i: int) -> bool:
    """Whether body i has hardly moved for long enough to be asked whether it stands."""
    return bool(A.RESTING[i].calm_for >= 1.0)


@uncounted
def motionless(A: Scene, MINE: IntArray, n: int) -> bool:
    """Whether none of the n bodies MINE has any velocity, as when a stack is put down, nor was tested lately: static
    forces are then looked for before motion is."""
    for q in range(n):
        body = A.BODY[MINE[q]]
        if body.vx != 0.0 or body.vy != 0.0 or body.spin != 0.0 or A.RESTING[MINE[q]].calm_for < 0.0:
            return False
    return True


@uncounted
def postpone(A: Scene, MINE: IntArray, n: int) -> None:
    """The n bodies MINE are asked again much later, unless they stand in between."""
    for q in range(n):
        A.RESTING[MINE[q]].calm_for = -float(REST_RETRY)


@uncounted
def rest_threshold(A: Scene, root: int, MINE: IntArray, n: int, among: int, t: float) -> float:
    """The speed relative to |a| dt at which the island of the n bodies MINE, on others, `among` in all, may come to a
    stand at instant t, 0 if it may not; it is asked again much later, unless it stood in between."""
    if t > 0.0 or A.PAR.pulled == 0.0 or A.COUNT.together > 0 or A.RULE.shape[0] > 0:
        return 0.0
    if not motionless(A, MINE, n):
        if A.MEMBER[root].hits > 0:
            return 0.0
        for q in range(n):
            if not slow_for_long(A, MINE[q]) or A.MEMBER[MINE[q]].busy > 0:
                return 0.0
    postpone(A, MINE, n)
    return candidate_speed(among)


@uncounted
def slow(A: Scene, root: int) -> bool:
    """Whether all bodies of an island were as good as at rest at both ends of this step, undisturbed."""
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


@uncounted
def find_candidates(A: Scene) -> None:
    """At the end of a step, before its contacts enter the ledger: which islands come to a stand."""
    if A.PAR.pulled == 0.0 or A.COUNT.together > 0 or A.RULE.shape[0] > 0:
        return
    some = False
    for i in range(A.BODY.shape[0] - 1):
        if A.STATE[i].island == i and A.MEMBER[i].rest == AWAKE and slow(A, i):
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

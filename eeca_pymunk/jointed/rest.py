"""Rest of islands with joints.

If joints and contacts leave an island unchanged over a whole step, their forces are static and hold it in every
following step. So an island is put to rest if its bodies have no velocity at the start and the end of such an interval,
up to REST_SPEED times the speed that the largest single force on the body would give it in the step. Its poses and the
forces of contacts and joints are kept (`..islands.at_rest`). It is solved again if a joint is edited, the law of a
spring changes, a partner moves, or for the same reasons as an island without joints.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..geometry.flight import has_velocity, point_speed
from ..islands.at_rest import moves_itself, put_to_rest, set_awake
from ..joints.ledger import clear_interval
from ..model.bodies import AT_REST, CHANGED
from ..model.joint_steps import EXACT
from ..model.joints import GEAR, Joints
from ..model.parameters.rest import REST_SPEED
from ..model.scene import Scene
from ..pairs.rules import law
from .gathered import save_joints


@nonallocating
def lever_of(A: Scene, i: int) -> float:
    """Length by which the spin of body i adds to its speed: that of its shapes, or its radius of gyration."""
    body = A.BODY[i]
    gyration = math.sqrt(body.inv_mass / body.inv_inertia) if body.inv_inertia > 0.0 else 0.0
    return float(max(body.extent, gyration))


@nonallocating
def speed_of_forces(A: Scene, J: Joints, i: int) -> float:
    """Speed that the largest single force on body i (acceleration, or one joint) would give its points in this step."""
    reach, s = lever_of(A, i), J.OF[i]
    found = (math.hypot(A.PULL[i, 0], A.PULL[i, 1]) + abs(A.PULL[i, 2]) * reach) * A.PAR.dt
    for k in range(J.COMPONENT[s].first_joint if s >= 0 else 0, J.COMPONENT[s].end_joint if s >= 0 else 0):
        joint = J.JOINT[J.COUPLING[k].joint]
        if joint.body[0] == i or joint.body[1] == i:
            per = A.BODY[i].inv_mass if joint.kind < GEAR else A.BODY[i].inv_inertia * reach
            found = max(found, (abs(joint.impulse[0]) + abs(joint.impulse[1])) * per)
    return float(found)


@nonallocating
def is_still(A: Scene, J: Joints, root: int) -> bool:
    """Whether all bodies of an island, whose interval is the whole step, have no velocity at its start and end, up to
    REST_SPEED, and none was hit."""
    i = root
    while i >= 0:
        body, rest, reach, most = A.BODY[i], A.RESTING[i], lever_of(A, i), REST_SPEED * speed_of_forces(A, J, i)
        if A.MEMBER[i].busy > 0 or point_speed(body.vx, body.vy, body.spin, reach) > most:
            return False
        if point_speed(rest.end_vx, rest.end_vy, rest.end_spin, reach) > most:
            return False
        i = A.MEMBER[i].following
    return True


@nonallocating
def has_moving_partner(A: Scene, J: Joints, s: int) -> bool:
    """Whether component s has a joint to a body that moves by itself."""
    n = A.BODY.shape[0]
    for w in range(J.COMPONENT[s].first_body, J.COMPONENT[s].end_body):
        body = int(J.JOINED[w].body)
        if moves_itself(A, body) if body < n else has_velocity(J.PARTNER[body - n]):
            return True
    return False


@nonallocating
def holds_still(A: Scene, J: Joints, s: int) -> bool:
    """Whether all joints of component s hold exactly, and none is to a moving partner."""
    if J.STEPPED[s].status != EXACT or has_moving_partner(A, J, s):
        return False
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        if J.JOINT[J.COUPLING[k].joint].touched != 0:
            return False
    return True


@nonallocating
def presses_still(A: Scene, root: int) -> bool:
    """Whether no contact of an island is on a body that moves by itself, or on a moving surface."""
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root != root:
            continue
        _, _, surface_x, surface_y = law(A, A.PUSHED_BY[c].a, A.PUSHED_BY[c].b)
        if surface_x != 0.0 or surface_y != 0.0:
            return False
        for shape in (A.PUSHED_BY[c].a, A.PUSHED_BY[c].b):
            if moves_itself(A, A.LINK[shape].owner):
                return False
    return True


@nonallocating
def rest_if_still(A: Scene, J: Joints, root: int) -> None:
    """Put an island to rest if its interval, which is the whole step and was solved, moves nothing."""
    if A.COUNT.together > 0 or A.COUNT.unmet > 0 or A.MEMBER[root].hits > 0:
        return
    if not (is_still(A, J, root) and presses_still(A, root)):
        return
    i = root
    while i >= 0:
        if A.MEMBER[i].tied == i and not holds_still(A, J, J.OF[i]):
            return
        i = A.MEMBER[i].following
    i = root
    while i >= 0:
        rest = A.RESTING[i]
        rest.lift_x = rest.lift_y = rest.lift_angle = rest.end_vx = rest.end_vy = rest.end_spin = 0.0
        if A.MEMBER[i].tied == i:
            clear_interval(J.STEPPED[J.OF[i]])
            save_joints(J, J.OF[i])
        i = A.MEMBER[i].following
    put_to_rest(A, root)


@nonallocating
def disturbed(A: Scene, J: Joints, s: int) -> bool:
    """Whether joints of component s, at rest, are edited or apart, have other laws than in the last step, or hold it to
    something that moves."""
    for k in range(J.COMPONENT[s].first_joint, J.COMPONENT[s].end_joint):
        j = J.COUPLING[k].joint
        joint, kept = J.JOINT[j], J.AT_START[j]
        # The program's functions change the laws of springs without an edit.
        if joint.push != kept.push or joint.stiffness != kept.stiffness or joint.rest != kept.rest:
            return True
        if joint.touched != 0:
            return True
    return has_moving_partner(A, J, s)


@nonallocating
def wake_disturbed(A: Scene, J: Joints) -> None:
    """At the start of a step: mark the islands at rest as CHANGED that are `disturbed`."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i].tied == i and A.MEMBER[i].rest == AT_REST:
            if disturbed(A, J, J.OF[i]):
                A.MEMBER[A.STATE[i].island].rest = CHANGED
            else:
                save_joints(J, J.OF[i])  # where the interval begins again if the island is hit


@nonallocating
def end_rest(A: Scene, root: int) -> None:
    """End the rest of an island with joints that is hit in this step; its interval began at the start of the step."""
    if A.MEMBER[root].rest == AT_REST:
        set_awake(A, root)

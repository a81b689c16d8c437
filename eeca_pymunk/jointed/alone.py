"""The interval of an island that is one component and near no other shape: no contacts, no memory allocated."""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..islands.local import open_until
from ..joints.ledger import clear_interval
from ..model.joints import Joints
from ..model.parameters.intervals import INTERVAL_RETRY
from ..model.scene import Scene
from ..model.step import AGAIN, DONE
from ..pairs.rules import barred
from .component import step_in_scratch
from .gathered import gather_alone, restore_joints, save_joints, takes_shorter
from .lengths import excess_alone, next_length


@nonallocating
def is_component(A: Scene, J: Joints, root: int) -> bool:
    """Whether an island is one component: then it has as many bodies. All bodies of a component are in one island
    (`..islands.building.build_islands`)."""
    s = J.OF[root]
    if s < 0:
        return False
    count = 0
    for i in range(J.COMPONENT[s].first_body, J.COMPONENT[s].end_body):
        count += 1 if J.JOINED[i].freedoms > 0 else 0
    return bool(count == A.MEMBER[root].bodies)


@nonallocating
def meets_no_other(A: Scene, root: int) -> bool:
    """Whether no shape of an island has another one near that it may meet."""
    i = root
    while i >= 0:
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                if not barred(A, s, int(A.POOL[w])):
                    return False
        i = A.MEMBER[i].following
    return True


@nonallocating
def begin_alone(A: Scene, J: Joints, root: int, t: float, h: float, last: bool) -> tuple[int, float]:
    """`solve.try_jointed` for an island that `is_component` and meets nothing."""
    s, before = J.OF[root], J.PROGRESS.effort
    save_joints(J, s)
    clear_interval(J.STEPPED[s])
    step_in_scratch(J, s, h, gather_alone(A, J, s, t, h), True)
    shorter = takes_shorter(A, J, s, t, h, J.PROGRESS.effort - before)
    far = 0.0 if last else 2.0 if shorter else excess_alone(A, J, s, t, h)
    if far > INTERVAL_RETRY:
        restore_joints(J, s)
        return AGAIN, h / far
    first = J.COMPONENT[s].first_body
    for i in range(J.COMPONENT[s].end_body - first):
        if J.LOCAL[i].freedoms > 0:
            body, local = J.JOINED[first + i].body, J.LOCAL[i]
            account_turning(A, J, s, body, local.pose[2], local.travel[2])
            set_path(A, body, h, local.pose, local.pose, local.v0)
    A.COUNT.solves += 1
    open_until(A, root, t + h)
    return DONE, next_length(h, far)


@nonallocating
def account_turning(A: Scene, J: Joints, s: int, body: int, angle: float, way: float) -> None:
    """Account for the work of the torque T on a body of component s, T (chi - turned): it acts along the way chi = h
    w_m, which differs a little from the angle that the body turns, from its own to `angle`."""
    b = A.BODY[body]
    if b.inv_inertia > 0.0 and A.PULL[body, 2] != 0.0:
        J.STEPPED[s].turned_work += A.PULL[body, 2] * (way - (angle - b.angle)) / b.inv_inertia


@nonallocating
def set_path(A: Scene, body: int, h: float, POSE: FloatArray, END: FloatArray, V: FloatArray) -> None:
    """Set the path of a body: a parabola to POSE (3,) after h. At its end the body is moved to END, with velocity V."""
    A.STATE[body].version += 1
    b, rest = A.BODY[body], A.RESTING[body]
    b.ax = 2.0 * (POSE[0] - b.x - h * b.vx) / (h * h)
    b.ay = 2.0 * (POSE[1] - b.y - h * b.vy) / (h * h)
    b.angular = 2.0 * (POSE[2] - b.angle - h * b.spin) / (h * h)
    rest.lift_x, rest.lift_y, rest.lift_angle = END[0] - POSE[0], END[1] - POSE[1], END[2] - POSE[2]
    rest.end_vx, rest.end_vy, rest.end_spin = V[0], V[1], V[2]

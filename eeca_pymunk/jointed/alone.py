"""The interval of what hangs together by joints and meets nobody: no contacts, and no arrays to be made."""

from __future__ import annotations

from ..compiled import nonallocating
from ..islands.local import open_until
from ..joints.ledger import clear_interval
from ..model.joint_steps import ELASTIC
from ..model.joints import Joints
from ..model.parameters.intervals import INTERVAL_RETRY
from ..model.scene import Scene
from ..pairs.rules import barred
from .component import step_in_scratch
from .gathered import gather_alone, keep_joints, restore_joints
from .lengths import excess_alone


@nonallocating
def is_component(A: Scene, J: Joints, root: int) -> bool:
    """Whether an island is one component."""
    s = J.OF[root]
    if s < 0:
        return False
    count = 0
    for i in range(J.COMPONENT[s].first_body, J.COMPONENT[s].end_body):
        if J.JOINED[i].freedoms > 0:
            if A.STATE[J.JOINED[i].body].island != root:
                return False
            count += 1
    return bool(count == A.MEMBER[root].bodies)


@nonallocating
def meets_nobody(A: Scene, root: int) -> bool:
    """Whether no shape of an island has another one near that it may meet."""
    i = root
    while i >= 0:
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                if not barred(A.RULE, s, int(A.POOL[w])):
                    return False
        i = A.MEMBER[i].following
    return True


@nonallocating
def begin_alone(A: Scene, J: Joints, root: int, t: float, h: float, last: bool) -> float:
    """Begin an interval of length h, without contacts, of an island that `is_component` at instant t, at which all its
    bodies are; 0, or how many times too long it is, with nothing done; not if it is the `last` attempt."""
    s = J.OF[root]
    keep_joints(J, s)
    clear_interval(J.STEPPED[s])
    step_in_scratch(J, s, h, gather_alone(A, J, s, t, h), True)
    far = 0.0 if last else 2.0 if J.STEPPED[s].status >= ELASTIC else excess_alone(A, J, s, t, h)
    if far > INTERVAL_RETRY:
        restore_joints(J, s)
        return far
    first = J.COMPONENT[s].first_body
    for i in range(J.COMPONENT[s].end_body - first):
        if J.LOCAL[i].freedoms > 0:
            lay_path(A, J, s, J.JOINED[first + i].body, i, h)
    A.COUNT.solves += 1
    open_until(A, root, t + h)
    return 0.0


@nonallocating
def lay_path(A: Scene, J: Joints, s: int, body: int, i: int, h: float) -> None:
    """Let a body go to where the scratch of its component has it at i: see `..jointed.solve`."""
    BODY, LOCAL = A.BODY, J.LOCAL
    if BODY[body].inv_inertia > 0.0 and A.PULL[body, 2] != 0.0:
        turned = LOCAL[i].pose[2] - BODY[body].angle
        J.STEPPED[s].turned_work += A.PULL[body, 2] * (LOCAL[i].travel[2] - turned) / BODY[body].inv_inertia
    A.STATE[body].version += 1
    b, rest = BODY[body], A.RESTING[body]
    b.ax = 2.0 * (LOCAL[i].pose[0] - b.x - h * b.vx) / (h * h)
    b.ay = 2.0 * (LOCAL[i].pose[1] - b.y - h * b.vy) / (h * h)
    b.angular = 2.0 * (LOCAL[i].pose[2] - b.angle - h * b.spin) / (h * h)
    rest.lift_x, rest.lift_y, rest.lift_angle = 0.0, 0.0, 0.0
    rest.lift_vx, rest.lift_vy, rest.lift_spin = LOCAL[i].v0[0], LOCAL[i].v0[1], LOCAL[i].v0[2]

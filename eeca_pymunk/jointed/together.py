"""A step whose contacts act together at its middle, in a scene with joints.

As `..impacts.midstep`, without the further passes for bodies that impulses send into others.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel
from ..impacts.midstep import anew, begin_together, join_all
from ..impacts.step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, ROOM_FOR_LISTS, finish
from ..islands.intervals import solve
from ..islands.membership import unite
from ..model.joints import Joints, joints_of
from ..model.scene import Scene, scene_of
from ..model.step import DONE
from .loop import account_joints, start_jointed
from .solve import begin_interval


@kernel
def resume_together_jointed(
    A: Scene, J: Joints, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, USUAL: FloatArray,
    status: int,
) -> int:  # fmt: skip
    """The rest of a step, whose bits so far are `status`; from its start, if it has been broken off for more room."""
    COUNT, BODY = A.COUNT, A.BODY
    n = BODY.shape[0] - 1
    A.RESTING[n].speed = 0.0
    for i in range(n):
        A.RESTING[i].speed = math.hypot(BODY[i].vx, BODY[i].vy) + abs(BODY[i].spin) * BODY[i].extent
    anew(A)
    if not join_all(A, USUAL):
        return ROOM_FOR_LISTS
    for i in range(n):
        if A.MEMBER[i].tied >= 0:
            unite(A, i, A.MEMBER[i].tied)
    # A solve may make another body the root of its island, which then would be solved again.
    roots = 0
    for i in range(n):
        if A.STATE[i].island == i:
            A.BLOCK[roots] = i
            roots += 1
    for q in range(roots):
        root = A.BLOCK[q]
        jointed = A.MEMBER[root].jointed > 0
        if (begin_interval(A, J, root, 0.0, A.PAR.dt) if jointed else solve(A, root, 0.0)) != DONE:
            return ROOM_FOR_CONTACTS
    if COUNT.pushes > A.LOG.shape[0]:
        return ROOM_FOR_EVENTS
    account_joints(A, J)
    return finish(A, STATES, WALK, EXTRA, ENDS, status)


@kernel
def step_together_jointed(
    TABLE: Table, JOINTS: Table, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray,
    USUAL: FloatArray, dt: float, gx: float, gy: float, left: float, bits: int,
) -> int:  # fmt: skip
    """From the states that were read to those that are to be written: arguments and answer as
    `..impacts.midstep.step_together`."""
    A, J = scene_of(TABLE), joints_of(JOINTS)
    if bits >= 0:
        return resume_together_jointed(A, J, STATES, WALK, EXTRA, ENDS, USUAL, bits)
    status = start_jointed(A, J, STATES, WALK, EXTRA, dt, gx, gy, left)
    if status < 0:
        return status
    begin_together(A)
    return resume_together_jointed(A, J, STATES, WALK, EXTRA, ENDS, USUAL, status)

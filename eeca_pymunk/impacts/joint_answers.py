"""How components answer an impact: the columns of its contacts, and limits that take part in it.

A limit on its bound acts as contacts do, 0 <= lam _|_ rate >= 0. All are free at first; those into which the solution
moves are held in the next one. None is let go again: of several limits of one component one may pull.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..jointed.columns import WITH_TANGENTS, fill_group, push_group
from ..jointed.component import project_speeds, size_joints
from ..jointed.gathered import find_places, gather_component
from ..jointed.groups import Groups
from ..joints.correct import hold_closing, keep_speeds
from ..joints.frame import has_prescribed_motion
from ..joints.start import compute_rows
from ..joints.workspace import workspace
from ..model.contacts import Columns
from ..model.joint_steps import SPEEDS
from ..model.joints import Joints
from ..model.scene import Scene
from ..newton.response import prepare_response, respond
from .simultaneous import Block


@nonallocating
def activate_limits(A: Scene, J: Joints, block: Block, groups: Groups, t: float) -> bool:
    """Let limits on their bounds take part in the impact at instant t if the velocities of the block move into them.
    Returns whether there are any that did not before."""
    more = False
    for s in groups.JOINTED:
        length = gather_component(A, J, s, block.POSE, block.V, block.V, block.IM, block.II, t, 0.0)
        W = workspace(J, s)
        size_joints(W, length)
        compute_rows(W)
        keep_speeds(W)
        more = hold_closing(W, False) or more
    return more


@kernel
def answer_impact(A: Scene, J: Joints, block: Block, groups: Groups, C: Columns, n: int, t: float) -> bool:
    """Set the columns C of the contacts of the block at instant t, and project its velocities onto those that joints
    allow. Returns whether partners drive a component."""
    ROWS, V = block.ROWS, block.V
    INDEX, driven = np.full(len(block.IM), -1, np.int64), False
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0:
            continue
        length = gather_component(A, J, s, block.POSE, V, np.zeros_like(V), block.IM, block.II, t, 0.0)
        size = find_places(A, J, s, INDEX)
        PUSH, moved = np.zeros((size, 3)), has_prescribed_motion(workspace(J, s))
        driven = driven or moved
        if moved:
            project_speeds(J, s, length)
            for q in range(n):
                if groups.GROUP[q] == g:
                    for c in range(3):
                        V[q, c] = J.LOCAL[INDEX[q]].v0[c]
        if not prepare_response(workspace(J, s), SPEEDS, 2.0):
            continue
        fill_group(J, groups, C, g, INDEX, ROWS, len(ROWS), PUSH, WITH_TANGENTS)
        if not moved:
            keep_allowed(J, block, groups, g, n, INDEX, PUSH)
    return driven


@nonallocating
def put_momenta(block: Block, groups: Groups, g: int, n: int, V: FloatArray, INDEX: IntArray, PUSH: FloatArray) -> None:
    """Put the momenta of the bodies of group g at velocities V into PUSH."""
    for q in range(n):
        if groups.GROUP[q] == g:
            for c in range(3):
                mobility = block.II[q] if c == 2 else block.IM[q]
                PUSH[INDEX[q], c] = V[q, c] / mobility if mobility > 0.0 else 0.0


@nonallocating
def keep_allowed(J: Joints, block: Block, groups: Groups, g: int, n: int, INDEX: IntArray, PUSH: FloatArray) -> None:
    """Project the velocities of group g, whose component is prepared (`..newton.response`), onto those that
    joints allow, by M^-1 G^T times impulses of joints."""
    V = block.V
    PUSH[:] = 0.0
    put_momenta(block, groups, g, n, V, INDEX, PUSH)
    respond(workspace(J, groups.COMPONENT[g]), PUSH)
    for q in range(n):
        if groups.GROUP[q] == g:
            for c in range(3):
                V[q, c] = PUSH[INDEX[q], c]


@kernel
def add_joint_impulses(
    A: Scene, J: Joints, block: Block, groups: Groups, L: FloatArray, FREE: FloatArray, t: float
) -> None:
    """Add to `Joint.struck` the impulses of joints caused by the impulses L of an impact at instant t, and by the part
    of the velocities FREE that they do not allow; in components that partners move, by L alone."""
    ROWS = block.ROWS
    INDEX = np.full(len(block.IM), -1, np.int64)
    for g in range(len(groups.COMPONENT)):
        s = groups.COMPONENT[g]
        if s < 0:
            continue
        gather_component(A, J, s, block.POSE, FREE, np.zeros_like(FREE), block.IM, block.II, t, 0.0)
        PUSH = np.zeros((find_places(A, J, s, INDEX), 3))
        if not prepare_response(workspace(J, s), SPEEDS, 2.0):
            continue
        if not has_prescribed_motion(workspace(J, s)):
            put_momenta(block, groups, g, len(FREE), FREE, INDEX, PUSH)
        for i in range(len(ROWS)):
            push_group(groups, g, INDEX, ROWS[i], L[i, 0], L[i, 1], PUSH)
        respond(workspace(J, s), PUSH)
        W = workspace(J, s)
        for k in range(W.joints):
            for r in range(W.link[k].rows):
                impulse = W.J.RIGHT[W.link[k].first_row + r] * W.J.HINGE[k].scale[r]
                W.J.JOINT[W.link[k].joint].struck[r] += impulse

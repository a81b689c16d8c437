"""The memory of joints: arrays for a set of joints, and those of one component."""

from __future__ import annotations

import numpy as np

from ..arrays import side_by_side
from ..compiled import inlined
from ..compiled.records import Rows, rows
from ..model.bodies import Body
from ..model.joint_steps import BodyStep, JointLedger, JointStep, Progress
from ..model.joints import Component, ComponentBody, Coupling, Joint, Joints, Tally, Workspace
from .plan import Room, make_plan, room_for, together


@inlined
def workspace(J: Joints, s: int) -> Workspace:
    """The memory of component s."""
    C = J.COMPONENT[s]
    return Workspace(
        J, s, J.COUPLING[C.first_joint : C.end_joint], C.end_joint - C.first_joint, C.end_body - C.first_body
    )


_NO_ROOM = Room(1, 1, 1, 1, 2, 1)


def make_joints(bodies: Rows[Body], joint: Rows[Joint], partner: Rows[Body], order: int) -> Joints:
    """The arrays of joints, with their plan.

    Args:
        bodies: (n,) those of the scene.  joint: (j,), kept, not copied.  partner: (x,) bodies that joints cannot move.
        order: 4 where nothing in a component dissipates, drives, or touches something; or 2.
    """
    count = len(joint)
    component, member, link = rows(Component, 0), rows(ComponentBody, 0), rows(Coupling, 0)
    of, room, components = np.full(len(bodies), -1, np.int64), _NO_ROOM, 0
    if count > 0:
        component, member, link = side_by_side(
            ((count,), Component.TYPE), ((2 * count,), ComponentBody.TYPE), ((count,), Coupling.TYPE)
        )
        components = make_plan(together(bodies, partner), joint, component, member, link, of)
        room = room_for(component, components)
    hinge, local, matrix, right, more, stiff, progress, part, pivots, kept, stepped, tally = side_by_side(
        ((room.joints,), JointStep.TYPE), ((room.bodies,), BodyStep.TYPE), ((room.matrix,), np.float64),
        ((room.right,), np.float64), ((room.scratch,), np.float64), ((6, 6), np.float64), ((1,), Progress.TYPE),
        ((1,), JointLedger.TYPE), ((room.rows,), np.int64), ((count,), Joint.TYPE),
        ((max(components, 1),), JointLedger.TYPE), ((1,), Tally.TYPE),
    )  # fmt: skip
    joints = Joints(
        joint, partner, component, member, link, hinge, local, matrix, right, more, stiff, progress[0], part[0],
        pivots, of, kept, stepped, tally[0],
    )  # fmt: skip
    joints.TALLY.order, joints.TALLY.components = order, components
    return joints

"""The memory of joints: arrays for a set of joints, and those of one component."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compiled import inlined
from ..compiled.records import Rows, row, rows
from ..model.bodies import Body
from ..model.joint_steps import BodyStep, JointLedger, JointStep, Progress
from ..model.joints import Component, ComponentBody, Coupling, Joint, Joints, Tally, Workspace
from .plan import make_plan, room_for


@inlined
def workspace(J: Joints, s: int) -> Workspace:
    """The memory of component s."""
    C = J.COMPONENT[s]
    return Workspace(
        J, s, J.COUPLING[C.first_joint : C.end_joint], C.end_joint - C.first_joint, C.end_body - C.first_body
    )


_NO_ROOM = room_for(rows(Component, 0))


def make_joints(bodies: Rows[Body], joint: Rows[Joint], partner: Rows[Body], order: int) -> Joints:
    """The arrays of joints, with their plan.

    Args:
        bodies: (n,) those of the scene.  joint: (j,), kept, not copied.  partner: (x,) bodies that joints cannot move.
        order: 4 where nothing in a component dissipates, drives, or touches something; or 2.
    """
    count = len(joint)
    component, member, link = rows(Component, count), rows(ComponentBody, 2 * count), rows(Coupling, count)
    tally, of, room = row(Tally), np.full(len(bodies), -1, np.int64), _NO_ROOM
    tally.order = order
    if count > 0:
        everyone: Any = np.concatenate((bodies, partner))
        tally.components = make_plan(everyone, joint, component, member, link)
        room = room_for(component[: tally.components])
    for s in range(tally.components):
        mine = member[component[s].first_body : component[s].end_body]
        of[mine["body"][mine["freedoms"] > 0]] = s
    return Joints(
        joint, partner, component, member, link, rows(JointStep, room.joints), rows(BodyStep, room.bodies),
        np.zeros(room.matrix), np.zeros(room.right), np.zeros(room.scratch), np.zeros((6, 6)), row(Progress),
        row(JointLedger), np.zeros(room.rows, np.int64), of, rows(Joint, count),
        rows(JointLedger, max(tally.components, 1)), tally,
    )  # fmt: skip

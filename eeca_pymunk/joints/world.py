"""All components of a set of bodies without contacts, stepped by one call."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compiled import Table, nonallocating, table_of
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joint_steps import JointLedger
from ..model.joints import Joint, Joints, joints_of
from .motion import size_up
from .step import take_step
from .workspace import make_joints, workspace


@nonallocating
def gather_island(bodies: Rows[Body], J: Joints, s: int, h: float) -> float:
    """Copy the bodies of component s into its scratch; its size, the length that errors are measured by."""
    C, local = J.COMPONENT[s], J.LOCAL
    for i in range(C.end_body - C.first_body):
        member, L = J.MEMBER[C.first_body + i], local[i]
        b = bodies[member.body]
        L.pose[0], L.pose[1], L.pose[2] = b.x, b.y, b.angle
        L.v0[0], L.v0[1], L.v0[2] = b.vx, b.vy, b.spin
        L.acceleration[0], L.acceleration[1], L.acceleration[2] = b.ax, b.ay, b.angular
        L.mobility[0], L.mobility[1], L.mobility[2] = b.inv_mass, b.inv_mass, b.inv_inertia
        L.cayley, L.column, L.freedoms, L.first = member.cayley, member.column, member.freedoms, member.first
    return size_up(J.JOINT, J.LINK, C.first_joint, C.end_joint, local, C.end_body - C.first_body, h)


@nonallocating
def step_all(JOINTS: Table, bodies: Rows[Body], h: float) -> int:
    """Step all components of a plan by h, in place of the poses and velocities of `bodies`; the worst status.

    Bodies outside components are not moved. STEPPED is filled in.
    """
    J = joints_of(JOINTS)
    worst = 0
    for s in range(J.TALLY.components):
        length = gather_island(bodies, J, s, h)
        W = workspace(J, s)
        worst = max(worst, take_step(W, h, J.TALLY.order, length, J.STEPPED[s]))
        for i in range(W.bodies):
            b, L = bodies[J.MEMBER[W.J.COMPONENT[W.s].first_body + i].body], J.LOCAL[i]
            if b.inv_mass > 0.0 or b.inv_inertia > 0.0:
                b.x, b.y, b.angle = L.pose[0], L.pose[1], L.pose[2]
                b.vx, b.vy, b.spin = L.v0[0], L.v0[1], L.v0[2]
    return worst


@dataclass
class Islands:
    """A plan of the components of some joints, with the memory that stepping them needs.

    Attributes:
        joint: (j,) the joints.  order: 2, or 4 where a component allows it.
    """

    joint: Rows[Joint]
    order: int = 2

    def plan(self, bodies: Rows[Body]) -> None:
        """Find the components of `bodies` (n,), and make room."""
        self.use(make_joints(bodies, self.joint, bodies[:0], self.order))
        self.arrays.PROGRESS.budget = np.inf

    def use(self, arrays: Joints) -> None:
        """Take these arrays."""
        self.arrays, self._table = arrays, table_of(arrays)

    @property
    def ledger(self) -> Rows[JointLedger]:
        """Energies of the last step, of each component."""
        return self.arrays.STEPPED[: self.arrays.TALLY.components]

    def step(self, bodies: Rows[Body], h: float) -> int:
        """Step all components of `bodies` (n,) by h; the worst status."""
        return step_all(self._table, bodies, h)

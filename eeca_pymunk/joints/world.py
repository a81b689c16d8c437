"""All islands of a set of bodies, stepped by one call."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from ..compiled.records import Rows
from ..model.bodies import Body
from .layout import LEDGER_COLUMNS
from .motion import size_up
from .plan import make_plan, room_for
from .scratch import (
    BEFORE,
    BODY_0,
    BODY_1,
    BUDGET,
    CAYLEY,
    COLUMN,
    FIRST,
    FOUND,
    FREE,
    FREEDOMS,
    HINGE_COLUMNS,
    JOINT_0,
    JOINT_1,
    LINK_COLUMNS,
    LOCAL_COLUMNS,
    M_BODY,
    M_CAYLEY,
    M_COLUMN,
    M_FIRST,
    M_FREEDOMS,
    MEMBER_COLUMNS,
    MOBILITY,
    NODE_COLUMNS,
    POSE,
    SPAN_COLUMNS,
)
from .step import island_step


@uncounted
def gather_island(
    bodies: Rows[Body], joint: FloatArray, span: IntArray, s: int, member: IntArray, link: IntArray, h: float,
    local: FloatArray, node: IntArray,
) -> float:  # fmt: skip
    """Copy the bodies of island s into its scratch; the size of the island, the length that errors are measured by."""
    b0, count = span[s, BODY_0], span[s, BODY_1] - span[s, BODY_0]
    for i in range(count):
        body = member[b0 + i, M_BODY]
        b = bodies[body]
        local[i, POSE], local[i, POSE + 1], local[i, POSE + 2] = b.x, b.y, b.angle
        local[i, BEFORE], local[i, BEFORE + 1], local[i, BEFORE + 2] = b.vx, b.vy, b.spin
        local[i, FREE], local[i, FREE + 1], local[i, FREE + 2] = b.ax, b.ay, b.angular
        local[i, MOBILITY], local[i, MOBILITY + 1], local[i, MOBILITY + 2] = b.inv_mass, b.inv_mass, b.inv_inertia
        local[i, CAYLEY] = member[b0 + i, M_CAYLEY]
        node[i, COLUMN], node[i, FREEDOMS] = member[b0 + i, M_COLUMN], member[b0 + i, M_FREEDOMS]
        node[i, FIRST] = member[b0 + i, M_FIRST]
    return size_up(joint, link, span[s, JOINT_0], span[s, JOINT_1], local, count, h)


@uncounted
def step_all(
    bodies: Rows[Body], joint: FloatArray, tie: IntArray, span: IntArray, member: IntArray, link: IntArray,
    islands: int, h: float, order: int, hinge: FloatArray, local: FloatArray, node: IntArray,
    matrix: FloatArray, right: FloatArray, more: FloatArray, pivots: IntArray, stiff: FloatArray, found: FloatArray,
    part: FloatArray, ledger: FloatArray, status: IntArray,
) -> int:  # fmt: skip
    """Step all islands of a plan by h, in place of the poses and velocities of `bodies`; the worst status.

    Bodies outside islands are not moved. `ledger` (islands, LEDGER_COLUMNS) and `status` (islands,) are filled in.
    """
    worst = 0
    for s in range(islands):
        b0, n = span[s, BODY_0], span[s, BODY_1] - span[s, BODY_0]
        j0, j1 = span[s, JOINT_0], span[s, JOINT_1]
        length = gather_island(bodies, joint, span, s, member, link, h, local, node)
        status[s] = island_step(
            joint, tie, hinge, link[j0:j1], j1 - j0, local, node, n, h, order, length, span[s], matrix, right, more,
            pivots, stiff, found, part, ledger[s],
        )  # fmt: skip
        worst = max(worst, status[s])
        for i in range(n):
            b = bodies[member[b0 + i, M_BODY]]
            if b.inv_mass > 0.0 or b.inv_inertia > 0.0:
                b.x, b.y, b.angle = local[i, POSE], local[i, POSE + 1], local[i, POSE + 2]
                b.vx, b.vy, b.spin = local[i, BEFORE], local[i, BEFORE + 1], local[i, BEFORE + 2]
    return worst


@dataclass
class Islands:
    """A plan of the islands of some joints, with the scratch that stepping them needs.

    Attributes:
        joint: (j, JOINT_COLUMNS) and tie: (j, TIE_COLUMNS) the joints.  order: 2, or 4 where an island allows it.
        ledger: (islands, LEDGER_COLUMNS) energies of the last step.  status: (islands,) of the last step.
    """

    joint: FloatArray
    tie: IntArray
    order: int = 2
    islands: int = 0
    ledger: FloatArray = field(default_factory=lambda: np.zeros((0, LEDGER_COLUMNS)))
    status: IntArray = field(default_factory=lambda: np.zeros(0, np.int64))

    def plan(self, bodies: Rows[Body]) -> None:
        """Find the islands of `bodies` (n, BODY_COLUMNS), and make room."""
        joints = len(self.tie)
        self._span = np.zeros((joints, SPAN_COLUMNS), np.int64)
        self._member = np.zeros((2 * joints, MEMBER_COLUMNS), np.int64)
        self._link = np.zeros((joints, LINK_COLUMNS), np.int64)
        self.islands = make_plan(bodies, self.joint, self.tie, self._span, self._member, self._link)
        room = room_for(self._span[: self.islands])
        self._hinge = np.zeros((room.joints, HINGE_COLUMNS))
        self._local = np.zeros((room.bodies, LOCAL_COLUMNS))
        self._node = np.zeros((room.bodies, NODE_COLUMNS), np.int64)
        self._matrix, self._right = np.zeros(room.matrix), np.zeros(room.right)
        self._more, self._pivots = np.zeros(room.scratch), np.zeros(room.rows, np.int64)
        self._stiff, self._found, self._part = np.zeros((6, 6)), np.zeros(FOUND), np.zeros(LEDGER_COLUMNS)
        self._found[BUDGET] = np.inf
        self.ledger, self.status = np.zeros((self.islands, LEDGER_COLUMNS)), np.zeros(self.islands, np.int64)

    def step(self, bodies: Rows[Body], h: float) -> int:
        """Step all islands of `bodies` (n, BODY_COLUMNS) by h; the worst status."""
        return step_all(
            bodies, self.joint, self.tie, self._span, self._member, self._link, self.islands, h, self.order,
            self._hinge, self._local, self._node, self._matrix, self._right, self._more, self._pivots,
            self._stiff, self._found, self._part, self.ledger, self.status,
        )  # fmt: skip

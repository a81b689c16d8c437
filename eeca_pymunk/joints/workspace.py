"""The memory of joints: arrays for a set of joints, and those of one component."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..arrays import IntArray
from ..compiled import Table, inlined, kernel, nonallocating
from ..compiled.layouts import COUNT, Layout, Plan
from ..compiled.records import Rows
from ..model.bodies import Body
from ..model.joints import NOTHING, Joint, Joints, Workspace, joints_of
from ..newton.boxes import room_for_boxes
from .plan import make_plan, together


@inlined
def workspace(J: Joints, s: int) -> Workspace:
    """The workspace of component s."""
    C = J.COMPONENT[s]
    return Workspace(
        J, s, J.COUPLING[C.first_joint : C.end_joint], C.end_joint - C.first_joint, C.end_body - C.first_body
    )


@nonallocating
def measure_plan(J: Joints, ROOM: IntArray) -> bool:
    """Write to ROOM the largest needs of one component; returns whether the arrays of J suffice.

    Args:
        ROOM (6,): out, bodies, joints, numbers of pivots, entries of a matrix, entries of a right side, and of scratch.
    """
    for k in range(6):
        ROOM[k] = 1
    for s in range(J.TALLY.components):
        C = J.COMPONENT[s]
        whole, dual = C.unknowns * (3 * C.band + 1), C.dual_size * (2 * C.dual_band + 1)
        ROOM[0] = max(ROOM[0], C.end_body - C.first_body)
        ROOM[1] = max(ROOM[1], C.end_joint - C.first_joint)
        ROOM[2] = max(ROOM[2], 2 * C.unknowns)
        ROOM[3] = max(ROOM[3], whole, dual if C.dual_for != NOTHING else 0)
        ROOM[4] = max(ROOM[4], 2 * (C.unknowns + C.impulses))
        ROOM[5] = max(ROOM[5], C.dual_size + room_for_boxes(C.boxes, C.unknowns + C.impulses))
    ROOM[4] = max(ROOM[4], 2)
    small = J.LOCAL.shape[0] < ROOM[0] or J.HINGE.shape[0] < ROOM[1] or J.PIVOTS.shape[0] < ROOM[2]
    return bool(
        not small and J.MATRIX.shape[0] >= ROOM[3] and J.RIGHT.shape[0] >= ROOM[4] and J.MORE.shape[0] >= ROOM[5]
    )


@kernel
def plan_components(table: Table, BODY: Rows[Body], ROOM: IntArray) -> bool:
    """Plan the components of the joints of `table`, whose other arrays contain zeros, for the bodies BODY (n,) of the
    scene. See `measure_plan`."""
    J = joints_of(table)
    J.OF[:] = -1
    J.TALLY.order = 4
    if J.JOINT.shape[0] > 0:
        bodies = together(BODY, J.PARTNER)
        J.TALLY.components = make_plan(bodies, J.JOINT, J.COMPONENT, J.JOINED, J.COUPLING, J.OF)
    return measure_plan(J, ROOM)


_PLAN = "TALLY", "PROGRESS", "PARTS", "PART_LEDGER", "STIFF", "COMPONENT", "JOINED", "COUPLING", "KEPT", "STEPPED", "OF"
_OF_ONE = "LOCAL", "HINGE", "PIVOTS", "MATRIX", "RIGHT", "MORE"  # scratch of one component


@cache
def _arrays() -> Plan[Joints]:
    own = _PLAN + _OF_ONE
    return Plan(Joints, own, len(own), ("JOINT", "PARTNER"), {}, {"STIFF": (COUNT, 6)})


class JointMemory:
    """Memory for successive plans of joints."""

    def __init__(self) -> None:
        self._layout = Layout(_arrays())
        self._room: IntArray = np.ones(len(_OF_ONE), np.int64)
        self._most: tuple[int, ...] = (1, 1, 1, 1, 2, 1)  # of one component so far

    def plan(self, BODY: Rows[Body], JOINT: Rows[Joint], PARTNER: Rows[Body]) -> Table:
        """The table of joints, `Joints`, with their plan; replaces the last one.

        Args:
            BODY: (n,) those of the scene.  JOINT: (j,), kept, not copied.  PARTNER: (x,), which joints cannot move.
        """
        j = len(JOINT)
        while True:
            counts = {
                "TALLY": 1, "PROGRESS": 1, "PARTS": 1, "PART_LEDGER": 1, "STIFF": 6, "OF": len(BODY), "JOINT": j,
                "PARTNER": len(PARTNER),
                "COMPONENT": j, "JOINED": 2 * j, "COUPLING": j, "KEPT": j, "STEPPED": j,
            }  # fmt: skip
            table = self._layout.lay(counts | dict(zip(_OF_ONE, self._most, strict=True)), JOINT, PARTNER)
            if plan_components(table, BODY, self._room):
                return table
            self._most = tuple(map(max, self._room.tolist(), self._most))

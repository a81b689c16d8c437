"""The memory of joints: arrays for a set of joints, and those of one component."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from ..arrays import IntArray
from ..compiled import Table, inlined, kernel, nonallocating
from ..compiled.layouts import ROWS, Layout, Plan
from ..compiled.records import Rows, rows
from ..model.bodies import AT_REST, CHANGED, Body
from ..model.joints import UNUSED, Joint, Joints, Workspace, joints_of
from ..model.scene import scene_of
from .pinned import find_pinned, release_held
from .plan import make_plan, together


@inlined
def workspace(J: Joints, s: int) -> Workspace:
    """The workspace of component s."""
    component = J.COMPONENT[s]
    return Workspace(
        J,
        s,
        J.COUPLING[component.first_joint : component.end_joint],
        component.end_joint - component.first_joint,
        component.end_body - component.first_body,
    )


@nonallocating
def measure_plan(J: Joints) -> bool:
    """Write to ROOM the largest needs of one component: bodies, joints, numbers of pivots, entries of a matrix, entries
    of a right side, and of scratch; returns whether the arrays of J suffice."""
    ROOM = J.ROOM
    for k in range(6):
        ROOM[k] = 1
    for s in range(J.TALLY.components):
        component = J.COMPONENT[s]
        whole, dual = component.unknowns * (3 * component.band + 1), component.dual_size * (2 * component.dual_band + 1)
        ROOM[0] = max(ROOM[0], component.end_body - component.first_body)
        ROOM[1] = max(ROOM[1], component.end_joint - component.first_joint)
        ROOM[2] = max(ROOM[2], 2 * component.unknowns, component.dual_size)
        ROOM[3] = max(ROOM[3], whole, dual if component.dual_for != UNUSED or component.cycles > 0 else 0)
        ROOM[4] = max(ROOM[4], 2 * (component.unknowns + component.impulses))
        ROOM[5] = max(ROOM[5], component.dual_size)
    ROOM[4] = max(ROOM[4], 2)
    small = J.LOCAL.shape[0] < ROOM[0] or J.HINGE.shape[0] < ROOM[1] or J.PIVOTS.shape[0] < ROOM[2]
    return bool(
        not small and J.MATRIX.shape[0] >= ROOM[3] and J.RIGHT.shape[0] >= ROOM[4] and J.MORE.shape[0] >= ROOM[5]
    )


@kernel
def tie_components(table: Table, joints: Table) -> None:
    """Make a ring of the bodies of each component. Predictions by earlier components are void; where bodies have lost
    theirs, islands are built in the next step, even if no component remains."""
    A, OF = scene_of(table), joints_of(joints).OF
    MEMBER, BODY, COUNT = A.MEMBER, A.BODY, A.COUNT
    first, last = np.full(OF.shape[0], -1, np.int64), np.full(OF.shape[0], -1, np.int64)
    for i in range(MEMBER.shape[0]):
        BODY[i].due = min(BODY[i].due, -1.0)
        s = OF[i]
        if MEMBER[i].rest == AT_REST:
            MEMBER[A.STATE[i].island].rest = CHANGED  # joints may hold it otherwise now
        if MEMBER[i].tied >= 0 and s < 0:
            COUNT.any_placed = max(COUNT.any_placed, 1)
        MEMBER[i].tied, MEMBER[i].next_tied = -1, -1
        if s >= 0:
            first[s] = i if first[s] < 0 else first[s]
            MEMBER[i].tied, MEMBER[i].next_tied = first[s], first[s]
            if last[s] >= 0:
                MEMBER[last[s]].next_tied = i
            last[s] = i


@kernel
def plan_components(table: Table, joints: Table) -> int:
    """Plan the components of joints, whose other arrays contain zeros: which bodies they hold, and which the others tie
    together. Returns the number of held bodies; -1, with none held, if arrays are too short (`measure_plan`)."""
    A, J = scene_of(table), joints_of(joints)
    J.OF[:] = -1
    J.TALLY.order = 4
    if J.JOINT.shape[0] > 0:
        find_pinned(table, joints)
        J.TALLY.components = make_plan(together(A.BODY, J.PARTNER), J)
    if not measure_plan(J):
        release_held(table, joints)
        return -1
    tie_components(table, joints)
    return J.TALLY.pinned


_ONE = "TALLY", "PROGRESS", "NEWTON", "PARTS", "AGREEMENT", "RUNG_LEDGER"
_PLAN = *_ONE, "STIFF", "COMPONENT", "JOINED", "COUPLING", "AT_START", "STEPPED", "OF"
_OF_ONE = "LOCAL", "HINGE", "PIVOTS", "MATRIX", "RIGHT", "MORE"  # scratch of one component, in the order of ROOM


@cache
def _arrays() -> Plan[Joints]:
    zeros = "ROOM", *_PLAN, *_OF_ONE
    return Plan(Joints, (*zeros, "PINNED"), len(zeros), ("JOINT", "PARTNER", "STILL"), {}, {"STIFF": (ROWS, 6)})


class Linkage(NamedTuple):
    """The joints of a world."""

    joint: Rows[Joint]  # (j,) between rows of BODY, or len(BODY) + row of PARTNER
    PARTNER: Rows[Body]  # (x,) bodies that joints cannot move
    still: IntArray  # (n + x,) 1 for bodies that do not move; empty if there is none


NO_LINKAGE = Linkage(rows(Joint, 0), rows(Body, 0), np.zeros(0, np.int64))


class JointMemory:
    """Memory for successive plans of joints.

    Attributes:
        held: rows of the bodies that joints hold by the last plan.
    """

    held: Sequence[int]

    def __init__(self) -> None:
        self._layout = Layout(_arrays())
        self._most: tuple[int, ...] = (1, 1, 1, 1, 2, 1)  # of one component so far

    def plan(self, scene: Table, n: int, linkage: Linkage) -> Table:
        """The table of joints, `Joints`, with their plan, in a scene of n bodies, in which they now hold and tie some;
        replaces the last one."""
        JOINT, PARTNER, STILL = linkage
        j, x = len(JOINT), len(PARTNER)
        while True:
            counts = {
                **dict.fromkeys(_ONE, 1), "STIFF": 6, "OF": n, "JOINT": j, "PARTNER": x, "STILL": len(STILL),
                "PINNED": n if len(STILL) else 0, "ROOM": len(_OF_ONE),
                "COMPONENT": j, "JOINED": 2 * j, "COUPLING": j, "AT_START": j, "STEPPED": j,
                **dict(zip(_OF_ONE, self._most, strict=True)),
            }  # fmt: skip
            table = self._layout.lay(counts, JOINT, PARTNER, STILL)
            pinned = plan_components(scene, table)
            if pinned >= 0:
                self.held = self._layout.array("PINNED")["body"][:pinned].tolist() if pinned else ()
                return table
            self._most = tuple(map(max, self._layout.integers("ROOM").tolist(), self._most))

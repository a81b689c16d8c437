"""The event loop of a world with joints: the arrays of both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray
from ..compiled import table_of
from ..compiled.records import Rows
from ..impacts.film import Reel
from ..impacts.memory import OF_SCENE, gathered
from ..impacts.remembering import UNBOUND
from ..impacts.scene import EventLoop
from ..joints.layout import JOINT_COLUMNS, TIE_COLUMNS
from ..joints.plan import make_plan, room_for
from ..joints.scratch import (
    BODY_0,
    BODY_1,
    FOUND,
    HINGE_COLUMNS,
    LINK_COLUMNS,
    LOCAL_COLUMNS,
    M_BODY,
    M_FREEDOMS,
    MEMBER_COLUMNS,
    NODE_COLUMNS,
    SPAN_COLUMNS,
)
from ..model.bodies import Body
from ..model.shapes import Link, Shape
from .layout import COMPONENTS, OF_JOINTS, ORDER, STEPPED_COLUMNS, TALLY_LENGTH, Joints
from .loop import step_jointed
from .run import run_jointed
from .together import step_together_jointed


class JointedLoop(EventLoop):
    """Steps the packed bodies, shapes and joints of a world.

    Args:
        BODY, SHAPE, LINK, VERTEX, disks, limit: as `EventLoop`.
        joint, tie: (j, ...) the joints, see `..joints.layout`; kept, not copied. Bodies are rows of BODY, or len(BODY)
            + row of PARTNER (x,), which joints cannot move.
        together: whether all contacts of a step act together at its middle, rather than at their instants.
        order: 4 where nothing in a component dissipates, drives, or touches something; or 2.
    """

    def __init__(
        self, BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, disks: int, limit: int,
        joint: FloatArray, tie: IntArray, PARTNER: Rows[Body], together: bool = False, order: int = 4,
    ) -> None:  # fmt: skip
        super().__init__(BODY, SHAPE, LINK, VERTEX, disks, limit)
        self._joint, self._tie, self._partner, self._order = joint, tie, PARTNER, order
        self.together = together
        if together:
            self._options = ()
        self.plan()

    def plan(self) -> None:
        """Find the components anew: after changes of joints' kinds, bodies, anchors off centre, or of mobilities."""
        joint, tie, n = self._joint, self._tie, len(self.scene.BODY)
        count = len(tie)
        span, member = np.zeros((count, SPAN_COLUMNS), np.int64), np.zeros((2 * count, MEMBER_COLUMNS), np.int64)
        link = np.zeros((count, LINK_COLUMNS), np.int64)
        bodies: Any = np.concatenate((self.scene.BODY, self._partner))
        components = make_plan(bodies, joint, tie, span, member, link)
        room = room_for(span[:components])
        tally = np.zeros(TALLY_LENGTH, np.int64)
        tally[COMPONENTS], tally[ORDER] = components, self._order
        of = np.full(n, -1, np.int64)
        ring = self.scene.MEMBER
        ring["tied"] = ring["next_tied"] = -1
        for s in range(components):
            rows = member[span[s, BODY_0] : span[s, BODY_1]]
            moved = np.sort(rows[rows[:, M_FREEDOMS] > 0, M_BODY])
            of[moved] = s
            ring["tied"][moved], ring["next_tied"][moved] = moved[0], np.roll(moved, -1)
        self.joints = Joints(
            joint, tie, self._partner, span, member, link, np.zeros((room.joints, HINGE_COLUMNS)),
            np.zeros((room.bodies, LOCAL_COLUMNS)), np.zeros((room.bodies, NODE_COLUMNS), np.int64),
            np.zeros(room.matrix), np.zeros(room.right), np.zeros(room.scratch), np.zeros((6, 6)), np.zeros(FOUND),
            np.zeros(8), np.zeros(room.rows, np.int64), of,
            np.zeros((count, JOINT_COLUMNS)), np.zeros((count, TIE_COLUMNS), np.int64),
            np.zeros((max(components, 1), STEPPED_COLUMNS)), tally,
        )  # fmt: skip
        self._ties = table_of(self.joints)
        self._bound = UNBOUND

    def _gather(self) -> IntArray:
        (self.scene, self.joints), memory = gathered((self.scene, OF_SCENE), (self.joints, OF_JOINTS))
        self.near = self._lists()
        self._joint, self._tie = self.joints.JOINT, self.joints.TIE
        self._ties = table_of(self.joints)
        return memory

    @property
    def joint(self) -> FloatArray:
        """(j, JOINT_COLUMNS) the joints."""
        return self._joint

    @property
    def tie(self) -> IntArray:
        """(j, TIE_COLUMNS) the joints."""
        return self._tie

    @property
    def partner(self) -> Rows[Body]:
        """(x,) bodies that joints cannot move."""
        return self._partner

    def rebind(self, joint: FloatArray, tie: IntArray, PARTNER: Rows[Body]) -> None:
        """Take other arrays that have the same in them."""
        self._joint, self._tie, self._partner = joint, tie, PARTNER
        self.joints = Joints(joint, tie, PARTNER, *self.joints[3:])
        self._ties = table_of(self.joints)
        self._bound = UNBOUND

    def __getstate__(self) -> dict[str, object]:
        return {key: value for key, value in super().__getstate__().items() if key != "_ties"}

    def __setstate__(self, state: dict[str, object]) -> None:
        super().__setstate__(state)
        self._ties = table_of(self.joints)

    def _bind(self, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        if self.together:
            return step_together_jointed.bind(self.table, self._ties, *states, self._usual)
        return step_jointed.bind(self.table, self._ties, *states)

    def _bind_run(self, reel: Reel, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        return run_jointed.bind(self.table, self._ties, reel.table, *states, self._usual)

"""The event loop of a world with joints: the arrays of both."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray
from ..compiled import table_of
from ..compiled.records import Rows
from ..impacts.memory import OF_SCENE, gathered
from ..impacts.remembering import UNBOUND
from ..impacts.run_buffers import RunBuffers
from ..impacts.scene import EventLoop
from ..joints.workspace import make_joints
from ..model.bodies import Body
from ..model.joints import OF_JOINTS, Joint
from ..model.shapes import Link, Shape
from .loop import step_jointed
from .run import run_jointed
from .together import step_together_jointed


class JointedLoop(EventLoop):
    """Steps the packed bodies, shapes and joints of a world.

    Args:
        BODY, SHAPE, LINK, VERTEX, disks, limit: as `EventLoop`.
        joint: (j,) the joints; kept, not copied. Bodies are rows of BODY, or len(BODY)
            + row of PARTNER (x,), which joints cannot move.
        together: whether all contacts of a step act together at its middle, rather than at their instants.
        order: 4 where nothing in a component dissipates, drives, or touches something; or 2.
    """

    def __init__(
        self, BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, disks: int, limit: int,
        joint: Rows[Joint], PARTNER: Rows[Body], together: bool = False, order: int = 4,
    ) -> None:  # fmt: skip
        super().__init__(BODY, SHAPE, LINK, VERTEX, disks, limit)
        self._joint, self._partner, self._order = joint, PARTNER, order
        self.together = together
        self._options = () if together else self._options
        self.plan()

    def plan(self) -> None:
        """Find the components anew: after changes of joints' kinds, bodies, anchors off centre, or of mobilities."""
        self.joints = make_joints(self.scene.BODY, self._joint, self._partner, self._order)
        ring = self.scene.MEMBER
        ring["tied"] = ring["next_tied"] = -1
        for s in range(self.joints.TALLY.components):
            moved = np.flatnonzero(s == self.joints.OF)
            ring["tied"][moved], ring["next_tied"][moved] = moved[0], np.roll(moved, -1)
        self._ties = table_of(self.joints)
        self._bound = UNBOUND

    def _gather(self) -> IntArray:
        (self.scene, self.joints), memory = gathered((self.scene, OF_SCENE), (self.joints, OF_JOINTS))
        self._joint = self.joints.JOINT
        self._ties = table_of(self.joints)
        return memory

    @property
    def joint(self) -> Rows[Joint]:
        """(j,) the joints."""
        return self._joint

    @property
    def partner(self) -> Rows[Body]:
        """(x,) bodies that joints cannot move."""
        return self._partner

    def rebind(self, joint: Rows[Joint], PARTNER: Rows[Body]) -> None:
        """Take other arrays that have the same in them."""
        self._joint, self._partner = joint, PARTNER
        self.joints = self.joints._replace(JOINT=joint, PARTNER=PARTNER)
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

    def _bind_run(self, buffers: RunBuffers, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        return run_jointed.bind(self.table, self._ties, buffers.table, *states, self._usual)

"""Stand-in for the loop of jointed bodies: islands of joints, free flight for all others, no contacts."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..impacts.scene import EventLoop
from ..joints.layout import BODY_A, BODY_B, TOUCHED
from ..joints.world import Islands
from ..layout import ANGLE, AX, BODY_ROW, IM, LEFT, NOW, SINCE, SPIN, TWIST, VX, X
from ..transfer import give, take


class JointedLoop(EventLoop):
    def __init__(
        self, BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, disks: int, limit: int,
        joint: FloatArray, tie: IntArray, PARTNER: FloatArray, together: bool,
    ) -> None:  # fmt: skip
        super().__init__(BODY, SHAPE, LINK, VERTEX, disks, limit)
        self.joint, self.tie, self.PARTNER, self.together = joint, tie, PARTNER, together
        self.islands = Islands(joint, tie, 2)
        self.plans = 0
        self.plan()

    def _all(self) -> FloatArray:
        return np.concatenate((self.scene.BODY, self.PARTNER))

    def plan(self) -> None:
        self.plans += 1
        self.islands.plan(self._all())

    def step(
        self, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float, gy: float,
        left: float,
    ) -> int:  # fmt: skip
        BODY = self.scene.BODY
        n = len(BODY)
        status = take(STATES, WALK, EXTRA, BODY, gx, gy, left)
        if status < 0:
            return status
        edited = (STATES[NOW, :, :6] != STATES[LEFT, :, :6]).any(axis=1)
        rows = WALK[BODY_ROW, edited]
        hit = np.isin(self.tie[:, BODY_A], rows) | np.isin(self.tie[:, BODY_B], rows)
        self.tie[hit, TOUCHED] = 1
        every = self._all()
        self.islands.step(every, dt)
        bound = np.zeros(n + len(self.PARTNER), bool)
        bound[self.tie[:, BODY_A : BODY_B + 1].ravel()] = True
        bound = bound[:n] & (BODY[:, IM] > 0.0)
        free = ~bound
        BODY[bound, X : SPIN + 1] = every[:n][bound, X : SPIN + 1]
        BODY[free, X : ANGLE + 1] += dt * (BODY[free, VX : SPIN + 1] + 0.5 * dt * BODY[free, AX : TWIST + 1])
        BODY[free, VX : SPIN + 1] += dt * BODY[free, AX : TWIST + 1]
        BODY[:, SINCE] = dt
        return give(STATES, WALK, EXTRA, BODY, ENDS, dt, left, status)

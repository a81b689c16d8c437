"""pymunk's constraints in packed arrays: what they are, what the user changed since, and what goes back.

Anchors of pymunk stand relative to the body, ours to its centre of mass.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..joints.layout import (
    ANCHOR_AX,
    BODY_A,
    BODY_B,
    DAMPING,
    ERROR_BIAS,
    GEAR,
    GROOVE,
    IMPULSE_1,
    IMPULSE_2,
    JOINT_COLUMNS,
    KIND,
    LENGTH,
    LOWER,
    MAX_BIAS,
    MAX_FORCE,
    MOTOR,
    NORMAL_X,
    NOTCH,
    OFFSET,
    PHASE,
    PIN,
    PIVOT,
    RATCHET,
    RATE,
    RATIO,
    REST,
    ROTARY_LIMIT,
    ROTARY_SPRING,
    SIDE,
    SLIDE,
    SOFT,
    SPRING,
    STIFFNESS,
    TIE_COLUMNS,
    TOOTH,
    TOOTH_PHASE,
    TOUCHED,
    UPPER,
)  # fmt: skip
from .edits import Edits, show_impulses
from .spring_functions import own_function

ANCHORS = slice(ANCHOR_AX, ANCHOR_AX + 4)
_SMALL = 1e-9  # a pin shorter than this, over its anchors' distances, is a pivot


class JointRows:
    """The constraints of a space as JOINT and TIE rows, kept up to date with what the user changes.

    Attributes:
        items: the constraints, in the order of the rows.  joint: (j, JOINT_COLUMNS).  tie: (j, TIE_COLUMNS).
        row: the row of each constraint.  functions: springs that have a force or torque function of the user's own.
        before, after: constraints with a `pre_solve`, with a `post_solve`.
    """

    def __init__(
        self, constraints: Iterable[pymunk.Constraint], row: Mapping[pymunk.Body, int], past: JointRows | None = None
    ) -> None:
        """The rows of `constraints` between bodies with these rows; what `past` knows of them is kept."""
        self.items = list(constraints)
        self.joint: FloatArray = np.zeros((len(self.items), JOINT_COLUMNS))
        self.tie: IntArray = np.zeros((len(self.items), TIE_COLUMNS), np.int64)
        for j, item in enumerate(self.items):
            self.tie[j, BODY_A], self.tie[j, BODY_B] = row[item.a], row[item.b]
            _read(item, self.joint[j], self.tie[j])
            self.tie[j, TOUCHED] = 1
        if past is not None:
            past.refresh()
            for j, item in enumerate(self.items):
                if item in past.row:
                    i = past.row[item]
                    self.joint[j], self.tie[j, SIDE:] = past.joint[i], past.tie[i, SIDE:]
        self.row: dict[pymunk.Constraint, int] = {item: j for j, item in enumerate(self.items)}
        self._edits = Edits(self.row)
        self._ratchets = np.flatnonzero(self.tie[:, KIND] == RATCHET)
        self._find_functions()

    def _find_functions(self) -> None:
        self.functions = [j for j, item in enumerate(self.items) if own_function(item)]
        self.before = [item for item in self.items if item.pre_solve is not None]
        self.after = [item for item in self.items if item.post_solve is not None]

    def refresh(self) -> bool:
        """Read anew the constraints that the user changed; whether the islands must be planned anew."""
        edited = self._edits.take()
        if not edited:
            return False
        replan = False
        for j in sorted(edited):
            off_before, kind, soft = self.joint[j, ANCHORS] != 0.0, self.tie[j, KIND], self.tie[j, SOFT]
            _read(self.items[j], self.joint[j], self.tie[j])
            self.tie[j, TOUCHED] = 1
            off = self.joint[j, ANCHORS] != 0.0
            replan = replan or kind != self.tie[j, KIND] or soft != self.tie[j, SOFT] or bool((off != off_before).any())
        self._find_functions()
        return replan

    def touch(self, rows: IntArray) -> None:
        """Mark the joints of bodies (rows) that the user has moved or pushed."""
        hit = np.isin(self.tie[:, BODY_A], rows) | np.isin(self.tie[:, BODY_B], rows)
        self.tie[hit, TOUCHED] = 1

    def impulse(self, j: int) -> float:
        """What `constraint.impulse` would be after native's step: of springs signed (positive pushes), else >= 0."""
        first, second = self.joint[j, IMPULSE_1], self.joint[j, IMPULSE_2]
        if self.tie[j, KIND] == SPRING:
            return float(first)
        if self.tie[j, KIND] == ROTARY_SPRING:
            return float(first)
        return math.hypot(first, second)

    def write(self) -> None:
        """Give ratchets the notch they have reached, and let `constraint.impulse` read ours."""
        for j in self._ratchets:
            item = self.items[j]
            if item.angle != self.joint[j, NOTCH]:
                item.angle = float(self.joint[j, NOTCH])
                self._edits.forget(int(j))
        show_impulses(self.items, self.impulse)


def _read(c: Any, joint: FloatArray, tie: IntArray) -> None:
    """Fill in the parameters of one row."""
    joint[MAX_FORCE], joint[ERROR_BIAS], joint[MAX_BIAS] = c.max_force, c.error_bias, c.max_bias
    tie[SOFT] = int(math.isfinite(c.max_force))
    tie[SIDE] = 0
    if hasattr(c, "anchor_a"):
        joint[ANCHOR_AX : ANCHOR_AX + 2] = c.anchor_a - c.a.center_of_gravity
    if hasattr(c, "anchor_b"):
        joint[ANCHOR_AX + 2 : ANCHOR_AX + 4] = c.anchor_b - c.b.center_of_gravity
    if isinstance(c, pymunk.PinJoint):
        _pin(c.distance, joint, tie)
    elif isinstance(c, pymunk.SlideJoint):
        if c.min == c.max:
            _pin(c.max, joint, tie)
        else:
            tie[KIND], joint[LOWER], joint[UPPER] = SLIDE, c.min, c.max
    elif isinstance(c, pymunk.PivotJoint):
        tie[KIND] = PIVOT
    elif isinstance(c, pymunk.GrooveJoint):
        tie[KIND] = GROOVE
        first, last = c.groove_a - c.a.center_of_gravity, c.groove_b - c.a.center_of_gravity
        along = (last - first).normalized()
        normal = along.perpendicular()
        joint[NORMAL_X : NORMAL_X + 2] = normal
        joint[OFFSET], joint[LOWER], joint[UPPER] = normal.dot(first), along.dot(first), along.dot(last)
    elif isinstance(c, pymunk.DampedSpring):
        tie[KIND], joint[STIFFNESS], joint[DAMPING], joint[REST] = SPRING, c.stiffness, c.damping, c.rest_length
    elif isinstance(c, pymunk.DampedRotarySpring):
        tie[KIND], joint[STIFFNESS], joint[DAMPING], joint[REST] = ROTARY_SPRING, c.stiffness, c.damping, c.rest_angle
    elif isinstance(c, pymunk.RotaryLimitJoint):
        if c.min == c.max:
            tie[KIND], joint[RATIO], joint[PHASE] = GEAR, 1.0, c.min
        else:
            tie[KIND], joint[LOWER], joint[UPPER] = ROTARY_LIMIT, c.min, c.max
    elif isinstance(c, pymunk.RatchetJoint):
        tie[KIND], joint[TOOTH], joint[TOOTH_PHASE] = RATCHET, c.ratchet, c.phase
        joint[NOTCH] = _notch(c)
    elif isinstance(c, pymunk.GearJoint):
        tie[KIND], joint[RATIO], joint[PHASE] = GEAR, c.ratio, c.phase
    elif isinstance(c, pymunk.SimpleMotor):
        tie[KIND], joint[RATE] = MOTOR, c.rate


def _pin(length: float, joint: FloatArray, tie: IntArray) -> None:
    """A pin, or a pivot if it has no length: there a pin has no direction."""
    scale = float(np.abs(joint[ANCHOR_AX : ANCHOR_AX + 4]).max())
    tie[KIND] = PIVOT if length <= _SMALL * max(scale, 1e-300) or length == 0.0 else PIN
    joint[LENGTH] = length


def _notch(c: pymunk.RatchetJoint) -> float:
    """The notch as native's step finds it: kept while the angle is short of it, else the last one passed."""
    turned = c.b.angle - c.a.angle
    if (c.angle - turned) * c.ratchet > 0.0:
        return float(c.angle)
    return math.floor((turned - c.phase) / c.ratchet) * c.ratchet + c.phase

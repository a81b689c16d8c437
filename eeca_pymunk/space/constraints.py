"""Constraints: pymunk's ten constraints as rows of JOINT, and the check of their values.

Anchors of pymunk are relative to the body's origin, those of JOINT to its centre of mass. Degenerate constraints become
others:

| constraint | read as |
|---|---|
| pin of length 0, groove of length 0 | pivot |
| slide with equal limits | pin |
| rotary limit with equal limits | gear |
"""

from __future__ import annotations

import math
import struct
from functools import cache
from typing import Any, NamedTuple

import pymunk

from ..errors import UnsupportedFeature
from ..model import joints
from .private import joints as private_joints

_SMALL = 1e-9  # a pin is a pivot if its length, over the largest coordinate of its anchors, is at most this
_KINDS = (
    pymunk.PinJoint, pymunk.SlideJoint, pymunk.PivotJoint, pymunk.GrooveJoint, pymunk.DampedSpring,
    pymunk.DampedRotarySpring, pymunk.RotaryLimitJoint, pymunk.RatchetJoint, pymunk.GearJoint, pymunk.SimpleMotor,
)  # fmt: skip
# Attributes that must be finite; that must be >= 0, and may be infinite unless also in _FINITE; that must not be 0.
_FINITE = (
    "anchor_a", "anchor_b", "groove_a", "groove_b", "distance", "stiffness", "damping", "rest_length", "rest_angle",
    "phase", "ratchet", "ratio", "rate",
)  # fmt: skip
_POSITIVE = ("max_force", "max_bias", "error_bias", "damping")
_NOT_ZERO = ("ratio", "ratchet")
# All attributes that are numbers or points: they change neither the functions of a constraint nor whether its bodies
# collide.
NUMBERS = frozenset((*_FINITE, *_POSITIVE, *_NOT_ZERO, "angle", "min", "max"))
_NEAR_NOTCH = 1e-9  # of a tooth: a body that stands on a notch may be before it by round-off


@cache
def _numbers(kind: Any) -> tuple[list[str], list[str], list[str]]:
    """The attributes of a kind of constraint that must be finite, >= 0, and not 0."""
    finite, positive, not_zero = ([a for a in names if hasattr(kind, a)] for names in (_FINITE, _POSITIVE, _NOT_ZERO))
    return finite, positive, not_zero


def check_constraint(c: Any) -> None:
    """ValueError, with the remedy, for values that no joint can have; UnsupportedFeature for an unknown kind."""
    if not isinstance(c, _KINDS):
        raise UnsupportedFeature(f"{name(c)} is none of pymunk's constraints; remove it or use ep.Native(space)")
    kind: Any = type(c)
    finite, positive, not_zero = _numbers(kind)
    for attribute in finite:
        value = getattr(c, attribute)
        if not (all(map(math.isfinite, value)) if isinstance(value, tuple) else math.isfinite(value)):
            raise ValueError(f"{name(c)} has {attribute} = {value}: set a finite one")
    for attribute in positive:
        value = getattr(c, attribute)
        if not value >= 0.0:
            raise ValueError(f"{name(c)} has {attribute} = {value}: set a value >= 0")
    if not c.error_bias <= 1.0:
        raise ValueError(f"{name(c)} has error_bias = {c.error_bias}: set a value from 0 to 1")
    for attribute in not_zero:
        if getattr(c, attribute) == 0.0:
            raise ValueError(f"{name(c)} has {attribute} = 0: set another one")
    if isinstance(c, (pymunk.SlideJoint, pymunk.RotaryLimitJoint)):
        if not c.min <= c.max or (c.min == c.max and math.isinf(c.min)):
            raise ValueError(f"{name(c)} has min = {c.min} and max = {c.max}, which contradict: set min <= max")
        if isinstance(c, pymunk.SlideJoint) and c.max < 0.0:
            raise ValueError(f"{name(c)} has max = {c.max}, less than any distance: set a value >= 0")


def name(c: Any) -> str:
    """A name of a constraint for messages: pymunk gives it no number and no `repr` of its own."""
    return f"{c} between {c.a} and {c.b}"


class ConstraintValues(NamedTuple):
    """The values of a constraint: fields of `Joint`, with its units; 0 where its kind has none. Anchors are relative to
    centres of mass."""

    kind: int
    force: tuple[float, float, float]  # max_force, error_bias, max_bias
    anchor_a: tuple[float, float] = (0.0, 0.0)
    anchor_b: tuple[float, float] = (0.0, 0.0)
    length: float = 0.0
    limits: tuple[float, float] = (0.0, 0.0)  # lower, upper
    groove: tuple[float, float, float] = (0.0, 0.0, 0.0)  # normal, offset
    spring: tuple[float, float, float] = (0.0, 0.0, 0.0)  # stiffness, damping, rest
    gear: tuple[float, float] = (0.0, 0.0)  # ratio, phase
    rate: float = 0.0
    ratchet: tuple[float, float, float] = (0.0, 0.0, 0.0)  # tooth, tooth_phase, notch

    @property
    def finite_force(self) -> bool:
        """Whether its max_force is finite."""
        return math.isfinite(self.force[0])

    @property
    def shape(self) -> tuple[object, ...]:
        """Kind, bounds, anchors, length and limits: all values on which `plan` and `reach` depend except `gear`, which
        programs may change in every step, to drive a servo."""
        return self[:6]

    @property
    def plan(self) -> tuple[object, ...]:
        """The values on which the plan of its component depends."""
        (ax, ay), (bx, by) = self.anchor_a, self.anchor_b
        return self.kind, self.finite_force, ax != 0.0, ay != 0.0, bx != 0.0, by != 0.0

    @property
    def reach(self) -> tuple[object, ...]:
        """The values that decide whether it can hold bodies immobile (`..joints.pinned`)."""
        return self.kind, self.finite_force, self.anchor_a, self.anchor_b, self.length, self.limits, self.gear

    def is_fine(self) -> bool:
        """Whether all values are valid: the rules of `check_constraint`, in a fifth of its time, as programs that drive
        joints edit them in every step. Where it fails, `check_constraint` says which value is wrong."""
        (force, error, bias), (lower, upper), (stiffness, damping, rest) = self.force, self.limits, self.spring
        numbers = *self.anchor_a, *self.anchor_b, *self.groove, *self.gear, *self.ratchet, stiffness, damping, rest
        total = sum(numbers) + self.length + self.rate
        signs = force >= 0.0 and 0.0 <= error <= 1.0 and bias >= 0.0 and damping >= 0.0 and self.length >= 0.0
        wrong = (self.kind == joints.GEAR and self.gear[0] == 0.0) or (self.kind == joints.SLIDE and upper < 0.0)
        return signs and math.isfinite(total) and lower <= upper and not wrong

    def put(self, memory: bytearray, j: int, a: int, b: int) -> None:
        """Write the values to row j of JOINT, whose memory is given, as EDITED, for bodies in the rows a and b."""
        _ROW.pack_into(
            memory, j * joints.Joint.TYPE.itemsize, self.kind, a, b, self.finite_force, *self.anchor_a, *self.anchor_b,
            *self.force, self.length, *self.limits, *self.groove, *self.spring, 0.0, *self.gear, self.rate,
            *self.ratchet, 0, joints.EDITED,
        )  # fmt: skip


_ROW = struct.Struct("4q23d2q")  # fields of `Joint` from the first to `touched`


def read(c: Any) -> ConstraintValues:
    """The values of a constraint.

    Raises:
        ValueError, UnsupportedFeature: see `check_constraint`.
    """
    if isinstance(c, pymunk.RatchetJoint) or not isinstance(c, _KINDS):
        check_constraint(c)  # first, because `_notch` divides by `ratchet`
    found = _read(c, private_joints.bounds(c))
    if not found.is_fine():
        check_constraint(c)
    return found


def _read(c: Any, force: tuple[float, float, float]) -> ConstraintValues:
    if isinstance(c, pymunk.SimpleMotor):
        return ConstraintValues(joints.MOTOR, force, rate=c.rate)
    if isinstance(c, pymunk.DampedRotarySpring):
        return ConstraintValues(joints.ROTARY_SPRING, force, spring=(c.stiffness, c.damping, c.rest_angle))
    if isinstance(c, pymunk.RotaryLimitJoint):
        if c.min == c.max:
            return ConstraintValues(joints.GEAR, force, gear=(1.0, c.min))
        return ConstraintValues(joints.ROTARY_LIMIT, force, limits=(c.min, c.max))
    if isinstance(c, pymunk.RatchetJoint):
        return ConstraintValues(joints.RATCHET, force, ratchet=(c.ratchet, c.phase, _notch(c)))
    if isinstance(c, pymunk.GearJoint):
        return ConstraintValues(joints.GEAR, force, gear=(c.ratio, c.phase))
    b = _anchor(c.anchor_b, c.b)
    if isinstance(c, pymunk.GrooveJoint):
        return _groove(c, force, b)
    a = _anchor(c.anchor_a, c.a)
    if isinstance(c, pymunk.PinJoint):
        return _pin(c.distance, force, a, b)
    if isinstance(c, pymunk.SlideJoint):
        if c.min == c.max:
            return _pin(c.max, force, a, b)
        return ConstraintValues(joints.SLIDE, force, a, b, limits=(c.min, c.max))
    if isinstance(c, pymunk.PivotJoint):
        return ConstraintValues(joints.PIVOT, force, a, b)
    return ConstraintValues(joints.SPRING, force, a, b, spring=(c.stiffness, c.damping, c.rest_length))


def _anchor(anchor: tuple[float, float], body: pymunk.Body) -> tuple[float, float]:
    """An anchor relative to the centre of mass of its body, not rotated."""
    (x, y), (kx, ky) = anchor, body.center_of_gravity
    return x - kx, y - ky


def _pin(
    length: float, force: tuple[float, float, float], a: tuple[float, float], b: tuple[float, float]
) -> ConstraintValues:  # fmt: skip
    """A pin, or a pivot if its length is 0, for which a pin has no direction."""
    kind = joints.PIVOT if length <= _SMALL * max(map(abs, (*a, *b))) else joints.PIN
    return ConstraintValues(kind, force, a, b, length)


def _groove(c: pymunk.GrooveJoint, force: tuple[float, float, float], b: tuple[float, float]) -> ConstraintValues:
    """A groove, or a pivot if its ends are equal, for which a groove has no direction."""
    first, last = c.groove_a - c.a.center_of_gravity, c.groove_b - c.a.center_of_gravity
    if c.groove_a == c.groove_b:
        return ConstraintValues(joints.PIVOT, force, (first.x, first.y), b)
    along = (last - first).normalized()
    normal = along.perpendicular()
    ends, offset = (along.dot(first), along.dot(last)), normal.dot(first)
    return ConstraintValues(joints.GROOVE, force, (0.0, 0.0), b, limits=ends, groove=(*normal, offset))


def ratchets_of(space: pymunk.Space) -> list[pymunk.RatchetJoint]:
    """The ratchets of a space."""
    return [c for c in space.constraints if isinstance(c, pymunk.RatchetJoint)]


def forget_notches(space: pymunk.Space) -> None:
    """Let each ratchet stand on the last notch that its bodies have passed where they are now, whatever they passed
    before."""
    for c in ratchets_of(space):
        c.angle = _last_notch(c, c.b.angle - c.a.angle, _NEAR_NOTCH)


def _notch(c: pymunk.RatchetJoint) -> float:
    """The notch as in pymunk's step: `c.angle` while the relative angle has not reached it, else the last notch that
    was passed."""
    relative = c.b.angle - c.a.angle
    if (c.angle - relative) * c.ratchet > 0.0:
        return float(c.angle)
    return _last_notch(c, relative, 0.0)


def _last_notch(c: pymunk.RatchetJoint, relative: float, near: float) -> float:
    """The last notch passed at the relative angle of both bodies, or to be passed within the part `near` of a tooth."""
    return math.floor((relative - c.phase) / c.ratchet + near) * c.ratchet + c.phase

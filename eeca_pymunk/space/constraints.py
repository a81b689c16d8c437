"""Constraints: pymunk's ten constraints as rows of JOINT, and the check of their values.

Anchors of pymunk are relative to the body's origin, those of JOINT to its centre of mass. Degenerate constraints become
others: a pin of length 0 and a groove of length 0 pivots, a slide with equal limits a pin, a rotary limit with equal
limits a gear.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pymunk

from ..errors import UnsupportedFeature
from ..model.joints import (
    GEAR,
    GROOVE,
    MOTOR,
    PIN,
    PIVOT,
    RATCHET,
    ROTARY_LIMIT,
    ROTARY_SPRING,
    SLIDE,
    SPRING,
    Joint,
)

_SMALL = 1e-9  # a pin shorter than this, over its anchors' distances, is a pivot
_KINDS = (
    pymunk.PinJoint, pymunk.SlideJoint, pymunk.PivotJoint, pymunk.GrooveJoint, pymunk.DampedSpring,
    pymunk.DampedRotarySpring, pymunk.RotaryLimitJoint, pymunk.RatchetJoint, pymunk.GearJoint, pymunk.SimpleMotor,
)  # fmt: skip
# Attributes that must be finite; that may be infinite but must be >= 0; that must not be 0.
_FINITE = (
    "anchor_a", "anchor_b", "groove_a", "groove_b", "distance", "stiffness", "damping", "rest_length", "rest_angle",
    "phase", "ratchet", "ratio", "rate",
)  # fmt: skip
_POSITIVE = ("max_force", "max_bias", "error_bias", "damping")
_NOT_ZERO = ("ratio", "ratchet")


@cache
def _numbers(kind: Any) -> tuple[list[str], list[str], list[str]]:
    """The attributes of a kind of constraint that must be finite, >= 0, and not 0."""
    finite, positive, some = ([a for a in names if hasattr(kind, a)] for names in (_FINITE, _POSITIVE, _NOT_ZERO))
    return finite, positive, some


def check_constraint(c: Any) -> None:
    """ValueError, with the remedy, for values that no joint can have."""
    if not isinstance(c, _KINDS):
        raise UnsupportedFeature(f"{name(c)} is none of pymunk's constraints; remove it or use ep.Native(space)")
    kind: Any = type(c)
    finite, positive, some = _numbers(kind)
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
    for attribute in some:
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


def read(c: Any, joint: Joint) -> None:
    """Fill in the parameters of one row of JOINT; `check_constraint` has passed it."""
    joint.max_force, joint.error_bias, joint.max_bias = c.max_force, c.error_bias, c.max_bias
    joint.soft = int(math.isfinite(c.max_force))
    joint.side = 0
    if hasattr(c, "anchor_a"):
        joint.anchor_a[:] = c.anchor_a - c.a.center_of_gravity
    if hasattr(c, "anchor_b"):
        joint.anchor_b[:] = c.anchor_b - c.b.center_of_gravity
    if isinstance(c, pymunk.PinJoint):
        _pin(c.distance, joint)
    elif isinstance(c, pymunk.SlideJoint):
        if c.min == c.max:
            _pin(c.max, joint)
        else:
            joint.kind, joint.lower, joint.upper = SLIDE, c.min, c.max
    elif isinstance(c, pymunk.PivotJoint):
        joint.kind = PIVOT
    elif isinstance(c, pymunk.GrooveJoint):
        _groove(c, joint)
    elif isinstance(c, pymunk.DampedSpring):
        joint.kind, joint.stiffness, joint.damping, joint.rest = SPRING, c.stiffness, c.damping, c.rest_length
        joint.push = 0.0
    elif isinstance(c, pymunk.DampedRotarySpring):
        joint.kind, joint.stiffness, joint.damping, joint.rest = ROTARY_SPRING, c.stiffness, c.damping, c.rest_angle
        joint.push = 0.0
    elif isinstance(c, pymunk.RotaryLimitJoint):
        if c.min == c.max:
            joint.kind, joint.ratio, joint.phase = GEAR, 1.0, c.min
        else:
            joint.kind, joint.lower, joint.upper = ROTARY_LIMIT, c.min, c.max
    elif isinstance(c, pymunk.RatchetJoint):
        joint.kind, joint.tooth, joint.tooth_phase = RATCHET, c.ratchet, c.phase
        joint.notch = _notch(c)
    elif isinstance(c, pymunk.GearJoint):
        joint.kind, joint.ratio, joint.phase = GEAR, c.ratio, c.phase
    elif isinstance(c, pymunk.SimpleMotor):
        joint.kind, joint.rate = MOTOR, c.rate


def _pin(length: float, joint: Joint) -> None:
    """A pin, or a pivot if its length is 0, for which a pin has no direction."""
    scale = float(max(np.abs(joint.anchor_a).max(), np.abs(joint.anchor_b).max()))
    joint.kind = PIVOT if length <= _SMALL * max(scale, 1e-300) or length == 0.0 else PIN
    joint.length = length


def _groove(c: pymunk.GrooveJoint, joint: Joint) -> None:
    """A groove, or a pivot if its ends are equal, for which a groove has no direction."""
    first, last = c.groove_a - c.a.center_of_gravity, c.groove_b - c.a.center_of_gravity
    if c.groove_a == c.groove_b:
        joint.kind, joint.anchor_a[:] = PIVOT, first
        return
    along = (last - first).normalized()
    normal = along.perpendicular()
    joint.kind, joint.anchor_a[:] = GROOVE, 0.0
    joint.normal[:] = normal
    joint.offset, joint.lower, joint.upper = normal.dot(first), along.dot(first), along.dot(last)


def _notch(c: pymunk.RatchetJoint) -> float:
    """The notch as in pymunk's step: kept while the angle has not reached it, else the last one passed."""
    turned = c.b.angle - c.a.angle
    if (c.angle - turned) * c.ratchet > 0.0:
        return float(c.angle)
    return math.floor((turned - c.phase) / c.ratchet) * c.ratchet + c.phase

"""Joints of random compositions: all ten kinds between random bodies, and what holds of them.

Joints fit at the start. Some have a `max_force`, as motors always do; some hang on the container.
"""

from __future__ import annotations

import math
from random import Random

import pymunk

HOLDS = 1e-8  # of the component (`reach`), of joints in a step that has converged: NEARLY_HELD of the method
OFF = 1e-3  # of the length of the scene, whatever converges
BOUND = 1e-9  # over max_force dt
ANCHORS = "anchor_a", "anchor_b", "groove_a", "groove_b"
KINDS = ("pivot", "pin", "slide", "groove", "spring", "rotary spring", "rotary limit", "ratchet", "gear", "motor")


def join(R: Random, a: pymunk.Body, b: pymunk.Body, length: float, mass: float) -> pymunk.Constraint:
    """A random joint of two bodies of a scene of such a length, that fits as they are; `mass` is that of one."""
    kind, L = R.choice(KINDS), length
    here = pymunk.Vec2d(*((p + q) / 2 for p, q in zip(a.position, b.position, strict=True)))
    end_a, end_b = (body.position + pymunk.Vec2d(R.uniform(-0.3, 0.3) * L, R.uniform(-0.3, 0.3) * L) for body in (a, b))
    at_a, at_b, far = a.world_to_local(end_a), b.world_to_local(end_b), (end_b - end_a).length
    between = b.angle - a.angle
    torque, joint = mass * L * L, None
    if kind == "pivot":
        joint = pymunk.PivotJoint(a, b, R.choice((here, end_a)))
    elif kind == "pin":
        joint = pymunk.PinJoint(a, b, at_a, at_b)
    elif kind == "slide":
        joint = pymunk.SlideJoint(a, b, at_a, at_b, R.choice((0.0, 0.8 * far)), R.choice((1.1 * far, far)))
    elif kind == "groove":
        along = pymunk.Vec2d(0.5 * L, 0.0).rotated(R.uniform(0.0, 6.0))
        joint = pymunk.GrooveJoint(a, b, a.world_to_local(end_b - along), a.world_to_local(end_b + along), at_b)
    elif kind == "spring":
        joint = pymunk.DampedSpring(
            a, b, at_a, at_b, R.choice((0.5, 1.0)) * far, mass * R.choice((1.0, 100.0)), mass * R.choice((0.0, 0.1))
        )
    elif kind == "rotary spring":
        joint = pymunk.DampedRotarySpring(
            a, b, -between, torque * R.choice((1.0, 100.0)), torque * R.choice((0.0, 0.1))
        )
    elif kind == "rotary limit":
        joint = pymunk.RotaryLimitJoint(a, b, between - R.uniform(0.0, 1.0), between + R.uniform(0.0, 1.0))
    elif kind == "ratchet":
        joint = pymunk.RatchetJoint(a, b, between, R.choice((-0.5, 0.5)))
    elif kind == "gear":
        ratio = R.choice((1.0, -1.0, 2.0))
        joint = pymunk.GearJoint(a, b, b.angle * ratio - a.angle, ratio)
    else:
        joint = pymunk.SimpleMotor(a, b, R.uniform(-3.0, 3.0))
    if kind == "motor" or R.random() < 0.15:
        joint.max_force = mass * (L if kind in KINDS[:5] else L * L) * R.choice((0.1, 1.0, 10.0, 100.0))
    joint.collide_bodies = R.random() < 0.5
    return joint


def apart(joint: pymunk.Constraint, length: float) -> float:
    """How far a joint is from what it holds, over the length of the scene, or in radians; 0 for what may give way."""
    if math.isfinite(joint.max_force):
        return 0.0
    a, b = joint.a, joint.b
    if isinstance(joint, pymunk.GrooveJoint):
        p, q = (a.local_to_world(end) for end in (joint.groove_a, joint.groove_b))
        x = b.local_to_world(joint.anchor_b) - p
        part = min(max(x.dot(q - p) / (q - p).dot(q - p), 0.0), 1.0)
        return (x - part * (q - p)).length / length
    if isinstance(joint, (pymunk.PivotJoint, pymunk.PinJoint, pymunk.SlideJoint)):
        far = (b.local_to_world(joint.anchor_b) - a.local_to_world(joint.anchor_a)).length
        if isinstance(joint, pymunk.PinJoint):
            return abs(far - joint.distance) / length
        if isinstance(joint, pymunk.SlideJoint):
            return max(far - joint.max, joint.min - far, 0.0) / length
        return far / length
    if all(body.body_type != pymunk.Body.DYNAMIC or math.isinf(body.moment) for body in (a, b)):
        return 0.0  # nothing can turn either
    between = b.angle - a.angle
    if isinstance(joint, pymunk.RotaryLimitJoint):
        return max(between - joint.max, joint.min - between, 0.0)
    if isinstance(joint, pymunk.GearJoint):
        return abs(b.angle * joint.ratio - a.angle - joint.phase)
    return 0.0


def component(joint: pymunk.Constraint) -> set[pymunk.Body]:
    """The bodies that this joint and others connect, not through bodies that no force moves."""
    seen, front = {joint.a, joint.b}, [joint.a, joint.b]
    while front:
        body = front.pop()
        if body.body_type == pymunk.Body.DYNAMIC:
            found = {end for other in body.constraints for end in (other.a, other.b)} - seen
            seen |= found
            front += found
    return seen


def reach(joint: pymunk.Constraint) -> float:
    """The size of the component of a joint, which its errors are measured by: its farthest coordinate or anchor."""
    seen = component(joint)
    ends = {other for body in seen if body.body_type == pymunk.Body.DYNAMIC for other in body.constraints}
    anchors = (getattr(other, name, (0.0, 0.0)) for other in ends for name in ANCHORS)
    return max((0.0, *(abs(x) for anchor in anchors for x in anchor), *(abs(x) for b in seen for x in b.position)))


def may_contradict(joint: pymunk.Constraint) -> bool:
    """Whether this component has two joints that hold exactly on what joints do not move, or do not turn, of which the
    program turns or moves something: others may not follow, as a limit between what two gears turn, or between what a
    ratchet turns and a body of infinite moment; so do two joints of points between this and another one. A gear with
    another ratio than 1, and another such joint, fix the angles of both bodies that they connect."""
    seen = component(joint)
    springs = pymunk.DampedSpring, pymunk.DampedRotarySpring
    angles = pymunk.GearJoint, pymunk.RotaryLimitJoint, pymunk.RatchetJoint
    exact = {c for body in seen for c in body.constraints if {c.a, c.b} <= seen}
    exact = {c for c in exact if math.isinf(c.max_force) and not isinstance(c, springs)}
    turns = [c for c in exact if isinstance(c, angles)]
    led, fixed = 0, int(len(turns) > 2 and any(isinstance(c, pymunk.GearJoint) and c.ratio != 1.0 for c in turns))
    for body in seen:
        if body.body_type != pymunk.Body.DYNAMIC:
            held = sum(body in (c.a, c.b) for c in exact)
            moves = body.velocity.length > 0.0 or body.angular_velocity != 0.0
            led, fixed = led + (held if moves else 0), fixed + held
        elif math.isinf(body.moment):
            fixed += sum(body in (c.a, c.b) and isinstance(c, angles) for c in exact)
            ends = [frozenset((c.a, c.b)) for c in exact if body in (c.a, c.b) and not isinstance(c, angles)]
            fixed += len(ends) - len(set(ends))
    return led > 0 and fixed > 1


def overdone(joint: pymunk.Constraint, dt: float) -> float:
    """The impulse of a joint over `max_force` dt; springs and what has no bound are at 0."""
    springs = (pymunk.DampedSpring, pymunk.DampedRotarySpring)
    if isinstance(joint, springs) or not math.isfinite(joint.max_force) or joint.max_force == 0.0:
        return 0.0
    return abs(joint.impulse) / (joint.max_force * dt)

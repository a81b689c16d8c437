"""How much energy can come from outside in a step: a bound on the entry "external" of the ledger.

What acts from outside has a power that the scene and the step's own report bound:

* a contact of a kinematic body, or of shapes with a surface velocity: its impulse times the speed of the surface at its
  point, |J| |v|, for the impulse does the work J v on the other body. Where such a body has gone into others, it lifts
  them out: at most the weight of all bodies times the deepest overlap;
* a motor: `max_force` times the angle that it turns. That is the larger of the change of the angle and of dt times the
  largest relative spin, before or after the step: angles of jointed bodies follow Cayley's map, which turns them by
  (dt spin)^2 / 12 less, and a motor that an impact turns round goes to and fro within the step;
* another joint with a `max_force` may give way and come back later: as a motor, with the way of its points, or its
  angle, in place of the motor's angle;
* a joint on a kinematic body that moves, one without a `max_force` that a step has left apart, and functions of the
  program that push bodies have no bound here.

With none of them the bound is 0: gravity is part of the energy, and external has to be 0 up to the round-off of the
sums that it is taken from, for which `Composition` allows CLOSES of the scale of energy, as for the residual.
"""

from __future__ import annotations

import math

import pymunk

import eeca_pymunk as ep

SLACK = 1.0 + 1e-9  # rounding of products of impulses and speeds
POINTS = (pymunk.PinJoint, pymunk.SlideJoint, pymunk.PivotJoint, pymunk.GrooveJoint)
Motion = tuple[float, pymunk.Vec2d, float, pymunk.Vec2d]  # relative angle and place, and their rates


def motion(joint: pymunk.Constraint) -> Motion:
    """Relative angle, distance of the points, relative spin, and velocity of the points of a joint."""
    a, b = joint.a, joint.b
    ratio = joint.ratio if isinstance(joint, pymunk.GearJoint) else 1.0
    angle, spin = ratio * b.angle - a.angle, ratio * b.angular_velocity - a.angular_velocity
    if not isinstance(joint, POINTS):
        return angle, pymunk.Vec2d.zero(), spin, pymunk.Vec2d.zero()
    there = b.local_to_world(joint.anchor_b)
    here = there if isinstance(joint, pymunk.GrooveJoint) else a.local_to_world(joint.anchor_a)
    speed = b.velocity_at_world_point(there) - a.velocity_at_world_point(here)
    return angle, a.world_to_local(there), spin, speed


class Outside:
    """What acts from outside in the step that follows.

    Args:
        box: the kinematic body of the scene.  pushed: whether functions of the program push bodies.
    """

    def __init__(self, space: pymunk.Space, box: pymunk.Body, pushed: bool) -> None:
        self.space, self.box, self.place = space, box, box.position
        self.speed, self.spin = box.velocity.length, abs(box.angular_velocity)
        self.bounded = [(c, motion(c)) for c in space.constraints if math.isfinite(c.max_force)]
        self.belt = max((shape.surface_velocity.length for shape in space.shapes), default=0.0)
        moving = self.speed > 0.0 or self.spin > 0.0
        self.unbounded = pushed or any(moving and box in (c.a, c.b) for c in space.constraints)

    def most(self, report: ep.StepReport, dt: float) -> float:
        """The bound, once the step has been taken."""
        if self.unbounded:
            return math.inf
        total = 0.0
        for joint, (angle, place, spin, speed) in self.bounded:
            now = motion(joint)
            way = max((now[1] - place).length, dt * speed.length, dt * now[3].length)
            if not isinstance(joint, POINTS):
                way = max(abs(now[0] - angle), dt * abs(spin), dt * abs(now[2]))
            total += joint.max_force * way
        contacts = report.contacts
        if not self.belt and not self.speed and not self.spin:
            return SLACK * total
        for i, (normal, friction) in enumerate(zip(report.impulse, report.friction, strict=True)):
            push, fast = math.hypot(normal, friction), self.belt
            if self.box in (contacts.bodies[contacts.body_a[i]], contacts.bodies[contacts.body_b[i]]):
                fast += self.speed + self.spin * math.hypot(*(contacts.point[i] - self.place))
            total += push * fast
        weight = sum(b.mass for b in self.space.bodies if b is not self.box) * self.space.gravity.length
        return SLACK * (total + weight * max(0.0, -min(contacts.gap, default=0.0)))

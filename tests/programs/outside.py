"""How much energy can come from outside in a step: a bound on the entry "external" of the ledger.

What acts from outside has a power that the scene and the step's own report bound:

* a contact of a kinematic body, or of shapes with a surface velocity: its impulse times the speed of the surface at its
  point, |J| |v|, for the impulse does the work J v on the other body. Where such a body has gone into others, it lifts
  them out, and what lies deep in them: at most the weight of all bodies times the deepest overlap, of the contacts or
  of any two bodies before, and what springs then store by that way of their ends;
* a motor: `max_force` times the angle that it turns. Mostly that is the larger of the change of the angle and of dt
  times the largest relative spin, before or after the step. Impacts may turn it to and fro within the step: it never
  turns by more than dt times the largest spins that the energy of the scene allows (`Outside.fastest`);
* another joint with a `max_force` may give way and come back later: as a motor, with the way of its points, or its
  angle, in place of the motor's angle;
* a joint on a kinematic body that moves, one without a `max_force` that a step has left apart, and functions of the
  program that push bodies have no bound here.

With none of them the bound is 0: gravity is part of the energy, and external has to be 0 up to the round-off of the
sums that it is taken from, for which `Composition` allows CLOSES of the scale of energy, as for the residual.
"""

from __future__ import annotations

import math
from contextlib import suppress
from itertools import combinations

import numpy as np
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


def _loose_energy(space: pymunk.Space) -> float:
    """Energy that motion has, and springs may give: kinetic and (1/2) k x^2."""
    energy = ep.measure(space).kinetic
    for joint in space.constraints:
        if isinstance(joint, pymunk.DampedSpring):
            ends = joint.a.local_to_world(joint.anchor_a), joint.b.local_to_world(joint.anchor_b)
            energy += 0.5 * joint.stiffness * (ends[0].get_distance(ends[1]) - joint.rest_length) ** 2
        elif isinstance(joint, pymunk.DampedRotarySpring):
            energy += 0.5 * joint.stiffness * (joint.a.angle - joint.b.angle - joint.rest_angle) ** 2
    return float(energy)


def _per_root_energy(joint: pymunk.Constraint) -> list[float]:
    """For the two bodies of a joint: the largest rate along it per sqrt(2 T), 1/sqrt(I) of an angle, 1/sqrt(m) +
    r/sqrt(I) of a point at r; 0 for a body that nothing moves."""
    found = []
    for body, anchor in ((joint.a, getattr(joint, "anchor_a", None)), (joint.b, getattr(joint, "anchor_b", None))):
        if body.body_type != pymunk.Body.DYNAMIC:
            found.append(0.0)
        elif isinstance(joint, POINTS):
            at = [anchor] if anchor is not None else [joint.groove_a, joint.groove_b]
            arm = max((point - body.center_of_gravity).length for point in at)
            found.append(1.0 / math.sqrt(body.mass) + arm / math.sqrt(body.moment))
        else:
            ratio = joint.ratio if isinstance(joint, pymunk.GearJoint) and body is joint.b else 1.0
            found.append(abs(ratio) / math.sqrt(body.moment))
    return found


def _squeezed(space: pymunk.Space, depth: float) -> float:
    """The most that springs can store more as each body is lifted by `depth`: k d (x + d/2) for a change d of x. A body
    turns by less than depth over its radius of gyration, as the least displacement in the measure of masses does."""
    total = 0.0
    for spring in space.constraints:
        if isinstance(spring, pymunk.DampedSpring):
            ends = spring.a.local_to_world(spring.anchor_a), spring.b.local_to_world(spring.anchor_b)
            stretched, way = abs(ends[0].get_distance(ends[1]) - spring.rest_length), 0.0
            for body, anchor in ((spring.a, spring.anchor_a), (spring.b, spring.anchor_b)):
                if body.body_type == pymunk.Body.DYNAMIC:
                    arm = (anchor - body.center_of_gravity).length
                    way += depth * (1.0 + arm * math.sqrt(body.mass / body.moment))
        elif isinstance(spring, pymunk.DampedRotarySpring):
            stretched = abs(spring.a.angle - spring.b.angle - spring.rest_angle)
            turned = [b for b in (spring.a, spring.b) if b.body_type == pymunk.Body.DYNAMIC]
            way = sum(depth * math.sqrt(body.mass / body.moment) for body in turned)
        else:
            continue
        total += spring.stiffness * way * (stretched + 0.5 * way)
    return total


def _deepest(space: pymunk.Space) -> float:
    """Deepest overlap of shapes of two bodies. The sign of the distance depends on the order of the two shapes; only
    what overlaps has points."""
    depth, boxes = 0.0, [(shape, shape.cache_bb(), shape.body) for shape in space.shapes]
    for (one, here, a), (other, there, b) in combinations(boxes, 2):
        if a is not b and here.intersects(there):
            with suppress(AssertionError):  # of pymunk, for shapes that do not collide
                depth = max(depth, *(abs(point.distance) for point in one.shapes_collide(other).points), 0.0)
    return depth


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
        self.depth = _deepest(space) if moving else 0.0
        self.energy = _loose_energy(space)
        self.unbounded = pushed or any(moving and box in (c.a, c.b) for c in space.constraints)

    def fastest(self, given: float, dt: float) -> float:
        """sqrt(2 T) of the largest kinetic energy T in the step: gravity g makes it grow by at most g sqrt(M) dt, a
        force F on a body by F dt / sqrt(m), a torque by F dt / sqrt(I); contacts add the energy `given`."""
        bodies = [b for b in self.space.bodies if b.body_type == pymunk.Body.DYNAMIC]
        most = math.sqrt(2.0 * (self.energy + given))
        most += self.space.gravity.length * math.sqrt(sum(b.mass for b in bodies)) * dt
        for joint, _ in self.bounded:
            most += sum(joint.max_force * dt * rate for rate in _per_root_energy(joint))
        return most

    def most(self, report: ep.StepReport, dt: float, nearly: bool) -> float:
        """The bound, once the step has been taken: for motors that turn one way if `nearly`, else for all."""
        if self.unbounded:
            return math.inf
        total = 0.0
        for joint, (angle, place, spin, speed) in self.bounded:
            now = motion(joint)
            way = max((now[1] - place).length, dt * speed.length, dt * now[3].length)
            if not isinstance(joint, POINTS):
                way = max(abs(now[0] - angle), dt * abs(spin), dt * abs(now[2]))
            total += joint.max_force * way if nearly else 0.0
        total += self._carried(report, dt)
        if not nearly:
            fastest = self.fastest(total, dt)
            total += sum(c.max_force * dt * fastest * rate for c, _ in self.bounded for rate in _per_root_energy(c))
        return SLACK * total

    def _carried(self, report: ep.StepReport, dt: float) -> float:
        """The most that contacts with surfaces that move can do: the box goes on while it turns."""
        if not self.belt and not self.speed and not self.spin:
            return 0.0
        contacts = report.contacts
        box = contacts.bodies.index(self.box)
        carried = (contacts.body_a == box) | (contacts.body_b == box)
        speed = max(self.speed, self.box.velocity.length)
        spin = max(self.spin, abs(self.box.angular_velocity))
        far = np.hypot(*(contacts.point - self.place).T) + speed * dt
        fast = self.belt + carried * (speed + spin * far)
        total = float(np.hypot(report.impulse, report.friction) @ fast)
        weight = sum(b.mass for b in self.space.bodies if b is not self.box) * self.space.gravity.length
        depth = max(self.depth, -min(contacts.gap, default=0.0))
        return total + weight * depth + _squeezed(self.space, depth)

"""Whether joints that hold exactly lead a body through a wall of its container: then no contact can keep it inside.

Velocities of all bodies are unknown, but for those of the container and for spins of infinite moment. They satisfy the
joints, with limits at their bounds from one side. A body is led out if the least rate at which it goes outward, by a
linear program, is above 0; or if it is outside wherever joints allow it to come to, from where it is, with the angles
that bodies of infinite moment have (`kept_out`): a linkage just before its dead centre has rates inward, but no way.
Joints that may give way, springs, motors and ratchets are taken for free.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk
from scipy.optimize import linprog, minimize

from eeca_pymunk.arrays import FloatArray

AT = 1e-6  # distance from a bound, over the length of the scene, or in radians, up to which a limit is at it


class _Rates:
    """Rates as linear functions of the unknown velocities, in lengths of the scene, with a constant as last entry."""

    def __init__(self, bodies: list[pymunk.Body], length: float) -> None:
        self.place, self.size, self.length = {body: 3 * k for k, body in enumerate(bodies)}, 3 * len(bodies), length

    def spin(self, body: pymunk.Body) -> FloatArray:
        """Rate of a body's angle."""
        row = np.zeros(self.size + 1)
        if body not in self.place or math.isinf(body.moment):
            row[-1] = body.angular_velocity
        else:
            row[self.place[body] + 2] = 1.0
        return row

    def point(self, body: pymunk.Body, point: pymunk.Vec2d, way: pymunk.Vec2d) -> FloatArray:
        """Rate of a point of a body along `way`."""
        row, arm = np.zeros(self.size + 1), (point - body.position) / self.length
        if body not in self.place:
            row[-1] = way.dot(body.velocity) / self.length
        else:
            row[self.place[body]], row[self.place[body] + 1] = way
        return row + arm.cross(way) * self.spin(body)


def _bounded(rate: FloatArray, low: float, high: float, small: float) -> list[tuple[FloatArray, bool]]:
    """Rows of a value that is `low` above one bound and `high` below another one: (rate, whether it has to be 0), else
    it has to be at least 0."""
    rows = [(rate, False)] if low <= small else []
    return rows + ([(-rate, False)] if high <= small else [])


def _rows(joint: pymunk.Constraint, rates: _Rates) -> list[tuple[FloatArray, bool]]:
    """Rows of a joint, as `_bounded` has them."""
    a, b, small = joint.a, joint.b, AT * rates.length
    if math.isfinite(joint.max_force):
        return []
    if isinstance(joint, (pymunk.PivotJoint, pymunk.PinJoint, pymunk.SlideJoint)):
        p, q = a.local_to_world(joint.anchor_a), b.local_to_world(joint.anchor_b)
        ways = [pymunk.Vec2d(1.0, 0.0), pymunk.Vec2d(0.0, 1.0)]
        if not isinstance(joint, pymunk.PivotJoint):
            ways = [(q - p).normalized()]
        found = [rates.point(b, q, way) - rates.point(a, p, way) for way in ways]
        if isinstance(joint, pymunk.SlideJoint):
            far = p.get_distance(q)
            return _bounded(found[0], far - joint.min, joint.max - far, small)
        return [(row, True) for row in found]
    if isinstance(joint, pymunk.GrooveJoint):
        p, q, x = a.local_to_world(joint.groove_a), a.local_to_world(joint.groove_b), b.local_to_world(joint.anchor_b)
        along = (q - p).normalized()
        slide, across = (rates.point(b, x, way) - rates.point(a, x, way) for way in (along, along.perpendicular()))
        return [(across, True), *_bounded(slide, (x - p).dot(along), (q - x).dot(along), small)]
    if isinstance(joint, pymunk.GearJoint):
        return [(joint.ratio * rates.spin(b) - rates.spin(a), True)]
    if isinstance(joint, pymunk.RotaryLimitJoint):
        between = b.angle - a.angle
        return _bounded(rates.spin(b) - rates.spin(a), between - joint.min, joint.max - between, AT)
    return []


class _Poses:
    """Where points of bodies are, by their unknown poses: places relative to the present ones, in lengths of the scene,
    and angles, of those with a finite moment."""

    def __init__(self, bodies: list[pymunk.Body], length: float) -> None:
        self.row, self.length = {body: 3 * k for k, body in enumerate(bodies)}, length

    def angle(self, body: pymunk.Body, at: FloatArray) -> float:
        """A body's angle."""
        if body not in self.row or math.isinf(body.moment):
            return float(body.angle)
        return float(body.angle + at[self.row[body] + 2])

    def place(self, body: pymunk.Body, at: FloatArray) -> pymunk.Vec2d:
        """A body's position, in lengths of the scene."""
        way = at[self.row[body] :][:2] if body in self.row else (0.0, 0.0)
        return body.position / self.length + pymunk.Vec2d(*map(float, way))

    def point(self, body: pymunk.Body, point: pymunk.Vec2d, at: FloatArray) -> pymunk.Vec2d:
        """A point of a body, given in its coordinates, in lengths of the scene."""
        return self.place(body, at) + (point / self.length).rotated(self.angle(body, at))

    def errors(self, joint: pymunk.Constraint, at: FloatArray) -> tuple[list[float], list[float]]:
        """What is 0 and what is not negative if a joint is closed."""
        a, b, L = joint.a, joint.b, self.length
        if isinstance(joint, (pymunk.PivotJoint, pymunk.PinJoint, pymunk.SlideJoint)):
            between = self.point(b, joint.anchor_b, at) - self.point(a, joint.anchor_a, at)
            if isinstance(joint, pymunk.PivotJoint):
                return [*between], []
            if isinstance(joint, pymunk.PinJoint):
                return [between.length - joint.distance / L], []
            return [], [between.length - joint.min / L, joint.max / L - between.length]
        if isinstance(joint, pymunk.GrooveJoint):
            p, q = self.point(a, joint.groove_a, at), self.point(a, joint.groove_b, at)
            x, along = self.point(b, joint.anchor_b, at), (q - p).normalized()
            return [along.cross(x - p)], [along.dot(x - p), along.dot(q - x)]
        one, two = self.angle(a, at), self.angle(b, at)
        if isinstance(joint, pymunk.GearJoint):
            return [joint.ratio * two - one - joint.phase], []
        if isinstance(joint, pymunk.RotaryLimitJoint):
            return [], [two - one - joint.min, joint.max - two + one]
        return [], []


def kept_out(space: pymunk.Space, box: pymunk.Body, body: pymunk.Body, length: float, inside: float) -> bool:
    """Whether joints keep a body's centre farther than `inside` (length) from the middle of the box, in the direction
    in which it is farthest, wherever they allow it to come to."""
    found, joints = [body], [joint for joint in space.constraints if math.isinf(joint.max_force)]
    for one in found:
        ends = [end for joint in joints if one in (joint.a, joint.b) for end in (joint.a, joint.b)]
        found += [end for end in dict.fromkeys(ends) if end not in found and end.body_type == pymunk.Body.DYNAMIC]
    joints = [joint for joint in joints if joint.a in found or joint.b in found]
    if not joints:
        return False
    poses = _Poses(found, length)
    out = _outward(box, body)

    def away(at: FloatArray) -> float:
        return float(out.dot(poses.place(body, at) - box.position / length))

    def errors(at: FloatArray, kind: int) -> FloatArray:
        return np.array([error for joint in joints for error in poses.errors(joint, at)[kind]])

    none = np.zeros(3 * len(found))
    laws = [{"type": name, "fun": errors, "args": (kind,)} for kind, name in enumerate(("eq", "ineq"))]
    least = minimize(away, none, method="SLSQP", constraints=[law for law in laws if len(errors(none, law["args"][0]))])
    return bool(least.success and least.fun * length > inside)


def _outward(box: pymunk.Body, body: pymunk.Body) -> pymunk.Vec2d:
    """The direction from the middle of the box to the wall that a body is farthest beyond."""
    x, y = box.world_to_local(body.position)
    out = pymunk.Vec2d(math.copysign(1.0, x), 0.0) if abs(x) > abs(y) else pymunk.Vec2d(0.0, math.copysign(1.0, y))
    return out.rotated(box.angle)


def led_out(space: pymunk.Space, box: pymunk.Body, body: pymunk.Body, length: float) -> bool:
    """Whether joints lead a body out of the box, beyond the wall that it is farthest beyond."""
    bodies = [other for other in space.bodies if other.body_type == pymunk.Body.DYNAMIC]
    rates = _Rates(bodies, length)
    out = _outward(box, body)
    rate = rates.point(body, body.position, out) - rates.point(box, body.position, out)
    # Rows without unknowns are of what nothing moves.
    rows = [row for joint in space.constraints for row in _rows(joint, rates) if np.any(row[0][:-1])]
    equal, least = ([row for row, exact in rows if exact is kind] for kind in (True, False))
    found = linprog(
        rate[:-1],
        A_ub=-np.array([row[:-1] for row in least]) if least else None,
        b_ub=[row[-1] for row in least] if least else None,
        A_eq=np.array([row[:-1] for row in equal]) if equal else None,
        b_eq=[-row[-1] for row in equal] if equal else None,
        bounds=(None, None),
    )
    return bool(found.status == 0 and found.fun + rate[-1] > 0.0)

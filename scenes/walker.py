"""A walker: a hull on two legs with a hip and a knee each, four motors of bounded torque, and a ground of segments.

What Gymnasium's BipedalWalker is made of, in metres and kilograms, with the hips at both ends of the hull, so that a
gait that is a function of time alone does not fall over.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import Scene
from .terrain import add_ground, remember

GRAVITY = 9.81
_HULL = (1.6, 0.4)
_THIGH, _SHIN, _WIDTH = 0.55, 0.55, 0.18
_PERIOD = 0.5  # s
_STANCE = 0.85  # part of it in which a foot pushes back on the ground, slowly
_SWING, _LIFT = 0.25, 0.6  # of hip and knee, rad
_REST = (0.35, -0.7)  # of hip and knee
_FASTEST = 10.0  # rad/s


class Gait:
    """Rates of the motors towards joint angles that are functions of time; the legs are half a period apart."""

    def __init__(self, motors: list[pymunk.SimpleMotor], phases: list[tuple[bool, float]]) -> None:
        self.motors, self.phases = motors, phases
        self.reset()
        # pymunk calls it once a step, before the motors push.
        motors[0].pre_solve = self.act

    def reset(self) -> None:
        """To the start of the gait."""
        self.time, self._work = 0.0, 0.0
        self._angles = [self.angle(motor) for motor in self.motors]

    @staticmethod
    def angle(motor: pymunk.SimpleMotor) -> float:
        """What a joint is bent by."""
        return motor.b.angle - motor.a.angle

    def wanted(self, knee: bool, phase: float, time: float) -> float:
        """The angle that a joint should have."""
        turn, ramp = (time / _PERIOD + phase) % 1.0, min(1.0, time / _PERIOD)
        stands = turn < _STANCE
        done = turn / _STANCE if stands else (turn - _STANCE) / (1.0 - _STANCE)
        if knee:
            return _REST[1] - (0.0 if stands else ramp * _LIFT * math.sin(math.pi * done))
        way = 1.0 - 2.0 * done if stands else -math.cos(math.pi * done)
        return _REST[0] + ramp * _SWING * way

    def act(self, constraint: pymunk.Constraint, space: pymunk.Space) -> None:
        """pymunk's `pre_solve` of the first motor."""
        self._work = self.work()
        self._angles = [self.angle(motor) for motor in self.motors]
        self.time += space.current_time_step
        for motor, (knee, phase) in zip(self.motors, self.phases, strict=True):
            rate = 12.0 * (self.wanted(knee, phase, self.time) - self.angle(motor))
            # A motor's rate is that of a relative to b.
            motor.rate = -min(_FASTEST, max(-_FASTEST, rate))

    def work(self) -> float:
        """What the motors can have put in so far (J): their largest torques times the angles that they have turned."""
        ways = zip(self.motors, self._angles, strict=True)
        return self._work + sum(motor.max_force * abs(self.angle(motor) - before) for motor, before in ways)


def build(seed: int = 0, dt: float = 1 / 50, duration: float = 8.0) -> Scene:
    """A walker of 14 kg that starts on its feet, on flat ground that becomes uneven after 3 m."""
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    rng = np.random.default_rng(seed)
    heights = [0.0 if k < 8 else float(rng.uniform(0.0, 0.08)) for k in range(28)]
    add_ground(space, [(-4.0 + k, y) for k, y in enumerate(heights)], 1.0)
    group = pymunk.ShapeFilter(group=1)
    hull = pymunk.Body(8.0, pymunk.moment_for_box(8.0, _HULL))
    drop = _THIGH * math.cos(_REST[0]) + _SHIN * math.cos(_REST[0] + _REST[1]) + 0.5 * _WIDTH
    hull.position = (0.0, drop + 0.15)
    shape = pymunk.Poly.create_box(hull, _HULL)
    shape.filter, shape.friction = group, 0.5
    space.add(hull, shape)
    bodies, motors, phases = [hull], [], []
    for x, phase in ((-0.6, 0.0), (0.6, 0.5)):
        above, joint = hull, pymunk.Vec2d(x, -0.15)
        angle = 0.0
        for knee, (length, mass) in enumerate(((_THIGH, 2.0), (_SHIN, 1.0))):
            angle += _REST[knee]
            limb = pymunk.Body(mass, mass * length**2 / 12.0)
            limb.angle = angle
            top = above.local_to_world(joint)
            limb.position = top + pymunk.Vec2d(0.0, -0.5 * length).rotated(angle)
            bone = pymunk.Segment(limb, (0.0, 0.5 * length), (0.0, -0.5 * length), 0.5 * _WIDTH)
            bone.filter, bone.friction = group, 1.0
            motor = pymunk.SimpleMotor(above, limb, 0.0)
            motor.max_force = 60.0
            low, high = (-1.6, -0.1) if knee else (-0.9, 0.9)
            space.add(
                limb,
                bone,
                pymunk.PivotJoint(above, limb, joint, (0.0, 0.5 * length)),
                pymunk.RotaryLimitJoint(above, limb, low, high),
                motor,
            )
            bodies.append(limb)
            motors.append(motor)
            phases.append((bool(knee), phase))
            above, joint = limb, pymunk.Vec2d(0.0, -0.5 * length)
    gait = Gait(motors, phases)
    back = remember(bodies)

    def reset() -> None:
        back()
        gait.reset()

    parameters = {"seed": seed, "dt": dt}
    return Scene("walker", space, bodies, dt, duration, 1e6, parameters=parameters, driver=gait, reset=reset)

"""A lander on two sprung legs: an engine and two nozzles bring it down on a pad between hills.

What Gymnasium's LunarLander is made of, in metres and kilograms: a hull, two legs on a pivot, a limit and a rotary
spring each, and a ground of segments. The pilot is a law of the hull's state: it has no memory, so that the same start
gives the same flight.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import Scene
from .terrain import add_ground, remember

GRAVITY = 3.0
_HULL = [(-0.7, -0.4), (0.7, -0.4), (0.7, 0.1), (0.4, 0.6), (-0.4, 0.6), (-0.7, 0.1)]
_LEG = (0.16, 0.9)  # width, height
_SPLAY = 0.45  # angle of a leg to the hull's axis


class Pilot:
    """Thrust along the hull's axis, and a torque.

    Attributes:
        off: whether the engine is off: the hull is as low as it stands, and slow.
    """

    def __init__(self, hull: pymunk.Body, mass: float, height: float) -> None:
        self.hull, self.mass, self.height = hull, mass, height
        self.reset()
        hull.velocity_func = self.act

    def reset(self) -> None:
        """Forget the flight so far."""
        self._work, self.off = 0.0, False
        self._force, self._torque = pymunk.Vec2d(0.0, 0.0), 0.0
        self._place, self._angle = self.hull.position, self.hull.angle

    def act(self, body: pymunk.Body, gravity: pymunk.Vec2d, damping: float, dt: float) -> None:
        """pymunk's velocity function of the hull: gravity and what the engines push with in this step."""
        self._work = self.work()
        self._place, self._angle = body.position, body.angle
        self._force, self._torque = self.law()
        pymunk.Body.update_velocity(body, gravity + self._force / body.mass, damping, dt)
        body.angular_velocity += self._torque / body.moment * dt

    def law(self) -> tuple[pymunk.Vec2d, float]:
        """The force (N) and the torque (N m) for the hull's state."""
        hull = self.hull
        above = hull.position.y - self.height
        self.off = self.off or (above < 0.06 and hull.velocity.length < 0.4)
        if self.off:
            return pymunk.Vec2d(0.0, 0.0), 0.0
        # The hull leans against its way to the middle and its speed, at most by .35.
        lean = min(0.35, max(-0.35, 0.08 * hull.position.x + 0.22 * hull.velocity.x))
        torque = 40.0 * (lean - hull.angle) - 16.0 * hull.angular_velocity
        speed = -0.25 - 0.45 * max(0.0, above)
        thrust = self.mass * (GRAVITY + 2.5 * (speed - hull.velocity.y))
        axis = pymunk.Vec2d(-math.sin(hull.angle), math.cos(hull.angle))
        return axis * min(2.2 * GRAVITY * self.mass, max(0.0, thrust)), min(30.0, max(-30.0, torque))

    def work(self) -> float:
        """What the engines have put in so far (J): forces, which are constant within a step, times ways."""
        way = self.hull.position - self._place
        return self._work + self._force.dot(way) + self._torque * (self.hull.angle - self._angle)


def build(seed: int = 0, dt: float = 1 / 50, duration: float = 9.0) -> Scene:
    """A lander that starts 6 m above the pad and 4 m beside it, moving and turning."""
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    rng = np.random.default_rng(seed)
    tops = [(-9.0 + 1.5 * k, 0.0 if 4 <= k <= 8 else float(rng.uniform(-0.3, 1.6))) for k in range(13)]
    add_ground(space, tops, 0.8)
    group = pymunk.ShapeFilter(group=1)
    hull = pymunk.Body(8.0, pymunk.moment_for_poly(8.0, _HULL))
    hull.position = (-4.0, 6.0)
    shape = pymunk.Poly(hull, _HULL, radius=0.01)
    shape.friction, shape.filter = 0.4, group
    space.add(hull, shape)
    bodies = [hull]
    length = _LEG[1]
    for side in (-1.0, 1.0):
        leg = pymunk.Body(0.6, pymunk.moment_for_box(0.6, _LEG))
        knee = pymunk.Vec2d(0.6 * side, -0.3)
        leg.angle = _SPLAY * side
        leg.position = hull.position + knee + pymunk.Vec2d(0.0, -0.5 * length).rotated(leg.angle)
        foot = pymunk.Poly.create_box(leg, _LEG, radius=0.01)
        foot.friction, foot.filter = 0.8, group
        low, high = sorted((0.1 * side, 0.9 * side))
        space.add(
            leg,
            foot,
            pymunk.PivotJoint(hull, leg, knee, (0.0, 0.5 * length)),
            pymunk.RotaryLimitJoint(hull, leg, low, high),
            # Its angle is that of the hull to the leg.
            pymunk.DampedRotarySpring(hull, leg, -_SPLAY * side, 150.0, 6.0),
        )
        bodies.append(leg)
    for body in bodies:
        body.velocity = (1.5, -0.5)
    pilot = Pilot(hull, sum(b.mass for b in bodies), _standing())
    back = remember(bodies)

    def reset() -> None:
        back()
        pilot.reset()

    parameters = {"seed": seed, "dt": dt}
    return Scene("lander", space, bodies, dt, duration, 1e6, parameters=parameters, driver=pilot, reset=reset)


def _standing() -> float:
    """The height of the hull's middle over the ground while its legs are as splayed as the springs want."""
    width, length = _LEG
    return 0.3 + length * math.cos(_SPLAY) + 0.5 * width * math.sin(_SPLAY) + 0.01

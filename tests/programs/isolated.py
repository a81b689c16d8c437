"""Bodies that nothing acts on but contacts, joints, springs and motors between them, and what they then keep.

`Isolated` draws a scene of a seed and plays it: two to nine bodies of masses 1 : 10 000 in space without weight, in
units of 1e-3 to 1e3, some joined, with steps of 1e-4 to 1 s. Laws, in each step:

* linear momentum stays to 1e-12 of the sum of its magnitudes; angular momentum to 1e-11 in steps that converge, if
  joints were closed before and none exerts a torque on the whole, as a gear of another ratio than 1 does;
* the ledger closes, losses are not negative, and nothing comes from outside unless a joint may give energy;
* no joint exceeds its `max_force`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from random import Random

import pymunk

import eeca_pymunk as ep

from .compositions import Broken, stored
from .joined import BOUND, HOLDS, apart, join, overdone
from .outside import POINTS

LINEAR, ANGULAR, CLOSES, GAINS = 1e-12, 1e-11, 1e-10, 1e-9
KINDS = "disk", "box", "polygon", "rod", "two", "disk off its centre"  # of bodies


def touch(a: pymunk.Body, b: pymunk.Body) -> bool:
    """Whether shapes of two bodies overlap."""
    for one in a.shapes:
        for other in b.shapes:
            with suppress(AssertionError):  # of pymunk, for shapes that do not
                if one.shapes_collide(other).points:
                    return True
    return False


class Isolated:
    """The scene of a seed; `bodies` are those that touch no earlier one."""

    def __init__(self, seed: int) -> None:
        self.random = R = Random(f"iso {seed}")
        self.space, self.unit, mass = pymunk.Space(), R.choice((1e-3, 1.0, 1.0, 1e3)), R.choice((1e-3, 1.0, 1.0, 1e3))
        count = R.randint(2, 9)
        drawn = [self._body(mass * 10 ** R.uniform(-2, 2), math.sqrt(count)) for _ in range(count)]
        self.bodies: list[pymunk.Body] = []
        for body in drawn:
            if not any(touch(body, other) for other in self.bodies):
                self.bodies.append(body)
        self.space.remove(*(item for body in drawn if body not in self.bodies for item in (body, *body.shapes)))
        if len(self.bodies) > 1:
            self._join()
        self.dt = R.choice((1e-4, 1 / 240, 1 / 60, 1 / 60, 1 / 30, 0.1, 1.0))

    def _body(self, mass: float, wide: float) -> pymunk.Body:
        R, U = self.random, self.unit
        size = U * R.uniform(0.2, 0.7)
        body = pymunk.Body(mass, 0.4 * mass * size * size if R.random() > 0.08 else math.inf)
        body.position, body.angle = (U * R.uniform(-2, 2) * wide, U * R.uniform(-2, 2) * wide), R.uniform(-3, 3)
        speed = R.choice((0, 1, 5, 30)) * U
        body.velocity = R.uniform(-speed, speed), R.uniform(-speed, speed)
        body.angular_velocity = 0 if math.isinf(body.moment) else R.choice((0, 1, 10)) * R.uniform(-1, 1)
        kind = R.choice(KINDS)
        corners = R.randint(3, 7) if kind == "polygon" else 0
        turns = [2 * math.pi * k / max(corners, 1) for k in range(corners)]
        width = R.choice((0, 0.05 * U)) if kind in ("box", "rod") else 0
        make: dict[str, Callable[[], list[pymunk.Shape]]] = {
            "disk": lambda: [pymunk.Circle(body, size)],
            "disk off its centre": lambda: [pymunk.Circle(body, size, (0.3 * size, 0))],
            "box": lambda: [pymunk.Poly.create_box(body, (2 * size, size), width)],
            "polygon": lambda: [pymunk.Poly(body, [(size * math.cos(turn), size * math.sin(turn)) for turn in turns])],
            "rod": lambda: [pymunk.Segment(body, (-size, 0), (size, 0), width)],
            "two": lambda: [pymunk.Circle(body, 0.5 * size, (-size, 0)), pymunk.Poly.create_box(body, (size, size))],
        }
        made = make[kind]()
        elasticity, friction = R.choice((0, 0.5, 1)), R.choice((0, 0.5, 1.5))
        for shape in made:
            shape.elasticity, shape.friction = elasticity, friction
        self.space.add(body, *made)
        return body

    def _join(self) -> None:
        R = self.random
        for _ in range(R.choice((0, 0, 1, 2, 4, 6))):
            a, b = R.sample(self.bodies, 2)
            joint = join(R, a, b, self.unit, a.mass)
            if R.random() < 0.5 and not isinstance(joint, pymunk.SimpleMotor):
                joint.max_force = math.inf
            self.space.add(joint)
        pairs = list(zip(self.bodies, self.bodies[1:], strict=False)) if R.random() < 0.4 else []
        for a, b in pairs:
            if R.random() < 0.6:
                stiffness, damping = a.mass * R.choice((1, 30)), a.mass * R.choice((0, 0.3))
                self.space.add(pymunk.DampedSpring(a, b, (0, 0), (0, 0), 0.3 * self.unit, stiffness, damping))

    def momenta(self) -> tuple[pymunk.Vec2d, float, float, float]:
        """Momentum, angular momentum about the centre of mass, and the sums of the magnitudes of both."""
        mass = sum(body.mass for body in self.bodies)
        centre = sum((body.mass * body.position for body in self.bodies), pymunk.Vec2d(0, 0)) / mass
        linear, angular, size, arms = pymunk.Vec2d(0, 0), 0.0, 0.0, 0.0
        for body in self.bodies:
            at, spin = body.position - centre, 0.0 if math.isinf(body.moment) else body.moment * body.angular_velocity
            linear, size = linear + body.mass * body.velocity, size + body.mass * body.velocity.length
            angular += body.mass * at.cross(body.velocity) + spin
            arms += body.mass * at.length * body.velocity.length + abs(spin)
        return linear, angular, size, arms

    def play(self, steps: int = 60) -> None:
        """Take the steps; `Broken` says which law does not hold."""
        joints, stepper, least = list(self.space.constraints), ep.EECA(self.space), 1e-20 * self.unit
        bounded = [c for c in joints if math.isfinite(c.max_force)]
        twisted = any(isinstance(c, POINTS) for c in bounded) or any(math.isinf(b.moment) for b in self.bodies)
        twisted |= any(isinstance(c, pymunk.GearJoint) and c.ratio != 1 for c in joints)
        drives = bool(bounded) or any(isinstance(c, pymunk.SimpleMotor) for c in joints)
        before, kinetic = self.momenta(), ep.measure(self.space).kinetic
        for k in range(steps):
            off = any(apart(c, self.unit) > HOLDS for c in joints)
            report = stepper.step(self.dt)
            now, energy = self.momenta(), ep.measure(self.space).kinetic
            size, arms = max(before[2], now[2]), max(before[3], now[3])
            if (now[0] - before[0]).length > LINEAR * (size + least):
                raise Broken(f"step {k}: momentum is off by {(now[0] - before[0]).length / size:.1e}")
            if not (twisted or off) and report.converged and abs(now[1] - before[1]) > ANGULAR * (arms + least):
                raise Broken(f"step {k}: angular momentum is off by {abs(now[1] - before[1]) / arms:.1e}")
            book = report.ledger
            assert book is not None
            losses = book.restitution, book.friction, book.damping
            scale = energy + kinetic + abs(book.external) + abs(book.change) + sum(losses) + stored(self.space)
            if abs(book.residual) > CLOSES * scale or min(losses) < -GAINS * scale:
                raise Broken(f"step {k}: {book}")
            if not (drives or off) and abs(book.external) > GAINS * scale:
                raise Broken(f"step {k}: {book.external / scale:.1e} from outside")
            if any(overdone(c, self.dt) > 1 + BOUND for c in joints):
                raise Broken(f"step {k}: a joint exceeds its max_force")
            before, kinetic = now, energy

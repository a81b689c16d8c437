"""What is edited, added and removed: only that is asked anew, and the space goes on as one whose stepper asks all."""

from __future__ import annotations

import random

import pymunk
import pytest

import eeca_pymunk as ep

from ..steppers import Forgetful

DT = 1 / 60


class Program:
    """A space whose bodies, shapes and joints come, change and go, by the numbers of `seed`."""

    def __init__(self, seed: int, joints: bool) -> None:
        self.random, self.joints = random.Random(seed), joints
        self.space = pymunk.Space()
        self.space.gravity = 0.0, -900.0
        for p, q in (((-300, 0), (300, 0)), ((-300, 0), (-300, 600)), ((300, 0), (300, 600))):
            wall = pymunk.Segment(self.space.static_body, p, q, 3.0)
            wall.friction = 0.5
            self.space.add(wall)
        self.bodies: list[pymunk.Body] = []
        self.away: list[pymunk.Body] = []
        self.shapes: dict[pymunk.Body, list[pymunk.Shape]] = {}  # in an order of their own: pymunk's sets have none
        for _ in range(8):
            self.add()

    def shape(self, body: pymunk.Body) -> pymunk.Shape:
        size = self.random.uniform(5.0, 15.0)
        shape: pymunk.Shape = (
            pymunk.Circle(body, size) if self.random.random() < 0.5 else pymunk.Poly.create_box(body, (size, size))
        )
        shape.friction, shape.elasticity = 0.4, self.random.choice((0.0, 0.5))
        if body.body_type == pymunk.Body.DYNAMIC and self.random.random() < 0.3:
            shape.mass = 1.0
        self.shapes.setdefault(body, []).append(shape)
        return shape

    def add(self) -> None:
        body = pymunk.Body(1.0, 100.0, self.random.choice((pymunk.Body.DYNAMIC,) * 4 + (pymunk.Body.KINEMATIC,)))
        body.position = self.random.uniform(-250, 250), self.random.uniform(50, 500)
        self.space.add(body, self.shape(body))
        self.bodies.append(body)

    def remove(self) -> None:
        body = self.random.choice(self.bodies)
        self.space.remove(body, *self.shapes[body], *body.constraints)
        self.bodies.remove(body)
        self.away.append(body)

    def bring_back(self) -> None:
        if not self.away:
            return
        body = self.away.pop()
        if body.body_type == pymunk.Body.DYNAMIC:
            body.mass = self.random.uniform(0.5, 2.0)
        for shape in self.shapes[body]:
            shape.friction = 0.3
        self.space.add(body, *self.shapes[body])
        self.bodies.append(body)

    def add_shape(self) -> None:
        body = self.random.choice(self.bodies)
        self.space.add(self.shape(body))

    def remove_shape(self) -> None:
        body = self.random.choice(self.bodies)
        if len(self.shapes[body]) > 1:
            self.space.remove(self.shapes[body].pop(0))

    def edit(self) -> None:
        body = self.random.choice(self.bodies)
        if body.body_type == pymunk.Body.DYNAMIC:
            body.mass, body.moment = self.random.uniform(0.5, 2.0), 80.0
        for shape in self.shapes[body]:
            shape.friction = self.random.random()
            self.regroup(shape)
            if isinstance(shape, pymunk.Circle):
                shape.unsafe_set_radius(self.random.uniform(5.0, 15.0))

    def regroup(self, shape: pymunk.Shape) -> None:
        group = self.random.randint(0, 2)
        shape.filter = pymunk.ShapeFilter(group if group != shape.filter.group else (group + 1) % 3)

    def join(self) -> None:
        one, other = self.random.sample(self.bodies, 2)
        if self.joints and one.body_type == other.body_type == pymunk.Body.DYNAMIC:
            self.space.add(pymunk.PinJoint(one, other))

    def change(self) -> None:
        edits = self.add, self.remove, self.bring_back, self.add_shape, self.remove_shape, self.edit, self.join
        self.random.choice(edits)()

    def state(self) -> list[float]:
        return [c for body in self.bodies for c in (*body.position, body.angle, *body.velocity, body.angular_velocity)]


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("joints", [False, True])
def test_bit_by_bit_as_if_all_were_read_anew(seed: int, joints: bool) -> None:
    one, other = Program(seed, joints), Program(seed, joints)
    stepper, reading = ep.EECA(one.space), Forgetful(other.space)
    for k in range(90):
        if k % 3 == 2:
            one.change()
            other.change()
        stepper.step(DT)
        reading.step(DT)
        assert one.state() == other.state(), k


class Filters(Program):
    """A space whose bodies are jointed, or may sleep, or both; only its shapes are edited, or it turns a motor."""

    def __init__(self, seed: int, joints: bool, sleeps: bool) -> None:
        super().__init__(seed, joints)
        dynamic = [body for body in self.bodies if body.body_type == pymunk.Body.DYNAMIC]
        for one, other in zip(dynamic[::2], dynamic[1::2], strict=False):
            if joints:
                self.space.add(pymunk.PinJoint(one, other))
        self.motor = pymunk.SimpleMotor(dynamic[0], dynamic[1], 1.0)
        if joints:
            self.motor.max_force = 1e4
            self.space.add(self.motor)
        if sleeps:
            self.space.sleep_time_threshold = 0.3

    def change(self) -> None:
        shape = self.random.choice(self.shapes[self.random.choice(self.bodies)])
        edit, value = self.random.randrange(3), self.random.random()
        if edit < 2:
            self.regroup(shape)
            shape.friction, shape.surface_velocity = value, (10.0 * value, 0.0)
        elif isinstance(shape, pymunk.Circle):
            shape.unsafe_set_radius(5.0 + 10.0 * value)
        if value < 0.2:
            self.motor.rate = value


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("joints", "sleeps"), [(False, True), (True, False), (True, True)])
def test_patches_are_what_a_new_reading_gives_bit_by_bit(seed: int, joints: bool, sleeps: bool) -> None:
    one, other = Filters(seed, joints, sleeps), Filters(seed, joints, sleeps)
    stepper, reading = ep.EECA(one.space), ep.EECA(other.space)
    reading.patch = lambda world, moved: False  # type: ignore[method-assign]
    for k in range(60):
        if k % 3 == 2:
            one.change()
            other.change()
        stepper.step(DT)
        reading.step(DT)
        assert one.state() == other.state(), k
    assert stepper.patches > 3
    assert stepper.reads < reading.reads

"""What users do to constraints: edits, impulses read, functions, springs with laws of their own, joints added."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pymunk
import pytest

from scenes.linkages import bars, body, chain, empty, pendulum

from .driving import Driven, error, run


@pytest.mark.parametrize(
    "make",
    [
        lambda s, b: pymunk.PinJoint(s.static_body, b),
        lambda s, b: pymunk.PivotJoint(s.static_body, b, (0, 0), (0, 2)),
        lambda s, b: pymunk.SlideJoint(s.static_body, b, (0, 0), (0, 0), 0, 2),
        lambda s, b: pymunk.GrooveJoint(s.static_body, b, (-1, -2), (1, -2), (0, 0)),
        lambda s, b: pymunk.DampedSpring(s.static_body, b, (0, 0), (0, 0), 1.0, 30.0, 1.0),
    ],
    ids=["pin", "pivot", "slide", "groove", "spring"],
)
def test_impulses_read_as_under_native(make) -> None:  # type: ignore[no-untyped-def]
    # A weight at rest, with native's signs: springs that pull are negative.
    reads = []
    for native in (True, False):
        space = empty(10.0)
        weight = body(space, 3.0, 1.0, (0.0, -2.0))
        joint = make(space, weight)
        space.add(joint)
        stepper = Driven(space)
        for _ in range(50):
            space.step(0.001) if native else stepper.step(0.001)
        if native:
            del stepper
        reads.append(joint.impulse)
    assert reads[1] == pytest.approx(reads[0], rel=5e-3)


def test_rotary_and_motor_impulses_read_as_under_native() -> None:
    for make in (
        lambda s, b: pymunk.DampedRotarySpring(s.static_body, b, 0.0, 10.0, 0.0),
        lambda s, b: pymunk.SimpleMotor(s.static_body, b, 2.0),
    ):
        reads = []
        for native in (True, False):
            space = empty(0.0)
            wheel = body(space, 1.0, 1.0, (0.0, 0.0), 0.5)
            joint = make(space, wheel)
            space.add(joint)
            stepper = Driven(space)
            space.step(1e-4) if native else stepper.step(1e-4)
            if native:
                del stepper
            reads.append(joint.impulse)
        assert reads[1] == pytest.approx(reads[0], rel=1e-3)


def test_an_edit_is_seen_and_only_once() -> None:
    space = pendulum()
    stepper = run(space, 1 / 60, 10)
    pin = next(iter(space.constraints))
    world = stepper.stepper._world
    assert world is not None
    assert world.joints is not None
    assert not world.joints.edited
    pin.distance = 1.1
    for _ in range(200):
        stepper.step(1 / 60)
    assert next(iter(space.bodies)).position.length == pytest.approx(1.1, abs=1e-9)
    booked = stepper.restitution
    stepper.step(1 / 60)
    assert stepper.restitution == booked


def test_breaking_joints_and_new_ones() -> None:
    # The heavy end is let go in flight: it falls freely, and the rest swings on with its energy.
    space = chain(3, 5.0)
    stepper = run(space, 1 / 60, 20)
    end = list(space.bodies)[-1]
    last = list(space.constraints)[-1]
    space.remove(last)
    place, speed = end.position, end.velocity
    for _ in range(6):
        stepper.step(1 / 60)
    np.testing.assert_allclose(end.position, place + 0.1 * speed + pymunk.Vec2d(0, -0.5 * 9.81 * 0.01), atol=1e-12)
    space.add(pymunk.PivotJoint(space.static_body, end, end.position))
    for _ in range(60):
        stepper.step(1 / 60)
    assert error(space) < 1e-9
    assert stepper.restitution > 0.0


def test_functions_are_called_once_a_step_around_it() -> None:
    space = pendulum()
    pin, calls = next(iter(space.constraints)), []
    pin.pre_solve = lambda c, s: calls.append(("pre", c is pin, s is space))
    pin.post_solve = lambda c, s: calls.append(("post", c.impulse > 0.0, s is space))
    run(space, 1 / 60, 2)
    assert calls == [("pre", True, True), ("post", False, True)] * 2 or calls == [
        ("pre", True, True), ("post", True, True)
    ] * 2  # fmt: skip


def swing(steps: int, time: float) -> float:
    """The worst error of the energy of f = -4 s - 30 s^3, s = length - 1, whose potential is 2 s^2 + 7.5 s^4."""
    space = empty(0.0)
    a, b = body(space, 1.0, 1.0, (0.0, 0.0)), body(space, 2.0, 1.0, (1.8, 0.0))
    b.velocity = (0.0, 1.0)
    spring = pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1.0, 1.0, 0.0)
    spring.force_func = lambda c, length: -4.0 * (length - 1.0) - 30.0 * (length - 1.0) ** 3
    space.add(spring)

    def total() -> float:
        s = (b.position - a.position).length - 1.0
        return sum(0.5 * one.kinetic_energy for one in (a, b)) + 2.0 * s**2 + 7.5 * s**4

    start, worst = total(), 0.0
    stepper = Driven(space)
    for _ in range(steps):
        stepper.step(time / steps)
        worst = max(worst, abs(total() - start))
    return worst


def test_energy_of_an_own_law_of_a_spring_is_of_fourth_order() -> None:
    errors = [swing(steps, 4.0) for steps in (120, 240, 480)]
    assert errors[0] < 1e-2
    for coarse, fine in itertools.pairwise(errors):
        assert 3.9 < math.log2(coarse / fine) < 4.1


def test_own_torque_is_called_and_conserves_momentum() -> None:
    # T = 3 sin(a - b): the reduced moment 0.4 swings as a pendulum, of which energy is known.
    space = empty(0.0)
    a, b = body(space, 1.0, 0.5, (0.0, 0.0)), body(space, 1.0, 2.0, (1.0, 0.0))
    a.angular_velocity = 2.0
    spring = pymunk.DampedRotarySpring(a, b, 0.0, 1.0, 0.0)
    spring.torque_func = lambda c, angle: 3.0 * math.sin(angle)
    space.add(spring)
    run(space, 1 / 60, 200)
    energy = 0.25 * a.angular_velocity**2 + b.angular_velocity**2 + 3.0 * (1.0 - math.cos(a.angle - b.angle))
    assert energy == pytest.approx(1.0, abs=1e-7)
    assert 0.5 * a.angular_velocity + 2.0 * b.angular_velocity == pytest.approx(1.0, abs=1e-12)


def test_a_capped_spring_pulls_with_its_max_force_and_conserves() -> None:
    # k = 100, cap 5, from 1 beyond rest: constant pull until .05 from rest: v^2/2 = 5 * .95 + 5 * .05 / 2.
    space = empty(0.0)
    weight = body(space, 1.0, 1.0, (3.0, 0.0))
    spring = pymunk.DampedSpring(space.static_body, weight, (0, 0), (0, 0), 2.0, 100.0, 0.0)
    spring.max_force = 5.0
    space.add(spring)
    stepper = run(space, 1 / 60, 30)
    assert weight.position.x == pytest.approx(3.0 - 0.5 * 5.0 * 0.25, abs=1e-12)
    for _ in range(200):
        stepper.step(1 / 60)
        s = abs(weight.position.x - 2.0)
        held = 50.0 * s * s if s < 0.05 else 5.0 * (s - 0.025)
        assert 0.5 * weight.velocity.x**2 + held == pytest.approx(5.0 * 0.975, abs=1e-11)


def test_anchors_count_from_the_centre_of_gravity() -> None:
    # The same bars with their frames moved off the centres of mass, and turned.
    one, two = bars(), bars()
    for bar in list(two.bodies):
        centre = bar.position
        bar.center_of_gravity = (0.2, -0.3)
        bar.position = centre - pymunk.Vec2d(0.2, -0.3)
    for joint in two.constraints:
        joint.anchor_b = joint.anchor_b + pymunk.Vec2d(0.2, -0.3)
        if joint.a is not two.static_body:
            joint.anchor_a = joint.anchor_a + pymunk.Vec2d(0.2, -0.3)
    run(one, 1 / 60, 60)
    run(two, 1 / 60, 60)
    for a, b in zip(one.bodies, two.bodies, strict=True):
        np.testing.assert_allclose(b.local_to_world(b.center_of_gravity), a.position, atol=1e-11)
        assert b.angle == pytest.approx(a.angle, abs=1e-11)


def test_a_mouse_drags_a_chain() -> None:
    space = chain(4, lean=1.5)
    end = list(space.bodies)[-1]
    mouse = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    mouse.position = end.position
    grip = pymunk.PivotJoint(mouse, end, (0, 0), (0, 0))
    grip.max_force, grip.error_bias = 500.0, (1 - 0.15) ** 60
    space.add(grip)
    stepper = Driven(space)
    for k in range(120):
        mouse.position = mouse.position + pymunk.Vec2d(0.01, 0.01) * (k < 60)
        stepper.step(1 / 60)
    assert (mouse.position - end.position).length < 0.05
    assert abs(stepper.unexplained()) < 1e-11 * 100.0

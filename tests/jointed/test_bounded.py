"""Motors of bounded force in chains whose links touch: impulses within their bounds, energy no more than they work."""

from __future__ import annotations

import random
import time

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled import plain
from eeca_pymunk.jointed.bounded_rows import list_rows
from eeca_pymunk.model.joints import PRESCRIBED
from eeca_pymunk.rows.bounded import room_for_rows

from .measures import angular_momentum, apart, energy, kinetic, momentum, moving
from .test_taut import bridge


def links(seed: int, count: int = 4, force: float = 20.0, slow: float = 3.0) -> pymunk.Space:
    """A free chain of boxes, without gravity and friction, whose joints are driven by motors of bounded force."""
    rng = random.Random(seed)
    space = pymunk.Space()
    chain: list[pymunk.Body] = []
    for i in range(count):
        body = pymunk.Body(1.0, 0.075)
        body.position = i, 0.0
        body.angular_velocity, body.velocity = rng.uniform(-slow, slow), (rng.uniform(-1, 1), rng.uniform(-1, 1))
        space.add(body, pymunk.Poly.create_box(body, (0.9, 0.3)))
        if chain:
            joint = pymunk.PivotJoint(chain[-1], body, (i - 0.5, 0.0))
            joint.collide_bodies = False
            motor = pymunk.SimpleMotor(chain[-1], body, rng.uniform(-5.0, 5.0))
            motor.max_force = force
            space.add(joint, motor)
        chain.append(body)
    return space


def motors(space: pymunk.Space) -> list[pymunk.SimpleMotor]:
    return [c for c in space.constraints if isinstance(c, pymunk.SimpleMotor)]


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 1 / 30])
@pytest.mark.parametrize(("seed", "force"), [(41, 20.0), (1, 0.5), (2, 20.0), (3, 100.0), (4, 50.0)])
def test_work_of_bounded_motors_bounds_the_energy(seed: int, force: float, dt: float) -> None:
    """|impulse| <= max_force dt exactly; a step's rise of energy <= max_force times the angles turned, and external is
    that work; momentum and angular momentum of a free chain stay."""
    space = links(seed, force=force)
    stepper = ep.EECA(space)
    start, turning, scale = momentum(space), angular_momentum(space), 0.0
    for _ in range(round(3.0 / dt)):
        before = energy(space)
        angles = [m.b.angle - m.a.angle for m in motors(space)]
        spins = [abs(m.b.angular_velocity - m.a.angular_velocity) for m in motors(space)]
        report = stepper.step(dt)
        scale = max(scale, before)
        turned = 0.0
        for motor, angle, spin in zip(motors(space), angles, spins, strict=True):
            a, b = motor.a, motor.b
            # Between impacts a link may turn to and fro: hardly faster than at the step's ends, or the motor's rate.
            fastest = max(spin, abs(b.angular_velocity - a.angular_velocity), abs(motor.rate))
            turned += max(abs(b.angle - a.angle - angle), dt * fastest)
        work = 1.25 * force * turned
        assert energy(space) - before <= work + 1e-11 * scale
        assert abs(report.ledger.external) <= work + 1e-11 * scale
        assert abs(report.ledger.residual) <= 1e-11 * scale
        assert report.ledger.restitution >= -1e-11 * scale
        assert max(m.impulse for m in motors(space)) <= force * dt * (1.0 + 1e-15)
    assert apart(space) < 1e-9
    np.testing.assert_allclose(momentum(space), start, atol=1e-11 * (1.0 + scale))
    assert angular_momentum(space) == pytest.approx(turning, abs=1e-10 * (1.0 + scale))


@pytest.mark.parametrize("dt", [1 / 1000, 1 / 240, 1 / 60])
def test_a_chain_that_is_hit_keeps_its_angular_momentum(dt: float) -> None:
    rng = random.Random(2)
    space, before = pymunk.Space(), None
    for i in range(8):
        body = pymunk.Body(1.0, 0.075)
        body.position, body.angular_velocity = (i, 0.0), rng.uniform(-3.0, 3.0)
        space.add(body, pymunk.Poly.create_box(body, (0.9, 0.3)))
        if before is not None:
            joint = pymunk.PivotJoint(before, body, (i - 0.5, 0.0))
            joint.collide_bodies = False
            space.add(joint)
        before = body
    for _ in range(4):
        body = pymunk.Body(1.0, 0.045)
        body.position, body.velocity = (rng.uniform(0.0, 7.0), 1.0 + rng.random()), (rng.uniform(-1.0, 1.0), -3.0)
        space.add(body, pymunk.Circle(body, 0.3))
    stepper = ep.EECA(space)
    start, pushed = angular_momentum(space), 0
    for _ in range(round(1.5 / dt)):
        pushed += len(stepper.step(dt).contacts)
        assert angular_momentum(space) == pytest.approx(start, rel=1e-12)
    assert pushed > 20


@pytest.mark.parametrize(("planks", "load"), [(20, 1.0), (20, 20.0), (60, 5.0), (60, 200.0)])
def test_what_a_taut_bridge_gives_back_it_has_taken(planks: int, load: float) -> None:
    """Straight between its ends, no rigid motion is left to it: it gives way elastically. What comes back from that is
    no more than what has gone into it, joints stay within 1e-8 of the length times the load, and the load stays up."""
    space, _ = bridge(0.0, 1.0, planks)
    box = pymunk.Body(load, load * 0.4**2 / 6)
    box.position = 0.25 * planks, 0.26
    space.add(box, pymunk.Poly.create_box(box, (0.4, 0.4)))
    for shape in space.shapes:
        shape.friction = 0.8
    stepper, taken, unmet, start = ep.EECA(space), 0.0, 0, energy(space)
    for _ in range(120):
        report = stepper.step(1 / 60)
        taken += report.ledger.external
        unmet += not report.converged
        assert taken <= 1e-9 * load
        assert energy(space) - start <= 1e-9 * load
    assert apart(space) <= 1e-8 * 0.5 * planks * max(1.0, load ** (1 / 3))
    assert box.position.y > 0.235
    assert unmet <= 0.1 * 120 or load > 20.0


def crowd(seed: int) -> tuple[pymunk.Space, float]:
    """Boxes and disks in a box that turns, held together by joints of many kinds."""
    rng = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    walls = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    walls.angular_velocity = rng.uniform(-2.0, 2.0)
    corners = [(-4, -4), (4, -4), (4, 4), (-4, 4)]
    space.add(walls, *(pymunk.Segment(walls, corners[i - 1], corners[i], 0.1) for i in range(4)))
    bodies = []
    for i in range(14):
        body = pymunk.Body(10.0 ** rng.choice([-1, 0, 0, 1]), 0.1)
        body.position, body.velocity = (-3 + 2 * (i % 4), -3 + 2 * (i // 4)), (rng.uniform(-3, 3), rng.uniform(-3, 3))
        shape = pymunk.Circle(body, 0.4) if i % 2 else pymunk.Poly.create_box(body, (0.9, 0.5))
        shape.friction = 0.5
        space.add(body, shape)
        bodies.append(body)
    for _ in range(12):
        a, b = rng.sample(bodies, 2)
        kind, middle = rng.randrange(5), 0.5 * (a.position + b.position)
        if kind == 0:
            space.add(pymunk.PinJoint(a, b))
        elif kind == 1:
            space.add(pymunk.PivotJoint(a, b, tuple(middle)))
        elif kind == 2:
            space.add(pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0.0, 1.1 * (a.position - b.position).length))
        elif kind == 3:
            space.add(pymunk.RotaryLimitJoint(a, b, -1.0, 1.0))
        else:
            motor = pymunk.SimpleMotor(a, b, rng.uniform(-8.0, 8.0))
            motor.max_force = rng.choice([2.0, 50.0, 1000.0])
            space.add(motor)
    return space, rng.choice([1 / 60, 1 / 30])


@pytest.mark.parametrize("seed", range(6))
def test_a_step_of_many_joints_takes_bounded_work(seed: int) -> None:
    """Over-determined sets of joints in a box that turns: the ledger closes whatever is given up, and operations of a
    step are bounded."""
    space, dt = crowd(seed)
    stepper, scale = ep.EECA(space), 0.0
    for _ in range(60):
        before = energy(space)
        began = time.process_time()
        report = stepper.step(dt)
        took = time.process_time() - began
        scale = max(scale, abs(before), sum(kinetic(b) for b in moving(space)))
        assert abs(energy(space) - before - report.ledger.change) <= 1e-9 * scale
        assert abs(report.ledger.residual) <= 1e-9 * scale
        assert report.ledger.restitution >= -1e-9 * scale
        for motor in motors(space):
            assert motor.impulse <= motor.max_force * dt * (1.0 + 1e-12)
        # Some 20 ms on an idle machine: what is bounded is the number of operations.
        assert took < 1.0 or plain()


def test_another_stepper_on_a_moving_space_changes_no_energy() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    last = space.static_body
    for i in range(5):
        body = pymunk.Body(1.0, 0.1)
        body.position = i + 1.0, 0.0
        space.add(body, pymunk.PivotJoint(last, body, (i + 0.5, 0.0)))
        last = body
    start = energy(space)
    for _ in range(12):
        stepper = ep.EECA(space)
        for _ in range(10):
            stepper.step(1 / 60)
            assert energy(space) == pytest.approx(start, abs=1e-12 * 5 * 9.81 * 5)
    assert apart(space) < 1e-13


def yard(unit: float, boxes: int = 6) -> tuple[pymunk.Space, pymunk.Body, pymunk.Body]:
    """Boxes on a floor seen from above, whose friction bounded joints emulate: two lie in each other, four in a row in
    front of a tank, which follows a kinematic body; the space, the tank and that body."""
    space = pymunk.Space()
    places = [(-4.0, 3.0), (-3.4, 3.3), *((2.0 + 1.1 * i, 0.1 * i) for i in range(boxes - 2))]
    control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(control)

    def add(x: float, y: float, size: float, mass: float, holder: pymunk.Body, force: float) -> pymunk.Body:
        body = pymunk.Body(mass, mass * (size * unit) ** 2 / 6.0)
        body.position = x * unit, y * unit
        box = pymunk.Poly.create_box(body, (size * unit, size * unit))
        box.friction = 0.7
        pivot, gear = pymunk.PivotJoint(holder, body, (0.0, 0.0), (0.0, 0.0)), pymunk.GearJoint(holder, body, 0.0, 1.0)
        pivot.max_bias = gear.max_bias = 0.0
        pivot.max_force, gear.max_force = force * unit, 0.25 * force * unit * unit
        space.add(body, box, pivot, gear)
        return body

    for x, y in places:
        add(x, y, 1.0, 1.0, space.static_body, 50.0)
    return space, add(0.0, 0.0, 1.5, 10.0, control, 500.0), control


@pytest.mark.parametrize("unit", [1e-3, 1e-1, 1.0, 7.0, 1e2, 1e3, 1e4])
def test_boxes_that_lie_in_each_other_and_that_a_tank_pushes_are_solved(unit: float) -> None:
    """What lies without any load or velocity is solved as it is: by one solve a step, not by shorter and shorter
    intervals. Where impulses reach the rim of a disc, homotopies leave them to sweeps: with squares for discs one of
    the units has steps that are not solved."""
    space, tank, control = yard(unit)
    stepper = ep.EECA(space)
    lying = [b for b in moving(space) if b.position.x < -unit]
    for _ in range(120):
        control.velocity = 1.5 * unit, 0.0
        report = stepper.step(1 / 60)
        assert report.converged, report.unmet
        assert report.iterations <= 18
        assert all(b.velocity == (0.0, 0.0) and b.angular_velocity == 0.0 for b in lying)
    assert tank.position.x > 1.0 * unit


@pytest.mark.parametrize("spin", [0.0, 0.3])
def test_a_motor_at_different_bounds_in_parts_of_a_step_is_given(spin: float) -> None:
    """Inside its bounds it holds the speed of its target; where it has not, it was at its bounds in turn."""
    space = pymunk.Space()
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 2.0)
    motor = pymunk.SimpleMotor(a, b, 0.0)
    motor.max_force = 5.0
    space.add(a, b, motor)
    stepper = ep.EECA(space)
    stepper.step(0.1)
    scene, J = stepper.event_loop.scene, stepper.event_loop.joints
    J.HINGE[0].total[0], J.COUPLING[0].bounded = 0.2, PRESCRIBED
    scene.PLACE[:2] = 0, 1
    B = room_for_rows(1, 2)
    list_rows(scene, J, B, 0, 0.1, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0 + spin]]))
    assert B.ROWS[0].now == 0.2
    assert (B.ROWS[0].low, B.ROWS[0].high) == ((-0.5, 0.5) if spin == 0.0 else (0.2, 0.2))


def test_motors_of_a_long_arm_are_solved_together() -> None:
    """Each of twelve motors bears all links beyond it."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    before = space.static_body
    for i in range(12):
        link = pymunk.Body(1.0, 0.1)
        link.position = i + 0.5, 0.0
        motor = pymunk.SimpleMotor(before, link, 0.0)
        motor.max_force = 100.0 * (12 - i) ** 2
        space.add(link, pymunk.PivotJoint(before, link, (float(i), 0.0)), motor)
        before = link
    stepper = ep.EECA(space)
    for _ in range(10):
        assert stepper.step(1 / 60).converged
    assert before.position == pytest.approx((11.5, 0.0), abs=1e-10)

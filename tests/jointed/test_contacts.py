"""Jointed bodies that lie, slide, roll and are pushed: contacts and joints in one solve."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep

from .measures import apart, energy, kinetic, moving


def ground(space: pymunk.Space, friction: float = 0.5, elasticity: float = 0.0, unit: float = 1.0) -> pymunk.Segment:
    line = pymunk.Segment(space.static_body, (-60.0 * unit, 0.0), (60.0 * unit, 0.0), 0.1 * unit)
    line.friction, line.elasticity = friction, elasticity
    space.add(line)
    return line


def chain(links: int, height: float, tilt: float = 0.2, unit: float = 1.0) -> pymunk.Space:
    """Boxes held end to end by pivots, above a rough floor."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81 * unit
    ground(space, unit=unit)
    last = None
    half = 0.5 * math.hypot(1.0, tilt) * unit
    for i in range(links):
        body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (unit, 0.2 * unit)))
        body.position, body.angle = (i * unit, (height + tilt * i) * unit), math.atan(tilt)
        box = pymunk.Poly.create_box(body, (0.8 * unit, 0.2 * unit))
        box.friction, box.filter = 1.0, pymunk.ShapeFilter(group=1)
        space.add(body, box)
        if last is not None:
            space.add(pymunk.PivotJoint(last, body, (half, 0.0), (-half, 0.0)))
        last = body
    return space


@pytest.mark.parametrize("unit", [1e-2, 1.0, 1e2])
def test_dropped_chain_comes_to_rest(unit: float) -> None:
    space = chain(4, 0.5, unit=unit)
    stepper = ep.EECA(space)
    start, last = energy(space), energy(space)
    for _ in range(120):
        report = stepper.step(1.0 / 60.0)
        now = energy(space)
        assert now - last < 1e-12 * start
        assert abs(report.ledger.residual) < 1e-12 * start
        assert report.ledger.restitution > -1e-13 * start
        assert report.ledger.friction > -1e-13 * start
        last = now
    places = [b.position for b in moving(space)]
    held = 0.0
    for _ in range(60):
        report = stepper.step(1.0 / 60.0)
        held = float(report.impulse.sum())
    for body, place in zip(moving(space), places, strict=True):
        assert (body.position - place).length < 1e-9 * unit
    assert held == pytest.approx(4.0 * 9.81 * unit / 60.0, rel=1e-9)
    assert apart(space) < 1e-11 * unit
    for shape in space.shapes:
        if shape.body in moving(space):
            assert shape.bb.bottom > (0.1 - 1e-3) * unit


def test_motor_rolls_a_wheel() -> None:
    # torque T on a disk that rolls: a = (T/r) / (m + I/r^2)
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    ground(space, friction=1.0)
    wheel = pymunk.Body(2.0, 0.3)
    wheel.position = 0.0, 0.6
    disk = pymunk.Circle(wheel, 0.5)
    disk.friction = 1.0
    motor = pymunk.SimpleMotor(wheel, space.static_body, -1000.0)
    motor.max_force = 1.5
    space.add(wheel, disk, motor)
    stepper = ep.EECA(space)
    work = 0.0
    for _ in range(60):
        report = stepper.step(1.0 / 60.0)
        work += report.ledger.external
    a = (1.5 / 0.5) / (2.0 + 0.3 / 0.25)
    assert abs(wheel.velocity.x) == pytest.approx(a, rel=1e-6)
    assert abs(wheel.velocity.x + wheel.angular_velocity * 0.5) < 1e-9
    assert work == pytest.approx(kinetic(wheel), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_random_figures_lose_and_never_gain(seed: int) -> None:
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    ground(space, friction=0.7, elasticity=0.4)
    last = None
    for i in range(4):
        body = pymunk.Body(float(rng.uniform(0.5, 2.0)), 0.1)
        body.position, body.angle = (0.6 * i, 1.5), float(rng.uniform(-1.0, 1.0))
        shape = (
            pymunk.Poly.create_box(body, (0.3, 0.4)) if rng.random() < 0.5 else pymunk.Circle(body, 0.2, (0.05, 0.0))
        )
        shape.friction, shape.elasticity = 0.8, float(rng.uniform(0.0, 0.9))
        space.add(body, shape)
        body.velocity = tuple(rng.normal(size=2))
        if last is not None:
            kind = int(rng.integers(3))
            if kind == 0:
                space.add(pymunk.PivotJoint(last, body, (0.6 * i - 0.3, 1.5)))
            elif kind == 1:
                space.add(pymunk.DampedSpring(last, body, (0.0, 0.0), (0.0, 0.0), 0.5, 40.0, 0.5))
            else:
                space.add(pymunk.PinJoint(last, body, (0.1, 0.0), (-0.1, 0.0)))
        last = body
    stepper = ep.EECA(space)
    start = abs(energy(space)) + sum(kinetic(b) for b in moving(space))
    before = energy(space)
    for _ in range(90):
        report = stepper.step(1.0 / 60.0)
        book = report.ledger
        now = energy(space)
        assert abs(now - before - book.change) < 1e-11 * start
        assert abs(book.residual) < 1e-11 * start
        assert now - before - max(book.external, 0.0) < 1e-9 * start
        before = now
    assert apart(space) < 1e-8


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60])
@pytest.mark.parametrize("strength", [0.05, 0.5, 50.0])
def test_a_motor_presses_on_a_wall_with_its_max_force_and_stays(strength: float, dt: float) -> None:
    """Whether it needs many steps to reach its rate, or would reach it within one: native stands there, too."""
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (0.13, 0.25), (0.13, 0.6), 0.0))
    bar = pymunk.Body(0.125, pymunk.moment_for_box(0.125, (0.05, 0.35)))
    bar.position, bar.angle = (0.13, 0.0), -0.3
    motor = pymunk.SimpleMotor(space.static_body, bar, -1.0)
    motor.max_force = strength
    blade = pymunk.Poly(bar, [(-0.025, 0.0), (0.025, 0.0), (0.025, 0.35), (-0.025, 0.35)])
    space.add(bar, blade, motor, pymunk.PivotJoint(space.static_body, bar, bar.position, (0, 0)))
    stepper = ep.EECA(space)
    for k in range(round(1.0 / dt)):
        report = stepper.step(dt)
        if k * dt > 0.5:
            # The wall's end lies on the blade's side.
            assert bar.angle == pytest.approx(-math.asin(0.025 / 0.25), abs=1e-6)
            assert bar.angular_velocity == pytest.approx(0.0, abs=1e-9)
            assert motor.impulse == pytest.approx(strength * dt)
            assert report.impulse.sum() == pytest.approx(strength * dt / math.sqrt(0.25**2 - 0.025**2), rel=1e-6)


def test_a_spring_presses_a_bar_on_a_wall_and_does_not_push_it_through() -> None:
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (0.13, 0.25), (0.13, 0.6), 0.0))
    bar = pymunk.Body(0.125, pymunk.moment_for_box(0.125, (0.05, 0.35)))
    bar.position, bar.angle = (0.13, 0.0), -0.3
    blade = pymunk.Poly(bar, [(-0.025, 0.0), (0.025, 0.0), (0.025, 0.35), (-0.025, 0.35)])
    spring = pymunk.DampedRotarySpring(space.static_body, bar, -0.5, 1.0, 0.05)
    space.add(bar, blade, spring, pymunk.PivotJoint(space.static_body, bar, bar.position, (0, 0)))
    stepper = ep.EECA(space)
    for _ in range(160):
        report = stepper.step(1 / 80)
    assert bar.angle == pytest.approx(-math.asin(0.025 / 0.25), abs=1e-6)
    torque = 1.0 * (0.5 - bar.angle)
    assert report.impulse.sum() * math.sqrt(0.25**2 - 0.025**2) == pytest.approx(torque / 80, rel=1e-6)


@pytest.mark.parametrize("kind", ["pivot", "pin", "gear"])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_moving_support_pays_for_what_it_sets_going(kind: str, unit: float) -> None:
    """The velocity jumps by dv to what fits the joint: (1/2) dv.M dv is lost, the rest is the work of the support."""
    space, body = pymunk.Space(), pymunk.Body(1.5, unit * unit)
    support = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    support.velocity, support.angular_velocity = (1.0 * unit, 0.5 * unit), 0.7
    body.position = (2.0 * unit, 0.7 * unit)
    joint: pymunk.Constraint
    if kind == "pivot":
        joint = pymunk.PivotJoint(support, body, (unit, 0.5 * unit))
    elif kind == "pin":
        joint = pymunk.PinJoint(support, body, (0, 0), (0, 0))
    else:
        joint = pymunk.GearJoint(support, body, 0.0, 1.0)
    space.add(support, body, joint)
    ledger = ep.EECA(space).step(1e-9).ledger
    gained = 0.5 * 1.5 * body.velocity.length**2 + 0.5 * unit * unit * body.angular_velocity**2
    assert ledger is not None
    assert ledger.restitution == pytest.approx(gained, rel=1e-5)
    assert ledger.external == pytest.approx(2.0 * gained, rel=1e-5)
    assert abs(ledger.residual) <= 1e-13 * gained


def test_free_bodies_that_overlap_beside_joints_do_not_go_back_in_time() -> None:
    """Balls lie on an L that a slide joint holds at its limit; some overlap as they land."""
    space = pymunk.Space()
    space.gravity = 0.0, 900.0
    bar = pymunk.Body(10.0, 10000.0)
    bar.position, bar.angle, bar.angular_velocity = (300.0, 300.0), -0.25056740282256035, -0.8610807133981175
    legs = [pymunk.Segment(bar, p, q, 1.0) for p, q in (((-145, 0), (255, 0)), ((-145, 0), (-145, -25)))]
    space.add(bar, *legs)
    pin, slide = pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(body_type=pymunk.Body.STATIC)
    pin.position, slide.position = (300.0, 300.0), (200.0, 300.0)
    space.add(pymunk.PinJoint(bar, pin, (0, 0), (0, 0)), pymunk.SlideJoint(bar, slide, (-100, 0), (0, 0), 0, 25))
    for x, y, vx, vy, spin in (
        (170.00081015755865, 316.3820201282212, 16.377441132044105, 125.6678152286018, 0.13798840135679902),
        (197.35742741508014, 310.4133283176172, 11.337391295652438, 102.54487042177566, -1.8282815375655228),
        (224.57029412544102, 303.8178303847197, 2.3310656704538726, 65.46628771735284, -0.896586634918918),
        (250.41731238949725, 293.0513513474903, -4.942993739182866, 47.649472194060216, -2.937399796958845),
    ):
        ball = pymunk.Body(1.0, 98.0)
        ball.position, ball.velocity, ball.angular_velocity = (x, y), (vx, vy), spin
        space.add(ball, pymunk.Circle(ball, 14.0))
    for shape in space.shapes:
        shape.friction = 1.0
    ledger = ep.EECA(space).step(1 / 50).ledger
    assert ledger is not None
    assert abs(ledger.residual) <= 1e-12 * abs(ledger.change)


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 30, 1 / 10])
def test_reported_impulses_are_the_change_of_momentum(turns: bool, dt: float) -> None:
    """Impulses that keep contacts from closing where velocities are made to fit the joints were not reported."""
    space = pymunk.Space()
    space.gravity = 0.0, -2.0
    box = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    corners = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]
    walls = [pymunk.Segment(box, p, q, 0.1) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)]
    space.add(box, *walls)
    for wall in walls:
        wall.friction = 0.5
    bodies = []
    for i, mass in enumerate((0.2, 5.0, 1.0)):
        body = pymunk.Body(mass, 0.3 * mass)
        body.position, body.velocity, body.angular_velocity = (1.2 * i - 1.2, 0.3 * i), (3.0, -4.0 + i), 3.0 * i - 2.0
        shape: pymunk.Shape = pymunk.Circle(body, 0.5) if i == 1 else pymunk.Poly.create_box(body, (1.0, 0.6))
        shape.friction = 0.5
        space.add(body, shape)
        bodies.append(body)
    space.add(*(pymunk.PivotJoint(a, b, (x, 0.2)) for a, b, x in zip(bodies, bodies[1:], (-0.6, 0.6), strict=False)))
    stepper, largest = ep.EECA(space), 0.0
    for k in range(int(6.0 / dt)):
        box.angular_velocity = 0.8 * math.sin(k * dt) if turns else 0.0
        before = sum((b.mass * b.velocity for b in bodies), pymunk.Vec2d.zero())
        report = stepper.step(dt)
        after = sum((b.mass * b.velocity for b in bodies), pymunk.Vec2d.zero())
        n = report.contacts.normal
        push = report.impulse[:, None] * n + report.friction[:, None] * np.stack((-n[:, 1], n[:, 0]), axis=1)
        here = np.array([b is box for b in report.contacts.bodies])
        sign = 1.0 * here[report.contacts.body_a] - 1.0 * here[report.contacts.body_b]
        change = np.array(after - before) - 6.2 * dt * np.array(space.gravity)
        largest = max(largest, float(np.abs(change).max()))
        assert sign @ push == pytest.approx(change, abs=1e-11 * 6.2 * 10.0)
    assert largest > 1.0


def test_the_elasticity_of_a_shape_does_nothing_on_what_has_none() -> None:
    """Two bodies on a spring, on a floor that shakes: whether overlaps are lifted depended on the shapes of the bodies,
    not on their contacts, so that elastic ones stayed four times as deep."""
    paths = []
    for elasticity in (0.5, 1.0):
        space = pymunk.Space()
        space.gravity = 0.0, -9.81
        wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        space.add(wall, pymunk.Segment(wall, (-9.0, 0.0), (9.0, 0.0), 0.0))
        bodies = [pymunk.Body(mass, 0.1 * mass) for mass in (1.0, 20.0)]
        for body, y in zip(bodies, (0.5, 2.0), strict=True):
            body.position = 0.0, y
            disk = pymunk.Circle(body, 0.5)
            disk.elasticity = elasticity
            space.add(body, disk)
        space.add(pymunk.DampedSpring(*bodies, (0.0, 0.0), (0.0, 0.0), 1.5, 2000.0, 0.0))
        stepper, deepest = ep.EECA(space), 0.0
        for k in range(100):
            wall.velocity = 0.0, math.sin(7.0 * k / 30.0)
            ledger = stepper.step(1 / 30).ledger
            assert ledger is not None
            assert abs(ledger.residual) < 1e-11
            deepest = max(deepest, 0.5 - bodies[0].position.y + wall.position.y)
        assert deepest < 0.01
        paths.append([tuple(body.position) for body in bodies])
    assert paths[0] == paths[1]


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("put_in", [0.004, -0.004])
@pytest.mark.parametrize("joined", [False, True])
def test_a_slow_wall_takes_resting_bodies_along_without_gravity(joined: bool, put_in: float, unit: float) -> None:
    """Nothing but the wall says how fast they will be; it pushes on the line of their centres, and is `put_in` one."""
    space = pymunk.Space()
    wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wall.velocity = (-0.01 * unit, 0.0)
    first, second = pymunk.Body(1.0, 0.1 * unit**2), pymunk.Body(1.0, 0.1 * unit**2)
    first.position, second.position = ((put_in - 0.2) * unit, 0.0), (-1.2 * unit, 0.0)
    space.add(wall, pymunk.Segment(wall, (0.1 * unit, -5.0 * unit), (0.1 * unit, 5.0 * unit), 0.1 * unit))
    space.add(first, pymunk.Circle(first, 0.2 * unit), second, pymunk.Circle(second, 0.2 * unit))
    if joined:
        space.add(pymunk.PivotJoint(first, second, (-0.7 * unit, 0.0)))
    stepper = ep.EECA(space)
    for _ in range(60):
        assert stepper.step(1 / 60).converged
    assert first.position.x + 0.2 * unit == pytest.approx(wall.position.x, abs=1e-6 * unit)
    assert first.velocity.x == pytest.approx(-0.01 * unit, rel=1e-9)
    assert second.velocity.x == pytest.approx(-0.01 * unit if joined else 0.0, rel=1e-9)


@pytest.mark.parametrize("place", [0.0, 1e-119, 1e-200])
def test_a_wheel_pinned_at_its_middle_at_the_origin_holds_what_it_carries(place: float) -> None:
    """Errors of joints are measured by the size of the component, which has a radius of gyration even where
    coordinates, ways and anchors are 0 or what round-off has left of them."""
    space, wheel, box = pymunk.Space(), pymunk.Body(100.0, 100.0), pymunk.Body(1.0, 1.0 / 6.0)
    space.gravity = 0.0, -10.0
    wheel.position, box.position = (place, 0.0), (0.0, 1.5)
    space.add(wheel, pymunk.Poly.create_box(wheel, (2.0, 2.0)), box, pymunk.Poly.create_box(box, (1.0, 1.0)))
    space.add(pymunk.PivotJoint(space.static_body, wheel, (0.0, 0.0), (0.0, 0.0)))
    stepper = ep.EECA(space)
    for _ in range(10):
        assert stepper.step(0.02).converged
    assert box.position.y == pytest.approx(1.5, abs=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("feet", [False, True])
def test_what_lands_flat_does_not_turn(feet: bool, friction: float) -> None:
    """Both corners of a box without elasticity, or both its feet, meet the floor at once, also in one solve with joints
    (here one that never acts). The first one alone had stopped it, and turned it at up to 9 rad/s."""
    for height in (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2):
        space = pymunk.Space()
        space.gravity = 0.0, -10.0
        floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
        box, other = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 0.1)
        box.position, other.position = (0.0, height), (3.0, 9.0)
        shapes = [pymunk.Circle(box, 0.1, (x, -0.2)) for x in (-0.3, 0.3)]
        space.add(floor, box, other, *(shapes if feet else [pymunk.Poly.create_box(box, (0.6, 0.6))]))
        space.add(pymunk.Circle(other, 0.3), pymunk.SlideJoint(box, other, (0.0, 0.0), (0.0, 0.0), 0.0, 100.0))
        for shape in space.shapes:
            shape.friction = friction
        stepper = ep.EECA(space)
        for _ in range(30):
            stepper.step(1 / 60)
            assert abs(box.angular_velocity) < 1e-6, height  # velocities agree to 1e-6 (AGREE)

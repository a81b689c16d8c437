"""Joints that hang on a body which the program moves or turns: what energy it can give them, whatever converges.

In the frame of a body of constant velocity V and spin w, joints between it and other bodies do no work: Jacobi's
integral K - V . P - w L, with L about its place, does not rise. Gears of other ratios than 1 would change L.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.joint_steps import UNHELD

from ..programs.joined import HOLDS, apart, join, reach
from .test_pairs import drawn


def scene(seed: int) -> tuple[pymunk.Space, pymunk.Body, float]:
    """Bodies of masses up to 1 : 10^4 without weight, some of their joints on a body that moves, turns or both; that
    body; and a length of steps. On one that turns no joint is apart at the start: what closing displaces has another
    velocity of the frame."""
    chance, space = Random(f"driven {seed}"), pymunk.Space()
    shape, count = chance.choice(("one", "two", "chain", "loop")), chance.randint(2, 5)
    wheel, count = pymunk.Body(body_type=pymunk.Body.KINEMATIC), {"one": 1, "two": 2}.get(shape, count)
    wheel.position, way = (-1.0, 0.0), chance.choice(("turns", "moves", "both"))
    if way != "turns":
        wheel.velocity = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0)
    if way != "moves":
        wheel.angular_velocity = chance.choice((0.1, 1.0, 3.0)) * chance.choice((-1.0, 1.0))
    line = [wheel]
    for k in range(count):
        mass = 10.0 ** chance.uniform(-4.0, 0.0)
        body = pymunk.Body(mass, mass * 10.0 ** chance.uniform(-3.0, 0.0))
        body.position, body.velocity = (float(k), 0.0), (chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0))
        body.angular_velocity = chance.uniform(-2.0, 2.0)
        line.append(body)
    space.add(*line)
    long = shape in ("chain", "loop")
    for a, b in [*pairwise(line), *([(line[-1], wheel)] if shape == "loop" else [])]:
        if long:
            space.add(pymunk.PivotJoint(a, b, (a.position + b.position) / 2))
        for _ in range(chance.choice((0, 1)) if long else chance.choice((1, 2, 3))):
            space.add(drawn(chance, a, b))
    if shape in ("chain", "two"):
        for _ in range(chance.choice((1, 2))):
            space.add(drawn(chance, wheel, line[-1]))
    for joint in list(space.constraints):
        if isinstance(joint, pymunk.GearJoint) and wheel.angular_velocity != 0.0:
            joint.ratio = 1.0
        if wheel.angular_velocity != 0.0 and off(joint) > HOLDS:
            space.remove(joint)
    return space, wheel, chance.choice((1 / 240, 1 / 60, 1 / 30, 0.1))


def off(joint: pymunk.Constraint) -> float:
    """How far a joint is apart, over its component, whose size in steps is also a way in them: up to a tenth more."""
    return apart(joint, max(1.0, reach(joint)))


def energies(space: pymunk.Space, wheel: pymunk.Body, dt: float) -> tuple[float, float]:
    """Jacobi's integral, and the scale of its terms: kinetic energy, and that of the motion with the frame. Over a step
    an impulse acts along 2 tan(w dt/2)."""
    w, jacobi, scale = 2.0 * math.tan(0.5 * wheel.angular_velocity * dt) / dt, 0.0, 0.0
    for body in space.bodies:
        if body is not wheel:
            v, r, spin = body.velocity - wheel.velocity, body.position - wheel.position, body.angular_velocity
            led = wheel.velocity + w * r.perpendicular()
            jacobi += 0.5 * body.mass * v.dot(v) + 0.5 * body.moment * spin * spin
            jacobi -= w * (body.mass * r.cross(v) + body.moment * spin)
            scale += 0.5 * body.mass * (body.velocity.dot(body.velocity) + led.dot(led))
            scale += 0.5 * body.moment * (spin * spin + w * w)
    return jacobi, scale


@pytest.mark.parametrize("seed", [*range(120), 167, 199, 211])
def test_a_body_that_moves_or_turns_gives_joints_no_more_energy_than_its_motion_can(seed: int) -> None:
    """But for torques, which act along w dt: by (w dt)²/12 of their work. Joints of converged steps hold."""
    space, wheel, dt = scene(seed)
    stepper = ep.EECA(space)
    turned, (last, before) = wheel.angular_velocity * dt, energies(space, wheel, dt)
    apart_before = max(map(off, space.constraints), default=0.0)
    for _ in range(20):
        report = stepper.step(dt)
        ledger = report.ledger
        now, scale = energies(space, wheel, dt)
        assert ledger is not None
        assert now - last <= (1e-9 + turned**2 / 12.0) * (scale + before)
        assert abs(ledger.residual) <= 1e-9 * (scale + before)
        assert min(ledger.restitution, ledger.friction, ledger.damping) >= -1e-9 * (scale + before)
        apart_now = max(map(off, space.constraints), default=0.0)
        assert apart_now <= 1.1 * HOLDS or apart_before > HOLDS or not report.converged
        last, before, apart_before = now, scale, apart_now


@pytest.mark.parametrize("spin", [0.0, 2.0])
def test_the_work_of_a_support_is_the_same_by_impulses_and_by_the_balance_of_momentum(spin: float) -> None:
    """A pendulum and a spring on a body that moves and turns."""
    space, wheel, body = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 0.1)
    space.gravity, wheel.velocity, wheel.angular_velocity = (0.0, -9.81), (1.0, 0.5), spin
    body.position = 1.0, 0.0
    space.add(wheel, body, pymunk.PivotJoint(wheel, body, (0.3, 0.2)))
    space.add(pymunk.DampedSpring(wheel, body, (0.0, 1.0), (0.2, 0.0), 0.5, 20.0, 0.3))
    stepper = ep.EECA(space)
    for _ in range(5):
        assert stepper.step(1 / 60).converged
        assert stepper.event_loop is not None
        part = stepper.event_loop.joints.RUNG_LEDGER
        assert abs(part.supports) > 1e-3
        assert part.frame_work == pytest.approx(part.supports, rel=1e-11)


@pytest.mark.parametrize("kind", ["spring", "motor", "friction"])
def test_a_wheel_that_twists_a_body_on_a_pivot_is_paid_for_by_nothing_else(kind: str) -> None:
    """A torque acts along w dt, which the balance of momentum takes for 2 tan(w dt/2): the difference, 3e-3 of its work
    here, is neither a loss nor a gain. The work of the wheel is that of the impulses on it."""
    space, wheel, body = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 0.1)
    wheel.angular_velocity, body.position = 6.0, (0.5, 0.0)
    joint: pymunk.Constraint = pymunk.DampedRotarySpring(wheel, body, 0.0, 5.0, 0.0)
    if kind != "spring":
        joint = pymunk.SimpleMotor(wheel, body, 3.0) if kind == "motor" else pymunk.GearJoint(wheel, body, 0.0, 1.0)
        joint.max_force = 0.3
    space.add(wheel, body, pymunk.PivotJoint(wheel, body, (0.2, 0.0)), joint)
    stepper = ep.EECA(space)
    stepper.step(1 / 30)  # velocities are made to fit the pivot
    for _ in range(10):
        ledger = stepper.step(1 / 30).ledger
        assert abs(ledger.external) > 1e-3
        assert max(ledger.restitution, abs(ledger.damping)) <= 1e-15
        assert kind == "friction" or ledger.friction == 0.0


@pytest.mark.parametrize("driver", ["infinite moment", "kinematic"])
@pytest.mark.parametrize(("spin", "dt", "off"), [(3.0, 1 / 60, 1e-3), (10.0, 1 / 60, 0.01), (3.0, 0.1, 0.1)])
def test_what_a_gear_alone_holds_to_a_spin_keeps_its_momentum_and_gets_no_energy_but_by_its_torque(
    driver: str, spin: float, dt: float, off: float
) -> None:
    """Two bodies on a pivot, with a limit and a gear that contradict each other: no step of theirs converges. The place
    of what turns them counts for nothing: in a frame of its spin about any point that moves with their centre, Jacobi's
    integral does not rise, but for torques, by (w dt)²/12 of their work. Their momentum is 0."""
    space, far = pymunk.Space(), pymunk.Body(1.0, math.inf)
    if driver == "kinematic":
        far.body_type = pymunk.Body.KINEMATIC
    far.position, far.angular_velocity = (-5.0, 0.0), spin
    a, b = pymunk.Body(1.0, 0.3), pymunk.Body(0.5, 0.1)
    b.position = 1.0, 0.0
    space.add(far, a, b, pymunk.GearJoint(far, a, 0.0, 1.0), pymunk.PivotJoint(a, b, (0.5, 0.0)))
    space.add(pymunk.RotaryLimitJoint(a, b, -0.5, 0.0), pymunk.GearJoint(a, b, off, 1.0))
    stepper, last = ep.EECA(space), 0.0
    for _ in range(40):
        report = stepper.step(dt)
        momentum = a.mass * a.velocity + b.mass * b.velocity
        scale = a.mass * a.velocity.length + b.mass * b.velocity.length
        assert momentum.length <= 1e-11 * scale
        kinetic, turning = ep.measure(space).kinetic, 0.0
        for body in (a, b):
            turning += body.mass * body.position.cross(body.velocity) + body.moment * body.angular_velocity
        now = kinetic - spin * turning
        assert now - last <= (1e-9 + (spin * dt) ** 2 / 12.0) * (kinetic + abs(spin * turning))
        assert abs(report.ledger.residual) <= 1e-11 * (kinetic + abs(spin * turning))
        assert far.velocity == (0.0, 0.0)
        last = now


@pytest.mark.parametrize("seed", [56, 68, 96, 103, 109, 140, 151, 188, 247])
def test_the_ledger_closes_where_joints_contradict_spins_of_infinite_moment(seed: int) -> None:
    """Bodies of one to three, some of which cannot be turned, on random joints that no motion fits: supports that move
    apart are no frame, impulses reach 1e13, and their works cancel only up to round-off."""
    chance, space = Random(f"spins {seed}"), pymunk.Space()
    bodies = [space.static_body]
    for k in range(chance.choice((1, 1, 2, 3))):
        mass = 10 ** chance.uniform(-1, 1)
        body = pymunk.Body(mass, math.inf if k == 0 or chance.random() < 0.6 else 1.0)
        body.position, body.angle = (chance.uniform(-1, 1), chance.uniform(-1, 1)), chance.uniform(-1, 1)
        body.velocity = chance.uniform(-2, 2), chance.uniform(-2, 2)
        body.angular_velocity = chance.uniform(-2, 2)
        bodies.append(body)
        space.add(body)
    for _ in range(chance.choice((2, 2, 3, 4))):
        a = chance.choice(bodies[1:])
        b = chance.choice([body for body in bodies if body is not a])
        p, q = ((chance.uniform(-0.5, 0.5), chance.choice((0, 0.2))) for _ in range(2))
        space.add(chance.choice((
            lambda a=a, b=b, p=p, q=q: pymunk.PivotJoint(a, b, p, q),
            lambda a=a, b=b, p=p, q=q: pymunk.GrooveJoint(a, b, (0, 0), p, q),
            lambda a=a, b=b, p=p, q=q: pymunk.PinJoint(a, b, p, q),
            lambda a=a, b=b, p=p, q=q: pymunk.SlideJoint(a, b, p, q, 0.1, 0.5),
            lambda a=a, b=b: pymunk.GearJoint(a, b, 0.1, 1 + chance.random()),
            lambda a=a, b=b: pymunk.RotaryLimitJoint(a, b, -0.1, 0.1),
        ))())  # fmt: skip
    stepper, dt = ep.EECA(space), chance.choice((1 / 240, 1 / 60, 0.1))
    for _ in range(4):
        ledger = stepper.step(dt).ledger
        scale = ep.measure(space).kinetic + abs(ledger.external) + abs(ledger.change)
        assert abs(ledger.residual) <= 1e-9 * scale


def crank(ratio: float, mass: float, at: float, spin: float) -> tuple[pymunk.Space, Callable[[float], float]]:
    """A wheel of radius .5 that turns, a rod `ratio` times as long, and a piston in a groove on the ground; and
    the kinetic energy of the exact motion by the angle of the wheel."""
    space, wheel = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wheel.angular_velocity, radius, length = spin, 0.5, 0.5 * ratio
    p = pymunk.Vec2d(radius * math.cos(at), radius * math.sin(at))
    q = pymunk.Vec2d(p.x + math.sqrt(length**2 - p.y**2), 0.0)
    rod, piston = pymunk.Body(1.0, 0.1 * length**2), pymunk.Body(mass, math.inf)
    rod.position, rod.angle, piston.position = (p + q) / 2, (q - p).angle, q
    space.add(wheel, rod, piston, pymunk.PivotJoint(wheel, rod, p), pymunk.PivotJoint(rod, piston, q))
    space.add(pymunk.GrooveJoint(space.static_body, piston, (-50.0, 0.0), (50.0, 0.0), (0.0, 0.0)))

    def energy(angle: float) -> float:
        tilt = -math.asin(math.sin(angle) / ratio)
        turn = -spin * math.cos(angle) / (ratio * math.cos(tilt))
        speed = -radius * spin * math.sin(angle) - length * math.sin(tilt) * turn
        x = -radius * spin * math.sin(angle) - 0.5 * length * math.sin(tilt) * turn
        y = radius * spin * math.cos(angle) + 0.5 * length * math.cos(tilt) * turn
        return 0.5 * (mass * speed**2 + x * x + y * y + rod.moment * turn**2)

    return space, energy


def test_a_crank_that_its_wheel_drives_through_a_dead_centre_loses_nothing() -> None:
    """What the piston gains and loses, without an impact, is work of the wheel, also in steps whose joints are elastic
    for a moment, at the dead centre."""
    space, _ = crank(1.0001, 1.0, 0.3, 10.0)
    stepper, gave = ep.EECA(space), 0
    stepper.step(1 / 30)  # velocities are made to fit the joints
    for _ in range(200):
        report = stepper.step(1 / 30)
        assert report.ledger.restitution <= 1e-9 * ep.measure(space).kinetic
        gave += report.ledger.external != 0.0
    assert gave > 100


def test_supports_that_tear_joints_apart_do_all_the_work() -> None:
    """Where two bodies that the program moves tear three on pins apart, what these lose is work of the two: linear
    steps lose nothing themselves."""
    space, ends = pymunk.Space(), [pymunk.Body(body_type=pymunk.Body.KINEMATIC) for _ in range(2)]
    ends[0].velocity, ends[1].position, ends[1].velocity = (-10.0, 0.0), (3.0, 0.0), (10.0, 3.0)
    links = [pymunk.Body(1.0, 0.1) for _ in range(3)]
    for i, link in enumerate(links):
        link.position = i + 0.5, 0.0
    space.add(*ends, *links, pymunk.PinJoint(ends[0], links[0], (0.0, 0.0), (-0.5, 0.2)))
    space.add(*(pymunk.PinJoint(a, b, (0.5, 0.0), (-0.5, 0.2)) for a, b in pairwise(links)))
    space.add(pymunk.PivotJoint(links[-1], ends[1], (3.0, 0.0)))
    stepper, linear, losses = ep.EECA(space), 0, 0
    stepper.step(0.1)  # velocities are made to fit the joints
    for _ in range(12):
        before = ep.measure(space).kinetic
        report = stepper.step(0.1)
        assert stepper.event_loop is not None
        linear += stepper.event_loop.joints.TALLY.worst == UNHELD
        losses += ep.measure(space).kinetic < before
        assert report.ledger.restitution <= 1e-9 * before
    assert min(linear, losses) >= 3


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("ratio", [1.0001, 1.001, 1.01, 1.05, 1.2])
@pytest.mark.parametrize(("spin", "dt"), [(10.0, 1 / 60), (10.0, 1 / 30), (30.0, 1 / 60)])
def test_a_wheel_gives_a_crank_no_more_energy_than_its_motion_has(
    ratio: float, mass: float, spin: float, dt: float
) -> None:
    """Also where steps of half a radian pass dead centres at which the rod turns round: the speeds at the end of a step
    are off there, and nothing conserves energy that would keep them from growing."""
    space, energy = crank(ratio, mass, 1.0, spin)
    most = max(energy(2.0 * math.pi * k / 2000) for k in range(2000))
    stepper = ep.EECA(space)
    for _ in range(200):
        stepper.step(dt)
        assert ep.measure(space).kinetic <= 1.6 * most


@pytest.mark.parametrize("seed", [12, 87, 108])
def test_the_ledger_closes_where_joints_throw_bodies_that_are_caught_again(seed: int) -> None:
    """Between bodies that the program moves apart, elastic joints give speeds of which joints then keep next to none:
    the works of both are a million times what is left."""
    R, space = Random(f"ledx {seed}"), pymunk.Space()
    space.gravity = 0, R.choice((0, -9.81))
    driven, led = list[pymunk.Body](), list[pymunk.Body]()
    for _ in range(R.choice((1, 2, 2, 3))):
        body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        body.position, way = (R.uniform(-2, 2), R.uniform(-2, 2)), R.choice(("spin", "move", "both", "rest"))
        if way in ("spin", "both"):
            body.angular_velocity = R.uniform(-1, 1) * R.choice((1, 5, 20))
        if way in ("move", "both"):
            body.velocity = R.uniform(-1, 1), R.uniform(-1, 1)
        driven.append(body)
    for _ in range(R.randint(1, 6)):
        mass = 10 ** R.uniform(-2, 2)
        body = pymunk.Body(mass, mass * 10 ** R.uniform(-2, 0) if R.random() > 0.15 else math.inf)
        body.position, body.angle = (R.uniform(-2, 2), R.uniform(-2, 2)), R.uniform(-3, 3)
        led.append(body)
    space.add(*driven, *led)
    if R.random() < 0.3:
        for body in led:
            if R.random() < 0.6:
                disk = pymunk.Circle(body, 0.3)
                disk.elasticity, disk.friction = R.choice((0, 1)), 0.5
                space.add(disk)
    for _ in range(R.randint(2, 8)):
        a = R.choice(led)
        space.add(join(R, a, R.choice([b for b in (*driven, *led, space.static_body) if b is not a]), 1.0, a.mass))
    stepper, dt = ep.EECA(space), R.choice((1 / 240, 1 / 60, 1 / 60, 1 / 30, 0.1))
    for _ in range(90):
        ledger = stepper.step(dt).ledger
        now = ep.measure(space)
        scale = now.kinetic + abs(now.potential) + abs(ledger.external) + abs(ledger.change) + ledger.friction
        assert abs(ledger.residual) <= 1e-9 * scale

"""Islands that stand still are not solved again, keep their forces, and wake in the step in which something happens."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.piles import pile

from ..crowds import SHORT

DT, G = 1 / 60, 9.81
UNITS = (1e-3, 1.0, 1e3)


def stack(count: int = 3, unit: float = 1.0) -> tuple[pymunk.Space, list[pymunk.Body], pymunk.Body]:
    """Boxes of mass 1 and side `unit` on a kinematic floor, with gravity G unit; the floor."""
    space = pymunk.Space()
    space.gravity = (0.0, -G * unit)
    floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    ground = pymunk.Segment(floor, (-20 * unit, 0.0), (20 * unit, 0.0), 0.0)
    ground.friction = 0.7
    space.add(floor, ground)
    bodies = []
    for i in range(count):
        body = pymunk.Body(1.0, unit * unit / 6)
        body.position = (0.0, (0.5 + i) * unit)
        shape = pymunk.Poly.create_box(body, (unit, unit))
        shape.friction = 0.7
        space.add(body, shape)
        bodies.append(body)
    return space, bodies, floor


def at_rest(count: int = 3, unit: float = 1.0) -> tuple[ep.EECA, list[pymunk.Body], pymunk.Body]:
    space, bodies, floor = stack(count, unit)
    stepper = ep.EECA(space)
    for _ in range(5):
        report = stepper.step(DT)
    assert report.iterations == 0, "the stack is solved though nothing happens"
    return stepper, bodies, floor


@pytest.mark.parametrize("unit", UNITS)
def test_a_stack_stands_exactly_and_its_contacts_bear_its_weight(unit: float) -> None:
    stepper, bodies, _ = at_rest(10, unit)
    places = [(tuple(b.position), b.angle) for b in bodies]
    for _ in range(100):
        report = stepper.step(DT)
        assert report.iterations == 0
        assert report.ledger is not None
        assert report.ledger.residual == 0.0
    assert [(tuple(b.position), b.angle) for b in bodies] == places
    assert sum(report.impulse) == pytest.approx(G * unit * DT * 55, rel=1e-9)
    report = stepper.step(DT / 2)
    assert report.iterations == 0
    assert sum(report.impulse) == pytest.approx(G * unit * DT / 2 * 55, rel=1e-9)


@pytest.mark.parametrize("unit", UNITS)
def test_coming_to_a_stand_closes_the_ledger(unit: float) -> None:
    space, bodies, _ = stack(3, unit)
    bodies[2].position += (0.0, 0.01 * unit)
    stepper, scale = ep.EECA(space), 0.01 * G * unit * unit
    solved = []
    for _ in range(60):
        report = stepper.step(DT)
        solved.append(report.iterations)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-11 * scale
        assert min(report.ledger.restitution, report.ledger.friction) >= -1e-13 * scale
    assert solved[0] > 0
    assert solved[-1] == 0


def push(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    bodies[1].velocity = (1.0, 0.0)


def pull(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    bodies[1].apply_force_at_local_point((30.0, 0.0))


def weigh(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    stepper.space.gravity = (8.0, -G)


def place(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    bodies[2].position += (0.1, 0.1)


def carry(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    floor.velocity = (0.5, 0.0)


def grease(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    stepper.space.gravity = (1.0, -G)
    next(iter(bodies[0].shapes)).friction = 0.0


def remove(stepper: ep.EECA, bodies: list[pymunk.Body], floor: pymunk.Body) -> None:
    stepper.space.remove(bodies[0], *bodies[0].shapes)


@pytest.mark.parametrize("act", [push, pull, weigh, place, carry, grease, remove])
def test_it_wakes_at_once(act: Callable[[ep.EECA, list[pymunk.Body], pymunk.Body], None]) -> None:
    stepper, bodies, floor = at_rest()
    act(stepper, bodies, floor)
    before = bodies[1].position
    report = stepper.step(DT)
    assert bodies[1].position != before or report.iterations > 0
    for _ in range(3):
        stepper.step(DT)
    assert max(b.velocity.length for b in bodies[1:]) > 1e-3


def test_a_body_that_hits_it_hits_it_in_the_same_step() -> None:
    stepper, bodies, _ = at_rest()
    ball = pymunk.Body(1.0, 0.1)
    ball.position = (3.05, 2.5)
    ball.velocity = (-6.0, 0.0)
    shape = pymunk.Circle(ball, 0.3)
    shape.elasticity = 1.0
    stepper.space.add(ball, shape)
    # The gap of 2.25 closes after .375 s, which is 22.5 steps.
    for step in range(30):
        before = ball.velocity.x
        report = stepper.step(DT)
        if ball.velocity.x != before:
            break
        assert report.iterations == 0 or step < 5
    assert step == 22
    assert bodies[2].velocity.x < -1e-2
    assert report.ledger is not None
    assert abs(report.ledger.residual) < 1e-11


def test_what_a_handler_decides_wakes_it_when_it_decides_otherwise() -> None:
    """A box on a slope, whose friction is a handler's: it is at rest as long as that holds it, and slides without it by
    g sin a dt in each step."""
    space, slope = pymunk.Space(), 0.3
    space.gravity = (G * math.sin(slope), -G * math.cos(slope))
    floor, box = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0), pymunk.Body(1.0, 1 / 6)
    box.position = (0.0, 0.5)
    shape = pymunk.Poly.create_box(box, (1.0, 1.0))
    shape.collision_type = 1
    space.add(floor, box, shape)
    friction = [0.5]

    def decide(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.friction = friction[0]

    space.on_collision(1, None, pre_solve=decide)
    stepper = ep.EECA(space)
    for _ in range(5):
        report = stepper.step(DT)
    assert report.iterations == 0
    friction[0] = 0.0
    stepper.step(DT)
    assert box.velocity.x == pytest.approx(G * math.sin(slope) * DT, rel=1e-9)
    friction[0] = 0.5
    for _ in range(60):
        report = stepper.step(DT)
    assert report.iterations == 0
    assert box.velocity.length == 0.0


def test_spaces_in_which_jointed_bodies_do_not_collide_rest() -> None:
    """The joint's `collide_bodies` is a law of a pair that stays the same."""
    space, bodies, _ = stack(3)
    for k in range(2):
        ball = pymunk.Body(1.0, 1.0)
        ball.position = (5.0 + 0.5 * k, 0.5)
        space.add(ball, pymunk.Circle(ball, 0.5))
        bodies.append(ball)
    pin = pymunk.PinJoint(*bodies[3:])
    pin.collide_bodies = False
    space.add(pin)
    stepper = ep.EECA(space)
    for _ in range(5):
        report = stepper.step(DT)
    assert report.iterations == 0
    assert sum(report.impulse) == pytest.approx(8.0 * G * DT, rel=1e-9)


def test_without_weight_nothing_comes_to_a_stand() -> None:
    space, bodies, _ = stack()
    space.gravity = (0.0, 0.0)
    for body in bodies:
        body.velocity = (0.0, 1e-12)
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
    assert all(b.velocity.y == 1e-12 for b in bodies)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("friction", [0.0, 0.7])
def test_what_slides_or_rolls_slowly_goes_on(friction: float, unit: float) -> None:
    """A block without friction keeps its speed, and so does a disk that rolls: nothing takes that."""
    space = pymunk.Space()
    space.gravity = (0.0, -G * unit)
    ground = pymunk.Segment(space.static_body, (-20 * unit, 0.0), (20 * unit, 0.0), 0.0)
    ground.friction = friction
    body = pymunk.Body(1.0, unit * unit / 2)
    shape = pymunk.Circle(body, unit) if friction else pymunk.Poly.create_box(body, (2 * unit, 2 * unit))
    shape.friction = friction
    body.position = (0.0, unit)
    speed = 1e-5 * G * unit * DT
    body.velocity = (speed, 0.0)
    body.angular_velocity = -speed / unit if friction else 0.0
    space.add(ground, body, shape)
    stepper = ep.EECA(space)
    for _ in range(100):
        stepper.step(DT)
    assert body.velocity.x == pytest.approx(speed, rel=1e-9)
    assert body.position.x == pytest.approx(100 * DT * speed, rel=1e-9)


@pytest.mark.parametrize("friction", [0.0, 1.0])
def test_a_disk_spins_on_where_nothing_rubs(friction: float) -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    body = pymunk.Body(1.0, 0.5)
    body.position, body.angular_velocity = (0.0, 1.0), 1e-4
    shape = pymunk.Circle(body, 1.0)
    shape.friction = friction
    space.add(body, shape, pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.0))
    stepper = ep.EECA(space)
    for _ in range(20):
        report = stepper.step(DT)
    assert body.angular_velocity == 1e-4
    assert report.iterations == 0 or friction > 0.0, "a disk that nothing can stop from spinning stands as well"


@pytest.mark.parametrize("unit", UNITS)
def test_a_tall_stack_that_is_put_down_at_once_rests_from_the_first_step(unit: float) -> None:
    """Nothing moves, so that static forces are looked for before motion is: no sweeps carry its weight to the floor."""
    count = 30 if SHORT else 100
    space, bodies, _ = stack(count, unit)
    places = [(tuple(b.position), b.angle) for b in bodies]
    stepper = ep.EECA(space)
    for k in range(3):
        report = stepper.step(DT)
        assert k == 0 or report.iterations == 0
        assert [(tuple(b.position), b.angle) for b in bodies] == places
        borne = sum(report.impulse[report.contacts.point[:, 1] < 0.5 * unit])
        assert borne == pytest.approx(count * G * unit * DT, rel=1e-8)


def test_a_crowd_is_solved_a_few_times_a_step_however_often_it_is_hit() -> None:
    """A rain of disks: each hit on what lies together would be a solve of all of it."""
    space = pile("disks", 40 if SHORT else 300, 0.5, 0.5)
    stepper, solved = ep.EECA(space), []
    for _ in range(30 if SHORT else 120):
        stepper.step(DT)
        solved.append(int(stepper._method.scene.COUNT.solved))  # type: ignore[attr-defined]
    assert sum(solved) < 1.2 * len(solved) * len(space.bodies)
    assert max(solved) < 10 * len(space.bodies)


@pytest.mark.parametrize("seed", [230, 266, 330])
def test_what_rests_beside_others_that_do_not_is_awake_again(seed: int) -> None:
    """A rod leans on a disk, with friction, but not enough to stand. The program stops both now and then: the disk,
    beside the rod that is held, is put to rest; the rod is not, so that both are solved as one island. That counted as
    at rest, and the ledger had no losses for its motion (random scene 63008752)."""
    chance = Random(seed)
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    radius, mass = chance.uniform(0.3, 0.6), 10.0 ** chance.uniform(-1.0, 1.0)
    disk = pymunk.Body(mass, 0.4 * mass * radius * radius)
    disk.position = 0.0, radius
    slope = chance.uniform(0.3, 1.2)
    foot = radius / math.tan(0.5 * slope)
    half, mass = chance.uniform(0.6, 1.2) * foot, 10.0 ** chance.uniform(-1.0, 1.0)
    rod = pymunk.Body(mass, 0.4 * mass * half * half)
    rod.position, rod.angle = (foot - half * math.cos(slope), half * math.sin(slope)), math.pi - slope
    shapes = floor, pymunk.Circle(disk, radius), pymunk.Segment(rod, (-half, 0.0), (half, 0.0), 0.0)
    for shape in shapes:
        shape.friction = 1.0
    shapes[2].friction, shapes[2].elasticity = chance.choice((0.3, 1.0)), chance.choice((0.0, 1.0))
    space.add(disk, rod, *shapes)
    stepper, chance, scale = ep.EECA(space), Random(seed + 0.5), 10.0 * (disk.mass + rod.mass)
    for _ in range(40):
        act = chance.random()
        if act < 0.5:
            rod.velocity, rod.angular_velocity = (0.0, 0.0), 0.0
        if act < 0.4:
            disk.velocity, disk.angular_velocity = (0.0, 0.0), 0.0
        elif 0.5 <= act < 0.6:
            disk.velocity = 1e-6, 0.0
        report = stepper.step(chance.choice((1 / 240, 1 / 60)))
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-14 * scale


@pytest.mark.parametrize("pinned", [0, 1, 2])
def test_what_rests_on_a_body_that_is_welded_rests_on(pinned: int) -> None:
    """Whatever place the body has in its island, contacts act in the step in which joints begin to hold it."""
    stepper, bodies, _ = at_rest()
    space, body = stepper.space, bodies[pinned]
    space.add(
        pymunk.PivotJoint(space.static_body, body, body.position),
        pymunk.GearJoint(space.static_body, body, body.angle, 1.0),
    )
    where = [b.position for b in bodies]
    for _ in range(3):
        report = stepper.step(DT)
        assert report.converged
        assert max((b.position - at).length for b, at in zip(bodies, where, strict=True)) < 1e-15
        assert max(b.velocity.length for b in bodies) < 1e-15
        c, up = report.contacts, report.impulse * report.contacts.normal[:, 1]
        for body in bodies[:pinned] + bodies[pinned + 1 :]:
            i = c.bodies.index(body)
            assert up[c.body_b == i].sum() - up[c.body_a == i].sum() == pytest.approx(G * DT, rel=1e-9)

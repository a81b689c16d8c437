"""What stands carries what moves on it, as long as it can."""

from __future__ import annotations

import random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.bodies import CHANGED

from .test_at_rest import DT, UNITS, G

R, SPEED = 0.2, 0.5  # of the disk that rolls, in units


def plank(unit: float) -> tuple[pymunk.Space, pymunk.Body, pymunk.Body, pymunk.Body]:
    """A plank of mass 1 on a pedestal of half-width unit / 2, and a disk of mass 1 that is to roll along it."""
    space = pymunk.Space()
    space.gravity = (0.0, -G * unit)
    shapes: list[pymunk.Shape] = [pymunk.Segment(space.static_body, (-20 * unit, 0.0), (20 * unit, 0.0), 0.0)]
    bodies = []
    for mass, width, height, y in ((5.0, 1.0, 0.5, 0.25), (1.0, 4.0, 0.2, 0.6)):
        body = pymunk.Body(mass, pymunk.moment_for_box(mass, (width * unit, height * unit)))
        body.position = (0.0, y * unit)
        shapes.append(pymunk.Poly.create_box(body, (width * unit, height * unit)))
        bodies.append(body)
    disk = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0.0, R * unit))
    disk.position = (-0.4 * unit, (0.7 + R) * unit)
    shapes.append(pymunk.Circle(disk, R * unit))
    bodies.append(disk)
    for shape in shapes:
        shape.friction = 0.8
    space.add(*bodies, *shapes)
    return space, bodies[0], bodies[1], disk


@pytest.mark.parametrize("unit", UNITS)
def test_a_plank_carries_a_disk_until_its_weight_tips_it(unit: float) -> None:
    """About the pedestal's edge at 1/2: the plank's weight holds the disk's until that is at 1."""
    space, pedestal, board, disk = plank(unit)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    start = (*board.position, board.angle, *pedestal.position)
    disk.velocity, disk.angular_velocity = (SPEED * unit, 0.0), -SPEED / R
    begun, alone, energy = disk.position.x, 0, ep.measure(space).energy
    scale = G * unit * unit
    for k in range(1, 1000):
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * scale
        assert ep.measure(space).energy <= energy + 1e-12 * scale
        energy = ep.measure(space).energy
        if disk.position.x > 1.001 * unit:
            break
        alone += 1 if stepper._method.scene.COUNT.solved <= 1 else 0  # type: ignore[attr-defined]
        assert disk.position.x == pytest.approx(begun + SPEED * unit * k * DT, abs=1e-9 * unit)
        if disk.position.x < 0.999 * unit:
            now = (*board.position, board.angle, *pedestal.position)
            assert now == pytest.approx(start, abs=1e-9 * unit)
            floor = 0.0
            for z in range(len(report.contacts)):
                a = report.contacts.bodies[report.contacts.body_a[z]]
                b = report.contacts.bodies[report.contacts.body_b[z]]
                if space.static_body in (a, b):
                    floor += float(report.impulse[z] * abs(report.contacts.normal[z, 1]))
            assert floor == pytest.approx(7.0 * G * unit * DT, rel=1e-8)
    assert alone > 0.8 * k, "what stands is solved though it only carries"
    for _ in range(20):
        stepper.step(DT)
    assert board.angle < -1e-3
    assert pedestal.position == pytest.approx(start[3:], abs=1e-6 * unit)


def test_what_stands_lets_go_when_it_is_hit() -> None:
    space, _, board, disk = plank(1.0)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    disk.velocity, disk.angular_velocity = (SPEED, 0.0), -SPEED / R
    for _ in range(20):
        stepper.step(DT)
    ball = pymunk.Body(3.0, 1.0)
    ball.position, ball.velocity = (-1.9, 1.2), (0.0, -4.0)
    space.add(ball, pymunk.Circle(ball, 0.2))
    for _ in range(20):
        stepper.step(DT)
    assert board.angle > 1e-2
    assert disk.velocity.y > 0.0 or disk.position.y > 0.91


def test_an_elastic_box_on_a_belt_leans_on_an_elastic_wall() -> None:
    """Only the belt's friction presses it against the wall, no external force: it stays. The belt does mu m g |v| dt
    of work, which friction takes."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    belt = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    belt.surface_velocity, belt.friction = (-0.02, 0.0), 0.5
    wall = pymunk.Segment(space.static_body, (-1.0, 0.0), (-1.0, 5.0), 0.0)
    body = pymunk.Body(1.0, 0.1)
    body.position = -0.5, 0.5
    box = pymunk.Poly.create_box(body, (1.0, 1.0))
    box.friction = 1.0
    belt.elasticity = wall.elasticity = box.elasticity = 1.0
    space.add(belt, wall, body, box)
    stepper = ep.EECA(space)
    for _ in range(20):
        report = stepper.step(1 / 60)
        assert report.converged
        assert report.ledger is not None
        assert report.ledger.external == pytest.approx(0.5 * 9.81 * 0.02 / 60, rel=1e-9)
    assert body.position == pytest.approx((-0.5, 0.5), abs=1e-12)


def stacks(R: random.Random) -> tuple[pymunk.Space, list[list[pymunk.Body]], float]:
    """A random scene: stacks of boxes, those of each, disks that bounce and roll between and on them, and dt."""
    space, found = pymunk.Space(), []
    space.gravity = 0.0, -G
    e, mu = R.choice([0.0, 0.3, 0.8]), R.choice([0.3, 0.8])
    floor = pymunk.Segment(space.static_body, (-30, 0), (30, 0), 0.0)
    floor.elasticity, floor.friction = e, mu
    space.add(floor)
    for k in range(R.randint(1, 4)):
        stack, y = [], 0.0
        for _ in range(R.randint(1, 4)):
            high, wide, mass = R.uniform(0.5, 1.0), R.uniform(1.5, 2.5), R.choice([0.1, 1.0, 5.0])
            body = pymunk.Body(mass, pymunk.moment_for_box(mass, (wide, high)))
            body.position = 6 * k - 12 + R.uniform(-0.1, 0.1), y + high / 2
            y += high
            shape: pymunk.Shape = pymunk.Poly.create_box(body, (wide, high))
            shape.elasticity, shape.friction = e, mu
            space.add(body, shape)
            stack.append(body)
        found.append(stack)
    for _ in range(R.randint(2, 5)):
        mass, r = R.choice([0.1, 1.0]), R.uniform(0.1, 0.3)
        body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0.0, r))
        body.position = R.choice([-15, -9, -3, 3, 9, 15]) + R.uniform(-0.8, 0.8), R.uniform(1.0, 6.0)
        body.velocity = R.choice([0.0, R.uniform(-1.0, 1.0)]), 0.0
        shape = pymunk.Circle(body, r)
        shape.elasticity, shape.friction = R.choice([0.9, 1.0]), mu
        space.add(body, shape)
    return space, found, R.choice([1 / 240, 1 / 60, 1 / 60, 1 / 30, 0.1])


@pytest.mark.parametrize("seed", [2, 3, 26, 61, 78])
def test_arbiters_of_what_rests_hold_its_weight(seed: int) -> None:
    """The impulses on a body that a step leaves at rest are those of its weight, whatever rolls on it, hits what rolls
    on it, or has left it."""
    space, found, dt = stacks(random.Random(seed))
    stepper, checked = ep.EECA(space), 0
    for _ in range(120):
        before = {b: (b.position, b.angle, b.velocity.length) for stack in found for b in stack}
        stepper.step(dt)
        for body, (place, angle, speed) in before.items():
            if speed > 0.0 or body.velocity.length > 0.0 or body.position != place or body.angle != angle:
                continue
            total: list[pymunk.Vec2d] = []
            body.each_arbiter(lambda arbiter, kept: kept.append(arbiter.total_impulse), total)
            weight = body.mass * G * dt
            assert abs(sum(j.x for j in total)) <= 1e-7 * weight
            assert abs(sum(j.y for j in total)) == pytest.approx(weight, rel=1e-7)
            checked += 1
    assert checked > 100


@pytest.mark.parametrize("seed", [1, 8, 12])
def test_a_larger_island_that_wakes_its_support_ends_its_contacts(seed: int) -> None:
    """Boxes that fall on others at rest. If what moves is united with its support before the interval of that ends, and
    is the root of both, contacts of the support go on as those of an island that there is not, and are mixed with later
    ones of its number: the ledger is open by up to 4e-6 of the energy."""
    chance, space = random.Random(seed), pymunk.Space()
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.1)
    floor.friction = 0.6
    space.add(floor)
    for i in range(7):
        body = pymunk.Body(1.0, 1 / 6)
        body.position = (chance.uniform(-1.5, 1.5), 8.0 - 1.3 * i + (12.0 if i < 3 else 0.0))
        body.angle = chance.uniform(-0.3, 0.3)
        shape = pymunk.Poly.create_box(body, (1.0, 1.0))
        shape.friction = 0.5
        space.add(body, shape)
    stepper = ep.EECA(space)
    for _ in range(150):
        stepper.step(1 / 20)
        assert stepper.event_loop is not None
        assert all(member.rest != CHANGED for member in stepper.event_loop.scene.MEMBER)

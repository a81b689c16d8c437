"""Impacts on jointed bodies, through the public stepper: at their instants, passed on by joints, energy exact."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pymunk
import pytest
from scipy.integrate import solve_ivp

import eeca_pymunk as ep
from scenes.scene import add_disk

from .measures import angular_momentum, apart, energy, momentum


def pendulum_at_wall(scale: float = 1.0) -> tuple[pymunk.Space, pymunk.Body]:
    """A bob on a rod of length 1, released level, and a wall that it touches where it hangs straight."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81 * scale
    bob = pymunk.Body(1.0, 0.1 * scale**2)
    bob.position = scale, 0.0
    disk = pymunk.Circle(bob, 0.1 * scale)
    disk.elasticity = 1.0
    wall = pymunk.Segment(space.static_body, (-0.2 * scale, -3.0 * scale), (-0.2 * scale, 0.0), 0.1 * scale)
    wall.elasticity = 1.0
    space.add(bob, disk, wall, pymunk.PinJoint(space.static_body, bob))
    return space, bob


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_pendulum_bounces_without_loss(scale: float) -> None:
    space, bob = pendulum_at_wall(scale)
    stepper = ep.EECA(space)
    start, bounces = energy(space), 0
    for _ in range(400):
        report = stepper.step(1.0 / 60.0)
        bounces += report.impulse.size
        assert abs(report.ledger.residual) < 1e-13 * 9.81 * scale**2
        assert abs(bob.position.length - scale) < 1e-13 * scale
        assert bob.position.x > -1e-12 * scale
    assert bounces >= 5
    assert abs(energy(space) - start) < 1e-12 * 9.81 * scale**2


def test_order_through_impacts() -> None:
    # What bounces where it hangs straight is the mirror image of what swings on: |angle| of the free pendulum.
    duration = 2.0
    exact = solve_ivp(
        lambda _, y: (y[1], -9.81 * math.sin(y[0])), (0.0, duration), (0.5 * math.pi, 0.0), rtol=1e-12, atol=1e-13
    )
    angle = abs(exact.y[0, -1])
    errors = []
    for steps in (40, 80, 160):
        space, bob = pendulum_at_wall()
        stepper = ep.EECA(space)
        for _ in range(steps):
            stepper.step(duration / steps)
        errors.append(abs(math.atan2(bob.position.x, -bob.position.y) - angle))
    slopes = -np.diff(np.log2(errors))
    assert slopes.min() > 3.5, errors


@pytest.mark.parametrize("elasticity", [1.0, 0.5])
def test_free_pair_is_hit(elasticity: float) -> None:
    space = pymunk.Space()
    bodies = [pymunk.Body(1.0 + 0.5 * i, 0.3) for i in range(3)]
    for body, at in zip(bodies, [(0.0, 0.0), (1.0, 0.1), (-3.0, 0.3)], strict=True):
        body.position = at
        disk = pymunk.Circle(body, 0.3)
        disk.elasticity, disk.friction = math.sqrt(elasticity), 0.0 if elasticity == 1.0 else 0.8
        space.add(body, disk)
    bodies[2].velocity = 4.0, 0.0
    space.add(pymunk.PivotJoint(bodies[0], bodies[1], (0.5, 0.2)))
    stepper = ep.EECA(space)
    start, linear, angular = energy(space), momentum(space), angular_momentum(space)
    lost = 0.0
    for _ in range(100):
        report = stepper.step(0.02)
        lost += report.ledger.restitution + report.ledger.friction
        assert abs(report.ledger.residual) < 1e-13 * start
    assert np.abs(momentum(space) - linear).max() < 1e-12 * np.abs(linear).max()
    assert abs(angular_momentum(space) - angular) < 1e-11 * abs(angular)
    assert abs(energy(space) + lost - start) < 1e-12 * start
    assert (lost > 0.01 * start) == (elasticity < 1.0)
    assert apart(space) < 1e-12


def test_cradle_on_rods() -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    # Gaps make impacts come one after the other; bobs that touch share them.
    bodies, pitch = [], 1.0 + 1e-6
    for i in range(5):
        bob = pymunk.Body(1.0, 0.1)
        swing = math.radians(30.0) if i == 0 else 0.0
        bob.position = pitch * i - 3.0 * math.sin(swing), -3.0 * math.cos(swing)
        disk = pymunk.Circle(bob, 0.5)
        disk.elasticity = 1.0
        space.add(bob, disk, pymunk.PinJoint(space.static_body, bob, (pitch * i, 0.0)))
        bodies.append(bob)
    stepper = ep.EECA(space)
    start, quiet, far = energy(space), 0.0, 0.0
    for n in range(200):
        stepper.step(1.0 / 60.0)
        if n < 130:  # one swing of the last bob
            quiet = max(quiet, *(abs(b.velocity) for b in bodies[1:4]))
            far = max(far, bodies[4].position.x - 4.0 * pitch)
    assert quiet < 1e-4
    assert far == pytest.approx(3.0 * math.sin(math.radians(30.0)), rel=1e-3)
    assert abs(energy(space) - start) < 1e-12 * abs(start)
    assert apart(space) < 1e-12


@pytest.mark.parametrize("elasticity", [0.0, 0.5])
@pytest.mark.parametrize("ways", [(-2.0, -2.0), (-2.0, 2.0), (2.0, -2.0), (2.0, 2.0)])
def test_what_is_conveyed_into_a_corner_keeps_out_of_it(elasticity: float, ways: tuple[float, float]) -> None:
    """Each wall presses a disk into the other one, by as much as that one by friction 1 presses it into this: no finite
    impulses satisfy Coulomb's law, and of thirty steps one may spend its work on that."""
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    wall = pymunk.Segment(space.static_body, (0.0, -5.0), (0.0, 5.0), 0.0)
    floor.surface_velocity, wall.surface_velocity = (ways[0], 0.0), (0.0, ways[1])
    disk, other = pymunk.Body(1.0, 0.1), pymunk.Body(0.1, 0.01)
    disk.position, other.position = (1.0, 1.0), (2.0, 2.0)
    disk.velocity = other.velocity = -3.0, -3.0
    shape = pymunk.Circle(disk, 0.5)
    for each in (floor, wall, shape):
        each.friction = 1.0
    floor.elasticity = wall.elasticity = elasticity
    shape.elasticity = 1.0
    space.add(floor, wall, disk, other, shape, pymunk.Circle(other, 0.2), pymunk.PinJoint(disk, other))
    most = energy(space)
    stepper, unmet = ep.EECA(space), 0
    for _ in range(30):
        report = stepper.step(1 / 30)
        unmet += not report.converged
        assert abs(report.ledger.external) <= 1.1 * most
        assert min(disk.position) >= 0.5 - 1e-6
    assert unmet <= 1


@pytest.mark.parametrize("off", [0.0, 0.3])
def test_an_impact_does_not_stop_a_spin_of_infinite_moment(off: float) -> None:
    """A wheel of infinite moment, a body joined to it, and what falls on that body; with the pivot off its centre the
    wheel works."""
    space = pymunk.Space()
    wheel, other, ball = pymunk.Body(1.0, math.inf), pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    wheel.angular_velocity, other.position = 1.0, (2.0, 0.0)
    ball.position, ball.velocity = (2.0, 1.0), (0.0, -3.0)
    for body in (wheel, other, ball):
        shape = pymunk.Circle(body, 0.3)
        shape.elasticity = 0.8
        space.add(body, shape)
    space.add(pymunk.PivotJoint(wheel, other, (off, 0.0), (off - 2.0, 0.0)))
    stepper, hits = ep.EECA(space), 0
    for _ in range(20):
        report = stepper.step(1.0 / 60.0)
        hits += report.impulse.size
        assert wheel.angular_velocity == 1.0
        assert off > 0.0 or abs(report.ledger.external) < 1e-13
    assert hits > 0


@pytest.mark.parametrize(
    ("balls", "ratio", "gap", "first", "every"),
    [(8, 50, 0.0006, 0.0075, 0.001), (4, 100, 0.0019, 0.0035, 0.003), (4, 20, 0.0019, 0.0082, 0.002)],
)
def test_what_a_limit_pushes_to_a_wall_is_not_in_it_when_another_impact_ends_its_interval(
    balls: int, ratio: float, gap: float, first: float, every: float
) -> None:
    """A disk bounces to and fro between a wall and a heavy plate behind it, which meets others meanwhile: within a part
    of the interval the plate turns it to the wall again. It comes no deeper than one interval allows, a 20th of its
    size."""
    space = pymunk.Space()
    wall = pymunk.Segment(space.static_body, (0.0, -3.0), (0.0, 3.0), 0.0)
    light, heavy = pymunk.Body(1.0, 1.0), pymunk.Body(ratio, ratio)
    light.position, heavy.position = (-0.1 - gap, 0.0), (-1.0, 0.0)
    light.velocity = heavy.velocity = 1.0, 0.0
    far = light.position.x - heavy.position.x
    joint = pymunk.SlideJoint(heavy, light, (0, 0), (0, 0), far, far + 1.0)
    joint.collide_bodies = False
    shapes = [wall, pymunk.Circle(light, 0.1), pymunk.Poly.create_box(heavy, (0.2, 4.0))]
    space.add(*shapes, light, heavy, joint)
    for k in range(balls):
        ball = pymunk.Body(0.01, 1e-5)
        ball.position = -0.85 + first + every * k, (-1) ** k * (0.5 + 0.18 * (k // 2))
        shapes.append(pymunk.Circle(ball, 0.05))
        space.add(ball, shapes[-1])
    for shape in shapes:
        shape.elasticity = 1.0
    stepper = ep.EECA(space)
    for _ in range(3):
        assert stepper.step(1 / 60).converged
        assert light.position.x + 0.1 < 0.0052


HOLDS: dict[str, Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]] = {
    "pin": pymunk.PinJoint,
    "slide": lambda a, b: pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0.0, 1.0),
    "pivot": lambda a, b: pymunk.PivotJoint(a, b, (0, -1), (0, 0)),
}


@pytest.mark.parametrize("elasticity", [0.2, 1.0])
@pytest.mark.parametrize("links", [1, 3])
@pytest.mark.parametrize("kind", HOLDS)
def test_impulses_of_joints_have_their_answers_to_impacts(kind: str, links: int, elasticity: float) -> None:
    """A ball of mass m and speed v hits the last one of a chain: along taut joints each bears (1 + e) m v, across them
    none, but a pivot off the centre of a body, which turns with it."""
    dt, mass, speed = 1e-5, 2.0, 3.0
    for way, expected in (((0.0, -1.0), (1.0 + elasticity) * mass * speed), ((1.0, 0.0), 0.0)):
        if kind == "pivot" and expected == 0.0:
            continue
        space, last = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.STATIC)
        for k in range(links):
            ball = add_disk(space, (0.0, -k - 1.0), 0.1)
            space.add(HOLDS[kind](last, ball))
            last = ball
        hits = add_disk(space, last.position - (0.2 + dt) * pymunk.Vec2d(*way), 0.1, mass, speed * pymunk.Vec2d(*way))
        next(iter(hits.shapes)).elasticity = elasticity
        report = ep.EECA(space).step(dt)
        assert len(report.contacts) == 1
        told = [joint.impulse for joint in space.constraints]
        assert told == pytest.approx([expected] * links, abs=2.0 * speed**2 * dt)


@pytest.mark.parametrize("drift", [(0.0, 0.0), (7.0, -4.0)])
def test_answers_of_joints_to_impacts_are_the_same_on_a_partner_that_moves(drift: tuple[float, float]) -> None:
    """A ball that hangs from a kinematic body is hit along its pin, seen from another frame (Galilei)."""
    dt, mass, speed = 1e-5, 2.0, 3.0
    space, nail = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    nail.velocity = drift
    ball = add_disk(space, (0.0, -1.0), 0.1, velocity=drift)
    hits = add_disk(space, (0.0, -0.8 + dt), 0.1, mass, (drift[0], drift[1] - speed))
    next(iter(hits.shapes)).elasticity = 0.5
    space.add(nail, pymunk.PinJoint(nail, ball))
    ep.EECA(space).step(dt)
    (pin,) = space.constraints
    assert pin.impulse == pytest.approx(1.5 * mass * speed, abs=2.0 * speed**2 * dt)


def test_what_is_hit_as_often_as_a_step_allows_lands_on_all_else() -> None:
    """A chain of fifty planks falls on six humps of different heights, each an impact on all of it: two are, in a
    step; it lands on the others without, and none is passed over."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    for k in range(6):
        space.add(pymunk.Circle(space.static_body, 0.1, (2.0 + 6.0 * k, -0.1 - 0.008 * k)))
    planks = [pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.8, 0.2))) for _ in range(50)]
    for k, plank in enumerate(planks):
        plank.position, plank.velocity = (0.8 * k, 0.3), (0.0, -5.0)
        shape = pymunk.Poly.create_box(plank, (0.78, 0.2))
        shape.filter = pymunk.ShapeFilter(group=1)
        space.add(plank, shape)
    for k, (one, two) in enumerate(itertools.pairwise(planks)):
        space.add(pymunk.PivotJoint(one, two, (0.8 * k + 0.4, 0.3)))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.0, 0.5
    stepper = ep.EECA(space)
    before, touched = energy(space), set[int]()
    for _ in range(6):
        report = stepper.step(1.0 / 60.0)
        assert report.converged
        touched |= set(np.round((report.contacts.point[:, 0] - 2.0) / 6.0).astype(int))
        assert energy(space) <= before + 1e-10 * 9.81 * 50.0
        before = energy(space)
    assert touched == set(range(6))


@pytest.mark.parametrize("left", [2e-9, 9e-10, 1e-10, 1e-11, 1e-12])
def test_a_rod_that_bounces_just_before_the_end_of_a_step_ends_it(left: float) -> None:
    """`left`: of the step. No interval is begun for that, and none ends again and again."""
    space, dt = pymunk.Space(), 0.01
    wall = pymunk.Segment(space.static_body, (0.0, -5.0), (0.0, 5.0), 0.0)
    wall.elasticity = 1.0
    space.add(wall)
    ends = []
    for x in (0.0, -2.0):
        body = pymunk.Body(1.0, 1.0)
        body.position, body.velocity = (x - 0.5 - dt * (1.0 - left), 0.0), (1.0, 0.0)
        shape = pymunk.Circle(body, 0.5)
        shape.elasticity = 1.0
        space.add(body, shape)
        ends.append(body)
    space.add(pymunk.PinJoint(*ends))
    report = ep.EECA(space).step(dt)
    assert report.converged
    assert [body.velocity.x for body in ends] == pytest.approx([-1.0, -1.0], abs=1e-8)

"""Kinematic bodies that their own velocity functions accelerate: what is on them or hangs on them moves as with a
uniform gravity that is less by this acceleration (equivalence principle)."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import pymunk
import pytest

import eeca_pymunk as ep

Vector = tuple[float, float]
G, CLOSES = 9.81, 1e-12


def accelerate(body: pymunk.Body, by: Vector) -> None:
    """Let a body of the program gain the velocity `by` dt in each step."""

    def faster(body: pymunk.Body, _gravity: Vector, _damping: float, dt: float) -> None:
        body.velocity += dt * pymunk.Vec2d(*by)

    body.velocity_func = faster


def driven(by: Vector, gravity: bool) -> tuple[pymunk.Space, pymunk.Body]:
    """A space with a kinematic body that `by` accelerates or, in its frame, with the gravity -by."""
    space, body = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    if gravity:
        space.gravity = -by[0], -by[1]
    else:
        accelerate(body, by)
    space.add(body)
    return space, body


def play(
    space: pymunk.Space, base: pymunk.Body, dt: float, steps: int, closure: ep.Closure | None = None
) -> list[Vector]:
    """Places of all bodies relative to the base after each step, at the end also their velocities; ledgers close."""
    stepper, found = ep.EECA(space, closure), list[Vector]()
    others = [body for body in space.bodies if body is not base]
    for _ in range(steps):
        ledger = stepper.step(dt).ledger
        assert ledger is not None
        assert abs(ledger.residual) <= CLOSES * (abs(ledger.change) + ep.measure(space).kinetic + 1.0)
        found += [tuple(body.position - base.position) for body in others]
    return found + [tuple(body.velocity - base.velocity) for body in others]


def off(
    make: Callable[[bool], tuple[pymunk.Space, pymunk.Body]], dt: float, steps: int, closure: ep.Closure | None = None
) -> float:
    """How far both ways to see a scene come apart."""
    ways = [play(*make(gravity), dt, steps, closure) for gravity in (False, True)]
    return max(math.dist(p, q) for p, q in zip(*ways, strict=True))


@pytest.mark.parametrize("kind", ["pin", "pivot", "spring"])
@pytest.mark.parametrize("count", [1, 3])
def test_what_hangs_on_an_accelerated_hand(kind: str, count: int) -> None:
    def make(gravity: bool) -> tuple[pymunk.Space, pymunk.Body]:
        space, last = driven((4.0, 10.0), gravity)
        hand = last
        for k in range(count):
            body = pymunk.Body(1.0, 0.1)
            body.position = 0.0, -1.0 - k
            joint: pymunk.Constraint = pymunk.PinJoint(last, body)
            if kind == "pivot":
                joint = pymunk.PivotJoint(last, body, (0.0, -float(k)))
            elif kind == "spring":
                joint = pymunk.DampedSpring(last, body, (0.0, 0.0), (0.0, 0.0), 1.0, 500.0, 0.1)
            space.add(body, joint)
            last = body
        return space, hand

    assert off(make, 1 / 60, 60) <= 1e-11


def floor(by: Vector, gravity: bool, elasticity: float, bodies: list[tuple[pymunk.Body, pymunk.Shape]]) -> tuple[
    pymunk.Space, pymunk.Body
]:  # fmt: skip
    """Bodies above a plate that is accelerated."""
    space, plate = driven(by, gravity)
    ground = pymunk.Segment(plate, (-50.0, 0.0), (50.0, 0.0), 0.0)
    space.add(ground)
    for body, shape in bodies:
        space.add(body, shape)
    for shape in space.shapes:
        shape.elasticity, shape.friction = elasticity, 0.5
    return space, plate


def ball() -> list[tuple[pymunk.Body, pymunk.Shape]]:
    body = pymunk.Body(1.0, 0.1)
    body.position, body.angular_velocity = (0.0, 1.5), 1.0
    return [(body, pymunk.Circle(body, 0.5))]


def boxes() -> list[tuple[pymunk.Body, pymunk.Shape]]:
    found = []
    for k in range(3):
        body = pymunk.Body(1.0, 0.1)
        body.position, body.angle = (0.05 * k, 0.6 + 1.1 * k), 0.1 * k
        found.append((body, pymunk.Poly.create_box(body, (1.0, 1.0))))
    return found


@pytest.mark.parametrize("elasticity", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("by", [(0.0, G), (3.0, G)])
@pytest.mark.parametrize("closure", [ep.TimeOfImpact(), ep.Midstep()], ids=["time of impact", "midstep"])
def test_a_ball_bounces_and_rolls_on_an_accelerated_plate(
    elasticity: float, by: Vector, closure: ep.Closure
) -> None:  # fmt: skip
    assert off(lambda gravity: floor(by, gravity, elasticity, ball()), 1 / 60, 120, closure) <= 1e-11


@pytest.mark.parametrize(("up", "dt"), [(G, 1 / 60), (G, 0.1), (200.0, 1 / 60), (200.0, 0.1)])
@pytest.mark.parametrize(("elasticity", "joined"), [(0.0, False), (0.5, False), (0.0, True)])
def test_a_stack_comes_to_rest_on_an_accelerated_plate(up: float, dt: float, elasticity: float, joined: bool) -> None:
    """Also one that comes a whole body further in a step. Corrections are not the same in both frames, so that the
    stacks may be."""
    space, plate = floor((0.0, up), False, elasticity, found := boxes())
    if joined:
        for (one, _), (two, _) in pairwise(found):
            space.add(pymunk.PivotJoint(one, two, tuple((one.position + two.position) / 2)))
    play(space, plate, dt, 240)
    for body, shape in found:
        assert (body.velocity - plate.velocity).length <= 1e-6 * up * dt + 1e-15 * plate.velocity.length / dt
        assert shape.cache_bb().bottom >= plate.position.y - 1e-2


def test_what_is_at_rest_on_a_plate_that_begins_to_rise_goes_with_it() -> None:
    space, plate = floor((0.0, 0.0), False, 0.0, found := boxes()[:1])
    space.gravity = 0.0, -G
    stepper, (body, _) = ep.EECA(space), found[0]
    for _ in range(60):
        stepper.step(1 / 60)
    accelerate(plate, (0.0, 2.0))
    above = body.position.y
    for _ in range(60):
        stepper.step(1 / 60)
        assert abs(body.position.y - plate.position.y - above) <= 1e-9
        assert (body.velocity - plate.velocity).length <= 1e-9

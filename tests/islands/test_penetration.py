"""Bodies that are put into others come apart, at no cost where nothing has to be paid."""

from __future__ import annotations

import math

import pymunk
import pytest
from pymunk import Vec2d

import eeca_pymunk as ep
from eeca_pymunk.model.parameters.intervals import CORRECTION_STEP

DT = 1 / 60


def disk(space: pymunk.Space, at: Vec2d, radius: float, velocity: Vec2d, mass: float = 1.0) -> pymunk.Body:
    body = pymunk.Body(mass, 0.5 * mass * radius**2)
    body.position, body.velocity = at, velocity
    shape = pymunk.Circle(body, radius)
    shape.elasticity = 0.8
    space.add(body, shape)
    return body


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("apart", [0.0, 0.02, 1.3])
@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_disks_made_in_one_another_fly_on_side_by_side(unit: float, apart: float, gravity: float) -> None:
    """Their centre of mass flies as ever, and no energy comes from parting them; they end at a distance of 2 r."""
    space = pymunk.Space()
    space.gravity = 0.0, gravity * unit
    velocity = Vec2d(3.0, 4.0) * unit
    pair = [disk(space, Vec2d(k * apart * unit, 0.0), unit, velocity, 1.0 + k) for k in range(2)]
    stepper = ep.EECA(space)
    start = ep.measure(space)
    for k in range(30):
        book = stepper.step(DT).ledger
        assert book is not None
        scale = unit**2 * (50.0 + 20.0 * k)
        assert abs(book.residual) <= 1e-14 * scale
        assert abs(book.restitution) <= 1e-14 * scale
    t = 30 * DT
    middle = (pair[0].position + 2.0 * pair[1].position) / 3.0
    fall = Vec2d(2.0 * apart / 3.0 * unit, 0.0) + velocity * t + Vec2d(0.0, 0.5 * gravity * unit * t * t)
    assert (middle - fall).length <= 1e-13 * unit * 100.0
    assert (pair[1].position - pair[0].position).length == pytest.approx(2.0 * unit, rel=1e-8)
    end = ep.measure(space)
    assert end.kinetic + end.potential == pytest.approx(start.kinetic + start.potential, rel=1e-13, abs=1e-13 * unit**2)
    if gravity == 0.0:
        assert end.angular_momentum == pytest.approx(start.angular_momentum, abs=1e-12 * unit**2)


def test_a_disk_put_into_a_wall_comes_out_and_one_put_elsewhere_later_too() -> None:
    space = pymunk.Space()
    wall = pymunk.Segment(space.static_body, (0.0, -50.0), (0.0, 50.0), 0.5)
    wall.elasticity = 0.5
    space.add(wall)
    ball = disk(space, Vec2d(1.0, 0.0), 1.0, Vec2d(0.0, -1.0))
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    assert ball.position.x == pytest.approx(1.5, rel=1e-8)
    assert ball.velocity == (0.0, -1.0)
    ball.position = -0.7, 3.0
    for _ in range(10):
        stepper.step(DT)
    assert ball.position.x == pytest.approx(-1.5, rel=1e-8)


def test_many_disks_made_at_one_place_part_in_bounded_steps() -> None:
    space = pymunk.Space()
    disks = [disk(space, Vec2d(0.0, 0.0), 1.0, Vec2d(0.0, 0.0)) for _ in range(12)]
    stepper = ep.EECA(space)
    for _ in range(400):
        book = stepper.step(DT).ledger
        assert book is not None
        assert abs(book.residual) <= 1e-13
    gaps = [(a.position - b.position).length for i, a in enumerate(disks) for b in disks[:i]]
    assert min(gaps) >= 2.0 * (1.0 - 1e-6)


@pytest.mark.parametrize("speed", [0.0, 1.0])
def test_a_floor_that_slides_under_an_overlap_of_others_does_no_work(speed: float) -> None:
    """Without friction a floor that moves along itself does none: what lifts one disk out of another is paid by losses,
    as on a floor that rests."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor.velocity = speed, 0.0
    space.add(floor, pymunk.Segment(floor, (-50.0, 0.0), (50.0, 0.0), 0.1))
    for y in (0.6, 1.4):
        body = pymunk.Body(1.0, 0.1)
        body.position = 0.0, y
        space.add(body, pymunk.Circle(body, 0.5))
    stepper = ep.EECA(space)
    for _ in range(60):
        ledger = stepper.step(1 / 60).ledger
        assert ledger is not None
        assert abs(ledger.external) <= 1e-13


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("arm", [0.02, 0.05, 0.1])
def test_no_point_of_a_body_moves_farther_than_a_quarter_of_its_size_as_overlaps_are_corrected(
    unit: float, arm: float
) -> None:
    """A rod that is easily turned lies on a peg near its middle, which to first order a turn of a radian clears."""
    space = pymunk.Space()
    rod = pymunk.Body(1.0, 1e-4 * unit**2)
    outline = [(-1.0, -0.1), (1.0, -0.1), (1.0, 0.1), (-1.0, 0.1)]
    space.add(rod, pymunk.Poly(rod, [(x * unit, y * unit) for x, y in outline]))
    space.add(pymunk.Circle(space.static_body, 0.1 * unit, (arm * unit, -0.17 * unit)))
    stepper = ep.EECA(space)
    for _ in range(10):
        place, angle = rod.position, rod.angle
        book = stepper.step(DT).ledger
        assert book is not None
        assert book.residual == 0.0
        way = (rod.position - place).length + abs(rod.angle - angle) * math.hypot(1.0, 0.1) * unit
        assert way <= CORRECTION_STEP * math.hypot(1.0, 0.1) * unit * (1.0 + 1e-9)


@pytest.mark.parametrize("unit", [1e-3, 1.0])
@pytest.mark.parametrize("elasticity", [0.0, 1.0])
@pytest.mark.parametrize("deep", [0.01, 0.05, 0.2])
def test_a_correction_leads_no_thin_shape_through_a_wall(deep: float, elasticity: float, unit: float) -> None:
    """A heavy disk, put into a light one, displaces it and the rod below it beyond a floor that the rod does not touch
    yet: its contact is in no interval, and no impact is predicted on a displacement."""
    space, radius, gap = pymunk.Space(), 0.5 * unit, 0.01 * unit
    space.gravity = 0.0, -9.81 * unit
    floor = pymunk.Segment(space.static_body, (-50.0 * unit, 0.0), (50.0 * unit, 0.0), 0.0)
    rod = pymunk.Body(1.0, unit * unit / 3.0)
    rod.position = 0.0, gap
    line = pymunk.Segment(rod, (-unit, 0.0), (unit, 0.0), 0.0)
    floor.elasticity = line.elasticity = elasticity
    space.add(floor, rod, line)
    disk(space, Vec2d(0.0, gap + radius), radius, Vec2d.zero())
    disk(space, Vec2d(0.0, gap + 3.0 * radius - deep * unit), radius, Vec2d.zero(), 1000.0)
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
        assert rod.position.y > -CORRECTION_STEP * radius

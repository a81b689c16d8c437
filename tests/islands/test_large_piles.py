"""Crowds are calmed where something holds them, and only there."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons import piles

from ..crowds import SHORT

DT, G = 1 / 60, 9.81
UNITS = (1e-3, 1.0, 1e3)
FAST = 0.45  # of g dt: slow enough to be calmed, were it held


def wall(friction: float, unit: float, speed: float) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """30 boxes, 6 high, that slide on a floor side by side."""
    space = pymunk.Space()
    space.gravity = (0.0, -G * unit)
    floor = pymunk.Segment(space.static_body, (-50.0 * unit, 0.0), (50.0 * unit, 0.0), 0.0)
    floor.friction = friction
    space.add(floor)
    bodies = []
    for i in range(30):
        body = pymunk.Body(1.0, unit * unit / 6.0)
        body.position = ((i % 5) * unit, (0.5 + i // 5) * unit)
        body.velocity = (speed, 0.0)
        box = pymunk.Poly.create_box(body, (unit, unit))
        box.friction = 1.0
        space.add(body, box)
        bodies.append(body)
    return space, bodies


@pytest.mark.parametrize("unit", UNITS)
def test_what_slides_without_friction_slides_on(unit: float) -> None:
    speed = FAST * G * unit * DT
    space, bodies = wall(0.0, unit, speed)
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert sum(b.velocity.x for b in bodies) == pytest.approx(30 * speed, rel=1e-10)


@pytest.mark.parametrize("unit", UNITS)
def test_what_friction_stops_lies_where_it_would(unit: float) -> None:
    """v^2 / (2 mu g) from its start, but for the way that it falls in a step, twice."""
    speed, mu = 4.0 * FAST * G * unit * DT, 0.05
    space, bodies = wall(mu, unit, speed)
    stepper, scale = ep.EECA(space), 30 * G * 6 * unit * unit
    for _ in range(80):
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * scale
    way = speed * speed / (2.0 * mu * G * unit)
    assert all(b.velocity == (0.0, 0.0) for b in bodies)
    went = sum(b.position.x - (i % 5) * unit for i, b in enumerate(bodies)) / 30
    assert abs(went - way) <= G * unit * DT * DT


def rolls(body: pymunk.Body) -> bool:
    """Whether a disk rolls on the floor without slip, which nothing stops: friction does no work on it."""
    (disk,) = body.shapes
    if not isinstance(disk, pymunk.Circle) or body.position.y - disk.radius > 1e-6 * disk.radius:
        return False
    return abs(body.velocity.x + disk.radius * body.angular_velocity) <= 1e-9 * body.velocity.length


@pytest.mark.skipif(SHORT, reason="takes minutes in plain Python")
@pytest.mark.parametrize(
    ("kind", "count", "elasticity"), [("disks", 300, 0.0), ("mixed", 300, 0.0), ("boxes", 1000, 0.0)]
)
def test_a_large_pile_comes_to_rest(kind: str, count: int, elasticity: float) -> None:
    """A few that rattle about do not keep it awake."""
    space = piles.pile(kind, count, elasticity, 0.5)
    stepper, energy = ep.EECA(space, sync=False), abs(ep.measure(space).energy)
    speeds = [1.0] * 4
    for step in range(800):
        report = stepper.step(piles.DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * energy
        assert min(report.ledger.restitution, report.ledger.friction) >= -1e-13 * energy
        if step % 50 == 49:
            speeds = sorted(0.0 if rolls(b) else b.velocity.length for b in space.bodies)
            if speeds[-4] == 0.0:
                break
    assert speeds[-4] == 0.0, "no more than three may still move, but for disks that roll on the floor"

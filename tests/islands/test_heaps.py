"""Heaps of disks come to a stand, part by part, and their floor bears their weight."""

from __future__ import annotations

import random

import pymunk
import pytest

import eeca_pymunk as ep

from ..crowds import SHORT

DT, G = 1 / 60, 9.81
UNITS = (1e-3, 1.0, 1e3)


def heap(count: int, unit: float) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Disks without bounces that fall on each other between smooth walls, and a little to the right: on a level floor
    a disk between others may roll for ever, as slowly as it likes, and nothing takes that."""
    space = pymunk.Space()
    space.gravity = (0.1 * G * unit, -G * unit)
    for a, b in (((-2.0, 0.0), (2.0, 0.0)), ((-2.0, 0.0), (-2.0, 40.0)), ((2.0, 0.0), (2.0, 40.0))):
        wall = pymunk.Segment(space.static_body, (a[0] * unit, a[1] * unit), (b[0] * unit, b[1] * unit), 0.0)
        wall.friction = 0.7 if a[1] == b[1] else 0.0
        space.add(wall)
    bodies = []
    for i in range(count):
        radius = (0.3 + 0.02 * (7 * i % 11)) * unit
        body = pymunk.Body(1.0, 0.5 * radius * radius)
        body.position = ((-1.2 + 0.8 * (i % 4) + 0.01 * (i % 3)) * unit, (0.5 + 0.85 * (i // 4)) * unit)
        disk = pymunk.Circle(body, radius)
        disk.friction = 0.7
        space.add(body, disk)
        bodies.append(body)
    return space, bodies


def on_the_floor(space: pymunk.Space, report: ep.StepReport) -> float:
    """Vertical impulse that static shapes take, without friction."""
    static = [
        space.static_body in (report.contacts.bodies[a], report.contacts.bodies[b])
        for a, b in zip(report.contacts.body_a, report.contacts.body_b, strict=True)
    ]
    return abs(float(sum(report.impulse[static] * report.contacts.normal[static, 1])))


@pytest.mark.parametrize("unit", UNITS)
def test_a_heap_comes_to_a_stand(unit: float) -> None:
    space, bodies = heap(24, unit)
    stepper, scale = ep.EECA(space), 24 * G * 4 * unit * unit
    for _ in range(500):  # one disk rolls for long on another
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * scale
        assert min(report.ledger.restitution, report.ledger.friction) >= -1e-13 * scale
    assert report.iterations == 0, "the heap is solved though nothing happens"
    assert all(b.velocity == (0.0, 0.0) and b.angular_velocity == 0.0 for b in bodies)
    assert on_the_floor(space, report) == pytest.approx(24 * G * unit * DT, rel=1e-8)


@pytest.mark.parametrize(("count", "seed"), [(18, 39), (18, 53), (22, 58), (40, 59)])
def test_what_stands_part_by_part_bears_its_weight_in_a_sampling_of_heaps(count: int, seed: int) -> None:
    """Some stand before others do: in these, forces below have to follow those of what comes to a stand above."""
    rng = random.Random(seed)
    space, _ = heap(0, 1.0)
    for i in range(count):
        radius = rng.uniform(0.2, 0.4)
        body = pymunk.Body(1.0, 0.5 * radius * radius)
        body.position = (-1.2 + 0.8 * (i % 4) + rng.uniform(-0.05, 0.05), 0.5 + 0.85 * (i // 4))
        disk = pymunk.Circle(body, radius)
        disk.friction = 0.7
        space.add(body, disk)
    stepper = ep.EECA(space)
    for _ in range(600):
        report = stepper.step(DT)
    assert report.iterations == 0
    assert on_the_floor(space, report) == pytest.approx(count * G * DT, rel=1e-8)


@pytest.mark.parametrize("unit", UNITS)
def test_disks_that_nothing_rubs_stand_and_spin_on(unit: float) -> None:
    space, bodies = heap(12 if SHORT else 24, unit)
    for i, body in enumerate(bodies):
        next(iter(body.shapes)).friction = 0.0
        body.angular_velocity = 0.3 * i - 2.0
    spins = [b.angular_velocity for b in bodies]
    stepper, scale = ep.EECA(space), 24 * G * 4 * unit * unit
    for _ in range(400):
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * scale
    assert report.iterations == 0, "the heap is solved though nothing happens"
    assert all(b.velocity == (0.0, 0.0) for b in bodies)
    # Arms of round-off leave a trace while they fall.
    assert [b.angular_velocity for b in bodies] == pytest.approx(spins, abs=1e-6)
    spins, angles = [b.angular_velocity for b in bodies], [b.angle for b in bodies]
    for _ in range(60):
        stepper.step(DT)
    assert [b.angular_velocity for b in bodies] == spins
    assert [b.angle for b in bodies] == pytest.approx([a + w for a, w in zip(angles, spins, strict=True)], abs=1e-9)
    # Friction turns it into motion.
    for body in bodies:
        next(iter(body.shapes)).friction = 1.0
    for _ in range(3):
        stepper.step(DT)
    assert max(b.velocity.length for b in bodies) > 1e-3 * unit

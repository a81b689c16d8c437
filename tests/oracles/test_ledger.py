"""The ledger: closed in every step of every hard case, no loss negative; its work is that of an independent balance."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

from comparisons.hard_cases import Case, crowds, guards, impacts
from comparisons.hard_cases.case import DT, G, heavy, matter
from comparisons.hard_cases.moving import drum
from scenes.scene import add_box, add_disk, add_walls

from .audit import Audit
from .running import check, of


@pytest.mark.parametrize("one", of(impacts, crowds, guards), ids=lambda one: one.name)
def test_case_and_its_ledger(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


@pytest.mark.parametrize("velocity", [(0.0, 0.8), (0.9, 0.0), (-0.4, 0.5), (0.3, -0.6)])
def test_work_of_a_plate_is_its_velocity_times_the_momentum_that_it_gives(velocity: tuple[float, float]) -> None:
    """W = V . (change of momentum - weight t), whatever happens on it."""
    space = heavy()
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    plate.velocity = velocity
    space.add(plate, pymunk.Segment(plate, (-20.0, 0.0), (20.0, 0.0), 0.0))
    for k in range(6):
        where = (1.2 * (k % 3), 0.9 + 1.1 * (k // 3))
        body = add_disk(space, where, 0.4, 1.0 + k) if k % 2 else add_box(space, where, 0.8, 0.6, 1.0 + k)
        body.angle = 0.2 * k
    matter(space, 0.5, 0.4)
    moves = [body for body in space.bodies if body.body_type == pymunk.Body.DYNAMIC]

    def momentum() -> np.ndarray:
        return sum(body.mass * np.array(body.velocity) for body in moves)

    stepper, start = Audit(space), momentum()
    for _ in range(60):
        stepper.step(DT)
    weight = np.array((0.0, -G * sum(body.mass for body in moves)))
    given = momentum() - start - weight * 60 * DT
    assert stepper.total["external"] == pytest.approx(float(given @ velocity), rel=1e-9, abs=1e-9)
    assert abs(float(given @ velocity)) > 1.0


def test_work_of_a_drum_is_its_spin_times_the_angular_momentum_that_it_gives() -> None:
    """Without gravity, where bodies fly and slide along the rim."""
    space = drum(1.0, 0.0, 0.7)
    moves = [body for body in space.bodies if body.body_type == pymunk.Body.DYNAMIC]

    def whirl() -> float:
        return math.fsum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in moves)

    stepper, start = Audit(space), whirl()
    for _ in range(90):
        stepper.step(DT)
    assert stepper.total["external"] == pytest.approx(whirl() - start, rel=1e-9)
    assert abs(whirl() - start) > 1e-3


def test_friction_of_a_box_that_is_hit_while_it_slides_is_booked() -> None:
    space = heavy()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    box = add_box(space, (-2.0, 0.5), 1.0, 1.0, velocity=(4.0, 0.0))
    add_disk(space, (-1.0, 2.0), 0.3, 0.2)
    matter(space, 0.3, 0.5)
    stepper, hits = Audit(space), 0
    for _ in range(60):
        hits += stepper.step(1 / 30).lock == 1.0 and box.velocity.x > 0.1
    assert hits > 10
    assert stepper.total["friction"] > 1.0
    assert stepper.residual <= 1e-12


def test_damping_is_booked() -> None:
    space = heavy(0.0)
    body = add_disk(space, (0.0, 0.0), 0.5, velocity=(3.0, 0.0))
    space.damping = 0.5
    stepper = Audit(space)
    for _ in range(60):
        stepper.step(DT)
    assert stepper.total["damping"] == pytest.approx(4.5 - 0.5 * body.velocity.length**2, rel=1e-12)
    assert stepper.residual <= 1e-12


def test_forces_on_bodies_work() -> None:
    space = heavy()
    body = add_box(space, (0.0, 3.0), 1.0, 1.0)
    stepper, work = Audit(space), 0.0
    for _ in range(30):
        before = body.position
        body.apply_force_at_world_point((2.0, 1.0), body.position)
        stepper.step(DT)
        work += 2.0 * (body.position.x - before.x) + 1.0 * (body.position.y - before.y)
    assert stepper.total["external"] == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("height", [0.0, 1.0])
def test_work_of_what_nothing_turns_is_booked(height: float) -> None:
    """A disk of infinite moment spins on for ever: set down it comes to r omega, and half of the work is rubbed off.

    Dropped, with e = .5, it has the same in the end, and what it falls by on top.
    """
    gravity, radius, spin = 10.0, 0.5, 5.0
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    add_walls(space, [((-50.0, 0.0), (50.0, 0.0))])
    disk = pymunk.Body(2.0, math.inf)
    disk.position, disk.angular_velocity = (0.0, radius + height), spin
    shape = pymunk.Circle(disk, radius)
    space.add(disk, shape)
    for one in space.shapes:
        one.friction, one.elasticity = math.sqrt(0.4), math.sqrt(0.5)
    stepper = Audit(space)
    for _ in range(180):
        stepper.step(DT)
    speed = radius * spin
    assert disk.velocity == pytest.approx((-speed, 0.0), abs=1e-9)
    assert disk.angular_velocity == spin
    assert stepper.total["external"] == pytest.approx(2.0 * speed**2, rel=1e-9)
    assert stepper.total["friction"] == pytest.approx(speed**2, rel=1e-9)
    assert stepper.total["restitution"] == pytest.approx(2.0 * gravity * height, rel=1e-9, abs=1e-12)
    assert stepper.residual <= 1e-12

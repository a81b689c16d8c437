"""Contacts between bodies that redundant joints make one rigid body: they are left out, whatever the joints' order."""

from __future__ import annotations

from itertools import permutations

import pymunk
import pytest

import eeca_pymunk as ep

DT = 0.02
PINS = (((0, 0), (0, 20)), ((0, 0), (0, -20)), ((0, 20), (0, 0)), ((0, -20), (0, 0)))


def held(order: tuple[int, ...]) -> float:
    """The angle after 2 s of a disk that four pins hold to a box, pulled back by a force in its own frame, in a space
    with damping; each pin but three is redundant."""
    space = pymunk.Space()
    space.damping = 0.9
    disk = pymunk.Body(10.0, pymunk.moment_for_circle(10.0, 0.0, 10.0))
    box = pymunk.Body(5.0, pymunk.moment_for_box(5.0, (20.0, 20.0)))
    box.position = (60.0, 5.0)
    skin, cube = pymunk.Circle(disk, 10.0), pymunk.Poly.create_box(box, (20.0, 20.0))
    skin.collision_type, cube.collision_type = 1, 2
    space.add(disk, skin, box, cube)
    pins: list[pymunk.PinJoint] = []

    def grasp(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if not pins:
            pins.extend(pymunk.PinJoint(disk, box, *PINS[k]) for k in order)

    space.on_collision(1, 2, pre_solve=grasp)
    stepper = ep.EECA(space)
    while not pins:
        disk.apply_force_at_local_point((30.0, 0.0))
        stepper.step(DT)
    for pin in pins:  # one by one: pymunk adds what comes from a callback in no order
        space.add(pin)
    for _ in range(100):
        energy = disk.kinetic_energy + box.kinetic_energy
        disk.apply_force_at_local_point((-30.0, 0.0))
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-11 * energy
    return float(disk.angle)


def test_pins_in_any_order_hold_the_same_rigid_body() -> None:
    angles = [held(order) for order in permutations(range(4))]
    assert max(angles) == pytest.approx(min(angles), abs=1e-11)


def test_what_is_thousands_of_times_heavier_bounces_off_redundant_welds() -> None:
    """Its own mobility is a small part of that of the light body, which cannot move: as if it were the error of the
    response, the contact was left out, and the same impact repeated for ever (random scene 26003688)."""
    space = pymunk.Space()
    light, heavy = pymunk.Body(3.5, 0.34), pymunk.Body(5900.0, 115.0)
    heavy.position, heavy.velocity = (-2.0, 0.0), (5.0, 0.0)
    shapes = pymunk.Circle(light, 0.5), pymunk.Circle(heavy, 0.5)
    for shape in shapes:
        shape.elasticity = 1.0
    space.add(light, heavy, *shapes, pymunk.PivotJoint(space.static_body, light, (0, 0)))
    space.add(*(pymunk.GearJoint(space.static_body, light, 0, 1) for _ in range(2)))
    space.add(pymunk.DampedSpring(light, heavy, (0, 0), (0, 0), 2.0, 1e-6, 0.0))
    stepper = ep.EECA(space)
    for _ in range(30):
        assert stepper.step(DT).converged
    assert heavy.velocity.x == pytest.approx(-5.0, rel=1e-6)

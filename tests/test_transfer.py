"""States of pymunk to rows of BODY and back: closed forms of free motion, and what is told of edits."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

from eeca_pymunk import layout as at
from eeca_pymunk import transfer
from eeca_pymunk.geometry.flight import move_to
from eeca_pymunk.space.world import World
from scenes.scene import add_disk

DT = 0.125


def make(gravity: tuple[float, float] = (0.0, 0.0), center: tuple[float, float] = (0.0, 0.0)) -> World:
    """A body of mass 2 and moment 3 at (1, 2) beside static ones."""
    space = pymunk.Space()
    space.gravity = gravity
    one = pymunk.Body(2.0, 3.0)
    one.center_of_gravity = center
    one.angle, one.velocity, one.angular_velocity = 0.5, (0.25, -1.5), 2.0
    one.position = 1.0, 2.0
    space.add(one, pymunk.Circle(one, 0.5))
    pillar = pymunk.Body(body_type=pymunk.Body.STATIC)
    pillar.position, pillar.velocity = (5.0, 6.0), (7.0, 8.0)
    space.add(pillar)
    return World(space)


def the_body(world: World) -> pymunk.Body:
    return next(b for b in world.bodies.items if b.body_type == pymunk.Body.DYNAMIC)


def flown(world: World, dt: float, left: float) -> int:
    """A step of bodies that meet nothing: exact parabolas, constant spin or torque."""
    gx, gy = world.gravity
    status = transfer.read_states(world.STATES, world.IDS, world.EXTRA, world.BODY, gx, gy, left)
    if status < 0:
        return status
    for i in range(len(world.BODY)):
        move_to(world.BODY, i, dt)
    return transfer.write_states(world.STATES, world.IDS, world.EXTRA, world.BODY, world.ENDS, left, status)


def fly(world: World, dt: float = DT, left: float = 1.0) -> int:
    world.gather()
    status = flown(world, dt, left)
    if status >= 0:
        if status & transfer.FORCES:
            world.reset_forces()
        world.scatter(status)
    return status


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_thrown_body_follows_its_parabola(scale: float) -> None:
    world = make(gravity=(scale, -9.81 * scale))
    body = the_body(world)
    body.force, body.torque = (4.0 * scale, 2.0 * scale), 6.0
    a = np.array([3.0, -8.81]) * scale
    assert fly(world) == transfer.FORCES | transfer.TURNS
    assert tuple(body.velocity) == pytest.approx(tuple((0.25, -1.5) + DT * a), rel=1e-15)
    exact = np.array([1.0, 2.0]) + DT * np.array([0.25, -1.5]) + 0.5 * DT**2 * a
    assert tuple(body.position) == pytest.approx(tuple(exact), rel=1e-15)
    assert body.angular_velocity == 2.0 + DT * 2.0
    assert body.angle == 0.5 + DT * 2.0 + 0.5 * DT**2 * 2.0
    assert (body.force, body.torque) == ((0.0, 0.0), 0.0)


def test_static_bodies_stay_whatever_they_hold() -> None:
    world = make()
    pillar = next(b for b in world.space.bodies if b.body_type == pymunk.Body.STATIC)
    pillar.force = (3.0, 4.0)
    fly(world)
    assert (pillar.position, pillar.velocity, pillar.force) == ((5.0, 6.0), (7.0, 8.0), (3.0, 4.0))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_centre_of_mass_flies_and_the_body_turns_about_it(scale: float) -> None:
    center = (0.5 * scale, -0.25 * scale)
    world = make(gravity=(0.0, -1.0), center=center)
    body = the_body(world)
    start, velocity = np.array(body.local_to_world(center)), np.array(body.velocity)
    for n in range(1, 9):
        fly(world)
        t = n * DT
        exact = start + t * velocity + 0.5 * t * t * np.array([0.0, -1.0])
        assert np.array(body.local_to_world(center)) == pytest.approx(exact, rel=1e-14, abs=1e-14)
        assert body.angle == pytest.approx(0.5 + 2.0 * t, rel=1e-14)


def test_kinematic_bodies_feel_neither_gravity_nor_damping() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -1.0)
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    lift.velocity, lift.force = (1.0, 2.0), (5.0, 5.0)
    space.add(lift)
    world = World(space)
    fly(world, left=0.5)
    assert (lift.position, lift.velocity) == ((DT, 2.0 * DT), (1.0, 2.0))
    assert lift.force == (0.0, 0.0)


def test_damping_is_second_order() -> None:
    """x = v0 (1 - exp(-c t)) / c for damping exp(-c)."""
    c, error = 0.7, []
    for n in (8, 16, 32):
        space = pymunk.Space()
        body = add_disk(space, (0.0, 0.0), 0.1, velocity=(1.0, 0.0))
        world = World(space)
        for _ in range(n):
            fly(world, 1.0 / n, math.exp(-0.5 * c / n))
        assert body.velocity.x == pytest.approx(math.exp(-c), rel=1e-14)
        error.append(abs(body.position.x - (1.0 - math.exp(-c)) / c))
    order = np.log2(np.array(error[:-1]) / error[1:])
    assert order == pytest.approx(2.0, abs=0.02)
    assert error[-1] < 1e-4


def void(world: World) -> bool:
    """Whether the forecast of the one moving body became void in a flight."""
    world.BODY["due"] = 1.0
    assert fly(world) >= 0
    assert world.BODY["due"][-1] == 1.0
    return bool(world.BODY["due"][0] < 0.0)


EDITS = {
    "position": lambda b: setattr(b, "position", (b.position.x + 1e-15, b.position.y)),
    "angle": lambda b: setattr(b, "angle", b.angle + 1e-15),
    "velocity": lambda b: setattr(b, "velocity", b.velocity * 1.5),
    "spin": lambda b: setattr(b, "angular_velocity", 0.0),
    "force": lambda b: setattr(b, "force", (1e-9, 0.0)),
    "torque": lambda b: setattr(b, "torque", 1.0),
}


@pytest.mark.parametrize("gravity", [(0.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS.keys())
def test_only_what_was_edited_is_forecast_anew(edit: object, gravity: tuple[float, float]) -> None:
    world = make(gravity=gravity)
    assert void(world)
    assert not void(world)
    assert callable(edit)
    edit(the_body(world))
    assert void(world)
    # The force is gone, which is another edit.
    void(world)
    assert not void(world)
    world.STATES[at.WRITTEN, ~world.bodies.static] = np.nan
    assert void(world)


def test_angles_are_written_only_where_some_body_turns() -> None:
    world = make()
    body = the_body(world)
    assert fly(world) & transfer.TURNS
    body.angular_velocity = 0.0
    angle = body.angle
    assert not fly(world) & transfer.TURNS
    assert (body.angle, body.angular_velocity) == (angle, 0.0)
    # A spin that the step itself gives is written too.
    world.gather()
    world.STATES[at.WRITTEN, 0, 5] = 3.0
    assert world.write_whole() & transfer.TURNS
    world.scatter(transfer.TURNS)
    assert body.angular_velocity == 3.0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("column", range(9))
def test_numbers_that_are_not_finite_are_told(value: float, column: int) -> None:
    world = make()
    fly(world)
    world.gather()
    world.STATES[at.READ, 0, column] = value
    status = transfer.read_states(world.STATES, world.IDS, world.EXTRA, world.BODY, 0.0, 0.0, 1.0)
    assert status == transfer.NOT_FINITE


def test_overflow_other_bodies_and_moved_walls_are_told() -> None:
    world = make()
    the_body(world).velocity = (1e308, 0.0)
    assert fly(world, 100.0) == transfer.OVERFLOW
    world = make()
    next(b for b in world.space.bodies if b.body_type == pymunk.Body.STATIC).angle = 1.0
    assert fly(world) == transfer.MOVED_STATIC
    world = make()
    world.IDS[at.KNOWN_ID, 0] += 1
    assert fly(world) == transfer.OTHER_BODIES

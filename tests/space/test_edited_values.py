"""Edits of elasticity, friction, surface velocity, mass and moment: the results of earlier steps are kept."""

from __future__ import annotations

import math
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.world import World

from ..programs.test_patching import DT, EDITS, KEPT, scene
from ..steppers import state

G = 10.0


def far_away(space: pymunk.Space) -> tuple[pymunk.Shape, pymunk.Body]:
    """A wall and a body that meet nothing."""
    wall = pymunk.Segment(space.static_body, (500, 0), (501, 0), 0.1)
    body = pymunk.Body(1.0, 1.0)
    body.position = 600.0, 0.0
    space.add(wall, body, pymunk.Circle(body, 0.5))
    return wall, body


def box(space: pymunk.Space, x: float, y: float) -> tuple[pymunk.Body, pymunk.Shape]:
    body = pymunk.Body(1.0, 1 / 6)
    body.position = x, y
    shape = pymunk.Poly.create_box(body, (1, 1))
    shape.friction = 1.0
    space.add(body, shape)
    return body, shape


def at_rest(slope: float, count: int, joints: bool) -> tuple[pymunk.Space, pymunk.Shape, list[pymunk.Shape], ep.EECA]:
    """A column of boxes at rest on a floor, with gravity that leans by `slope` (rad)."""
    space = pymunk.Space()
    space.gravity = -G * math.sin(slope), -G * math.cos(slope)
    floor = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0.5)
    floor.friction = 1.0
    space.add(floor)
    boxes = [box(space, 0.0, 1.0 + k)[1] for k in range(count)]
    if joints:
        _, bob = far_away(space)
        space.add(pymunk.PinJoint(space.static_body, bob, (600, 5), (0, 0)))
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
    loop = stepper.event_loop
    assert loop is not None
    assert (loop.scene.MEMBER["rest"] == 1).sum() >= count
    return space, floor, boxes, stepper


@pytest.mark.parametrize("seed", range(8))
def test_the_rows_are_those_of_a_new_reading(seed: int) -> None:
    space, random = scene(seed, 12, 4), Random(seed)
    stepper = ep.EECA(space)
    for _ in range(20):
        for _ in range(3):
            EDITS[random.choice(KEPT)](space, random)
        stepper.step(DT)
        world, anew = stepper._world, World(space)
        assert world is not None
        for name in ("inv_mass", "inv_inertia", "elasticity", "friction"):
            assert world.BODY[name].tobytes() == anew.BODY[name].tobytes()
        assert world.SHAPE.tobytes() == anew.SHAPE.tobytes()
        assert world.bodies.mass.tolist() == anew.bodies.mass.tolist()
    assert stepper.reads == 1
    # A later patch of all rows writes these values.
    for radius in (0.15, 0.16):
        next(shape for shape in space.shapes if isinstance(shape, pymunk.Circle)).unsafe_set_radius(radius)
        stepper.step(DT)
    world, anew = stepper._world, World(space)
    assert world is not None
    assert world.SHAPE.tobytes() == anew.SHAPE.tobytes()


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("count", [3, 12, 30])
@pytest.mark.parametrize("threshold", [math.inf, 0.3])
def test_an_edit_of_what_touches_nothing_changes_nothing(seed: int, count: int, threshold: float) -> None:
    def path(edits: bool) -> list[object]:
        space = scene(seed, count, 4)
        space.sleep_time_threshold = threshold
        wall, body = far_away(space)
        stepper, found = ep.EECA(space), list[object]()
        for k in range(60):
            if edits and k % 3 == 2 and not any(one.is_sleeping for one in space.bodies):  # these would wake
                wall.friction, body.mass = 0.1 + 0.01 * k, 1.0 + 0.1 * k
            report = stepper.step(DT)
            found.append((state(space), report.impulse.tobytes(), report.converged))
        assert stepper.patches > 10 or not edits
        return found

    assert path(True) == path(False)


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("edited", ["floor", "box"])
def test_a_box_at_rest_slides_when_friction_falls(joints: bool, edited: str) -> None:
    """Its acceleration is g (sin a - mu cos a)."""
    slope, mu = 0.3, 0.1
    _, floor, (shape,), stepper = at_rest(slope, 1, joints)
    reads = stepper.reads
    (floor if edited == "floor" else shape).friction = mu
    for _ in range(10):
        stepper.step(DT)
    speed = 10 * DT * G * (math.sin(slope) - mu * math.cos(slope))
    assert shape.body is not None
    assert shape.body.velocity.x == pytest.approx(-speed, rel=1e-9)
    assert stepper.reads == reads
    floor.friction = shape.friction = 1.0
    for _ in range(40):
        stepper.step(DT)
    assert shape.body.velocity.length < 1e-12


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("edited", ["floor", "box"])
@pytest.mark.parametrize("steps", [0, 3])
def test_a_state_of_rest_that_is_set_back_feels_the_friction_of_now(joints: bool, edited: str, steps: int) -> None:
    slope, mu = 0.3, 0.1
    _, floor, (shape,), stepper = at_rest(slope, 1, joints)
    state = stepper.get_state()
    (floor if edited == "floor" else shape).friction = mu
    for _ in range(steps):
        stepper.step(DT)
    stepper.set_state(state)
    for _ in range(10):
        stepper.step(DT)
    assert shape.body is not None
    speed = 10 * DT * G * (math.sin(slope) - mu * math.cos(slope))
    assert shape.body.velocity.x == pytest.approx(-speed, rel=1e-9)


def test_a_state_of_rest_that_is_set_back_bears_the_weight_of_now() -> None:
    _, _, boxes, stepper = at_rest(0.0, 3, joints=False)
    state = stepper.get_state()
    assert boxes[2].body is not None
    boxes[2].body.mass = 5.0
    stepper.set_state(state)
    report = stepper.step(DT)
    on_floor = report.contacts.point[:, 1] < 0.75
    assert report.impulse[on_floor].sum() == pytest.approx(7.0 * G * DT, rel=1e-9)


@pytest.mark.parametrize(("then", "now"), [(1.0, 0.5), (0.5, 1.0)])
def test_whether_shapes_have_losses_is_not_a_matter_of_states(then: float, now: float) -> None:
    """Without losses, gravity and forces no contact can last: such spaces are not searched for those that do."""
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    shape = pymunk.Circle(body, 0.5)
    space.add(body, shape)
    shape.elasticity = then
    stepper = ep.EECA(space)
    state = stepper.get_state()
    shape.elasticity = now
    stepper.set_state(state)
    stepper.step(DT)
    loop = stepper.event_loop
    assert loop is not None
    assert loop.scene.COUNT.lossy == (now < 1.0)


@pytest.mark.parametrize("joints", [False, True])
def test_boxes_on_boxes_at_rest_follow_an_edit_below(joints: bool) -> None:
    """The lowest box and what it bears slide as one: friction between boxes holds."""
    slope, mu = 0.3, 0.2
    _, floor, boxes, stepper = at_rest(slope, 3, joints)
    floor.friction = mu
    for _ in range(5):
        stepper.step(DT)
    speed = 5 * DT * G * (math.sin(slope) - mu * math.cos(slope))
    for shape in boxes:
        assert shape.body is not None
        assert shape.body.velocity.x == pytest.approx(-speed, rel=1e-6)


@pytest.mark.parametrize("joints", [False, True])
def test_a_belt_that_starts_takes_a_box_along(joints: bool) -> None:
    """It accelerates by mu g until it has the speed of the surface."""
    _, floor, (shape,), stepper = at_rest(0.0, 1, joints)
    floor.friction = 0.25
    floor.surface_velocity = 0.5, 0.0
    body = shape.body
    assert body is not None
    for _ in range(3):
        stepper.step(DT)
    started = abs(body.velocity.x)
    assert started == pytest.approx(3 * DT * 0.25 * G, rel=1e-9)
    for _ in range(30):
        stepper.step(DT)
    assert abs(body.velocity.x) == pytest.approx(0.5, rel=1e-9)


def test_contacts_bear_the_weight_of_an_edited_mass() -> None:
    _, _, boxes, stepper = at_rest(0.0, 3, joints=False)
    assert boxes[1].body is not None
    boxes[1].body.mass, boxes[1].body.moment = 7.0, 7.0 / 6
    report = stepper.step(DT)
    on_floor = report.contacts.point[:, 1] < 0.75
    assert report.impulse[on_floor].sum() == pytest.approx(9.0 * G * DT, rel=1e-9)
    assert all(shape.body is not None and shape.body.velocity.length < 1e-12 for shape in boxes)
    assert stepper.reads == 1


@pytest.mark.parametrize("e", [0.0, 0.5, 0.9])
def test_a_ball_bounces_by_the_elasticity_that_was_set_in_flight(e: float) -> None:
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-5, 0), (5, 0), 0.5)
    floor.elasticity = 1.0
    ball = pymunk.Body(1.0, 1.0)
    ball.position, ball.velocity = (0.0, 3.0), (0.0, -2.0)
    shape = pymunk.Circle(ball, 0.5)
    shape.elasticity = 0.2
    space.add(floor, ball, shape)
    stepper = ep.EECA(space)
    for k in range(120):
        if k == 30:
            shape.elasticity = e
        stepper.step(DT)
    assert ball.velocity.y == pytest.approx(2.0 * e, abs=1e-12)


def test_forces_move_the_mass_that_was_set() -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    space.add(body, pymunk.Circle(body, 0.5))
    stepper, speed = ep.EECA(space), 0.0
    for k in range(20):
        body.mass = 1.0 + k
        body.force = 3.0, 0.0
        report = stepper.step(DT)
        speed += 3.0 / (1.0 + k) * DT
        assert body.velocity.x == pytest.approx(speed, rel=1e-12)
        assert abs(report.ledger.residual) < 1e-14 * (1.0 + k)
    assert stepper.reads == 1

"""Midstep: one solve of all contacts of a step, at its middle, of every shape."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from scenes.scene import add_disk, add_walls

GRAVITY = 9.81


def add_box(
    space: pymunk.Space, position: tuple[float, float], elasticity: float = 0.0, friction: float = 0.0
) -> pymunk.Body:  # fmt: skip
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (1.0, 1.0)))
    body.position = position
    shape = pymunk.Poly.create_box(body, (1.0, 1.0))
    shape.elasticity, shape.friction = elasticity, friction
    space.add(body, shape)
    return body


def floor(elasticity: float = 1.0, friction: float = 0.0, slope: float = 0.0, gravity: float = GRAVITY) -> pymunk.Space:
    """A long static line through the origin."""
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    c, s = 50.0 * math.cos(slope), 50.0 * math.sin(slope)
    line = pymunk.Segment(space.static_body, (-c, -s), (c, s), 0.0)
    line.elasticity, line.friction = elasticity, friction
    space.add(line)
    return space


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("bowl", [False, True])
def test_elastic_shapes_that_turn_keep_energy(seed: int, bowl: bool) -> None:
    scene = scenes.build("mixed", seed=seed, bowl=bowl)
    stepper, energy, impacts = ep.EECA(scene.space, ep.Midstep()), ep.measure(scene.space).energy, 0
    for _ in range(200):
        report = stepper.step(scene.dt)
        impacts += len(report.contacts)
        assert (report.psi2 == 0.0).all()
        assert (report.contacts.time == 0.5 * scene.dt).all()
        assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-12)
    assert impacts > 20


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_free_crowd_keeps_all_momenta(unit: float) -> None:
    rng = np.random.default_rng(4)
    space = pymunk.Space()
    for i in range(40):
        place = unit * (0.3 * (i % 8) + 0.02 * rng.normal()), unit * (0.3 * (i // 8) + 0.02 * rng.normal())
        add_disk(space, place, 0.1 * unit, 1.0 + i % 3, tuple(unit * rng.normal(size=2)))
    before, stepper, impacts = ep.measure(space), ep.EECA(space, ep.Midstep()), 0
    for _ in range(100):
        impacts += len(stepper.step(0.01).contacts)
    after = ep.measure(space)
    assert impacts > 20
    assert after.energy == pytest.approx(before.energy, rel=1e-12)
    np.testing.assert_allclose(after.linear_momentum, before.linear_momentum, atol=1e-12 * unit * 40)
    # The normal is that of the predicted middle, not of the instant of touch.
    assert after.angular_momentum == pytest.approx(before.angular_momentum, abs=1e-12 * unit**2 * 40)


def test_a_fast_disk_sends_one_at_rest_into_another_at_rest() -> None:
    # Light ones behind a heavy one are faster than anything was before; nobody may be overrun within the step.
    space = pymunk.Space()
    a = add_disk(space, (0.0, 0.0), 0.1, 100.0, (1.0, 0.0))
    others = [add_disk(space, (0.2 + 0.2 * i + 1e-3 * i, 0.0), 0.1, 0.01) for i in range(1, 5)]
    stepper, energy = ep.EECA(space, ep.Midstep()), ep.measure(space).energy
    for _ in range(3):
        stepper.step(0.1)
        x = np.array([a.position.x] + [b.position.x for b in others])
        assert np.diff(x).min() >= 0.2 - 1e-9
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)


def test_a_stack_of_boxes_rests_and_its_floor_carries_its_weight() -> None:
    space = floor(0.0)
    boxes = [add_box(space, (0.0, 0.5 + k)) for k in range(5)]
    stepper = ep.EECA(space, ep.Midstep())
    for _ in range(120):
        report = stepper.step(1 / 60)
    for k, box in enumerate(boxes):
        np.testing.assert_allclose(box.position, (0.0, 0.5 + k), atol=1e-9)
    ground = report.contacts.bodies.index(space.static_body)
    on_floor = (report.contacts.body_a == ground) | (report.contacts.body_b == ground)
    assert report.impulse[on_floor].sum() == pytest.approx(5 * GRAVITY / 60, rel=1e-9)


@pytest.mark.parametrize("mu", [0.2, 0.7])
def test_a_box_slides_or_sticks_on_a_slope(mu: float) -> None:
    slope = 0.4  # tan .4 = .42
    space = floor(0.0, 1.0, slope)
    box = add_box(space, (-0.5 * math.sin(slope), 0.5 * math.cos(slope)), 0.0, mu)
    box.angle = slope
    stepper, lost = ep.EECA(space, ep.Midstep()), 0.0
    for _ in range(60):
        ledger = stepper.step(1 / 60).ledger
        assert ledger is not None
        assert abs(ledger.residual) <= 1e-12 * GRAVITY
        lost += ledger.friction
    along = -(box.position.x * math.cos(slope) + box.position.y * math.sin(slope))
    pull = max(GRAVITY * (math.sin(slope) - mu * math.cos(slope)), 0.0)
    assert along == pytest.approx(0.5 * pull, abs=1e-9)
    assert lost == pytest.approx(mu * GRAVITY * math.cos(slope) * along if pull else 0.0, abs=1e-9)


def test_a_lossy_pile_never_gains_energy() -> None:
    rng = np.random.default_rng(1)
    space = floor(0.5, 0.4)
    add_walls(space, [((-2.0, 0.0), (-2.0, 9.0)), ((2.0, 0.0), (2.0, 9.0))])
    for i in range(12):
        body = add_box(space, (-1.2 + 1.2 * (i % 3), 0.8 + 1.2 * (i // 3)), 0.4, 0.5)
        body.angle = rng.uniform(-0.4, 0.4)
    stepper, energy = ep.EECA(space, ep.Midstep()), ep.measure(space).energy
    for _ in range(150):
        report = stepper.step(1 / 60)
        now = ep.measure(space).energy
        assert now <= energy + 1e-9 * GRAVITY
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-10
        assert min(report.ledger.restitution, report.ledger.friction) >= -1e-12
        energy = now


def test_order_in_dt_is_one_at_impacts_and_two_in_free_flight() -> None:
    def end(dt: float, drop: float) -> np.ndarray:
        space = floor(1.0, gravity=0.0)
        disk = add_disk(space, (0.0, drop), 0.1, velocity=(0.3, -1.0))
        stepper = ep.EECA(space, ep.Midstep())
        for _ in range(round(1.0 / dt)):
            stepper.step(dt)
        return np.array((*disk.position, *disk.velocity))

    np.testing.assert_allclose(end(0.1, 5.0), (0.3, 4.0, 0.3, -1.0), atol=1e-14)
    # It is at the floor at .4637 s: the impulse acts half a step off at most.
    for dt in (0.1, 0.01, 0.001):
        assert abs(end(dt, 0.5637)[1] - (0.1 + 1.0 - 0.4637)) <= dt


def test_a_kinematic_floor_that_does_not_move_gives_no_energy() -> None:
    """As the program has placed it once, in the first step, it pays for no correction later."""
    rng, space = np.random.default_rng(0), pymunk.Space()
    space.gravity = 0.0, -GRAVITY
    ground = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Poly(ground, [(-20.0, -1.0), (20.0, -1.0), (20.0, 0.0), (-20.0, 0.0)])
    shape.elasticity, shape.friction = 0.3, 0.6
    space.add(ground, shape)
    for k in range(12):
        body = add_box(space, (rng.uniform(-2.0, 2.0), 1.0 + 1.2 * k), 0.3, 0.6)
        body.angle, body.angular_velocity = rng.uniform(0.0, 6.0), rng.uniform(-5.0, 5.0)
    stepper = ep.EECA(space, ep.Midstep())
    for _ in range(120):
        report = stepper.step(1 / 30)
        assert report.ledger is not None
        assert report.ledger.external == 0.0


def test_another_closure_goes_on_without_what_was_at_rest() -> None:
    space = floor(0.0, 0.8)
    boxes = [add_box(space, (0.0, 0.5 + k), friction=0.8) for k in range(2)]
    stepper = ep.EECA(space)
    for _ in range(5):
        stepper.step(1 / 60)
    stepper.closure = ep.Midstep()
    add_box(space, (8.0, 5.0))
    boxes[1].velocity = 0.0, 10.0
    for _ in range(6):
        stepper.step(1 / 60)
        loop = stepper.event_loop
        assert loop is not None
        assert loop.scene.MEMBER["rest"].tolist() == [0, 0, 0, 0]
        assert loop.scene.STATE["version"][-1] == 0  # of the ground
    assert boxes[1].position.y == pytest.approx(1.5 + 1.0 - 0.5 * GRAVITY * 0.01, abs=1e-12)


@pytest.mark.parametrize("turns", [1.0, -1.0])
@pytest.mark.parametrize("kind", ["ratchet", "limit"])
def test_joints_take_their_step_once_whatever_memory_contacts_need(kind: str, turns: float) -> None:
    def path(crowd: int) -> list[tuple[float, float]]:
        space = pymunk.Space()
        wheel = pymunk.Body(1.0, 1.0)
        wheel.position, wheel.angular_velocity = (-50.0, 0.0), turns * 10.0
        rim = pymunk.Circle(wheel, 0.5)
        rim.elasticity = 1.0
        space.add(wheel, rim, pymunk.PivotJoint(space.static_body, wheel, (-50.0, 0.0)))
        if kind == "ratchet":
            space.add(pymunk.RatchetJoint(space.static_body, wheel, 0.0, 0.3))
        else:
            space.add(pymunk.RotaryLimitJoint(space.static_body, wheel, -0.05, 0.05))
        for i in range(crowd * crowd):
            body = pymunk.Body(1.0, 1.0)
            body.position = float(i // crowd), float(i % crowd)
            body.velocity = tuple(0.1 * (0.5 * crowd - x) for x in body.position)
            shape = pymunk.Circle(body, 0.5)
            shape.elasticity = 1.0
            space.add(body, shape)
        stepper, found = ep.EECA(space, ep.Midstep()), []
        for _ in range(3):
            stepper.step(0.1)
            found.append((wheel.angle, wheel.angular_velocity))
        return found

    assert path(12) == path(3)

"""report.unmet: which budget or tolerance was not met, and for which bodies."""

from __future__ import annotations

import pickle

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.parameters.events import BUDGET_TIME


def bouncing(limit: int) -> tuple[ep.EECA, pymunk.Body]:
    """A ball between two walls, hit 20 times a second, and another on its own."""
    space = pymunk.Space()
    for x in (-0.1, 0.1):
        wall = pymunk.Segment(space.static_body, (x, -9), (x, 9), 0.0)
        wall.elasticity = 1.0
        space.add(wall)
    bodies = []
    for x, v in ((0.0, 2.0), (5.0, 2.0)):
        body = pymunk.Body(1.0, 1.0)
        body.position, body.velocity = (x, 0.0), (v, 0.0)
        shape = pymunk.Circle(body, 0.05)
        shape.elasticity = 1.0
        space.add(body, shape)
        bodies.append(body)
    return ep.EECA(space, ep.TimeOfImpact(max_impacts=limit)), bodies[0]


def test_a_step_that_meets_all_has_nothing_to_tell() -> None:
    stepper, _ = bouncing(100)
    report = stepper.step(1.0)
    assert report.converged
    assert report.unmet == ()


def test_impacts_beyond_the_limit_are_told_with_their_bodies() -> None:
    stepper, ball = bouncing(7)
    report = stepper.step(1.0)
    assert not report.converged
    (unmet,) = report.unmet
    assert (unmet.name, unmet.value, unmet.limit) == ("impacts", 7.0, 7.0)
    assert ball in unmet.bodies
    assert len(unmet.bodies) == 2
    copy = pickle.loads(pickle.dumps(report))
    assert [u.name for u in copy.unmet] == ["impacts"]
    later = stepper.step(1e-9)
    assert later.unmet == ()
    assert report.unmet == (unmet,), "it was of its own step"


def test_what_meets_nothing_spends_work_too() -> None:
    """A body that crosses a row of others, and each of their near lists: what it leaves is an event as impacts are."""
    space = pymunk.Space()
    for k in range(20):
        body = pymunk.Body(1.0, 1.0)
        body.position = 2.0 * k, 0.0
        space.add(body, pymunk.Circle(body, 0.1))
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity, body.angular_velocity = (-5.0, 1.3), (50.0, 0.0), 1000.0
    space.add(body, pymunk.Poly(body, [(0.9, -0.1), (1.0, -0.1), (1.0, 0.1), (0.9, 0.1)]))
    stepper = ep.EECA(space)
    stepper._method.scene.COUNT.budget = 2  # type: ignore[attr-defined]
    reports = [stepper.step(BUDGET_TIME) for _ in range(24)]
    cut = [unmet for report in reports for unmet in report.unmet]
    assert not any(report.contacts for report in reports)
    assert cut
    assert body.position.x < 35.0 - 1e-6
    assert {unmet.name for unmet in cut} == {"solves"}
    assert all(unmet.value < 12 for unmet in cut)


def test_what_rests_pushes_up_to_the_end_of_a_step_that_is_cut_short() -> None:
    """The impulse of a box at rest on the floor is its weight times the length of the step, as it was in the end."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    space.add(pymunk.Segment(space.static_body, (-99, 0), (99, 0), 0.0))
    for i in range(7):
        body = pymunk.Body(1.0, 0.2)
        body.position, body.angle = (0.9 * (i % 2), 30.7 + i), 0.3 * i
        if i == 6:
            body.position, body.angle = (-50.0, 0.3), 0.0
        space.add(body, pymunk.Poly.create_box(body, (0.8, 0.6)))
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(1 / 60)
    scene = stepper.event_loop.scene
    scene.COUNT.budget = 20
    report = stepper.step(3.0)
    assert not report.converged
    assert scene.PAR.dt < 2.0
    below = report.contacts.point[:, 0] < -40.0
    assert report.impulse[below].sum() == pytest.approx(10.0 * scene.PAR.dt)


def test_a_step_without_work_left_ends_before_its_time() -> None:
    """Boxes that tumble, with hardly any solves: what the step has come to is consistent, energy right."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-99, 0), (99, 0), 0.0)
    floor.friction = 0.5
    space.add(floor)
    for i in range(6):
        body = pymunk.Body(1.0, 0.2)
        body.position, body.angle = (0.9 * (i % 2), 0.7 + i), 0.3 * i
        shape = pymunk.Poly.create_box(body, (0.8, 0.6))
        shape.friction = 0.5
        space.add(body, shape)
    stepper = ep.EECA(space)
    stepper._method.scene.COUNT.budget = 20  # type: ignore[attr-defined]
    start = ep.measure(space).energy
    report = stepper.step(3.0)
    assert not report.converged
    unmet = {u.name: u for u in report.unmet}["solves"]
    assert unmet.value >= unmet.limit == pytest.approx(20.0 * 3.0 / BUDGET_TIME)
    assert unmet.bodies
    assert report.ledger is not None
    assert abs(report.ledger.residual) < 1e-12 * start
    assert ep.measure(space).energy <= start
    assert min(b.position.y for b in space.bodies) > 0.25


def test_of_two_limits_the_one_that_was_exceeded_is_told() -> None:
    """A ball between a wall and a kinematic one that comes closer may be hit 64 times a step."""
    space = pymunk.Space()
    press = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    press.velocity = -0.11, 0.0
    ball = pymunk.Body(1.0, 1.0)
    ball.velocity = 3.0, 0.0
    still = pymunk.Segment(space.static_body, (-0.1, -9), (-0.1, 9), 0.0)
    shapes = still, pymunk.Segment(press, (0.1, -9), (0.1, 9), 0.0), pymunk.Circle(ball, 0.05)
    for shape in shapes:
        shape.elasticity = 1.0
    space.add(press, ball, *shapes)
    (unmet,) = ep.EECA(space).step(1.0).unmet
    assert (unmet.name, unmet.limit) == ("impacts", 64.0)
    assert unmet.value >= unmet.limit

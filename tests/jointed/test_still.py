"""Jointed bodies that nothing moves: their steps do nothing, and what moves them is noticed."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep

DT, FRICTION = 1 / 60, 1000.0


def box_on_a_table() -> tuple[ep.EECA, pymunk.Body, pymunk.PivotJoint]:
    """A box of mass 1 seen from above: a pivot of bounded force that closes nothing is its friction with the table."""
    space = pymunk.Space()
    box = pymunk.Body(1.0, 100.0)
    pivot = pymunk.PivotJoint(space.static_body, box, (0, 0), (0, 0))
    pivot.max_bias, pivot.max_force = 0.0, FRICTION
    space.add(box, pymunk.Poly.create_box(box, (20, 20)), pivot)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    return stepper, box, pivot


def effort(stepper: ep.EECA) -> float:
    """Operations that joints took in the last step."""
    assert stepper.event_loop is not None
    assert stepper.event_loop.joints is not None
    return float(stepper.event_loop.joints.PROGRESS.effort)


def test_nothing_is_solved_for_what_lies_still() -> None:
    stepper, box, _ = box_on_a_table()
    stepper.step(DT)
    assert effort(stepper) == 0.0
    assert box.position == (0.0, 0.0)


def test_a_force_beyond_friction_moves_it() -> None:
    stepper, box, _ = box_on_a_table()
    box.force = (1.5 * FRICTION, 0.0)
    stepper.step(DT)
    assert box.velocity.x == pytest.approx(0.5 * FRICTION * DT, rel=1e-12)


def test_a_velocity_moves_it_until_friction_has_taken_it() -> None:
    stepper, box, _ = box_on_a_table()
    box.velocity = (50.0, 0.0)
    for _ in range(10):
        stepper.step(DT)
    assert box.velocity == (0.0, 0.0)
    stepper.step(DT)
    assert effort(stepper) == 0.0


def test_a_joint_that_is_edited_acts() -> None:
    stepper, box, pivot = box_on_a_table()
    pivot.anchor_a, pivot.max_bias = (30.0, 0.0), 60.0
    stepper.step(DT)
    assert box.velocity.x > 1.0


def test_a_partner_that_moves_takes_it_along() -> None:
    space = pymunk.Space()
    box, belt = pymunk.Body(1.0, 100.0), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    pivot = pymunk.PivotJoint(belt, box, (0, 0), (0, 0))
    pivot.max_bias, pivot.max_force = 0.0, FRICTION
    space.add(box, belt, pymunk.Poly.create_box(box, (20, 20)), pivot)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    belt.velocity = (100.0, 0.0)
    stepper.step(DT)
    assert box.velocity.x == pytest.approx(FRICTION * DT, rel=1e-12)


def test_what_something_flies_into_moves() -> None:
    stepper, box, _ = box_on_a_table()
    ball = pymunk.Body(1.0, 10.0)
    ball.position, ball.velocity = (-16.0, 0.0), (600.0, 0.0)
    stepper.space.add(ball, pymunk.Circle(ball, 5.0))
    stepper.step(DT)
    assert box.velocity.x > 100.0


def test_damping_of_everything_leaves_it_still() -> None:
    """With damping 0 velocities end with each step: those at the end of the last interval are none of this one."""
    space = pymunk.Space()
    space.damping = 0.0
    wheel = pymunk.Body(1.0, 1.0)
    space.add(wheel, pymunk.RotaryLimitJoint(space.static_body, wheel, -9.0, 9.0))
    stepper = ep.EECA(space)
    wheel.torque = 60.0
    stepper.step(DT)
    angle = wheel.angle
    assert angle > 0.0
    for _ in range(3):
        report = stepper.step(DT)
        assert report.ledger.damping == 0.0
        assert wheel.angle == angle

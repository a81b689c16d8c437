"""Islands with joints at rest: they keep their forces and are not solved, until something changes."""

from __future__ import annotations

import pickle
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes import linkages

DT, G = 1 / 120, 10.0
Edit = Callable[[ep.EECA], object]


def chain() -> ep.EECA:
    """Planks of mass 1 on pivots, which have fallen on a floor."""
    return ep.EECA(linkages.planks(5, G))


def rested(stepper: ep.EECA, steps: int = 200) -> ep.EECA:
    """The stepper after steps in which everything has come to rest, of which the last ones solve nothing."""
    for _ in range(steps):
        report = stepper.step(DT)
        assert abs(report.ledger.residual) <= 1e-12
    assert effort(stepper) == 0.0
    return stepper


def effort(stepper: ep.EECA) -> float:
    """Operations that joints took in the last step."""
    assert stepper.event_loop is not None
    return float(stepper.event_loop.joints.PROGRESS.effort)


def first_body(stepper: ep.EECA) -> pymunk.Body:
    """The body that was added first."""
    return next(iter(stepper.space.bodies))


def joints(stepper: ep.EECA) -> list[pymunk.Constraint]:
    """The constraints of the space."""
    return list(stepper.space.constraints)


def lamp() -> ep.EECA:
    """A lamp that hangs on a spring and a pin, at rest from the start."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    lamp = pymunk.Body(1.0, 1.0)
    lamp.position = (0.0, -2.0)
    space.add(lamp, pymunk.Circle(lamp, 0.2))
    space.add(pymunk.PinJoint(space.static_body, lamp, (0.0, 0.0), (0.0, 0.0)))
    space.add(pymunk.DampedSpring(space.static_body, lamp, (0.0, 1.0), (0.0, 0.0), 1.0, 4.0, 0.0))
    return ep.EECA(space)


def test_a_chain_on_the_floor_is_not_solved_and_keeps_its_forces() -> None:
    stepper = rested(chain())
    before = [joint.impulse for joint in stepper.space.constraints]
    places = [(body.position, body.angle) for body in stepper.space.bodies]
    report = stepper.step(DT)
    assert sum(report.impulse * report.contacts.normal[:, 1]) == pytest.approx(-5.0 * G * DT, rel=1e-8)
    assert [joint.impulse for joint in stepper.space.constraints] == before
    assert [(body.position, body.angle) for body in stepper.space.bodies] == places
    assert report.ledger == ep.Ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_impulses_of_another_step_are_those_of_its_length() -> None:
    stepper = lamp()
    stepper.step(DT)
    pin, spring = list(stepper.space.constraints)
    assert effort(stepper) > 0.0
    stepper.step(2.0 * DT)
    assert effort(stepper) == 0.0
    assert pin.impulse == pytest.approx((G - 8.0) * 2.0 * DT, rel=1e-9)
    assert spring.impulse == pytest.approx(-8.0 * 2.0 * DT, rel=1e-9)  # pymunk's sign of a pull


def test_a_stiffer_spring_unloads_the_pin() -> None:
    stepper = rested(lamp(), 3)
    pin, spring = joints(stepper)
    assert isinstance(spring, pymunk.DampedSpring)
    spring.stiffness = 5.0
    stepper.step(DT)
    assert spring.impulse == pytest.approx(-G * DT, rel=1e-9)
    assert pin.impulse == pytest.approx(0.0, abs=1e-9 * G * DT)


EDITS: dict[str, Edit] = {
    "gravity": lambda e: setattr(e.space, "gravity", (3.0, -G)),
    "force": lambda e: setattr(first_body(e), "force", (3.0, 0.0)),
    "velocity": lambda e: setattr(first_body(e), "velocity", (0.5, 0.0)),
    "angular velocity": lambda e: setattr(first_body(e), "angular_velocity", 0.5),
    "no pin": lambda e: e.space.remove(joints(e)[0]),
    "motor": lambda e: e.space.add(pymunk.SimpleMotor(e.space.static_body, first_body(e), 1.0)),
    "anchor": lambda e: setattr(joints(e)[1], "anchor_a", (1.0, 1.0)),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS.keys())
def test_what_is_edited_moves_as_if_it_had_never_rested(edit: Edit) -> None:
    """The same edits after `refresh`, which forgets that the lamp rests, and of one that steps only later."""
    one, other = rested(lamp(), 5), rested(lamp(), 5)
    other.refresh()
    for stepper in (one, other):
        edit(stepper)
        for _ in range(3):
            stepper.step(DT)
    a, b = first_body(one), first_body(other)
    moved = a.position.get_distance((0.0, -2.0)) + abs(a.angle)
    assert moved > 1e-5
    assert a.position.get_distance(b.position) + abs(a.angle - b.angle) <= 1e-9 * moved


@pytest.mark.parametrize("edited", [True, False])
def test_a_partner_that_starts_takes_it_along(edited: bool) -> None:
    """By an edit, which marks its joints, or by its own function."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    hand, lamp = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 1.0)
    lamp.position = (0.0, -2.0)
    space.add(hand, lamp, pymunk.Circle(lamp, 0.2), pymunk.PivotJoint(hand, lamp, (0.0, -1.0)))
    speed = [0.0]

    def steer(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        body.velocity = (0.0, speed[0])

    if not edited:
        hand.velocity_func = steer
    stepper = rested(ep.EECA(space), 5)
    if edited:
        hand.velocity = (0.0, 3.0)
    speed[0] = 3.0
    for _ in range(1 if edited else 2):  # what a function sets is the velocity of the next step
        stepper.step(DT)
    assert lamp.position.y == pytest.approx(hand.position.y - 2.0, rel=1e-12)
    assert hand.position.y > DT


def test_the_law_of_a_spring_may_change() -> None:
    stepper = lamp()
    spring = joints(stepper)[1]
    assert isinstance(spring, pymunk.DampedSpring)
    pulls = [8.0]
    spring.force_func = lambda spring, length: -pulls[0]  # pulls as much as the pin leaves
    stepper.space.remove(joints(stepper)[0])
    pulls[0] = G
    rested(stepper, 5)
    pulls[0] = 2.0 * G
    stepper.step(DT)
    assert first_body(stepper).velocity.y == pytest.approx(G * DT, rel=1e-9)


def test_a_hit_moves_it_as_if_it_had_been_awake() -> None:
    """The chain is hit within a step: momentum stays but for what the floor takes, and the path is that of a chain that
    is solved in every step."""
    paths = []
    for awake in (False, True):
        stepper = rested(chain())
        ball = pymunk.Body(3.0, 1.0)
        ball.position, ball.velocity = (-1.5, 0.35), (10.0, 0.0)
        stepper.space.add(ball, pymunk.Circle(ball, 0.2))
        if awake:
            stepper.refresh()
        for _ in range(30):
            report = stepper.step(DT)
            assert abs(report.ledger.residual) <= 1e-11
        paths.append([(*body.position, body.angle) for body in stepper.space.bodies])
    assert paths[0][0][0] > 0.1
    np.testing.assert_allclose(paths[0], paths[1], rtol=0.0, atol=1e-6)


def test_a_state_set_back_rests_on_or_is_solved_as_before() -> None:
    stepper = rested(chain())
    bodies, state = list(stepper.space.bodies), stepper.get_state()
    paths = []
    for _ in range(2):
        stepper.set_state(state)
        for k in range(20):
            if k == 3:
                bodies[2].apply_impulse_at_local_point((0.0, 2.0))
            stepper.step(DT if k < 10 else 0.5 * DT)
        paths.append([(*body.position, body.angle, *body.velocity) for body in bodies])
    assert paths[0] == paths[1]


def test_a_state_set_back_feels_what_was_edited_since() -> None:
    stepper = rested(lamp(), 5)
    state, (pin, spring) = stepper.get_state(), joints(stepper)
    assert isinstance(spring, pymunk.DampedSpring)
    spring.stiffness = 5.0
    stepper.step(DT)
    stepper.set_state(state)
    stepper.step(DT)
    assert pin.impulse == pytest.approx(0.0, abs=1e-9 * G * DT)


def test_a_pickled_stepper_rests_on() -> None:
    stepper = rested(chain())
    copy = pickle.loads(pickle.dumps(stepper))
    for one in (stepper, copy):
        list(one.space.bodies)[2].apply_impulse_at_local_point((0.0, 2.0))
        for _ in range(20):
            one.step(DT)
    for a, b in zip(stepper.space.bodies, copy.space.bodies, strict=True):
        assert (a.position, a.angle, a.velocity) == (b.position, b.angle, b.velocity)


def test_a_motor_that_stalls_works_nothing_and_what_it_drives_is_at_rest() -> None:
    space = pymunk.Space()
    arm = pymunk.Body(1.0, 1.0)
    space.add(arm, pymunk.PivotJoint(space.static_body, arm, (0.0, 0.0)))
    space.add(pymunk.RotaryLimitJoint(space.static_body, arm, -1.0, 0.0))
    motor = pymunk.SimpleMotor(space.static_body, arm, -2.0)
    motor.max_force = 5.0
    space.add(motor)
    stepper = rested(ep.EECA(space), 5)
    assert motor.impulse == pytest.approx(5.0 * DT)
    motor.rate = 2.0
    stepper.step(DT)
    assert arm.angular_velocity < -1e-3


def test_what_lies_on_a_moving_belt_is_solved() -> None:
    """A box that a pin holds on a belt, which slips under it: the work of the belt is lost in friction."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    belt = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    belt.friction, belt.surface_velocity = 0.5, (1.0, 0.0)
    box = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (1.0, 0.2)))
    box.position = (0.0, 0.1)
    shape = pymunk.Poly.create_box(box, (1.0, 0.2))
    shape.friction = 1.0
    space.add(belt, box, shape, pymunk.PinJoint(space.static_body, box, (3.0, 0.1), (0.5, 0.0)))
    stepper = ep.EECA(space)
    for _ in range(10):
        report = stepper.step(DT)
    assert report.ledger.friction == pytest.approx(0.5 * G * DT, rel=1e-6)
    assert report.ledger.external == pytest.approx(0.5 * G * DT, rel=1e-6)


def test_slow_oscillations_go_on() -> None:
    """Only what static forces hold is at rest: at the turning points of a swing nothing stops."""
    space = pymunk.Space()
    ball = pymunk.Body(1.0, 1.0)
    ball.position = (1e-6, 0.0)
    space.add(ball, pymunk.Circle(ball, 0.1))
    space.add(pymunk.DampedSpring(space.static_body, ball, (-1.0, 0.0), (0.0, 0.0), 1.0, 40.0, 0.0))
    stepper = ep.EECA(space)
    most = 0.0
    for _ in range(600):
        stepper.step(DT)
        most = max(most, abs(ball.position.x))
    speed = abs(ball.velocity.x) / np.sqrt(40.0)
    assert np.hypot(ball.position.x, speed) == pytest.approx(1e-6, rel=1e-2)


def test_what_heavy_bodies_bear_stops_no_small_swing_beside_them() -> None:
    """A weight of 1e6 that hangs from a light ring, and a light ball on the weight, which swings by 1e-5: each body is
    measured by the forces on itself."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    ring, weight, ball = pymunk.Body(0.01, 1.0), pymunk.Body(1e6, 1e6), pymunk.Body(0.01, 1.0)
    ring.position, weight.position, ball.position = (0.0, -1.0), (0.0, -2.0), (1e-5, -3.0)
    space.add(ring, weight, ball)
    for a, b in ((space.static_body, ring), (ring, weight), (weight, ball)):
        space.add(pymunk.PinJoint(a, b, (0.0, 0.0), (0.0, 0.0)))
    stepper = ep.EECA(space)
    places = []
    for _ in range(1000):
        stepper.step(DT)
        places.append(ball.position.x)
    period = 2.0 * np.pi / np.sqrt(G)
    assert max(places[-round(period / DT) :]) == pytest.approx(1e-5, rel=1e-2)

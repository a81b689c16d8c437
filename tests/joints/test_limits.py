"""Ratchets, grooves, ropes, doors: what limits take and bear, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes.linkages import body, chain, empty

from .driving import Driven, error, ledger_closes, run

UNITS = [1e-3, 1.0, 1e3]  # m


@pytest.mark.parametrize("ratchet", [0.5, -0.5])
def test_ratchet_goes_one_way(ratchet: float) -> None:
    # A torsion spring carries it to its largest angle sqrt(I/k) w = sqrt(.5) * 2, and it falls back to the last notch.
    space = empty(0.0)
    wheel = body(space, 2.0, 0.5, (0.0, 0.0))
    wheel.angular_velocity = math.copysign(2.0, ratchet)
    ground = space.static_body
    pawl = pymunk.RatchetJoint(ground, wheel, 0.1, ratchet)
    space.add(pymunk.PivotJoint(ground, wheel, (0, 0), (0, 0)), pawl, pymunk.DampedRotarySpring(ground, wheel, 0, 1, 0))
    stepper = run(space, 1 / 60, 240)
    farthest = math.sqrt(2.0)
    notch = math.floor((math.copysign(farthest, ratchet) - 0.1) / ratchet) * ratchet + 0.1
    assert wheel.angle == pytest.approx(notch, abs=1e-12)
    assert pawl.angle == pytest.approx(notch, abs=1e-12)
    assert abs(wheel.angular_velocity) < 1e-10
    ledger_closes(stepper, 1.0)
    assert stepper.restitution == pytest.approx(1.0 - 0.5 * notch**2, rel=1e-12)


def test_bead_slides_down_its_groove_and_stops_at_the_end() -> None:
    space = empty()
    bead = body(space, 2.0, 0.5, (0.4, -0.3))
    space.add(pymunk.GrooveJoint(space.static_body, bead, (0, 0), (4, -3), (0, 0)))
    stepper = Driven(space)
    for _ in range(60):
        stepper.step(1 / 60)
    assert bead.position.length == pytest.approx(0.5 + 0.5 * 9.81 * 0.6, abs=1e-12)
    for _ in range(60):
        stepper.step(1 / 60)
    np.testing.assert_allclose(bead.position, (4.0, -3.0), atol=1e-11)
    assert bead.velocity.length < 1e-11
    assert stepper.restitution == pytest.approx(2.0 * 9.81 * 2.7, rel=1e-12)
    ledger_closes(stepper, 60.0)


@pytest.mark.parametrize("unit", UNITS)
def test_rope_is_never_longer_than_its_length(unit: float) -> None:
    # Dropped from (.8, 0): taut at depth .6 with vertical speed v; the radial part v .6 is lost, exactly.
    space = empty(9.81 * unit)
    weight = body(space, 2.0, 0.5 * unit**2, (0.8 * unit, 0.0))
    space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, unit))
    stepper = Driven(space)
    for _ in range(120):
        stepper.step(1 / 60)
        assert weight.position.length < (1.0 + 1e-11) * unit
    assert stepper.restitution == pytest.approx(2.0 * 9.81 * 0.6 * 0.36 * unit**2, rel=1e-3)
    ledger_closes(stepper, 20.0 * unit**2)


@pytest.mark.parametrize("let_go", [-1, 0, 1])
def test_a_taut_rope_does_not_hold_what_is_thrown_inwards(let_go: int) -> None:
    """Whatever an earlier part of a step has let go."""
    space = empty()
    weight = body(space, 2.0, 0.5, (0.0, -1.0))
    space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, 1.0))
    stepper = run(space, 1 / 60, 10)
    weight.velocity = (0.0, 3.0)
    stepper.joints.COUPLING["let_go"] = let_go
    before = stepper.restitution
    stepper.step(1 / 60)
    assert weight.position.y == pytest.approx(-1.0 + 3.0 / 60.0 - 0.5 * 9.81 / 3600.0, abs=1e-12)
    assert stepper.restitution == before


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("up", [0.001, 0.01, 0.2, 0.45])
def test_what_leaves_its_limit_and_comes_back_within_a_step_stops_there(up: float, unit: float) -> None:
    # Thrown up from the end of its rope, which is taut again after 2 v/g: m v^2/2 is lost, and the weight hangs.
    space = empty(9.81 * unit)
    weight = body(space, 2.0, 0.5 * unit**2, (0.0, -unit))
    space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, unit))
    weight.velocity = (0.0, up * unit)
    stepper = run(space, 0.1, 1)
    assert weight.position.y == pytest.approx(-unit, rel=1e-14)
    assert weight.velocity.length < 1e-12 * unit
    # As well as the bound is met.
    assert stepper.restitution == pytest.approx(up**2 * unit**2, abs=2.0 * 9.81 * 1e-12 * unit**2)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("slack", [2e-13, 4e-13, 8e-13, 2e-12])
def test_what_circles_at_the_end_of_its_rope_stays_there(slack: float, unit: float) -> None:
    # Slack by round-off it flies on straight, and the search for the instant at which the rope is taut ends early.
    for turns in np.geomspace(1e-4, 1e-2, 20):
        space = empty(0.0)
        weight = body(space, 2.0, 0.5 * unit**2, (0.0, (1.0 - slack) * unit))
        space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, unit))
        weight.velocity = (10.0 * turns * unit, -1e-9 * turns * unit)
        parts = run(space, 0.1, 1).joints.PARTS
        assert weight.position.length < (1.0 + 1e-11) * unit
        assert parts.events <= 2  # what round-off lets go is held at once, not met again and again


def test_what_hangs_at_its_limit_is_held_without_a_search() -> None:
    efforts = []
    for up in (0.0, 1e-13):
        space = empty()
        weight = body(space, 2.0, 0.5, (0.0, -1.0))
        space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, 1.0))
        weight.velocity = (0.0, up)
        efforts.append(run(space, 0.1, 1).joints.PROGRESS.effort)
    assert efforts[1] <= 2.0 * efforts[0]  # a velocity of round-off is no reason to let go and to meet it again


@pytest.mark.parametrize("unit", UNITS)
def test_door_stops_at_its_limit_and_rests_there(unit: float) -> None:
    space = empty(9.81 * unit)
    door = body(space, 2.0, 0.5 * unit**2, (0.8 * unit, 0.0))
    ground, hinge = space.static_body, (-0.8 * unit, 0.0)
    space.add(pymunk.PivotJoint(ground, door, (0, 0), hinge), pymunk.RotaryLimitJoint(ground, door, -0.9, 0.5))
    stepper = Driven(space)
    for _ in range(120):
        stepper.step(1 / 60)
        assert door.angle > -0.9 - 1e-12
    assert door.angle == pytest.approx(-0.9, abs=1e-12)
    assert stepper.restitution == pytest.approx(2.0 * 9.81 * 0.8 * math.sin(0.9) * unit**2, rel=1e-12)
    ledger_closes(stepper, 20.0 * unit**2)


def test_hanging_weight_reads_its_weight() -> None:
    space = empty()
    weight = body(space, 3.0, 1.0, (0.0, -2.0))
    pin = pymunk.PinJoint(space.static_body, weight)
    space.add(pin)
    stepper = run(space, 1 / 60, 5, 2)
    assert pin.impulse * 60.0 == pytest.approx(3.0 * 9.81, rel=1e-12)
    del stepper
    assert pin.impulse * 60.0 == pytest.approx(3.0 * 9.81, rel=1e-12)  # of the last step, whoever took it


def test_a_straight_taut_chain_between_walls_does_not_stop_the_step() -> None:
    # Singular: straight links exactly as long as the gap bear no weight at first order.
    space = chain(4)
    end = list(space.bodies)[-1]
    space.add(pymunk.PivotJoint(space.static_body, end, (4.0, 0.0), (0.5, 0.0)))
    stepper = Driven(space)
    for _ in range(20):
        stepper.step(1 / 60)
        assert error(space) < 1e-2
    assert abs(stepper.unexplained()) < 1e-10 * 40.0


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("speed", [1e-2, 1e-4, 1e-5, 1e-6])
def test_a_limit_whose_gap_opens_first_is_found(speed: float, unit: float) -> None:
    """A bob on its lower limit above the hinge is thrown up a little: y = v t - g t²/2 is back at t = 2 v/g << dt."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0 * unit
    bob = pymunk.Body(1.0, unit**2)
    bob.position, bob.velocity = (0.0, unit), (0.0, speed * unit)
    space.add(bob, pymunk.SlideJoint(space.static_body, bob, (0.0, 0.0), (0.0, 0.0), unit, 3.0 * unit))
    report = ep.EECA(space).step(0.1)
    assert report.converged
    assert bob.position.y == pytest.approx(unit, rel=1e-12)
    round_off = 1e-13 * 10.0 * unit**2  # of m g L
    assert report.ledger.restitution == pytest.approx(0.5 * (speed * unit) ** 2, rel=1e-6, abs=round_off)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("parts", [1, 2, 3, 7])
def test_what_would_pass_within_its_least_distance_in_a_step_stops_there(parts: int, unit: float) -> None:
    # On a line that is .1 off the anchor, from -1 to 1: it meets the circle of radius .5, and goes on along the tangent
    # there with .2 of its speed, which is the tangential part.
    space, aside, least = empty(0.0), 0.1 * unit, 0.5 * unit
    ball = body(space, 2.0, 0.5 * unit**2, (-unit, aside))
    ball.velocity = (2.0 * unit, 0.0)
    space.add(pymunk.SlideJoint(space.static_body, ball, (0, 0), (0, 0), least, 9.0 * unit))
    stepper = Driven(space)
    for _ in range(parts):
        stepper.step(1.0 / parts)
    across = math.sqrt(least**2 - aside**2)
    tangent = pymunk.Vec2d(aside, across) / least
    speed, left = 2.0 * unit * aside / least, 1.0 - (unit - across) / (2.0 * unit)
    assert (ball.velocity - speed * tangent).length < 1e-9 * unit
    assert (ball.position - pymunk.Vec2d(-across, aside) - speed * left * tangent).length < 1e-9 * unit
    assert stepper.restitution == pytest.approx(4.0 * unit**2 - speed**2, rel=1e-9)


def test_what_hangs_at_its_limit_is_held_in_the_shortest_step() -> None:
    """The bound is met but for round-off, which a short step must not close: that would take any force."""
    space = empty()
    weight = body(space, 2.0, 0.5, (0.0, -1.0 + 5e-13))
    space.add(pymunk.SlideJoint(space.static_body, weight, (0, 0), (0, 0), 0.0, 1.0))
    stepper = run(space, 1 / 60, 1)
    assert weight.velocity.length <= 1e-12
    stepper.step(1e-7)
    assert weight.velocity.length <= 1e-8


def test_closing_a_groove_does_not_pass_its_end() -> None:
    """The anchor is beside a groove that turns as it is drawn there, and next to its end."""
    space = pymunk.Space()
    rail, bead = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 1.0)
    space.add(rail, bead, pymunk.GrooveJoint(rail, bead, (0.0, 0.0), (2.0, 0.0), (0.0, 0.0)))
    bead.position = 1.9999, 0.2
    stepper, apart = ep.EECA(space), 0.2
    for _ in range(20):
        assert stepper.step(1.0 / 60.0).converged
        at = rail.world_to_local(bead.position)
        assert at.x <= 2.0 + 1e-12
        assert abs(at.y) < apart
        apart = abs(at.y)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_groove_of_bounded_force_does_not_hold_what_leaves_its_end(side: float) -> None:
    """A bead at the end of its groove is drawn away: it falls along it by g t^2/2, and the groove bears what draws
    across, but no more than its largest force."""
    for across, most in ((3.0, 1000.0), (3.0, 2.0)):
        space = pymunk.Space()
        space.gravity = -10.0 * side, -across
        bead = pymunk.Body(1.0, 1.0)
        bead.position = side, 0.0
        groove = pymunk.GrooveJoint(space.static_body, bead, (-1.0, 0.0), (1.0, 0.0), (0.0, 0.0))
        groove.max_force = most
        space.add(bead, groove)
        stepper = ep.EECA(space)
        for _ in range(10):
            assert stepper.step(0.02).converged
        slip = max(across - most, 0.0)
        assert bead.position == pytest.approx((side * (1.0 - 5.0 * 0.2**2), -0.5 * slip * 0.2**2), abs=1e-12)
        assert groove.impulse == pytest.approx(0.02 * min(across, most))


def test_a_groove_of_bounded_force_bears_at_its_end_what_it_can() -> None:
    """Drawn against its end and across by more than its largest force, it bears that in the direction of the pull."""
    space = pymunk.Space()
    space.gravity = 6.0, -8.0
    bead = pymunk.Body(1.0, 1.0)
    bead.position = 1.0, 0.0
    groove = pymunk.GrooveJoint(space.static_body, bead, (-1.0, 0.0), (1.0, 0.0), (0.0, 0.0))
    space.add(bead, groove)
    for most, rate in ((1000.0, 0.0), (5.0, 5.0)):
        groove.max_force, bead.position, bead.velocity = most, (1.0, 0.0), (0.0, 0.0)
        assert ep.EECA(space).step(0.02).converged
        assert bead.velocity == pytest.approx((0.6 * rate * 0.02, -0.8 * rate * 0.02), abs=1e-12)
        assert groove.impulse == pytest.approx(0.02 * min(10.0, most))


def test_a_limit_that_would_pull_later_is_held_up_to_the_instant_of_another() -> None:
    """A spring turns a falling body onto its lower limit, and would turn it off later; before that a rope holds it."""
    space = pymunk.Space()
    bob, ground = pymunk.Body(1.0, 1.0), space.static_body
    bob.velocity = 0.0, -1.0
    space.add(bob, pymunk.DampedSpring(ground, bob, (1.0, -0.04), (1.0, 0.0), 0.0, 1.0, 0.0))
    space.add(pymunk.RotaryLimitJoint(ground, bob, 0.0, 1.0))
    space.add(pymunk.SlideJoint(ground, bob, (0.0, 1.0), (0.0, 0.0), 0.0, 1.02))
    stepper = run(space, 0.1, 1)
    assert abs(bob.angle) < 1e-12
    assert bob.position.y == pytest.approx(-0.02, abs=1e-12)
    assert stepper.joints.PROGRESS.effort < 1e5  # the two are not met in turn


@pytest.mark.parametrize("joint", [pymunk.GearJoint, pymunk.RotaryLimitJoint])
def test_a_joint_of_angles_that_nothing_turns_does_nothing(joint: type) -> None:
    """Between a body of infinite moment and a kinematic one that turns; others go on as without it."""
    ends = []
    for joined in (False, True):
        space = pymunk.Space()
        wheel, rigid = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, math.inf)
        swing = pymunk.Body(1.0, 1.0)
        wheel.angular_velocity, rigid.velocity, swing.position = 1.0, (1.0, 0.0), (0.0, -1.0)
        space.add(wheel, rigid, swing, pymunk.PinJoint(rigid, swing, (0.5, 0.0), (0.2, 0.0)))
        if joined:
            space.add(joint(wheel, rigid, *((0.0, 1.0) if joint is pymunk.GearJoint else (-0.1, 0.1))))
        stepper = ep.EECA(space)
        assert all(stepper.step(1 / 60).converged for _ in range(60))
        ends.append((rigid.position, swing.position))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("kind", ["limit", "ratchet"])
def test_a_motor_of_unlimited_force_stalls_at_a_limit(kind: str, unit: float) -> None:
    """It turns one body against the ground or the stop of another one, loses what that had, I w²/2, once, and works no
    more; what has nothing to do with it goes on."""
    space, wheel, other = empty(0.0), pymunk.Body(2.0, 3.0 * unit**2), pymunk.Body(1.0, unit**2)
    ground, rate, bound = space.static_body, 1.0, -0.1
    other.position, other.velocity = (10.0 * unit, 0.0), (unit, 0.0)
    space.add(wheel, other, pymunk.PivotJoint(ground, wheel, (0, 0), (0, 0)), pymunk.SimpleMotor(ground, wheel, rate))
    limit, ratchet = pymunk.RotaryLimitJoint(ground, wheel, bound, 10.0), pymunk.RatchetJoint(ground, wheel, 0.0, 0.1)
    space.add(limit if kind == "limit" else ratchet)
    stepper, lost, worked = ep.EECA(space), 0.0, 0.0
    for _ in range(60):
        report = stepper.step(1 / 60)
        assert report.converged, report.unmet
        lost, worked = lost + report.ledger.restitution, worked + report.ledger.external
    once = 0.5 * 3.0 * unit**2 * rate**2
    assert wheel.angle == pytest.approx(bound if kind == "limit" else 0.0, abs=1e-11)
    assert lost == pytest.approx(once if kind == "limit" else 0.0, rel=1e-9, abs=1e-9 * once)
    assert worked == pytest.approx(lost, rel=1e-9, abs=1e-9 * once)
    assert other.position.x == pytest.approx(11.0 * unit, rel=1e-12)


@pytest.mark.parametrize("force", [3.0, math.inf])
@pytest.mark.parametrize("ratio", [1.0, 2.0, 3.0])
def test_a_motor_stalls_where_gears_hold_what_it_turns(ratio: float, force: float) -> None:
    """No impulse of it changes its speed: it has all that it may have, which the gear bears."""
    space, wheel, rigid, other = empty(0.0), pymunk.Body(1.0, 0.7), pymunk.Body(1.0, math.inf), pymunk.Body(2.0, 3.0)
    wheel.angle = 0.3
    gear = pymunk.GearJoint(wheel, rigid, -wheel.angle, ratio)
    motor, spring = pymunk.SimpleMotor(other, wheel, 1.7), pymunk.DampedRotarySpring(other, wheel, -0.2, 1.0, 0.1)
    motor.max_force = force
    other.moment = math.inf
    space.add(wheel, rigid, other, gear, motor, spring)
    stepper = ep.EECA(space)
    for _ in range(10):
        report = stepper.step(1 / 60)
        assert report.converged, report.unmet
        assert wheel.angle == pytest.approx(0.3, abs=1e-14)
        assert motor.impulse > 0.0
        if math.isfinite(force):
            assert motor.impulse == pytest.approx(force / 60, rel=1e-12)


@pytest.mark.parametrize("kind", ["slide", "limit", "groove", "ratchet"])
@pytest.mark.parametrize(("speed", "force"), [(1.0, 0.0), (0.0, 60.0), (-0.1, 60.0), (1.0, 60.0)])
def test_a_limit_that_a_program_has_left_apart_lets_bodies_come_back_by_themselves(
    kind: str, speed: float, force: float
) -> None:
    """It closes at its own rate; what moves or pulls back adds to this as it does without a limit. Speed and force
    towards the bound; a speed away from it is stopped."""

    def came(speed: float, force: float) -> tuple[float, float, float]:
        """Way and speed after three steps, and the work of what is outside."""
        space, ground, work = empty(0.0), pymunk.Body(body_type=pymunk.Body.STATIC), 0.0
        loose, turns = body(space, 1.0, 1.0, (0.0, 0.0)), kind in ("limit", "ratchet")
        if turns:
            loose.angle, loose.angular_velocity = 3.0, -speed
        else:
            loose.position, loose.velocity = (3.0, 0.0), (-speed, 0.0)
        joint = {
            "slide": pymunk.SlideJoint(loose, ground, (0, 0), (0, 0), 0.0, 1.0),
            "limit": pymunk.RotaryLimitJoint(ground, loose, -1.0, 1.0),
            "groove": pymunk.GrooveJoint(ground, loose, (-1, 0), (1, 0), (0, 0)),
            "ratchet": pymunk.RatchetJoint(ground, loose, 0.0, -0.5),
        }[kind]
        space.add(ground, joint)
        if isinstance(joint, pymunk.RatchetJoint):
            joint.angle = 0.5
        stepper = ep.EECA(space)
        for _ in range(3):
            loose.force, loose.torque = (0.0 if turns else -force, 0.0), -force if turns else 0.0
            report = stepper.step(1 / 60)
            assert report.converged
            work += report.ledger.external
        if turns:
            return 3.0 - loose.angle, -loose.angular_velocity, work
        return 3.0 - loose.position.x, -loose.velocity.x, work

    way, after, work = came(speed, force)
    closed, _, _ = came(0.0, 0.0)
    begins, time = max(speed, 0.0), 3 / 60
    assert closed > 0.2
    assert after == pytest.approx(begins + force * time, rel=1e-12)
    assert work == pytest.approx(0.5 * (after**2 - begins**2), abs=1e-12)
    # What comes back in one step is not left to be closed in the next.
    assert closed + 0.8 * (begins + 0.5 * force * time) * time < way <= closed + (begins + 0.5 * force * time) * time


def test_what_rests_on_a_limit_goes_on_though_it_cannot_pay_for_round_off() -> None:
    """A body on a pin stands at the end of a groove, against which a motor drives it, while a heavy one hangs on its
    groove: joints that are elastic, by 1e-9 of the component, give round-off of forces times distances, which is more
    than all kinetic energy. Steps had ended after 1e-7 s and less (random scene 63505455)."""
    space = empty()
    ground = space.static_body
    mount = body(space, 3030.658338911529, 520662.08613777126, (-50.0, -50.0), angle=-0.7440298733862001)
    slider = body(space, 182174.80044039781, 57396558.01326257, (-150.0, 150.0), angle=-1.625005820949963)
    rail = body(space, 8603.690651922285, 417309.59806091967, (-50.0, 150.0), angle=2.2720510289475646)
    weight = body(space, 11441518.08651775, 3623728360.4385686, (50.0, -50.0), angle=1.6011107208184727)
    slider.angular_velocity = 0.6210069390491064
    pin = pymunk.PinJoint(
        mount, slider, (12.666492581198874, 7.905376067477469), (2.0566195136100873, 10.81612741771957)
    )
    groove = pymunk.GrooveJoint(
        slider, rail, (-2.1982131164319583, 71.12880461951256), (-26.41434534297545, 114.87327787027374),
        (11.167993992216907, -1.1058580807522915),
    )  # fmt: skip
    motor = pymunk.SimpleMotor(slider, rail, -0.44735334329024923)
    motor.max_force = 455437001.10099477
    space.add(pin, groove, motor)
    for a, b in ((ground, mount), (ground, rail), (rail, weight)):
        space.add(pymunk.PivotJoint(a, b, tuple(b.position)), pymunk.GearJoint(a, b, b.angle - a.angle, 1.0))
    stepper = ep.EECA(space)
    for _ in range(60):
        assert stepper.step(0.1).converged
    assert slider.velocity.length < 1e-6
    assert slider.position == pytest.approx((-172.056857, 136.709072), abs=1e-6)

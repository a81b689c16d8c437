"""Linkages through the public stepper: periods, long chains, cloth, vehicles and tanks, against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.hard_cases.case import DT, G, matter
from comparisons.hard_cases.joints import apart, kept
from scenes import linkages
from scenes.scene import add_box, add_disk, add_walls

from .audit import Audit


def after(space: pymunk.Space, seconds: float, steps: int) -> Audit:
    stepper = Audit(space)
    for _ in range(steps):
        stepper.step(seconds / steps)
    return stepper


@pytest.mark.parametrize(
    ("length", "gravity", "period", "tolerance"),
    [(1.0, 9.81, 2.3678419475762, 1e-7), (300.0, 981.0, 4.1012, 5e-5)],
    ids=["IFToMM A01", "pymunk 216"],
)
def test_a_pendulum_hangs_after_a_quarter_of_its_period(
    length: float, gravity: float, period: float, tolerance: float
) -> None:
    space = linkages.pendulum(length, gravity)
    after(space, 0.25 * period, 60)
    (bob,) = space.bodies
    assert bob.position / length == pytest.approx((0.0, -1.0), abs=tolerance)  # as many digits as the period has


@pytest.mark.parametrize(("loops", "period"), [(2, 1.942514922607083), (40, 1.965601928704650)])
def test_four_bars_are_back_after_their_period(loops: int, period: float) -> None:
    """IFToMM A02; on the way A w² + B cos(phi) = A + B, all cranks being in step, singular twice."""
    space = linkages.four_bars(loops)
    crank, stepper, worst = next(iter(space.bodies)), Audit(space), 0.0
    a, b = (loops + 1) / 6.0 + loops / 2.0, ((loops + 1) / 2.0 + loops) * linkages.GRAVITY
    for _ in range(200):
        stepper.step(period / 200)
        tilt = 0.5 * math.pi - crank.angle
        worst = max(worst, abs(a * crank.angular_velocity**2 + b * math.cos(tilt) - a - b) / (a + b))
    assert crank.local_to_world((0.5, 0.0)) == pytest.approx((0.0, 1.0), abs=1e-7)
    assert crank.angle - 0.5 * math.pi == pytest.approx(-2.0 * math.pi, abs=1e-7)
    assert worst < 1e-6
    assert stepper.residual <= 1e-12


def test_chain_of_a_hundred_swings() -> None:
    assert kept(linkages.chain(100, lean=0.5), ep.EECA, 120, 100.0 * G * 50.0, 1 / 240) <= 1e-10


def test_acrobot_beats_runge_kutta() -> None:
    """Gymnasium's double pendulum, dt = .05 s, 100 s: fourth order in its angles drifts by 4.2e-6."""
    space = linkages.rods()
    assert kept(space, ep.EECA, 2000, 20.0, 0.05) <= 1e-10


def test_cloth_of_fifteen_by_fifteen_keeps_its_pins() -> None:
    assert kept(linkages.cloth(15), ep.EECA, 48, 225 * 0.1 * G * 1.4, 1 / 240) <= 1e-10


def test_a_cloth_that_falls_over_a_disk_gains_nothing() -> None:
    """Some of its steps are cut short, and give way by no more than a ten-thousandth of a mesh."""
    space = linkages.draped()
    matter(space, 0.5)
    stepper, worst = Audit(space), 0.0
    for _ in range(60):
        stepper.step(DT)
        worst = max(worst, apart(space))
    assert stepper.total["friction"] > 0.0
    assert worst <= 1e-5
    assert stepper.residual <= 1e-12
    assert stepper.loss >= -1e-12
    assert stepper.total["change"] < 0.0


def test_a_tank_rubs_to_rest_under_its_controls() -> None:
    """A body seen from above, held by a pivot with a force of 2 and by a gear with a torque of 1: v²/2a, w²/2b."""
    space = linkages.empty(0.0)
    tank = linkages.body(space, 1.0, 0.4, (0.0, 0.0))
    tank.velocity, tank.angular_velocity = (3.0, 4.0), 6.0
    control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    pivot, gear = pymunk.PivotJoint(control, tank, (0, 0), (0, 0)), pymunk.GearJoint(control, tank, 0.0, 1.0)
    pivot.max_bias = gear.max_bias = 0.0
    pivot.max_force, gear.max_force = 2.0, 1.0
    space.add(control, pivot, gear)
    stepper = after(space, 3.0, 180)
    assert tank.position.length == pytest.approx(25.0 / 4.0, rel=1e-9)
    assert tank.angle == pytest.approx(36.0 / 5.0, rel=1e-9)
    assert (tank.velocity.length, tank.angular_velocity) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert stepper.total["friction"] == pytest.approx(0.5 * 25.0 + 0.5 * 0.4 * 36.0, rel=1e-12)


@pytest.mark.parametrize("make", [ep.EECA, ep.Native])
def test_max_bias_is_how_fast_joints_that_are_apart_close(make: Callable[[pymunk.Space], ep.Stepper]) -> None:
    space = linkages.empty(0.0)
    body = linkages.body(space, 1.0, 1.0, (1.0, 0.0))
    pivot = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    pivot.max_bias = 0.5
    space.add(pivot)
    stepper = make(space)
    for _ in range(60):
        stepper.step(DT)
    assert body.position.x == pytest.approx(0.5, abs=0.5 * DT + 1e-9)


def car(friction: float, torque: float, slope: float) -> tuple[pymunk.Space, pymunk.Body, pymunk.Vec2d]:
    """A body of 10 on two wheels of 1, sprung and driven, that goes up a slope; its direction."""
    space = linkages.empty()
    along = pymunk.Vec2d(math.cos(slope), math.sin(slope))
    up = along.perpendicular()
    add_walls(space, [(tuple(-60.0 * along), tuple(200.0 * along))])
    body = add_box(space, tuple(0.9 * up), 2.4, 0.5, 10.0)
    body.angle = slope
    for x in (-0.9, 0.9):
        wheel = add_disk(space, tuple(0.4 * up + x * along), 0.4)
        motor = pymunk.SimpleMotor(body, wheel, 60.0)
        motor.max_force = torque
        spring = pymunk.DampedSpring(body, wheel, (x, 0.0), (0.0, 0.0), 0.75, 400.0, 30.0)
        space.add(pymunk.GrooveJoint(body, wheel, (x, -0.2), (x, -0.9), (0, 0)), spring, motor)
    matter(space, friction)
    for shape in space.shapes:
        if shape.body is not space.static_body:
            shape.filter = pymunk.ShapeFilter(group=1)
    return space, body, along


@pytest.mark.parametrize("slips", [True, False])
def test_a_car_goes_up_a_slope(slips: bool) -> None:
    """Slipping: g (mu cos - sin); gripping: (2 T/r - M g sin)/(M + 2 I/r²). Once its springs have come to rest."""
    slope = math.radians(15.0)
    friction, torque = (0.5, 400.0) if slips else (1.0, 9.0)
    space, body, along = car(friction, torque, slope)
    stepper = Audit(space)
    for _ in range(300):
        stepper.step(DT)
    before = body.velocity.dot(along)
    for _ in range(60):
        stepper.step(DT)
    if slips:
        exact = G * (friction * math.cos(slope) - math.sin(slope))
    else:
        exact = (2.0 * torque / 0.4 - 12.0 * G * math.sin(slope)) / (12.0 + 2.0 * 0.08 / 0.16)
    assert body.velocity.dot(along) - before == pytest.approx(exact, rel=1e-5)
    assert stepper.residual <= 1e-12
    assert stepper.total["external"] > stepper.total["change"]

"""What a container without mobility carries along as it turns by up to 1 rad in a step."""

from __future__ import annotations

import math
from itertools import pairwise

import pymunk
import pytest

import eeca_pymunk as ep

SPIN, HALF = 10.0, 5.0  # rad/s; half the side of the container, in lengths of its bodies
Placed = tuple[float, float, float, float]  # height, x, y, mass


def turning(
    placed: tuple[Placed, ...], unit: float, friction: float, centre: tuple[float, float] = (0.0, 0.0)
) -> tuple[pymunk.Space, pymunk.Body, list[pymunk.Body]]:
    """A container that turns about a point `centre` away from its middle, and boxes of length 1 that turn with it."""
    space, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(box)
    box.position, box.angular_velocity = (-centre[0] * unit, -centre[1] * unit), SPIN
    corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF), (-HALF, -HALF)]
    ends = [((x + centre[0]) * unit, (y + centre[1]) * unit) for x, y in corners]
    space.add(*(pymunk.Segment(box, p, q, 0.0) for p, q in pairwise(ends)))
    bodies = []
    for height, x, y, mass in placed:
        body = pymunk.Body(mass, mass * (1.0 + height * height) / 12.0 * unit * unit)
        body.position = x * unit, y * unit
        body.velocity, body.angular_velocity = box.velocity_at_world_point(body.position), SPIN
        space.add(body, pymunk.Poly.create_box(body, (unit, height * unit)))
        bodies.append(body)
    for shape in space.shapes:
        shape.friction = friction
    return space, box, bodies


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("angle", [0.1, 0.3, 0.8])
def test_a_turning_wall_does_no_work_on_what_it_carries(angle: float, unit: float) -> None:
    """A box on the middle of a wall: it stays there, at one speed. Along the tangents of the middles of intervals it
    would be lifted out of the wall in each step, by work from outside of a third of its energy in 40 steps of .8 rad.
    """
    space, box, (body,) = turning(((0.5, 0.0, 0.25 - HALF, 1.0),), unit, 1.0)
    stepper, work, energy = ep.EECA(space), 0.0, ep.measure(space).energy
    for _ in range(40):
        report = stepper.step(angle / SPIN)
        assert report.converged
        assert report.ledger is not None
        work += report.ledger.external
    x, y = box.world_to_local(body.position)
    assert abs(work) <= 1e-3 * energy
    assert abs(x) <= 0.02 * unit
    assert y == pytest.approx((0.25 - HALF) * unit, abs=1e-5 * unit)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("angle", [0.05, 0.1, 0.4, 0.8])
def test_what_sticks_to_a_turning_wall_stays_where_it_is(angle: float, unit: float) -> None:
    """A box off the middle of a wall, which friction takes along, for up to five turns. With the slip of the middle of
    an interval it would creep by w^2 h^2 x/4 in each, x being its distance from the middle: half its length here. Nor
    is slip of round-off a reason for shorter intervals."""
    space, box, (body,) = turning(((0.5, 2.0, 0.25 - HALF, 1.0),), unit, 1.0)
    stepper, energy, intervals = ep.EECA(space), ep.measure(space).energy, 0
    for _ in range(40):
        report = stepper.step(angle / SPIN)
        intervals += report.iterations
        assert report.ledger is not None
        assert abs(report.ledger.residual) <= 1e-12 * energy
    x, y = box.world_to_local(body.position)
    assert x == pytest.approx(2.0 * unit, abs=0.003 * unit)
    assert y == pytest.approx((0.25 - HALF) * unit, abs=1e-4 * unit)
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-3)
    assert intervals <= 40 * (1 + 25 * angle)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("angle", [0.05, 0.1, 0.4, 0.8])
def test_what_joints_connect_on_a_turning_wall_stays_too(angle: float, unit: float) -> None:
    """Two boxes that a pivot connects, in the solver of contacts with joints, for up to five turns: intervals end where
    the wall has turned by R (w h)^2 / 8 = .01 of a box (SAGITTA). In whole steps they would creep by .4 lengths."""
    space, box, (one, two) = turning(((0.5, 1.0, 0.25 - HALF, 1.0), (0.5, 2.5, 0.25 - HALF, 2.0)), unit, 1.0)
    space.add(pymunk.PivotJoint(one, two, (0.75 * unit, 0.0), (-0.75 * unit, 0.0)))
    stepper, energy = ep.EECA(space), ep.measure(space).energy
    for _ in range(40):
        ledger = stepper.step(angle / SPIN).ledger
        assert ledger is not None
        assert abs(ledger.residual) <= 1e-12 * energy
    x, y = box.world_to_local(one.position)
    assert x == pytest.approx(unit, abs=0.02 * unit)
    assert y == pytest.approx((0.25 - HALF) * unit, abs=1e-3 * unit)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dt", [0.005, 0.02])
def test_a_box_on_a_plate_that_tilts_slips_from_its_angle_of_friction_on(dt: float, unit: float) -> None:
    """A plate turns with w = .1 from the horizontal; a box on it slips from the angle tan a = mu on, and then is
    accelerated by g (sin a - mu cos a), which grows by w g (cos a + mu sin a) = w g / cos a: it has slipped s after
    (6 s cos a/(w g))^(1/3). What the rotation adds, w^2 x/g, is 1e-3."""
    space, plate = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.gravity = 0.0, -10.0 * unit
    plate.angular_velocity = 0.1
    box = pymunk.Body(1.0, unit * unit / 6.0)
    box.position = 1.0 * unit, 0.5 * unit
    box.velocity, box.angular_velocity = plate.velocity_at_world_point(box.position), 0.1
    space.add(plate, pymunk.Segment(plate, (-9.0 * unit, 0.0), (9.0 * unit, 0.0), 0.0))
    space.add(box, pymunk.Poly.create_box(box, (unit, unit)))
    for shape in space.shapes:
        shape.friction = 0.7
    stepper = ep.EECA(space)
    while abs(plate.world_to_local(box.position).x - unit) < 0.01 * unit:
        stepper.step(dt)
        assert plate.angle < 1.0
    begins = math.atan(0.49)
    assert plate.angle == pytest.approx(begins + 0.1 * (0.06 * math.cos(begins)) ** (1 / 3), abs=0.002 + 0.1 * dt)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dt", [0.002, 0.01])
def test_what_tumbles_on_a_wall_that_hardly_turns_does_so_as_on_one_that_rests(dt: float, unit: float) -> None:
    """A box on its corner, which falls over with 2 rad/s: within an interval h its corner's slip changes by W^2 h r/2
    with its own spin W, whatever the wall does. Taken for a speed of the wall, that is work from outside."""
    ends = []
    for spin in (0.0, 1e-9):
        space, wall, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, unit**2 / 6.0)
        space.gravity = 0.0, -10.0 * unit
        wall.angular_velocity = spin
        box.angle, box.position = 0.6, (0.0, math.cos(0.25 * math.pi - 0.6) / math.sqrt(2.0) * unit)
        box.angular_velocity = -2.0
        space.add(wall, pymunk.Segment(wall, (-9.0 * unit, 0.0), (9.0 * unit, 0.0), 0.0))
        space.add(box, pymunk.Poly.create_box(box, (unit, unit)))
        for shape in space.shapes:
            shape.friction = 0.4
        stepper, energy = ep.EECA(space), 10.0 * unit**2
        for _ in range(round(0.1 / dt)):
            ledger = stepper.step(dt).ledger
            assert ledger is not None
            assert abs(ledger.external) <= 10.0 * spin * energy
        ends.append([*(box.position / unit), box.angle, *(box.velocity / unit), box.angular_velocity])
    assert ends[1] == pytest.approx(ends[0], abs=1e-7)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(
    "placed",
    [
        ((0.05, 3.0, -3.0, 10.0),),
        ((0.5, 0.0, -3.0, 1.0), (0.5, -3.0, 0.0, 10.0), (0.05, 0.0, 0.0, 10.0)),
    ],
)
def test_what_a_container_presses_into_its_corners_stays_inside(placed: tuple[Placed, ...], unit: float) -> None:
    """A radian a step about a point outside: walls press with 65 times what turns the bodies, and these sank deeper in
    each step than corrections lift them."""
    space, box, bodies = turning(placed, unit, 0.5, (8.0, 0.0))
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(1.0 / SPIN)
        for body in bodies:
            x, y = box.world_to_local(body.position)
            assert max(abs(x - 8.0 * unit), abs(y)) <= HALF * unit


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dt", [0.001, 0.01])
def test_what_lies_on_a_roller_turns_with_its_surface(dt: float, unit: float) -> None:
    """A roller of radius 1 that turns with 10 rad/s, and on it, between guides without friction, a disk of radius .5:
    it comes to -20 rad/s, for any step. The spin of a disk turns neither its normals nor its tangents."""
    space, roller, disk = (
        pymunk.Space(),
        pymunk.Body(body_type=pymunk.Body.KINEMATIC),
        pymunk.Body(1.0, 0.125 * unit**2),
    )
    space.gravity = 0.0, -10.0 * unit
    roller.angular_velocity = 10.0
    disk.position, disk.angular_velocity = (0.0, 1.5 * unit), -19.0
    space.add(roller, pymunk.Circle(roller, unit), disk, pymunk.Circle(disk, 0.5 * unit))
    for shape in space.shapes:
        shape.friction = 1.0
    for x in (-0.5, 0.5):
        space.add(pymunk.Segment(space.static_body, (x * unit, 1.2 * unit), (x * unit, 3.0 * unit), 0.0))
    stepper = ep.EECA(space)
    for _ in range(50):
        assert stepper.step(dt).converged
    assert disk.angular_velocity == pytest.approx(-20.0, rel=1e-7)  # it may overlap the roller by as much


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("x", [0.0, 2.0])
@pytest.mark.parametrize("angle", [0.1, 0.4, 0.8, 1.6])
@pytest.mark.parametrize("held", [True, False])
def test_a_drum_keeps_what_it_carries(held: bool, angle: float, x: float, unit: float) -> None:
    """Walls that impulses move, `held` by a pivot: boxes sink by the tangents of the middle, from .8 rad a step on by
    more than the correction at the end of the step moves them, and corrections lift them before. Without a pivot that
    costs energy, as the angular momentum stays: what was lost in the step pays (boxes sink by .0026 at .1 rad, if it
    does not)."""
    space, drum = pymunk.Space(), pymunk.Body(1e4, 1e6 * unit * unit)
    drum.angular_velocity = SPIN
    corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF), (-HALF, -HALF)]
    ends = [(p * unit, q * unit) for p, q in corners]
    space.add(drum, *(pymunk.Segment(drum, p, q, 0.0) for p, q in pairwise(ends)))
    if held:
        space.add(pymunk.PivotJoint(space.static_body, drum, (0.0, 0.0)))
    box = pymunk.Body(1.0, 1.25 / 12.0 * unit * unit)
    box.position = x * unit, (0.25 - HALF) * unit
    box.velocity, box.angular_velocity = drum.velocity_at_world_point(box.position), SPIN
    space.add(box, pymunk.Poly.create_box(box, (unit, 0.5 * unit)))
    for shape in space.shapes:
        shape.friction = 1.0
    stepper = ep.EECA(space)
    energy, room = ep.measure(space).energy, 0.01 if held else {0.1: 0.001, 0.4: 0.005}.get(angle, 0.05)
    for _ in range(40):
        ledger = stepper.step(angle / SPIN).ledger
        assert abs(ledger.residual) <= 1e-12 * energy
        assert abs(ledger.external) <= 1e-12 * energy
        assert drum.world_to_local(box.position).y >= (0.25 - room - HALF) * unit

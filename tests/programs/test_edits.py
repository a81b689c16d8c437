"""What programs edit in place, between steps and without telling: the next step is that of a space built so."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space import edits

from ..steppers import state

DT = 1 / 60


def scene() -> pymunk.Space:
    """A box slides on a floor, and a disk falls on it, under a ceiling."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.1)
    ceiling = pymunk.Segment(space.static_body, (-5.0, 3.0), (5.0, 3.0), 0.1)
    box, ball = pymunk.Body(2.0, 0.5), pymunk.Body(1.0, 0.3)
    box.position, box.velocity = (0.0, 0.6), (2.0, 0.0)
    ball.position, ball.velocity = (0.6, 1.8), (0.0, 0.0)
    square, disk = pymunk.Poly.create_box(box, (1.0, 1.0)), pymunk.Circle(ball, 0.3)
    for shape in (floor, ceiling, square, disk):
        shape.friction, shape.elasticity = 0.4, 0.6
    space.add(floor, ceiling, box, square, ball, disk)
    return space


def parts(space: pymunk.Space) -> tuple[pymunk.Segment, pymunk.Body, pymunk.Poly, pymunk.Body, pymunk.Circle]:
    floor, _, square, disk = space.shapes
    box, ball = space.bodies
    return floor, box, square, ball, disk  # type: ignore[return-value]


def fall(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    pymunk.Body.update_velocity(body, (0.0, -2.0), damping, dt)


def rails(body: pymunk.Body, dt: float) -> None:
    pymunk.Body.update_position(body, dt)
    body.position = (body.position.x, 1.5)


def heavier(space: pymunk.Space) -> None:
    _, _, square, _, _ = parts(space)
    square.mass = 7.0


EDITS: dict[str, Callable[[pymunk.Space], None]] = {
    "friction": lambda s: setattr(parts(s)[2], "friction", 2.0),
    "elasticity": lambda s: setattr(parts(s)[4], "elasticity", 0.1),
    "surface velocity": lambda s: setattr(parts(s)[0], "surface_velocity", (3.0, 0.0)),
    "filter": lambda s: setattr(parts(s)[4], "filter", pymunk.ShapeFilter(mask=0)),
    "sensor": lambda s: setattr(parts(s)[2], "sensor", True),
    "radius of a circle": lambda s: parts(s)[4].unsafe_set_radius(0.5),
    "offset of a circle": lambda s: parts(s)[4].unsafe_set_offset((0.1, 0.1)),
    "ends of a segment": lambda s: parts(s)[0].unsafe_set_endpoints((-5.0, 0.0), (0.3, -0.1)),
    "radius of a segment": lambda s: parts(s)[0].unsafe_set_radius(0.05),
    "vertices": lambda s: parts(s)[2].unsafe_set_vertices([(-0.5, -0.5), (0.5, -0.5), (0.0, 0.5)]),
    "radius of a polygon": lambda s: parts(s)[2].unsafe_set_radius(0.1),
    "mass": lambda s: setattr(parts(s)[3], "mass", 20.0),
    "moment": lambda s: setattr(parts(s)[1], "moment", math.inf),
    "mass of a shape": heavier,
    "density of a shape": lambda s: setattr(parts(s)[2], "density", 3.0),
    "centre of gravity": lambda s: setattr(parts(s)[1], "center_of_gravity", (0.1, 0.2)),
    "static": lambda s: setattr(parts(s)[1], "body_type", pymunk.Body.STATIC),
    "kinematic": lambda s: setattr(parts(s)[1], "body_type", pymunk.Body.KINEMATIC),
    "velocity function": lambda s: setattr(parts(s)[3], "velocity_func", fall),
    "position function": lambda s: setattr(parts(s)[3], "position_func", rails),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS.keys())
def test_what_is_edited_in_place_is_seen_at_the_next_step(edit: Callable[[pymunk.Space], None]) -> None:
    ends = []
    for told in (False, True):
        space = scene()
        stepper = ep.EECA(space)
        for _ in range(5):
            stepper.step(DT)
        # Of both, nothing is kept of the steps before.
        stepper.refresh()
        stepper.step(DT)
        untouched = copy.deepcopy(space)
        edit(space)
        if told:
            stepper = ep.EECA(space)
        for _ in range(30):
            stepper.step(DT)
        ends.append(state(space))
    # Up to round-off: results of earlier steps are kept only without a new stepper.
    for mine, theirs in zip(*ends, strict=True):
        assert mine == pytest.approx(theirs, rel=1e-12, abs=1e-12)
    other = ep.EECA(untouched)
    for _ in range(30):
        other.step(DT)
    assert state(untouched) != ends[0]


@pytest.mark.parametrize("name", ["friction", "mass", "velocity function", "radius of a circle"])
def test_setters_do_what_pymunks_do(name: str) -> None:
    """Under pymunk's own step a space that is watched and one that is not go the same way."""
    spaces = [scene(), scene()]
    ep.EECA(spaces[0])
    for space in spaces:
        for _ in range(10):
            space.step(DT)
        EDITS[name](space)
        for _ in range(30):
            space.step(DT)
    assert state(spaces[0]) == state(spaces[1])


def test_only_edits_are_counted_and_only_in_their_space() -> None:
    space, other = scene(), scene()
    count, others = edits.counts(space), edits.counts(other)
    assert edits.counts(space) is count
    floor, _, _, ball, disk = parts(space)
    before = count[0]
    floor.friction = floor.friction
    ball.mass = ball.mass
    ball.velocity, ball.position, ball.force = (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)
    disk.collision_type = 3
    pymunk.Circle(pymunk.Body(1.0, 1.0), 1.0).friction = 0.5
    assert count[0] == before
    floor.friction = 0.9
    disk.unsafe_set_radius(0.2)
    assert count[0] == before + 2
    assert others[0] == 0
    assert isinstance(pymunk.Shape.friction.__doc__, str)


def test_an_edit_that_cannot_be_is_refused_and_taken_back() -> None:
    space = scene()
    stepper = ep.EECA(space)
    stepper.step(DT)
    parts(space)[0].elasticity = math.inf
    before = state(space)
    with pytest.raises(ValueError, match="elasticity inf"):
        stepper.step(DT)
    assert state(space) == before
    parts(space)[0].elasticity = 0.5
    stepper.step(DT)


@pytest.mark.parametrize("edited", [("sensor", True), ("filter", pymunk.ShapeFilter(mask=0))])
def test_a_callback_may_edit_what_it_meets(edited: tuple[str, object]) -> None:
    """Sounds silly, is common: a shape becomes a sensor, or passes what it met, when it is first hit. Whether that hit
    takes place depends on the version of pymunk."""
    after = []
    for make in (ep.Native, ep.EECA):
        space = pymunk.Space()
        ball = pymunk.Body(1.0, math.inf)
        ball.position, ball.velocity = (0.0, 0.0), (4.0, 0.0)
        disk, wall = pymunk.Circle(ball, 0.1), pymunk.Segment(space.static_body, (1.0, -1.0), (1.0, 1.0), 0.0)
        disk.elasticity = wall.elasticity = 1.0
        space.add(ball, disk, wall)
        space.on_collision(begin=lambda arbiter, space, data, wall=wall: setattr(wall, *edited))
        stepper = make(space)
        for _ in range(20):
            stepper.step(DT)
        after.append(ball.velocity.x)
        ball.position, ball.velocity = (0.0, 0.0), (4.0, 0.0)
        for _ in range(40):
            stepper.step(DT)
        assert ball.position.x == pytest.approx(40 * DT * 4.0)
    assert abs(after[0]) == pytest.approx(4.0)
    assert after[1] == pytest.approx(after[0])


def test_bodies_of_infinite_moment_that_spin_count_for_nothing_infinite() -> None:
    space = pymunk.Space()
    for spin in (1.0, -2.0):
        body = pymunk.Body(1.0, math.inf)
        body.angular_velocity, body.velocity = spin, (0.0, 1.0)
        space.add(body)
    stepper = ep.EECA(space)
    stepper.step(DT)
    assert ep.measure(space).kinetic == 1.0
    assert ep.measure(space).angular_momentum == 0.0
    assert [b.angular_velocity for b in space.bodies] == [1.0, -2.0]


def lifted_by(move: Callable[[pymunk.Body], None], sync: bool = True) -> tuple[pymunk.Body, pymunk.Body, float]:
    """A ball of 2 kg that rests on a kinematic plate, which `move` changes before each of 40 steps; the ball, the
    plate, and what came from outside (J)."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    ball = pymunk.Body(2.0, pymunk.moment_for_circle(2.0, 0.0, 0.5))
    ball.position = (0.0, 0.6)
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    disk, top = pymunk.Circle(ball, 0.5), pymunk.Segment(plate, (-2.0, 0.0), (2.0, 0.0), 0.1)
    disk.friction = top.friction = 0.5
    space.add(ball, disk, plate, top)
    stepper = ep.EECA(space, sync=sync)
    external = 0.0
    for k in range(60):
        if 10 <= k < 50:
            move(plate)
        report = stepper.step(DT)
        assert report.ledger is not None
        external += report.ledger.external
        assert abs(report.ledger.residual) < 1e-12
    return ball, plate, external


@pytest.mark.parametrize("sync", [True, False])
def test_a_plate_that_is_put_higher_lifts_what_rests_on_it_by_work_from_outside(sync: bool) -> None:
    """A program that sets positions and not velocities: the ball is 40 times .05 higher, at rest; the work is m g h."""
    ball, plate, external = lifted_by(lambda plate: setattr(plate, "position", (0.0, plate.position.y + 0.05)), sync)
    assert plate.position.y == pytest.approx(2.0)
    assert ball.position.y == pytest.approx(2.6, abs=1e-8)
    assert ball.velocity.length < 1e-9
    assert external == pytest.approx(2.0 * 10.0 * 2.0, rel=1e-8)


def test_a_plate_that_is_put_lower_lets_the_ball_fall_and_does_no_work() -> None:
    ball, plate, external = lifted_by(lambda plate: setattr(plate, "position", (0.0, plate.position.y - 0.05)))
    assert ball.position.y > plate.position.y + 0.6 - 1e-9
    assert external == pytest.approx(0.0, abs=1e-9)

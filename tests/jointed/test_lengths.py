"""How long intervals of islands with joints are: what moves far in a step stays inside of walls without width."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random
from types import SimpleNamespace

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import kind_of, zeros
from eeca_pymunk.jointed.gathered import gave_way
from eeca_pymunk.jointed.lengths import next_length
from eeca_pymunk.model.joint_steps import ELASTIC, UNHELD, JointLedger
from eeca_pymunk.model.joints import GIVES_WAY, Component, Coupling, Joint
from eeca_pymunk.model.parameters.intervals import INTERVAL_GROWTH, INTERVAL_RETRY
from scenes.linkages import body, empty
from tests.programs.compositions import Composition

HALF = 3.0


def add(space: pymunk.Space, place: tuple[float, float], disk: bool) -> pymunk.Body:
    """A disk, or a rod without width."""
    body = pymunk.Body(1.0, 0.1)
    body.position = place
    shape = pymunk.Circle(body, 0.3) if disk else pymunk.Segment(body, (-0.5, 0.0), (0.5, 0.0), 0.0)
    shape.elasticity = shape.friction = 0.5
    space.add(body, shape)
    return body


def room(kind: str, speed: float, gravity: float) -> pymunk.Space:
    """Two bodies on a joint that whirl, among walls without width."""
    space = pymunk.Space()
    space.gravity = 0.0, -gravity
    corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF), (-HALF, -HALF)]
    for p, q in pairwise(corners):
        wall = pymunk.Segment(space.static_body, p, q, 0.0)
        wall.elasticity = wall.friction = 0.5
        space.add(wall)
    a, b = add(space, (-1.0, 0.0), kind == "pin"), add(space, (1.0, 0.0), kind != "pivot")
    a.velocity, b.velocity = (5.0, -speed), (2.0, speed)
    joint: pymunk.Constraint = pymunk.PinJoint(a, b)
    if kind == "pivot":
        joint = pymunk.PivotJoint(a, b, (1.0, 0.0), (-1.0, 0.0))
    elif kind == "slide":
        joint = pymunk.SlideJoint(a, b, (0.5, 0.0), (0.0, 0.0), 0.5, 2.0)
    elif kind == "spring":
        joint = pymunk.DampedSpring(a, b, (0.5, 0.0), (0.0, 0.0), 0.2, 400.0, 0.0)
    space.add(joint)
    return space


@pytest.mark.parametrize("kind", ["pin", "pivot", "slide", "spring"])
@pytest.mark.parametrize(("speed", "gravity"), [(20.0, 300.0), (60.0, 300.0), (200.0, 0.0), (200.0, 300.0)])
def test_what_whirls_on_a_joint_stays_inside(kind: str, speed: float, gravity: float) -> None:
    """At 1/15 s they turn by radians in a step, or fall by 1.3 m, on paths that joints bend."""
    space = room(kind, speed, gravity)
    stepper = ep.EECA(space)
    for _ in range(60):
        ledger = stepper.step(1 / 15).ledger
        assert ledger is not None
        assert abs(ledger.residual) <= 1e-11 * (abs(ep.measure(space).energy) + abs(ledger.change) + 1.0)
        assert max(max(map(abs, body.position)) for body in space.bodies) <= HALF + 1e-3


@pytest.mark.parametrize(("seed", "steps"), [(14, 20), (21, 10), (66, 10), (70, 5), (100, 10), (190, 5)])
def test_steps_with_joints_that_end_early_close_their_ledgers(seed: int, steps: int) -> None:
    """Bodies of 1 mm at 30 Hz, which fall by dozens of their sizes in a step: spans that are not to be are not booked,
    and nobody leaves."""
    Composition(seed, joints=True).play(steps)


def test_spans_with_joints_end_early_rather_than_joints_give_way() -> None:
    """A chain of rods in the corner of a room, at 300 g: joints hold however little of a step the work suffices for."""
    space = room("pivot", 200.0, 3000.0)
    (joint,) = space.constraints
    assert isinstance(joint, pymunk.PivotJoint)
    stepper = ep.EECA(space)
    for _ in range(40):
        stepper.step(1 / 15)
        ends = joint.a.local_to_world(joint.anchor_a), joint.b.local_to_world(joint.anchor_b)
        assert (ends[0] - ends[1]).length <= 1e-9


@pytest.mark.parametrize("seed", [83, 232, 263, 393, 425, 466, 484, 541, 1075, 1326, 2588, 2707])
def test_what_a_stiff_spring_swings_in_a_step_stays_inside(seed: int) -> None:
    """The end of an interval in which a spring swings more than once jumps with its length: on the way to the instant
    at which a body was to meet a wall it was brought to the far side."""
    R, space = Random(seed), pymunk.Space()
    for p, q in pairwise([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0), (-5.0, -5.0)]):
        wall = pymunk.Segment(space.static_body, p, q, 0.0)
        wall.elasticity = 0.5
        space.add(wall)
    heavy, light = pymunk.Body(2000.0, math.inf), pymunk.Body(1.0, 0.1)
    heavy.position = R.uniform(1, 4), R.uniform(-4, 4)
    light.position = R.uniform(-4, -2), R.uniform(-4, 4)
    light.velocity, light.angle = (R.uniform(-90, 90), R.uniform(-90, 90)), R.uniform(0, 3)
    space.add(heavy, light, pymunk.Circle(heavy, 0.3), pymunk.Poly.create_box(light, (0.8, 0.5)))
    stiffness, far = 10 ** R.uniform(3, 6), (heavy.position - light.position).length
    length, damping = R.choice((0.5, 1.0)) * far, R.choice((0, stiffness * 1e-3))
    space.add(pymunk.DampedSpring(heavy, light, (0, 0), (-0.1, -0.3), length, stiffness, damping))
    if R.random() < 0.5:
        light.moment = math.inf
    stepper, dt = ep.EECA(space), R.choice((1 / 60, 1 / 30, 1 / 10))
    for _ in range(4):
        stepper.step(dt)
        assert max(abs(x) for body in (heavy, light) for x in body.position) < 5.0


@pytest.mark.parametrize("handler", [False, True])
@pytest.mark.parametrize("edited", [False, True])
def test_how_long_intervals_may_be_is_known_until_a_body_is_edited(edited: bool, handler: bool) -> None:
    """A pendulum whose last interval was shortened to a quarter of a step takes 1/4 and the rest of the next one, also
    where the program has a handler of collisions; and a whole one if its velocity was set."""
    space = empty(9.81)
    bob = body(space, 1.0, 0.1, (0.0, -1.0))
    bob.velocity = (0.5, 0.0)
    space.add(pymunk.Circle(bob, 0.1), pymunk.PinJoint(space.static_body, bob))
    if handler:
        space.on_collision(1, 2, begin=lambda *_: None)
    stepper = ep.EECA(space)
    stepper.step(1 / 60)
    loop = stepper.event_loop
    assert loop is not None
    loop.scene.RESTING["longest"] = 0.25 / 60
    if edited:
        bob.velocity *= 0.9
    stepper.step(1 / 60)
    assert loop.scene.COUNT.solves == (1 if edited else 2)


def test_how_long_intervals_may_be_is_remembered_beyond_an_impact() -> None:
    """Two disks on a pin that fall on a floor in the middle of a step: what comes after is no more than
    INTERVAL_GROWTH times as long as what has been found, as an island that is hard to solve would be solved in vain."""
    space = empty(0.0)
    one, two = (body(space, 1.0, 0.1, (x, 0.0)) for x in (-1.0, 1.0))
    floor = pymunk.Segment(space.static_body, (-9.0, -0.7), (9.0, -0.7), 0.1)
    space.add(pymunk.Circle(one, 0.5), pymunk.Circle(two, 0.4), pymunk.PinJoint(one, two), floor)
    one.velocity = two.velocity = (0.0, -12.0)
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    loop, dt = stepper.event_loop, 1 / 60
    assert loop is not None
    loop.scene.RESTING["longest"] = 1e-3 * dt
    assert stepper.step(dt).contacts
    assert max(loop.scene.RESTING["longest"][:2]) <= INTERVAL_GROWTH * 1.5 * dt


def test_a_joint_tells_its_force_whatever_the_intervals_of_a_step() -> None:
    """What hangs pulls with m g, and the impulse of a step is m g dt."""
    space = empty(9.81)
    weight = body(space, 2.0, 0.1, (0.0, -1.0))
    joint = pymunk.PinJoint(space.static_body, weight)
    space.add(joint)
    stepper = ep.EECA(space)
    for dt in (1 / 60, 1 / 60, 1 / 240):
        stepper.step(dt)
        assert joint.impulse == pytest.approx(2.0 * 9.81 * dt, rel=1e-9)
        loop = stepper.event_loop
        assert loop is not None
        loop.scene.RESTING["longest"] = 0.25 * dt


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("dt", [0.03, 0.04, 0.1])
@pytest.mark.parametrize("spin", [1.0, 2.0])
def test_what_slides_along_a_wall_that_turns_does_not_go_through_it(spin: float, dt: float, unit: float) -> None:
    """A motor lets a plank turn with a container, on whose floor it slides 24 of its heights far, into a corner, in a
    time s of 0.024 s. Rows are those of the start where bodies slide so far; the floor rises by spin v s^2 = 0.58 spin
    heights. Whole steps end beyond the corner, where nothing overlaps."""
    space = pymunk.Space()
    box, plank = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 0.4 * unit**2)
    space.add(box, plank, pymunk.Poly.create_box(plank, (2.0 * unit, unit)), pymunk.SimpleMotor(box, plank, 0.0))
    corners = [(-17.0, -17.0), (17.0, -17.0), (17.0, 17.0), (-17.0, 17.0), (-17.0, -17.0)]
    for (ax, ay), (bx, by) in pairwise(corners):
        space.add(pymunk.Segment(box, (ax * unit, ay * unit), (bx * unit, by * unit), 0.0))
    box.angular_velocity = plank.angular_velocity = spin
    plank.position = -8.0 * unit, -16.5 * unit
    carried = box.velocity_at_local_point(plank.position)
    plank.velocity = carried.x + 1000.0 * unit, carried.y
    report = ep.EECA(space).step(dt)
    x, y = box.world_to_local(plank.position)
    assert report.converged
    assert x <= 16.1 * unit
    assert y >= -16.75 * unit


@pytest.mark.parametrize(
    ("status", "compliance", "gave", "worse"),
    [(ELASTIC, 1e-9, 1e-3, False), (ELASTIC, 2e-9, 1e-3, True), (ELASTIC, 2e-9, 1e-6, False), (UNHELD, 0.0, 0.0, True)],
)
def test_elastic_joints_hold_worse_if_they_are_softer_and_more_than_twice_as_far_apart(
    status: int, compliance: float, gave: float, worse: bool
) -> None:
    """Those that contradict one another are as far apart in an interval of any length."""
    J = SimpleNamespace(
        COMPONENT=zeros(1, kind_of(Component)), COUPLING=zeros(1, kind_of(Coupling)), JOINT=zeros(1, kind_of(Joint)),
        AT_START=zeros(1, kind_of(Joint)), STEPPED=zeros(1, kind_of(JointLedger)),
    )  # fmt: skip
    J.COMPONENT[0].end_joint = 1
    J.AT_START[0].touched, J.AT_START[0].compliance, J.JOINT[0].compliance = GIVES_WAY, 1e-9, compliance
    J.STEPPED[0].status, J.STEPPED[0].misfit, J.STEPPED[0].misfit_added = status, 1e-5, gave
    assert gave_way(J, 0) == worse


def test_intervals_grow_as_their_motion_allows() -> None:
    """Not beyond what would be too long, but by half at least, and by INTERVAL_GROWTH at most: 1e-4 s becomes a step of
    1/60 s in three intervals where nothing moves."""
    for far in (0.15, 0.2, 0.5):
        assert next_length(1e-3, far) == pytest.approx(1e-3 / far)
    assert next_length(1e-3, 1.4) == pytest.approx(INTERVAL_RETRY * 1e-3)
    assert next_length(next_length(next_length(1e-4, 0.0), 0.0), 0.0) > 1 / 60

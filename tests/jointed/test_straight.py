"""Bodies on a straight chain of joints between fixed points, which cannot move: bridges and ropes without slack."""

from __future__ import annotations

import copy
import itertools
import math
import pickle
from collections.abc import Sequence

import numpy as np
import pymunk
import pytest
from pymunk import Vec2d

import eeca_pymunk as ep
from eeca_pymunk.impacts.scene import EventLoop

from .measures import apart, energy
from .test_taut import DT, LONG, SIDE, bridge


def held(stepper: ep.EECA) -> int:
    """How many bodies are held."""
    method = stepper._method
    assert isinstance(method, EventLoop)
    return int(method.joints.TALLY.pinned)


def laden(load: float, planks: int, height: float = 0.06) -> tuple[pymunk.Space, list[pymunk.Body], pymunk.Body]:
    """A box of mass `load` above the middle of a bridge without slack."""
    space, deck = bridge(0.0, planks=planks)
    box = pymunk.Body(load, load * SIDE**2 / 6)
    box.position = 0.5 * planks * LONG, height + 0.5 * SIDE
    space.add(box, pymunk.Poly.create_box(box, (SIDE, SIDE)))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.8
    return space, deck, box


def rope(count: int, friction: float = 0.0, joint: type = pymunk.PinJoint) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Balls a unit apart on a straight rope between two fixed points, joined at their centres."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    ends = [space.static_body, *(pymunk.Body(1.0, 0.02) for _ in range(count)), space.static_body]
    for k, ball in enumerate(ends[1:-1]):
        ball.position = k + 1.0, 0.0
        shape = pymunk.Circle(ball, 0.2)
        shape.friction = friction
        space.add(ball, shape)
    for k in range(count + 1):
        there = (0.0, 0.0) if k < count else (count + 1.0, 0.0)
        limits = (0.0, 1.0) if joint is pymunk.SlideJoint else ()
        space.add(joint(ends[k], ends[k + 1], (0.0, 0.0), there, *limits))
    return space, ends[1:-1]


@pytest.mark.parametrize("load", [1.0, 20.0])
@pytest.mark.parametrize("planks", [20, 60])
def test_a_bridge_without_slack_is_a_floor(planks: int, load: float) -> None:
    space, deck, box = laden(load, planks)
    stepper, last = ep.EECA(space), energy(space)
    for _ in range(240):
        report = stepper.step(DT)
        assert report.converged
        assert abs(report.ledger.residual) <= 1e-12 * load
        assert abs(report.ledger.external) <= 1e-12 * load
        assert energy(space) <= last + 1e-12 * load
        last = energy(space)
    assert held(stepper) == planks
    assert box.position.y == pytest.approx(0.04 + 0.5 * SIDE, abs=1e-9)
    assert apart(space) < 1e-14
    assert all(body.position.y == 0.0 and body.velocity.length == 0.0 for body in deck)


@pytest.mark.parametrize("joint", [pymunk.PinJoint, pymunk.SlideJoint])
def test_a_rope_without_slack_holds_what_hits_it(joint: type) -> None:
    """A ball of 200 link masses bounces as from fixed balls; a ball on the rope spins on."""
    space, links = rope(20, joint=joint)
    links[3].angular_velocity = 2.0
    heavy = pymunk.Body(200.0, 9.0)
    heavy.position, heavy.velocity = (10.0, 3.0), (0.0, -20.0)
    space.add(heavy, pymunk.Circle(heavy, 0.3))
    for shape in space.shapes:
        shape.elasticity = 1.0
    stepper, start = ep.EECA(space), energy(space)
    assert all(stepper.step(DT).converged for _ in range(60))
    assert energy(space) == pytest.approx(start, rel=1e-13)
    assert [link.position for link in links] == [(k + 1.0, 0.0) for k in range(20)]
    assert links[3].angle == pytest.approx(2.0)
    assert heavy.position.y > 0.2


def test_balls_that_rub_are_held_and_do_not_turn() -> None:
    """A box falls on a rope without slack, whose balls have friction: each step had spent all its work, and time had
    stood still, also without the box. A motor that turns a ball frees all."""
    space, links = rope(5, friction=0.5)
    box = pymunk.Body(2.0, 1.0)
    box.position, box.velocity = (3.0, 1.0), (0.5, 0.0)
    shape = pymunk.Poly.create_box(box, (2.4, 0.4))
    shape.friction = 0.5
    space.add(box, shape)
    stepper = ep.EECA(space)
    assert held(stepper) == 5
    for _ in range(120):
        report = stepper.step(DT)
        assert report.converged
        assert abs(report.ledger.external) <= 1e-12 * 20.0
    assert all(link.position == (k + 1.0, 0.0) and link.angle == 0.0 for k, link in enumerate(links))
    assert box.velocity.length <= 1e-9
    space.add(pymunk.SimpleMotor(space.static_body, links[0], 1.0))
    stepper.step(DT)
    assert held(stepper) == 0


@pytest.mark.parametrize(("slack", "load"), [(1e-10, 1.0), (1e-7, 1.0), (1e-7, 20.0)])
def test_what_is_hardly_longer_than_its_gap_does_not_stop_time(slack: float, load: float) -> None:
    """A box falls freely beside a bridge that joints of no length of an interval hold exactly: these had been halved
    until the work of a step was spent, of which it took a twentieth."""
    space, _, box = laden(load, 20)
    last = list(space.constraints)[-1]
    last.anchor_b = last.anchor_b - (slack, 0.0)
    clock = pymunk.Body(1.0, 1.0)
    clock.position = 1e3, 0.0
    space.add(clock, pymunk.Circle(clock, 0.1))
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert clock.velocity.y <= -0.7 * 9.81 * 60 * DT
    assert apart(space) <= 1e-3
    assert box.position.y > 0.0


@pytest.mark.parametrize(("slack", "found"), [(0.0, 12), (1e-13, 12), (1e-9, 0), (1e-3, 0)])
def test_slack_frees_all(slack: float, found: int) -> None:
    assert held(ep.EECA(bridge(slack)[0])) == found


def test_straight_pieces_of_what_is_bent_move() -> None:
    """A rope that is straight up to where it hangs down, and one with a bounded joint."""
    space, links = rope(6)
    space.remove(*[joint for joint in space.constraints if links[5] in (joint.a, joint.b) and joint.b is not links[5]])
    assert held(ep.EECA(space)) == 0
    space, _ = rope(6)
    list(space.constraints)[3].max_force = 100.0
    assert held(ep.EECA(space)) == 0


def test_what_hangs_from_a_held_body_swings() -> None:
    """A pendulum on the middle of a bridge moves as one on a fixed point, bit by bit."""
    ends = []
    for fixed in (False, True):
        space, deck = bridge(0.0, planks=4)
        bob = pymunk.Body(1.0, 0.1)
        bob.position = 3.0, -2.0
        end, anchor = (space.static_body, (1.0, 0.0)) if fixed else (deck[1], (0.25, 0.0))
        space.add(bob, pymunk.PinJoint(end, bob, anchor))
        stepper = ep.EECA(space)
        for _ in range(100):
            stepper.step(DT)
        ends.append((bob.position, bob.velocity))
    assert ends[0] == ends[1]


def test_two_held_chains_hold_a_third() -> None:
    """A beam between the middles of two bridges, one above the other."""
    space, low = bridge(0.0, planks=4)
    joints = list(space.constraints)
    high = []
    for plank in low:
        body = pymunk.Body(plank.mass, plank.moment)
        body.position = plank.position + Vec2d(0.0, 3.0)
        high.append(body)
        space.add(body)
    twin = dict(zip(low, high, strict=True))
    for joint in joints:
        a, b = (twin.get(body, body) for body in (joint.a, joint.b))
        up = [anchor + Vec2d(0.0, 3.0 if body is space.static_body else 0.0) for anchor, body in
              ((joint.anchor_a, a), (joint.anchor_b, b))]  # fmt: skip
        space.add(pymunk.PivotJoint(a, b, *up))
    beam = pymunk.Body(1.0, 1.0)
    beam.position = 0.75, 1.5
    space.add(beam, pymunk.PivotJoint(low[1], beam, (0.0, 0.0), (0.0, -1.5)))
    space.add(pymunk.PivotJoint(beam, high[1], (0.0, 1.5), (0.0, 0.0)))
    stepper = ep.EECA(space)
    assert held(stepper) == 9
    stepper.step(DT)
    assert beam.velocity == (0.0, 0.0)


def test_a_joint_that_is_removed_lets_all_fall() -> None:
    space, deck, _ = laden(2.0, 12)
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(DT)
    start = energy(space)
    space.remove(list(space.constraints)[6])
    for _ in range(30):
        assert abs(stepper.step(DT).ledger.residual) < 1e-11
    assert held(stepper) == 0
    assert deck[6].position.y < -0.1
    assert energy(space) <= start + 1e-11


def test_ends_that_are_brought_nearer_or_farther_free_and_hold() -> None:
    space, deck = bridge(0.0)
    last = list(space.constraints)[-1]
    stepper = ep.EECA(space)
    stepper.step(DT)
    assert held(stepper) == 12
    last.anchor_b = 5.9, 0.0
    for _ in range(20):
        stepper.step(DT)
    assert held(stepper) == 0
    assert deck[5].position.y < -0.01
    space, _ = bridge(0.0)
    pole = pymunk.Body(body_type=pymunk.Body.STATIC)
    space.remove(list(space.constraints)[-1])
    pole.position = 6.0, 0.1
    space.add(pymunk.PivotJoint(list(space.bodies)[-1], pole, (0.25, 0.0), (0.0, -0.1)))
    stepper = ep.EECA(space)
    stepper.step(DT)
    assert held(stepper) == 12
    pole.position = 5.9, 0.1
    stepper.step(DT)
    assert held(stepper) == 0


def test_a_held_body_goes_back_and_what_it_loses_is_booked() -> None:
    space, deck = bridge(0.0)
    stepper = ep.EECA(space)
    stepper.step(DT)
    deck[4].velocity, deck[4].angular_velocity = (1.0, 2.0), 3.0
    deck[7].position, deck[7].angle = (9.0, 9.0), 1.0
    expected = 0.5 * (5.0 + 9.0 * LONG**2 / 12)
    report = stepper.step(DT)
    assert report.ledger.restitution == pytest.approx(expected)
    assert report.ledger.change == pytest.approx(-expected)
    assert deck[4].velocity == (0.0, 0.0)
    assert deck[7].position == (7.5 * LONG, 0.0)
    assert deck[7].angle == 0.0


@pytest.mark.parametrize("speed", [0.0, 1.0])
@pytest.mark.parametrize("weld", [False, True], ids=["in a chain", "on a weld"])
def test_a_kinematic_body_goes_where_its_program_says(weld: bool, speed: float) -> None:
    """Neither a straight chain nor a weld holds it. Joints cannot follow: steps end early, and say so. At rest it holds
    others as a static body does."""
    space, post = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    links = [pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)]
    links[0].position, links[1].position, post.velocity = (-1.0, 0.0), (1.0, 0.0), (0.0, speed)
    chain = [space.static_body, links[0], post, links[1], space.static_body]
    space.add(post, *links)
    for k, (a, b) in enumerate(itertools.pairwise(chain[: 3 if weld else 5])):
        space.add(pymunk.PivotJoint(a, b, (k - 1.5, 0.0)))
        if weld:
            space.add(pymunk.GearJoint(a, b, 0.0, 1.0))
    stepper = ep.EECA(space)
    reports = [stepper.step(DT) for _ in range(5)]
    assert held(stepper) == (0 if speed > 0.0 else 1 if weld else 2)
    assert post.velocity == (0.0, speed)
    assert (post.position.y > 0.0) == (speed > 0.0)
    assert all(report.converged == (speed == 0.0) for report in reports)


def test_a_bridge_hangs_on_a_kinematic_post() -> None:
    """While the post is at rest, the bridge holds as on a static one (its joints opened by 1e-4 of a plank under loads,
    as those of a straight chain whose end may move). Once the program moves the post, it sags; a run of steps, and a
    copy, go the same way."""
    space, deck, _ = laden(10.0, 12, height=0.5)
    post = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    last = next(j for j in list(space.constraints)[::-1] if isinstance(j, pymunk.PivotJoint))
    post.position = deck[-1].local_to_world((0.5 * LONG, 0.0))
    space.remove(last)
    space.add(pymunk.PivotJoint(deck[-1], post, (0.5 * LONG, 0.0), (0.0, 0.0)), post)
    stepper = ep.EECA(space)
    assert all(stepper.step(DT).converged for _ in range(60))
    assert held(stepper) == 12
    assert apart(space) == 0.0
    post.velocity = -0.5, 0.0
    copied = pickle.loads(pickle.dumps(stepper))
    copied.run(30, DT)
    for _ in range(30):
        stepper.step(DT)
    assert held(stepper) == 0
    assert apart(space) <= 1e-9
    assert deck[6].position.y < -0.1
    assert [body.position for body in copied.space.bodies] == [body.position for body in space.bodies]
    post.velocity = 0.0, 0.0
    stepper.step(DT)
    assert held(stepper) == 0


def test_copies_runs_and_rollouts_go_the_same_way() -> None:
    space, _, box = laden(5.0, 12, height=0.4)
    box.angle = 0.3
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    other, twin = pickle.loads(pickle.dumps((space, stepper)))
    again, third = copy.deepcopy((space, stepper))
    state = stepper.get_state()
    start = np.array([[*b.position, b.angle, *b.velocity, b.angular_velocity] for b in space.bodies])
    for _ in range(50):
        stepper.step(DT)
        twin.step(DT)
    third.run(50, DT)
    ends = [[(*b.position, b.angle, *b.velocity) for b in one.bodies] for one in (space, other, again)]
    assert ends[0] == ends[1] == ends[2]
    stepper.set_state(state)
    for _ in range(50):
        stepper.step(DT)
    assert [(*b.position, b.angle, *b.velocity) for b in space.bodies] == ends[0]
    frames = ep.rollout(stepper, np.stack((start, start)), 50, DT, threads=2)
    stepper.set_state(start)
    for _ in range(50):
        stepper.step(DT)
    assert frames[1, -1, -1, :2].tolist() == list(box.position)
    assert frames[0].tobytes() == frames[1].tobytes()


def test_units_and_turns_do_not_matter() -> None:
    """The bridge from corner to corner of large coordinates, in mm and km."""
    for unit in (1e-3, 1.0, 1e3):
        space = pymunk.Space()
        far, along = 1e3 * unit, np.array((math.cos(0.7), math.sin(0.7)))
        before, anchor = space.static_body, (far, far)
        for k in range(30):
            plank = pymunk.Body(1.0, unit**2)
            plank.position, plank.angle = tuple(far + (k + 0.5) * unit * along), 0.7
            space.add(plank, pymunk.PivotJoint(before, plank, anchor, (-0.5 * unit, 0.0)))
            before, anchor = plank, (0.5 * unit, 0.0)
        space.add(pymunk.PivotJoint(before, space.static_body, anchor, tuple(far + 30.0 * unit * along)))
        assert held(ep.EECA(space)) == 30


def test_only_edits_of_lengths_and_anchors_look_for_straight_chains_again() -> None:
    """A rate that a program sets in each step must not cost a search."""
    space, deck = bridge(0.0)
    motor = pymunk.SimpleMotor(deck[0], deck[1], 1.0)
    space.add(motor)
    stepper = ep.EECA(space)
    stepper.step(DT)
    joints = stepper._world.joints if stepper._world is not None else None
    assert joints is not None
    motor.rate = 2.0
    joints.refresh()
    assert not joints.ends_moved
    next(iter(space.constraints)).anchor_a = 0.1, 0.0
    joints.refresh()
    assert joints.ends_moved


def hinged(order: Sequence[str], x: float = 0.0) -> pymunk.Space:
    """Two bars between fixed points, on whose common hinge a third one hangs; their pivots are added in this order.
    `x`: of the hinge."""
    space = pymunk.Space()
    space.gravity = 10.0, -10.0
    bars = []
    for at in ((x - 1.0, 0.0), (x + 1.0, 0.0), (x, -1.0)):
        bars.append(pymunk.Body(1.0, 1.0 / 3.0))
        bars[-1].position = at
    left, right, low = bars
    ends = {
        "left": (space.static_body, left, x - 2.0), "both": (left, right, x), "one": (left, low, x),
        "other": (right, low, x), "right": (right, space.static_body, x + 2.0),
    }  # fmt: skip
    space.add(*bars, *(pymunk.PivotJoint(*ends[name][:2], (ends[name][2], 0.0)) for name in order))
    return space


def test_bars_that_meet_in_one_point_are_held_whatever_the_order_of_their_joints() -> None:
    """Joints of length 0 form a cycle there; the body that hangs on them swings."""
    for order in itertools.permutations(("left", "both", "one", "other", "right")):
        space = hinged(order)
        stepper = ep.EECA(space)
        assert held(stepper) == 2, order
        for _ in range(3):
            stepper.step(DT)
        assert [*space.bodies][2].angular_velocity > 0.1
        assert max(body.velocity.length for body in [*space.bodies][:2]) == 0.0


def test_wheels_that_hold_one_another_twice_in_one_point_turn() -> None:
    """Each by two joints of length 0 on the next one, the first and the last on an axle: 2^30 chains, if those that
    differ by which of two joints they use are all followed."""
    space = pymunk.Space()
    wheels = [pymunk.Body(1.0, 1.0) for _ in range(30)]
    space.add(*wheels)
    for a, b in [(space.static_body, wheels[0]), *itertools.pairwise(wheels), (space.static_body, wheels[-1])]:
        space.add(*(pymunk.PivotJoint(a, b, (0.0, 0.0)) for _ in range(2)))
    for k, wheel in enumerate(wheels):
        wheel.angular_velocity = k - 0.5
    stepper = ep.EECA(space)
    for _ in range(3):
        assert stepper.step(DT).converged
    assert [wheel.angle for wheel in wheels] == pytest.approx([3.0 * DT * (k - 0.5) for k in range(30)], abs=1e-14)


@pytest.mark.parametrize("x", [0.0, 0.125, 1.0])
def test_what_hangs_on_the_origin_swings_as_elsewhere(x: float) -> None:
    """Round-off of a point at the origin is that of the numbers whose sum it is."""
    space = hinged(("left", "one", "other", "right"), x)
    [*space.constraints][2].anchor_b = 0.0, 1.0 + 2.3e-16
    stepper = ep.EECA(space)
    assert held(stepper) == 0
    for _ in range(20):
        stepper.step(DT)
    assert [*space.bodies][2].angle > 0.3


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_wheel_on_two_equal_pivots_turns_as_on_one(friction: float) -> None:
    """By a torque T = 1 for 1 s from 3 rad/s: 3 + T t / I = 5 rad/s."""
    space = pymunk.Space()
    wheel = pymunk.Body(2.0, 0.5)
    wheel.angular_velocity = 3.0
    rim = pymunk.Circle(wheel, 0.5)
    rim.friction = friction
    space.add(wheel, rim, *(pymunk.PivotJoint(space.static_body, wheel, (0.0, 0.0)) for _ in range(2)))
    stepper = ep.EECA(space)
    for _ in range(60):
        wheel.torque = 1.0
        stepper.step(1 / 60)
    assert wheel.angular_velocity == pytest.approx(5.0, abs=1e-9)
    assert wheel.position.length < 1e-12

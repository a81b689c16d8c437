"""Joints of a real space through `EECA.step`: all kinds, edits, callbacks, impulses, and native steps in between."""

from __future__ import annotations

import copy
import gc
import math
import pickle
import weakref
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.joints import JointRows
from scenes.linkages import bars, body, chain, empty, pendulum

DT = 1 / 60
Bodies = list[pymunk.Body]


def pair(gravity: float = 10.0) -> tuple[pymunk.Space, Bodies]:
    """Two bodies of which the first hangs from a pivot, moving."""
    space = empty(gravity)
    a, b = body(space, 2.0, 0.3, (0.0, -1.0)), body(space, 1.0, 0.2, (1.0, -1.2))
    a.velocity, a.angular_velocity, b.velocity, b.angular_velocity = (0.5, 0.0), 0.5, (0.5, 0.3), -1.0
    space.add(pymunk.PivotJoint(space.static_body, a, (0.0, 0.0)))
    return space, [a, b]


KINDS: dict[str, Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]] = {
    "pin": lambda a, b: pymunk.PinJoint(a, b, (0.2, 0.0), (-0.2, 0.1)),
    "slide": lambda a, b: pymunk.SlideJoint(a, b, (0.2, 0.0), (-0.2, 0.1), 0.1, 0.8),
    "pivot": lambda a, b: pymunk.PivotJoint(a, b, (0.5, -1.1)),
    "groove": lambda a, b: pymunk.GrooveJoint(a, b, (0.3, -0.1), (1.3, -0.1), (-0.2, 0.1)),
    "spring": lambda a, b: pymunk.DampedSpring(a, b, (0.2, 0.0), (-0.2, 0.1), 0.5, 60.0, 0.5),
    "rotary_spring": lambda a, b: pymunk.DampedRotarySpring(a, b, 0.3, 8.0, 0.1),
    "rotary_limit": lambda a, b: pymunk.RotaryLimitJoint(a, b, -0.2, 0.1),
    "ratchet": lambda a, b: pymunk.RatchetJoint(a, b, 0.0, 0.25),
    "gear": lambda a, b: pymunk.GearJoint(a, b, 0.0, 1.5),
    "motor": lambda a, b: pymunk.SimpleMotor(a, b, 3.0),
}


@pytest.mark.parametrize("make", KINDS.values(), ids=KINDS)
def test_all_kinds_go_where_fine_steps_of_native_go(make: Callable[..., pymunk.Constraint]) -> None:
    ends, angles = [], []
    for ours in (True, False):
        space, (a, b) = pair()
        joint = make(a, b)
        space.add(joint)
        step, dt = (ep.EECA(space).step, 1 / 240) if ours else (space.step, 1 / 24000)
        space.iterations = 30
        for _ in range(round(0.4 / dt)):
            step(dt)
        ends.append([*a.position, a.angle, *b.position, b.angle])
        angles.append(getattr(joint, "angle", 0.0))
    # Native lets the groove turn away under what slides in it, by .05 here.
    assert ends[0] == pytest.approx(ends[1], abs=0.05 if isinstance(joint, pymunk.GrooveJoint) else 5e-3)
    assert angles[0] == pytest.approx(angles[1], abs=1e-12)


HOLDING: dict[str, Callable[[pymunk.Space, pymunk.Body], pymunk.Constraint]] = {
    "pin": lambda s, b: pymunk.PinJoint(s.static_body, b),
    "pivot": lambda s, b: pymunk.PivotJoint(s.static_body, b, (0.0, 0.0)),
    "slide": lambda s, b: pymunk.SlideJoint(s.static_body, b, (0, 0), (0, 0), 0.0, 2.0),
    "groove": lambda s, b: pymunk.GrooveJoint(s.static_body, b, (-1.0, -2.0), (1.0, -2.0), (0, 0)),
    "soft pivot": lambda s, b: soft(pymunk.PivotJoint(s.static_body, b, (0.0, 0.0))),
    "by a kinematic body": lambda s, b: pymunk.PinJoint(lift(s), b),
    "by a body outside": lambda s, b: pymunk.PinJoint(pymunk.Body(body_type=pymunk.Body.KINEMATIC), b),
}


def soft(joint: pymunk.Constraint) -> pymunk.Constraint:
    joint.max_force = 1e3
    return joint


def lift(space: pymunk.Space) -> pymunk.Body:
    """A kinematic body that stands still at the origin."""
    made = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(made)
    return made


def slacken(rope: bool, weight: pymunk.Body) -> None:
    """Let a rope be shorter than its length by more than round-off, of which pymunk makes all of the weight or none,
    and its weight have no velocity that makes it longer."""
    if rope:
        weight.position += (0.0, 1e-12)
        weight.velocity = (0.0, 0.0)


@pytest.mark.parametrize("make", HOLDING.values(), ids=HOLDING)
def test_impulse_of_a_hanging_weight_is_m_g_dt(make: Callable[..., pymunk.Constraint]) -> None:
    space = empty(10.0)
    weight = body(space, 3.0, 1.0, (0.0, -2.0))
    joint = make(space, weight)
    space.add(joint)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(DT)
    assert joint.impulse == pytest.approx(3.0 * 10.0 * DT, rel=1e-9)
    # A step of native tells its own, which is none of a rope that is not taut.
    rope = isinstance(joint, pymunk.SlideJoint)
    slacken(rope, weight)
    space.step(0.5 * DT)
    assert joint.impulse == pytest.approx(0.0 if rope else 3.0 * 10.0 * 0.5 * DT, rel=1e-6)
    stepper.step(DT)
    assert joint.impulse == pytest.approx(3.0 * 10.0 * DT, rel=1e-6)
    del stepper
    gc.collect()
    assert joint.impulse == pytest.approx(3.0 * 10.0 * DT, rel=1e-6)
    slacken(rope, weight)
    space.step(0.5 * DT)
    assert joint.impulse == pytest.approx(0.0 if rope else 3.0 * 10.0 * 0.5 * DT, rel=1e-6)


def test_who_asks_for_impulses_keeps_neither_space_nor_joint() -> None:
    space = pendulum()
    ep.EECA(space).step(DT)
    joint = next(iter(space.constraints))
    impulse, gone = joint.impulse, [weakref.ref(space), weakref.ref(joint)]
    assert impulse > 0.0
    for body_ in list(space.bodies):
        space.remove(body_)
    space.remove(joint)
    del space
    gc.collect()
    assert joint.impulse == impulse
    del joint, body_
    gc.collect()
    assert [one() for one in gone] == [None, None]


def test_impulse_outlives_pickling_and_refresh() -> None:
    space = pendulum()
    joint, stepper = next(iter(space.constraints)), ep.EECA(space)
    stepper.step(DT)
    impulse = joint.impulse
    assert impulse > 0.0
    pickle.dumps(stepper)
    stepper.refresh()
    assert joint.impulse == impulse


def test_a_spring_at_rest_pulls_with_its_weight() -> None:
    space = empty(10.0)
    weight = body(space, 3.0, 1.0, (0.0, -2.0))
    spring = pymunk.DampedSpring(space.static_body, weight, (0, 0), (0, 0), 1.0, 30.0, 0.0)
    space.add(spring)
    ep.EECA(space).step(DT)
    assert weight.velocity.length < 1e-13
    assert ep.EECA(space).step(DT).time == DT
    stepper = ep.EECA(space)
    stepper.step(DT)
    assert spring.impulse == pytest.approx(-3.0 * 10.0 * DT)


def place(space: pymunk.Space) -> list[tuple[float, ...]]:
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies]


def test_joints_come_and_go_between_steps() -> None:
    space = chain(3, 5.0)
    stepper, first, end = ep.EECA(space), next(iter(space.bodies)), list(space.bodies)[-1]
    for _ in range(20):
        stepper.step(DT)
    space.remove(list(space.constraints)[-1])
    start, speed = end.position, end.velocity
    for _ in range(6):
        stepper.step(DT)
    np.testing.assert_allclose(end.position, start + 0.1 * speed + pymunk.Vec2d(0, -0.5 * 9.81 * 0.01), atol=1e-12)
    catch = pymunk.PivotJoint(space.static_body, end, end.position)
    where = end.position
    space.add(catch)
    for _ in range(30):
        stepper.step(DT)
    assert (end.position - where).length < 1e-9
    # One for another, so that there are as many as before.
    space.remove(catch)
    space.add(pymunk.PivotJoint(space.static_body, first, first.position))
    for _ in range(6):
        stepper.step(DT)
    assert end.position.y < where.y - 0.04
    space.remove(*space.constraints)
    stepper.step(DT)
    assert "joints" not in stepper.model


def test_the_rest_swings_on_when_joints_come_and_go_elsewhere() -> None:
    # What is known of a joint is kept when others come and go: nothing is projected, the path is bitwise the same.
    found = []
    for busy in (False, True):
        space = bars()
        stepper = ep.EECA(space)
        other = body(space, 1.0, 1.0, (50.0, 0.0))
        for k in range(60):
            if busy and k % 10 == 5:
                joint = pymunk.PivotJoint(space.static_body, other, other.position)
                space.add(joint)
            if busy and k % 10 == 9:
                space.remove(joint)
                space.add(pymunk.Circle(other, 0.1 + 0.01 * k))
            stepper.step(DT)
        found.append(place(space)[:2])
    assert found[0] == found[1]


def test_a_joint_breaks_from_its_own_post_solve() -> None:
    space = empty(10.0)
    weight = body(space, 3.0, 1.0, (0.0, -2.0))
    rope = pymunk.PinJoint(space.static_body, weight)
    felt = []

    def test(joint: pymunk.Constraint, space: pymunk.Space) -> None:
        felt.append(joint.impulse / DT)
        if joint.impulse / DT > 35.0:
            space.remove(joint)
            space.add(pymunk.Body(1.0, 1.0))

    rope.post_solve = test
    space.add(rope)
    stepper = ep.EECA(space)
    for k in range(12):
        weight.force = (0.0, -1.0 * k)
        stepper.step(DT)
    assert felt == pytest.approx([30.0, 31.0, 32.0, 33.0, 34.0, 35.0, 36.0][: len(felt)], rel=1e-6)
    assert 6 <= len(felt) <= 7
    assert len(space.constraints) == 0
    assert len(space.bodies) == 2
    assert weight.position.y < -2.04


@pytest.mark.parametrize("shapes", [0, 3, 20], ids=["bare", "reindexed", "rest steps"])
@pytest.mark.parametrize("sync", [True, False])
def test_functions_are_called_once_a_step_with_what_belongs_to_it(shapes: int, sync: bool) -> None:
    space = empty(10.0)
    weight = body(space, 3.0, 1.0, (0.0, -2.0))
    for i in range(shapes):
        far = body(space, 1.0, 1.0, (10.0 + i, 0.0))
        space.add(pymunk.Circle(far, 0.1))
    rope = pymunk.PinJoint(space.static_body, weight)
    calls: list[tuple[object, ...]] = []
    rope.pre_solve = lambda c, s: calls.append(("pre", c is rope, s is space))
    rope.post_solve = lambda c, s: calls.append(("post", round(c.impulse, 9), s is space))
    spring = pymunk.DampedSpring(space.static_body, weight, (0, 0), (0, 0), 1.0, 1.0, 0.0)
    stretched: list[float] = []
    spring.force_func = lambda c, length: stretched.append(length) or 0.0  # type: ignore[func-returns-value]
    space.add(rope, spring)
    stepper = ep.EECA(space, sync=sync)
    for _ in range(4):
        stepper.step(DT)
    assert calls == [("pre", True, True), ("post", 0.5, True)] * 4
    assert len(stretched) <= 8
    rope.pre_solve = rope.post_solve = None
    stepper.step(DT)
    assert len(calls) == 8
    assert rope.max_force == math.inf


def notes(calls: list[str], name: str) -> Callable[..., None]:
    return lambda *_: calls.append(name)


def test_functions_come_in_native_s_order_beside_collisions() -> None:
    found = []
    for ours in (False, True):
        space = empty(0.0)
        calls: list[str] = []
        space.collision_slop = 0.0
        a, b = body(space, 1.0, 1.0, (0.0, 0.0)), body(space, 1.0, 1.0, (0.95, 0.0))
        space.add(pymunk.Circle(a, 0.5), pymunk.Circle(b, 0.5))
        pin = pymunk.PinJoint(a, space.static_body, (0, 0), (-5.0, 0.0))
        pin.pre_solve, pin.post_solve = (notes(calls, name) for name in ("joint before", "joint after"))
        space.add(pin)
        space.on_collision(begin=notes(calls, "begin"), pre_solve=notes(calls, "pre"), post_solve=notes(calls, "post"))
        step = ep.EECA(space).step if ours else space.step
        step(DT)
        space.remove(pin)
        a.position = 0.0, 0.0
        b.position = 0.95, 0.0
        step(DT)
        found.append(calls)
    assert found[0] == ["begin", "pre", "joint before", "joint after", "post", "pre", "post"]
    assert found[1] == found[0]


@pytest.mark.parametrize("which", ["pre_solve", "post_solve"])
@pytest.mark.parametrize("handlers", [False, True])
def test_what_functions_raise_leaves_the_space_as_it_was(which: str, handlers: bool) -> None:
    space = pendulum()
    if handlers:
        space.on_collision(begin=lambda *_: None)
    stepper = ep.EECA(space)
    stepper.step(DT)
    pin, before = next(iter(space.constraints)), place(space)

    def fail(joint: pymunk.Constraint, space: pymunk.Space) -> None:
        next(iter(space.bodies)).velocity = (9.0, 9.0)
        raise RuntimeError("from the function")

    setattr(pin, which, fail)
    with pytest.raises(RuntimeError, match="from the function"):
        stepper.step(DT)
    assert place(space) == before
    assert stepper.time == DT
    setattr(pin, which, None)
    stepper.step(DT)
    assert place(space) != before


def test_velocity_that_pre_solve_sets_is_stepped_with() -> None:
    space = empty(0.0)
    one = body(space, 1.0, 1.0, (0.0, -2.0))
    motor = pymunk.SimpleMotor(space.static_body, one, 0.0)
    motor.pre_solve = lambda c, s: setattr(one, "velocity", (1.0, 0.0))
    space.add(motor)
    ep.EECA(space).step(0.5)
    assert one.position == pytest.approx((0.5, -2.0))


def test_handlers_and_functions_do_not_change_the_path() -> None:
    # Nothing collides, nothing is changed: bitwise the same path, and no velocity is projected anew each step.
    found = []
    for kind in ("plain", "handler", "function", "body", "both"):
        space = bars()
        if kind in ("handler", "both"):
            space.on_collision(begin=lambda *_: None)
        if kind in ("function", "both"):
            for joint in space.constraints:
                joint.pre_solve = joint.post_solve = lambda c, s: None
        if kind == "body":
            free = body(space, 1.0, 1.0, (90.0, 0.0))
            free.velocity_func = pymunk.Body.update_velocity
        stepper = ep.EECA(space)
        for _ in range(120):
            stepper.step(DT)
        found.append(place(space)[:2])
    assert all(one == found[0] for one in found)


def test_anchors_distances_and_forces_changed_between_steps() -> None:
    space = empty(10.0)
    one = body(space, 1.0, 0.1, (1.0, 0.0))
    pin = pymunk.PinJoint(space.static_body, one)
    space.add(pin)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    pin.anchor_b = (0.3, 0.0)
    pin.distance = 1.1
    for _ in range(240):
        stepper.step(DT)
    assert (one.local_to_world((0.3, 0.0))).length == pytest.approx(1.1, abs=1e-8)
    assert one.angular_velocity != 0.0
    pin.max_force = 0.0
    start, speed = one.position, one.velocity
    stepper.step(0.5)
    np.testing.assert_allclose(one.position, start + 0.5 * speed + pymunk.Vec2d(0.0, -1.25), atol=1e-9)


@pytest.mark.parametrize("inside", [False, True])
def test_a_mouse_drags(inside: bool) -> None:
    space = chain(4, lean=1.5)
    stepper, end = ep.EECA(space), list(space.bodies)[-1]
    mouse = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    mouse.position = end.position
    if inside:
        space.add(mouse)
    grip = pymunk.PivotJoint(mouse, end, (0, 0), (0, 0))
    grip.max_force, grip.error_bias = 500.0, (1 - 0.15) ** 60
    space.add(grip)
    for k in range(120):
        mouse.position = mouse.position + pymunk.Vec2d(0.01, 0.01) * (k < 60)
        where = mouse.position
        stepper.step(DT)
        assert mouse.position == where
    assert (mouse.position - end.position).length < 0.05
    assert grip.impulse > 0.0
    space.remove(grip)
    stepper.step(DT)


@pytest.mark.parametrize("kind", [pymunk.Body.KINEMATIC, pymunk.Body.DYNAMIC, pymunk.Body.STATIC])
def test_partners_have_the_pose_of_their_centre_of_gravity_and_velocities_if_kinematic(kind: int) -> None:
    """At first, after a move, and after another centre of gravity is set."""
    space = empty(0.0)
    hand = pymunk.Body(1.0, 1.0) if kind == pymunk.Body.DYNAMIC else pymunk.Body(body_type=kind)
    space.add(pymunk.PinJoint(hand, body(space, 1.0, 1.0, (4.0, -1.0))))
    stepper = ep.EECA(space)
    for place, angle, centre in (
        ((1.0, 2.0), 0.5, (0.25, 1.5)),
        ((3.0, 2.0), -2.0, (0.25, 1.5)),
        ((3.0, 2.0), -2.0, (2, 1)),
    ):
        hand.center_of_gravity = centre
        hand.position, hand.angle = place, angle
        if kind != pymunk.Body.STATIC:
            hand.velocity, hand.angular_velocity = (3.0, 4.0), 5.0
        world = stepper._present()
        world.gather()
        assert world.joints is not None
        world.joints.update(world.state, world.bodies.row, DT)
        (found,) = world.joints.partners.PARTNER
        where = hand.local_to_world(hand.center_of_gravity)
        assert (found.x, found.y, found.angle) == pytest.approx((where.x, where.y, angle), rel=1e-14)
        speeds = (3.0, 4.0, 5.0) if kind == pymunk.Body.KINEMATIC else (0.0, 0.0, 0.0)
        assert (found.vx, found.vy, found.spin) == speeds


def test_rows_of_joints_are_used_again_when_only_bodies_come_and_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then rows of bodies have other numbers. The path is that of rows that are made anew, bit by bit."""
    ends = []
    for again in (True, False):
        with monkeypatch.context() as patched:
            if not again:
                patched.setattr(JointRows, "renumber", lambda *_: False)
            space = empty()
            hand = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            links = [body(space, 1.0, 0.1, (x, -1.0)) for x in (0.5, 1.5)]
            pins = pymunk.PinJoint(hand, links[0]), pymunk.PivotJoint(links[0], links[1], (1.0, -1.0))
            space.add(*pins)
            stepper, guests, seen = ep.EECA(space), [], []
            for k in range(40):
                if k % 4 == 1:
                    ball = pymunk.Body(1.0, 1.0)
                    ball.position = 3.0 * k, 5.0
                    guests.append((ball, pymunk.Circle(ball, 0.5)))
                    space.add(*guests[-1])
                if k % 8 == 5:
                    space.remove(*guests.pop(0))
                if k % 4 == 2:
                    hand.position += 0.01, 0.0
                if k == 21:
                    pins[1].max_force = 3.0
                if k == 29:
                    space.remove(links[1], pins[1])
                if k == 33:
                    space.add(links[1], pins[1], hand)
                stepper.step(DT)
                assert stepper._world is not None
                seen.append(stepper._world.joints)
            assert (seen[1] is seen[0], seen[29] is seen[28], seen[33] is seen[32]) == (again, False, False)
            ends.append([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])
    assert ends[0] == ends[1]


def test_only_joints_of_partners_that_move_are_touched() -> None:
    space = empty(0.0)
    hand, post = (pymunk.Body(body_type=kind) for kind in (pymunk.Body.KINEMATIC, pymunk.Body.STATIC))
    hand.position, post.position = (1.0, 0.0), (2.0, 0.0)
    space.add(post)
    ends = [body(space, 1.0, 1.0, (x, -1.0)) for x in (1.0, 2.0, 3.0)]
    space.add(*(pymunk.PinJoint(a, b) for a, b in zip((hand, post), ends, strict=False)))
    space.add(pymunk.PinJoint(space.static_body, ends[2], (3.0, 0.0)))
    stepper = ep.EECA(space)
    stepper.step(DT)

    def touched() -> list[int]:
        world = stepper._world
        assert world is not None
        assert isinstance(world.joints, JointRows)
        world.gather()
        if not world.is_current():
            world = stepper._update_world(anew=True)
            world.gather()
        assert world.joints is not None
        world.joints.update(world.state, world.bodies.row, DT)
        return [int(mark) for mark in world.joints.joint["touched"]]

    assert touched() == [0, 0, 0]
    hand.position = (1.0, 0.01)
    assert touched() == [1, 0, 0]
    stepper.step(DT)
    post.position = (2.0, 0.01)
    # The joint of the hand is still closing.
    assert touched()[1:] == [1, 0]
    for _ in range(400):
        stepper.step(DT)
    assert touched() == [0, 0, 0]
    assert (ends[0].position - hand.position).length == pytest.approx(1.0, abs=1e-9)
    assert (ends[1].position - post.position).length == pytest.approx(1.0, abs=1e-9)


def test_a_centre_of_mass_off_the_origin_is_not_taken_for_an_edit() -> None:
    plain, other = bars(), bars()
    for bar in list(other.bodies):
        centre = bar.position
        bar.center_of_gravity = (0.2, -0.3)
        bar.position = centre - pymunk.Vec2d(0.2, -0.3)
    for joint in other.constraints:
        joint.anchor_b = joint.anchor_b + pymunk.Vec2d(0.2, -0.3)
        if joint.a is not other.static_body:
            joint.anchor_a = joint.anchor_a + pymunk.Vec2d(0.2, -0.3)
    steppers = [ep.EECA(space) for space in (plain, other)]
    for _ in range(300):
        for stepper in steppers:
            stepper.step(DT)
    for a, b in zip(plain.bodies, other.bodies, strict=True):
        np.testing.assert_allclose(b.local_to_world(b.center_of_gravity), a.position, atol=1e-9)
    energies = [ep.measure(space).energy for space in (plain, other)]
    assert energies == pytest.approx([ep.measure(bars()).energy] * 2, abs=1e-11)


def test_native_goes_on_as_from_a_fresh_space() -> None:
    for shapes in (0, 30):
        space = bars()
        for i in range(shapes):
            space.add(pymunk.Circle(body(space, 1.0, 1.0, (40.0 + i, 0.0)), 0.1))
        space.step(DT)
        stepper = ep.EECA(space)
        for _ in range(5):
            stepper.step(DT)
        twin = copy.deepcopy(space)
        assert place(twin) == place(space)
        for one in (space, twin):
            one.step(DT)
        np.testing.assert_allclose(place(space), place(twin), rtol=0.0, atol=1e-11)


def test_pickled_and_copied_spaces_go_on() -> None:
    space = bars()
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    resumed, fresh = pickle.loads(pickle.dumps(stepper)), ep.EECA(copy.deepcopy(space))
    for one in (stepper, resumed, fresh):
        for _ in range(30):
            one.step(DT)
    assert place(resumed.space) == place(space)
    # A new stepper of a copied space knows nothing of the steps before: its solver begins elsewhere.
    at = [[row[:3] for row in place(one.space)] for one in (fresh, stepper)]
    np.testing.assert_allclose(*at, rtol=0.0, atol=1e-6)


def refused() -> dict[str, Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]]:
    def edited(name: str, value: float) -> Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]:
        def make(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
            joint = pymunk.PivotJoint(a, b, (0.0, 0.0))
            setattr(joint, name, value)
            return joint

        return make

    return {
        "anchor_a": lambda a, b: pymunk.PinJoint(a, b, (math.nan, 0.0)),
        "min = 2.0 and max = 1.0": lambda a, b: pymunk.SlideJoint(a, b, (0, 0), (0, 0), 2.0, 1.0),
        "min = 0.5 and max = -0.5": lambda a, b: pymunk.RotaryLimitJoint(a, b, 0.5, -0.5),
        "max = -1.0": lambda a, b: pymunk.SlideJoint(a, b, (0, 0), (0, 0), -2.0, -1.0),
        "rate = inf": lambda a, b: pymunk.SimpleMotor(a, b, math.inf),
        "ratio = 0": lambda a, b: pymunk.GearJoint(a, b, 0.0, 0.0),
        "ratchet = 0": lambda a, b: pymunk.RatchetJoint(a, b, 0.0, 0.0),
        "stiffness = nan": lambda a, b: pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1.0, math.nan, 0.0),
        "damping = -1": lambda a, b: pymunk.DampedRotarySpring(a, b, 0.0, 1.0, -1.0),
        "error_bias = 2": edited("error_bias", 2.0),
    }


@pytest.mark.parametrize(("what", "make"), refused().items(), ids=refused())
def test_numbers_that_no_joint_can_have_are_refused_before_anything_moves(
    what: str, make: Callable[..., pymunk.Constraint]
) -> None:
    space, (a, b) = pair()
    stepper = ep.EECA(space)
    stepper.step(DT)
    before = place(space)
    joint = make(a, b)
    space.add(joint)
    for _ in range(2):
        with pytest.raises(ValueError, match=rf"{type(joint).__name__}.*{what}.*: set "):
            stepper.step(DT)
    assert place(space) == before
    space.remove(joint)
    stepper.step(DT)
    edited = next(iter(space.constraints))
    edited.error_bias = 2.0
    for _ in range(2):
        with pytest.raises(ValueError, match=r"error_bias = 2\.0"):
            stepper.step(DT)
    edited.error_bias = 1.0
    stepper.step(DT)


def test_a_joint_between_bodies_that_nothing_moves_does_nothing() -> None:
    # pymunk has it where the dynamic one of its bodies is outside the space.
    space, (a, _) = pair()
    alone, _ = pair()
    outside = pymunk.Body(1.0, 1.0)
    space.add(pymunk.PivotJoint(space.static_body, outside, (3.0, 3.0)), pymunk.SimpleMotor(outside, lift(space), 2.0))
    for one in (space, alone):
        stepper = ep.EECA(one)
        for _ in range(10):
            stepper.step(DT)
    assert (*a.position, a.angle) == (*next(iter(alone.bodies)).position, next(iter(alone.bodies)).angle)
    assert outside.position == (0.0, 0.0)
    assert outside.velocity == (0.0, 0.0)


def test_short_pins_equal_limits_and_points_of_grooves_hold_as_what_they_are() -> None:
    space = empty(10.0)
    ends = [body(space, 1.0, 0.1, (x, 0.0)) for x in range(4)]
    ground = space.static_body
    space.add(
        pymunk.PinJoint(ground, ends[0], (-0.5, 0.0), (-0.5, 0.0)),
        pymunk.SlideJoint(ground, ends[1], (1.0, 1.0), (0.0, 0.0), 1.0, 1.0),
        pymunk.GrooveJoint(ground, ends[2], (2.5, 0.0), (2.5, 0.0), (0.5, 0.0)),
        pymunk.RotaryLimitJoint(ground, ends[3], 0.0, 0.0),
    )
    ends[3].angular_velocity = 3.0
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert ends[0].local_to_world((-0.5, 0.0)) == pytest.approx((-0.5, 0.0), abs=1e-11)
    assert (ends[1].position - (1.0, 1.0)).length == pytest.approx(1.0, abs=1e-11)
    assert ends[2].local_to_world((0.5, 0.0)) == pytest.approx((2.5, 0.0), abs=1e-11)
    assert ends[3].angle == pytest.approx(0.0, abs=1e-11)
    assert ends[0].angular_velocity != 0.0


def test_the_model_names_joints() -> None:
    space, (a, b) = pair()
    stepper = ep.EECA(space)
    assert "1 joints (1 PivotJoint), order 4, 2 in contact and at limits" in stepper.model
    for name in ("pin", "pivot", "motor", "spring", "groove"):
        space.add(KINDS[name](a, b))
    next(iter(space.constraints)).max_force = 5.0
    assert (
        "6 joints (2 PivotJoint, 1 DampedSpring, 1 GrooveJoint, 1 PinJoint, 1 SimpleMotor), limits, motors, springs, "
        "limited forces, order 4 where nothing dissipates, else 2"
    ) in stepper.model
    space.remove(*space.constraints)
    assert "joint" not in stepper.model


@pytest.mark.parametrize(
    "make",
    [
        lambda space: ep.EECA(space, ep.Dashpot(1e4, 0.5)),
        lambda space: ep.Newmark.trapezoidal(space, 1e4),
        lambda space: ep.PenaltyEnergyMomentum(space, 1e4),
    ],
    ids=["dashpot", "newmark", "energy_momentum"],
)
def test_those_who_move_disks_alone_refuse_joints(make: Callable[[pymunk.Space], ep.Stepper]) -> None:
    space = empty(0.0)
    one = body(space, 1.0, 1.0, (0.0, 0.0))
    stepper = make(space)
    stepper.step(DT)
    pin = pymunk.PinJoint(space.static_body, one)
    space.add(pin)
    for _ in range(2):
        with pytest.raises(ep.UnsupportedFeature, match=r"PinJoint.*not modelled by.*ep\.EECA\(space\)"):
            stepper.step(DT)
    with pytest.raises(ep.UnsupportedFeature, match="PinJoint"):
        make(space)
    space.remove(pin)
    stepper.step(DT)


def touching(collide: bool) -> tuple[pymunk.Space, Bodies, pymunk.Constraint]:
    """Two disks that would fall apart at once if they collided, on a pin, above a floor."""
    space = empty(10.0)
    a, b = body(space, 1.0, 0.1, (0.0, 1.0)), body(space, 1.0, 0.1, (0.4, 1.0))
    space.add(*(pymunk.Circle(one, 0.5) for one in (a, b)))
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    for shape in (*space.shapes, floor):
        shape.friction = 0.5
    pin = pymunk.PinJoint(a, b)
    pin.collide_bodies = collide
    space.add(floor, pin)
    return space, [a, b], pin


@pytest.mark.parametrize("handlers", [False, True])
@pytest.mark.parametrize("closure", [ep.TimeOfImpact(), ep.Midstep()], ids=["time_of_impact", "midstep"])
def test_bodies_of_a_joint_pass_through_one_another_where_it_says_so(handlers: bool, closure: ep.Closure) -> None:
    space, (a, b), pin = touching(False)
    met: list[int] = []
    if handlers:
        space.on_collision(begin=lambda arbiter, *_: met.append(len({s.body for s in arbiter.shapes} & {a, b})))
    stepper = ep.EECA(space, closure)
    for _ in range(60):
        report = stepper.step(DT)
        contacts = report.contacts
        pairs = {
            frozenset((contacts.bodies[i], contacts.bodies[j]))
            for i, j in zip(contacts.body_a, contacts.body_b, strict=True)
        }
        assert frozenset((a, b)) not in pairs
    assert max(met, default=1) == 1
    assert (a.position - b.position).length == pytest.approx(0.4, abs=1e-9)
    # They rest on the floor all the same.
    assert a.position.y == pytest.approx(0.5, abs=1e-3)
    # Another joint that lets them collide does not change it; native looks for any that does not.
    space.add(pymunk.DampedSpring(a, b, (0, 0), (0, 0), 0.4, 1.0, 0.0))
    stepper.step(DT)
    assert (a.position - b.position).length == pytest.approx(0.4, abs=1e-9)
    # Edited: now they push each other, on what is left of the pin.
    pin.distance, pin.collide_bodies = 1.2, True
    a.position, b.position = (0.0, 0.5), (1.2, 0.5)
    for _ in range(5):
        stepper.step(DT)
    space.remove(pin)
    a.velocity, b.velocity = (1.0, 0.0), (-1.0, 0.0)
    for _ in range(30):
        stepper.step(DT)
    assert (a.position - b.position).length > 1.0 - 1e-3
    if handlers:
        assert max(met) == 2


def test_bodies_of_a_joint_collide_where_it_does_not_forbid_it() -> None:
    space, (a, b), pin = touching(True)
    space.remove(pin)
    space.add(pymunk.DampedSpring(a, b, (0, 0), (0, 0), 0.4, 1.0, 0.0))
    a.position, b.position = (0.0, 2.0), (1.01, 2.0)
    a.velocity, b.velocity = (1.0, 0.0), (-1.0, 0.0)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
        assert (a.position - b.position).length > 1.0 - 1e-9


def test_joints_are_added_from_collisions_and_removed_from_post_step_callbacks() -> None:
    space = empty(0.0)
    a, b = body(space, 1.0, 0.1, (0.0, 0.0)), body(space, 1.0, 0.1, (2.0, 0.0))
    space.add(pymunk.Circle(a, 0.5), pymunk.Circle(b, 0.5))
    a.velocity = (3.0, 0.0)

    def stick(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if not space.constraints:
            space.add(pymunk.PivotJoint(a, b, (0.5, 0.0), (-0.5, 0.0)), pymunk.GearJoint(a, b, 0.0, 1.0))

    space.on_collision(post_solve=stick)
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert len(space.constraints) == 2
    assert a.velocity == pytest.approx(b.velocity, abs=1e-9)
    assert a.velocity.x == pytest.approx(1.5, abs=1e-9)
    space.add_post_step_callback(lambda space, key: space.remove(*space.constraints), "break")
    stepper.step(DT)
    assert len(space.constraints) == 0
    stepper.step(DT)


@pytest.mark.parametrize("own_steps", [0, 1])
def test_the_ledger_closes_where_joints_with_springs_are_closed(own_steps: int) -> None:
    """Native leaves the pin apart; closing it stretches the spring."""
    space = pymunk.Space()
    body = pymunk.Body(1.5, 1.0)
    body.position, body.velocity, body.angular_velocity = (2.0, 0.7), (0.3, -1.0), 0.4
    pin = pymunk.PinJoint(space.static_body, body, (0.44, 0.0), (0.0, 0.31))
    spring = pymunk.DampedSpring(space.static_body, body, (0.34, 0.0), (0.0, 0.33), 0.43, 20.0, 0.29)
    space.add(body, pin, spring)
    stepper = ep.EECA(space)
    for _ in range(own_steps):
        stepper.step(1 / 60)
    space.step(1 / 60)
    book = stepper.step(1 / 60).ledger
    assert book is not None
    assert book.residual == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("watched", [False, True], ids=["", "with a handler"])
def test_bodies_outside_stay_as_they_are_where_pymunk_pushes_them(watched: bool) -> None:
    """pymunk pushes bodies outside the space, and makes nan of them where a joint has no mobility to push against."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    inside, heavy, fixed = lift(space), pymunk.Body(1.0, math.inf), pymunk.Body(body_type=pymunk.Body.STATIC)
    space.add(pymunk.Circle(inside, 0.1))
    heavy.velocity = 1.0, 2.0
    space.add(pymunk.GearJoint(heavy, fixed, 0.0, 1.0), pymunk.PinJoint(heavy, inside))
    if watched:
        space.on_collision(begin=lambda arbiter, space, data: None)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(0.01)
    assert (heavy.velocity, heavy.angular_velocity) == ((1.0, 2.0), 0.0)
    assert (fixed.velocity, fixed.angular_velocity) == ((0.0, 0.0), 0.0)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_rows_have_what_constraints_say_field_by_field(kind: str) -> None:
    space, (a, b) = pair()
    joint = KINDS[kind](a, b)
    joint.max_force, joint.error_bias, joint.max_bias = 7.0, 0.25, 3.0
    space.add(joint)
    rows = JointRows(space, {a: 0, b: 1}, 3, None)
    row = rows.joint[rows.row[joint]]
    assert row.body.tolist() == [0, 1]
    assert (row.finite_force, row.side, row.touched) == (1, 0, 1)
    assert (row.max_force, row.error_bias, row.max_bias) == (7.0, 0.25, 3.0)
    for ours, theirs in {
        "length": "distance", "stiffness": "stiffness", "damping": "damping", "ratio": "ratio", "rate": "rate",
        "tooth": "ratchet", "lower": "min", "upper": "max",
    }.items():  # fmt: skip
        if hasattr(joint, theirs):
            assert row[ours] == getattr(joint, theirs)
    if hasattr(joint, "anchor_b"):
        assert row.anchor_b.tolist() == list(joint.anchor_b)
    if hasattr(joint, "rate"):
        joint.rate = 9.0
        rows.refresh()
        assert row.rate == 9.0


@pytest.mark.parametrize("way", ["set", "a mass", "outside"])
def test_joints_hold_their_anchors_where_a_centre_of_gravity_is_moved(way: str) -> None:
    """Anchors are stored relative to it."""
    space, plate, far = pymunk.Space(), pymunk.Body(1.0, 1.0), pymunk.Body(2.0, 1.0)
    space.gravity, plate.position, far.position = (0.0, -9.81), (0.0, -1.0), (1.0, -1.0)
    hook = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    hook.angle = 0.5
    shape = pymunk.Circle(plate, 0.1)
    if way == "a mass":
        shape.mass = 1.0
    pivot, pin = pymunk.PivotJoint(hook, plate, (0, 0)), pymunk.PinJoint(plate, far, (0, 0.1), (0, 0.3))
    space.add(plate, far, shape, pivot, pin)
    stepper = ep.EECA(space)
    for k in range(30):
        if k == 2:
            (hook if way == "outside" else plate).center_of_gravity = (0.2, 0.1)
            if way == "a mass":
                heavy = pymunk.Circle(plate, 0.1, (0.5, 0.3))
                heavy.mass, heavy.sensor = 2.0, True
                space.add(heavy)
        stepper.step(1 / 60)
    assert plate.local_to_world(pivot.anchor_b).length < 1e-12
    apart = plate.local_to_world(pin.anchor_a).get_distance(far.local_to_world(pin.anchor_b))
    assert apart == pytest.approx(pin.distance, abs=1e-12)

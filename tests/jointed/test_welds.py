"""Welded bodies: what a pivot and a gear hold on fixed bodies does not move, and costs nothing but its impulses."""

from __future__ import annotations

import itertools
import pickle

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.impacts.scene import EventLoop

DT = 1 / 60


def welded(stepper: ep.EECA) -> int:
    """How many bodies are held where they are."""
    assert isinstance(stepper._method, EventLoop)
    return int(stepper._method.joints.TALLY.pinned)


def arm(links: int, ratio: float = 2.0, loose: bool = False) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A bent arm of planks, each welded to the one before, the first to the ground; each second joint has its bodies
    the other way round. A disk falls on it. `loose`: with a spring of no force, so that it counts as moving."""
    space, planks = pymunk.Space(), list[pymunk.Body]()
    space.gravity = 3.0, -10.0
    before = space.static_body
    for k in range(links):
        plank = pymunk.Body(1.0 + k, 2.0)
        plank.position, plank.angle = (float(k), 0.5 * k), 0.3 * k
        shape = pymunk.Poly.create_box(plank, (0.9, 0.3))
        space.add(plank, shape)
        a, b = (before, plank) if k % 2 == 0 else (plank, before)
        pivot = pymunk.PivotJoint(a, b, (k - 0.4, 0.5 * k))
        gear = pymunk.GearJoint(a, b, ratio * b.angle - a.angle, ratio)
        pivot.collide_bodies = gear.collide_bodies = False
        space.add(pivot, gear)
        before = plank
        planks.append(plank)
    disk = pymunk.Body(2.0, 0.1)
    disk.position, disk.velocity = (links - 0.7, 0.5 * links + 1.0), (-1.0, 0.0)
    space.add(disk, pymunk.Circle(disk, 0.3))
    for shape in space.shapes:
        shape.friction, shape.elasticity = 0.5, 0.4
    if loose:
        other = pymunk.Body(1.0, 1.0)
        other.position = 0.0, -50.0
        space.add(other, pymunk.DampedSpring(planks[-1], other, (0, 0), (0, 0), 0.0, 0.0, 0.0))
    return space, planks


def impulses(space: pymunk.Space, stepper: ep.EECA, plank: pymunk.Body, joints: int, steps: int = 60) -> FloatArray:
    """(steps, joints) of each step, with a force and a torque on a plank."""
    found = []
    for _ in range(steps):
        plank.force, plank.torque = (0.5, 0.25), 0.3
        assert stepper.step(DT).converged
        found.append([joint.impulse for joint in list(space.constraints)[:joints]])
    return np.array(found)


@pytest.mark.parametrize("ratio", [1.0, -2.0])
@pytest.mark.parametrize("links", [1, 2, 4])
def test_impulses_are_those_of_an_arm_whose_equations_are_solved(links: int, ratio: float) -> None:
    """By weight, forces, what is welded to it, and a first impact of the disk."""
    found = []
    for loose in (False, True):
        space, planks = arm(links, ratio, loose)
        stepper = ep.EECA(space)
        found.append(impulses(space, stepper, planks[-1], 2 * links, steps=30))
        assert welded(stepper) == (0 if loose else links)
        assert planks[0].position == pytest.approx((0.0, 0.0), abs=1e-12)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-8)
    assert found[1].max() > 3.0 * np.median(found[1], axis=0).max()  # the disk has hit it


@pytest.mark.parametrize("links", [1, 3])
def test_impulses_balance_those_of_contacts(links: int) -> None:
    """Each joint bears what acts beyond it: weights, the impacts of the disk, its friction and rest."""
    space, planks = arm(links, ratio=1.0)
    stepper = ep.EECA(space)
    joints, hits = list(space.constraints), 0
    for _ in range(90):
        report = stepper.step(DT)
        told, contacts = [joint.impulse for joint in joints], report.contacts
        # Places and impulses of what acts, by the plank on which it does.
        acts = [(k, np.array(p.position), DT * p.mass * np.array(space.gravity)) for k, p in enumerate(planks)]
        for c in range(len(contacts.body_a)):
            n = contacts.normal[c]
            push = report.impulse[c] * n + report.friction[c] * np.array([-n[1], n[0]])
            for body, side in ((contacts.body_a[c], -1.0), (contacts.body_b[c], 1.0)):
                if contacts.bodies[body] in planks:
                    acts.append((planks.index(contacts.bodies[body]), contacts.point[c], side * push))
                    hits += report.impulse[c] > 10.0 * DT
        for k in range(links):
            beyond = [(x - (k - 0.4, 0.5 * k), push) for i, x, push in acts if i >= k]
            total = sum(push for _, push in beyond)
            moment = sum(x[0] * push[1] - x[1] * push[0] for x, push in beyond)
            assert told[2 * k] == pytest.approx(np.hypot(*total), rel=1e-9)
            assert told[2 * k + 1] == pytest.approx(abs(moment), rel=1e-9, abs=1e-12)
    assert hits > 0


def test_energy_is_that_of_the_disk_alone() -> None:
    space, _ = arm(3)
    stepper = ep.EECA(space)
    for _ in range(120):
        ledger = stepper.step(DT).ledger
        assert abs(ledger.residual) < 1e-13
        assert ledger.external == 0.0
        assert ledger.restitution >= -1e-15


def test_a_body_that_moved_is_stopped_by_its_weld_at_a_loss() -> None:
    """An arrow of mass 2 and moment .5 at speed 3 and spin 4: m v^2/2 + I w^2/2 = 13."""
    space = pymunk.Space()
    body = pymunk.Body(2.0, 0.5)
    body.velocity, body.angular_velocity = (3.0, 0.0), 4.0
    space.add(body, pymunk.Circle(body, 0.1))
    space.add(
        pymunk.PivotJoint(space.static_body, body, (0.5, 0.0)), pymunk.GearJoint(space.static_body, body, 0.0, 1.0)
    )
    stepper = ep.EECA(space)
    ledger = stepper.step(DT).ledger
    assert ledger.restitution == pytest.approx(13.0)
    assert abs(ledger.residual) < 1e-13
    assert body.position == (0.0, 0.0)


@pytest.mark.parametrize("edit", ["max_force", "phase", "removed", "spring", "open", "kinematic"])
def test_what_may_move_is_not_welded(edit: str) -> None:
    space, planks = arm(2)
    pivot, gear = list(space.constraints)[:2]
    stepper = ep.EECA(space)
    stepper.step(DT)
    assert welded(stepper) == 2
    if edit == "max_force":
        gear.max_force = 1.0
    elif edit == "phase":
        gear.phase += 0.1
    elif edit == "removed":
        space.remove(gear)
    elif edit == "spring":
        space.add(pymunk.DampedSpring(space.static_body, planks[0], (0.0, 9.0), (0, 0), 5.0, 1.0, 0.0))
    elif edit == "open":
        pivot.anchor_a += 0.01, 0.0
    else:
        post = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        post.velocity = 0.0, 1e-3
        space.remove(pivot)
        space.add(post, pymunk.PivotJoint(post, planks[0], (-0.4, 0.0)))
    for _ in range(10):
        assert stepper.step(DT).converged
    assert welded(stepper) == 0
    # What closes on a fixed pose again, or keeps it, is where its joints say.
    if edit == "phase":
        assert planks[0].angle > 0.0


@pytest.mark.parametrize("link", [0, 1, 2])
@pytest.mark.parametrize("kind", ["gear", "limits"])
def test_a_servo_turns_any_link_of_a_welded_arm(kind: str, link: int) -> None:
    space, bodies = pymunk.Space(), [pymunk.Body(1.0, 1.0) for _ in range(3)]
    servos = list[pymunk.Constraint]()
    for k, (a, b) in enumerate(itertools.pairwise([space.static_body, *bodies])):
        b.position = 2.0 * k, 0.0
        servos += [pymunk.GearJoint(a, b, 0.0, 1.0) if kind == "gear" else pymunk.RotaryLimitJoint(a, b, 0.0, 0.0)]
        space.add(b, pymunk.PivotJoint(a, b, (2.0 * k - 1.0, 0.0)), servos[k])
    stepper, servo = ep.EECA(space), servos[link]
    stepper.step(DT)
    assert welded(stepper) == 3
    if isinstance(servo, pymunk.GearJoint):
        servo.phase = 0.5
    elif isinstance(servo, pymunk.RotaryLimitJoint):
        servo.max, servo.min = 0.5, 0.5
    for _ in range(180):
        assert stepper.step(DT).converged
    assert [body.angle for body in bodies] == pytest.approx([0.5 * (k >= link) for k in range(3)], abs=1e-6)
    assert stepper.reads == 1


@pytest.mark.parametrize("twist", [0.0, 3.0])
def test_welds_bear_what_velocity_functions_give(twist: float) -> None:
    """In place of gravity and of the body's force: m a dt at an arm of 1/2, and I alpha dt."""
    space, (plank,) = arm(1, ratio=1.0)

    def steer(body: pymunk.Body, gravity: pymunk.Vec2d, damping: float, dt: float) -> None:
        body.velocity -= 0.0, 20.0 * dt
        body.angular_velocity += twist * dt

    space.remove(*[shape for shape in space.shapes if shape.body is not plank])
    plank.velocity_func, plank.force = steer, (5.0, 5.0)
    stepper, (pivot, gear) = ep.EECA(space), list(space.constraints)
    stepper.step(DT)
    assert welded(stepper) == 1
    assert pivot.impulse == pytest.approx(plank.mass * 20.0 * DT)
    assert gear.impulse == pytest.approx(abs(plank.moment * twist - plank.mass * 20.0 * 0.4) * DT)


def test_welds_of_a_step_that_is_cut_short_show_forces_over_its_whole_length() -> None:
    """As other joints do: the weights of a plank and of a box that lies on it. Boxes far away use up the work."""
    space, (plank,) = arm(1)
    space.gravity = 0.0, -10.0
    (disk,) = (body for body in space.bodies if body is not plank)
    space.remove(disk, *disk.shapes)
    box = pymunk.Body(3.0, 0.1)
    box.position = 0.0, 0.3
    space.add(box, pymunk.Poly.create_box(box, (0.3, 0.3)), pymunk.Segment(space.static_body, (50, 0), (99, 0), 0.0))
    for k in range(6):
        body = pymunk.Body(1.0, 0.2)
        body.position, body.angle = (60.0 + 0.9 * (k % 2), 30.7 + k), 0.3 * k
        space.add(body, pymunk.Poly.create_box(body, (0.8, 0.6)))
    stepper, (pivot, _) = ep.EECA(space), list(space.constraints)
    for _ in range(60):
        stepper.step(DT)
    assert isinstance(stepper._method, EventLoop)
    stepper._method.scene.COUNT.budget = 20
    report = stepper.step(3.0)
    assert [unmet.name for unmet in report.unmet] == ["solves"]
    assert pivot.impulse == pytest.approx((plank.mass + box.mass) * 10.0 * 3.0, rel=1e-6)


def test_joints_come_and_go_in_one_reading() -> None:
    """A disk that falls from rest is welded to the ground at its place, and let go: it falls by g t^2/2 again. A box
    beside stays at rest on the floor all the time, and the first body to be joined collides with it afterwards."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    space.add(pymunk.Segment(space.static_body, (-9.0, -0.5), (9.0, -0.5), 0.0))
    disk, box = pymunk.Body(2.0, 0.5), pymunk.Body(1.0, 1 / 6)
    disk.position, box.position = (5.0, 8.0), (0.0, 0.0)
    space.add(disk, box, pymunk.Circle(disk, 0.5), pymunk.Poly.create_box(box, (1.0, 1.0)))
    stepper = ep.EECA(space)
    for height in (8.0, 7.2):
        for _ in range(24):
            assert stepper.step(DT).converged
        lower = height - 5.0 * (24 * DT) ** 2
        assert disk.position.y == pytest.approx(lower, abs=1e-12)
        weld = [
            pymunk.PivotJoint(space.static_body, disk, tuple(disk.position)),
            pymunk.GearJoint(space.static_body, disk, 0.0, 1.0),
        ]
        space.add(*weld)
        for _ in range(12):
            assert stepper.step(DT).converged
        assert (welded(stepper), disk.position.y) == (1, pytest.approx(lower, abs=1e-12))
        assert weld[0].impulse == pytest.approx(2.0 * 10.0 * DT)
        space.remove(*weld)
    between = pymunk.PinJoint(disk, box)
    between.collide_bodies = False
    space.add(between)
    stepper.step(DT)
    disk.position, disk.velocity = (0.0, 1.5), (0.0, 0.0)
    space.remove(between)
    for _ in range(120):
        stepper.step(DT)
    assert disk.position.y == pytest.approx(1.0, abs=1e-6)
    assert (box.position.y, stepper.reads) == (pytest.approx(0.0, abs=1e-12), 1)


def test_a_weld_that_a_program_puts_elsewhere_moves_with_its_ground() -> None:
    space, planks = arm(1)
    stepper = ep.EECA(space)
    stepper.step(DT)
    space.static_body.position = 0.0, 0.1
    space.reindex_shapes_for_body(space.static_body)
    for _ in range(400):
        stepper.step(DT)
    assert planks[0].position.y == pytest.approx(0.1, abs=1e-6)


def test_a_stack_on_welded_bodies_falls_asleep_with_them() -> None:
    space, planks = arm(1)
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.3
    for body in space.bodies:
        body.velocity = 0.0, 0.0
        if body not in planks:
            body.position = 0.0, 0.45
    stepper = ep.EECA(space)
    for _ in range(200):
        stepper.step(DT)
    assert all(body.is_sleeping for body in space.bodies)


def test_saved_runs_go_on_bit_by_bit() -> None:
    space, planks = arm(3)
    stepper = ep.EECA(space)
    impulses(space, stepper, planks[0], 6, steps=20)
    copied_space, copied = pickle.loads(pickle.dumps((space, stepper)))
    first = impulses(space, stepper, planks[0], 6, steps=20)
    again = impulses(copied_space, copied, next(iter(copied_space.bodies)), 6, steps=20)
    assert np.array_equal(first, again)
    assert [b.position for b in space.bodies] == [b.position for b in copied_space.bodies]


@pytest.mark.parametrize("angle", [0.3, 0.7, 1.1, 2.0])
@pytest.mark.parametrize("x", [0.0, 5.0])
def test_a_pivot_at_the_origin_welds_as_elsewhere(x: float, angle: float) -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    plank = pymunk.Body(1.0, 1.0 / 3.0)
    plank.position, plank.angle = (x + 1.0, 0.0), angle
    space.add(plank, pymunk.PivotJoint(space.static_body, plank, (x, 0.0)))
    space.add(pymunk.GearJoint(space.static_body, plank, angle, 1.0))
    assert welded(ep.EECA(space)) == 1

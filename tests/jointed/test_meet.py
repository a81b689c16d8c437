"""Intervals of islands with joints that are brought to an instant: their paths lead through nobody."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.geometry.flight import pose
from eeca_pymunk.jointed import meet as meetings
from eeca_pymunk.jointed import paths
from eeca_pymunk.jointed.ends import carry, shorten
from eeca_pymunk.jointed.meet import end_by, locate_impact
from eeca_pymunk.jointed.paths import passes_through
from eeca_pymunk.jointed.solve import try_jointed
from eeca_pymunk.model.joint_steps import UNHELD
from eeca_pymunk.model.joints import Joints
from eeca_pymunk.model.scene import Scene

G, SPEED, RADIUS = 10.0, 20.0, 0.2


def falling(h: float, high: float) -> tuple[Scene, Joints]:
    """A disk on a long rope, its row is 0, that has begun an interval h in which it falls on a floor `high` below."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    body = pymunk.Body(2.0, 1.0)
    body.position, body.velocity = (0.0, high), (0.0, -SPEED)
    disk = pymunk.Circle(body, RADIUS)
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    disk.elasticity = floor.elasticity = 1.0
    space.add(body, disk, floor, pymunk.SlideJoint(space.static_body, body, (0, high), (0, 0), 0.0, 99.0))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = h
    A.BODY[0].since, A.BODY[0].y, A.BODY[0].vy = 0.0, high, -SPEED
    assert try_jointed(A, J, 0, 0.0, h, True)[0] == 0
    return A, J


@pytest.mark.parametrize("h", [0.01, 0.06, 0.1, 0.5, 5.0])
def test_a_path_through_a_wall_is_seen_wherever_it_ends(h: float) -> None:
    """In the wall, just behind it, where its other side is near, or far away."""
    A, _ = falling(h, 1.0)
    assert (passes_through(A, 0, h) <= h) == (SPEED * h + 0.5 * G * h * h > 1.0 - RADIUS)


@pytest.mark.parametrize("h", [0.01, 0.1, 0.5, 1.0])
def test_an_interval_that_would_lead_through_a_wall_ends_before(h: float) -> None:
    """Its body stays on its side, with the energy that it had, until the instant that it is brought to."""
    A, J = falling(2.0 * h, 1.0)
    end_by(A, J, 0, h)
    assert (J.TALLY.worst == UNHELD) == (h > 0.01)
    body = A.BODY[0]
    assert (body.since, A.MEMBER[0].open) == (h, 0)
    assert RADIUS <= body.y <= 1.0
    assert 0.5 * body.vy**2 + G * body.y == pytest.approx(0.5 * SPEED**2 + G, rel=1e-12)
    if h == 0.01:
        assert body.y == pytest.approx(1.0 - SPEED * h - 0.5 * G * h * h, rel=1e-12)


@pytest.mark.parametrize("t", [0.01, 0.07])
def test_what_hangs_on_a_moving_body_is_where_that_has_it_as_a_step_is_cut(t: float) -> None:
    """At an instant before or after the one to which its island has been brought: joints hold, and all that its energy
    changes by is work of what moves, and of a force on it along its way."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    wheel, body, other = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(2.0, 1.0), pymunk.Body(1.0, 0.5)
    wheel.velocity, wheel.angular_velocity = (1.0, 0.5), 2.0
    body.position, other.position = (3.0, 0.0), (3.0, 1.0)
    joint = pymunk.PivotJoint(wheel, body, (2.0, 0.0))
    spring = pymunk.DampedSpring(wheel, other, (2.0, 2.0), (0.0, 0.0), 0.5, 30.0, 0.0)
    shapes = (pymunk.Circle(one, RADIUS) for one in (wheel, body, other))
    space.add(wheel, body, other, *shapes, joint, spring, pymunk.PinJoint(body, other))
    stepper = ep.EECA(space)
    body.force, body.torque = (3.0, 1.0), 0.7
    stepper.step(0.03)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    k = next(i for i in range(3) if A.STATE[i].island == i and A.MEMBER[i].jointed > 0)
    fixed = next(i for i in range(3) if A.BODY[i].inv_mass == 0.0)

    def state() -> tuple[float, float]:
        """How far the pivot's points are apart, and the energy of the bodies and the spring."""
        places = {2.0: body, 1.0: other}
        energy = 0.0
        for i in range(3):
            row = A.BODY[i]
            if i != fixed:
                one = places[round(1.0 / row.inv_mass)]
                one.position, one.angle = (row.x, row.y), row.angle
                one.velocity, one.angular_velocity = (row.vx, row.vy), row.spin
                energy += 0.5 * one.kinetic_energy + G * row.y / row.inv_mass  # pymunk leaves the half out
        x, y, angle = pose(A.BODY, fixed, A.BODY[k].since)
        wheel.position, wheel.angle = (x, y), angle
        far = wheel.local_to_world((2.0, 2.0)).get_distance(other.position)
        apart = wheel.local_to_world(joint.anchor_a).get_distance(body.local_to_world(joint.anchor_b))
        return apart, energy + 15.0 * (far - 0.5) ** 2

    (apart, before), here, turned = state(), body.position, body.angle
    external = float(A.PAR.external)
    assert apart <= 1e-12
    carry(A, J, k, t)
    for i in range(3):
        A.BODY[i].since = A.BODY[i].since if i == fixed else t
    assert state()[0] <= 1e-12
    change = state()[1] - before
    work = (3.0, 1.0) @ np.subtract(body.position, here) + 0.7 * (body.angle - turned)
    assert change == pytest.approx(A.PAR.external - external + work, abs=1e-12 * G)
    assert abs(A.PAR.external - external) > 1e-3


@pytest.mark.parametrize("sunk", [0.0, 1e-3])
@pytest.mark.parametrize("down", [3.0, 1.0, 0.5])
def test_shapes_that_open_only_by_what_joints_do_not_allow_meet_at_once(sunk: float, down: float) -> None:
    """Joints allow the mean velocity of both disks, which a step and an elastic impact keep apart; the rest is reversed
    within any interval, so that no search finds one at whose end they are apart (random scene 27000144)."""
    space = pymunk.Space()
    low, high = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    low.position, high.position = (0.0, RADIUS - sunk), (0.0, 3.0 - sunk)
    disks, floor = (
        [pymunk.Circle(one, RADIUS) for one in (low, high)],
        pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0),
    )
    for shape in (*disks, floor):
        shape.elasticity = 1.0
    space.add(low, high, *disks, floor, pymunk.PinJoint(low, high))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = 0.01
    for i in range(2):
        A.BODY[i].since, A.BODY[i].vy = 0.0, -down if A.BODY[i].y > 1.0 else 1.0
    root = A.STATE[0].island
    J.PROGRESS.effort = 0.0
    assert try_jointed(A, J, root, 0.0, 0.01, True)[0] == 0
    one = 0 if A.BODY[0].y < 1.0 else 1
    assert (locate_impact(A, J, one, 2, 0.005) == (0.0, False)) == (down > 1.0)


@pytest.mark.parametrize("slack", [0.0, 0.01, 0.5])
def test_limits_hold_on_what_a_moving_body_carries_along_as_a_step_is_cut(slack: float) -> None:
    """The limit is reached on the way; other joints alone would take the bodies beyond it (random scene 27000144)."""
    space = pymunk.Space()
    cart, near, far = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1.0, 1.0), pymunk.Body(3.0, 1.0)
    cart.velocity, near.velocity, far.velocity, far.position = (-5.0, 0.0), (-5.0, 0.0), (-5.0, 0.0), (2.0, 0.0)
    limit = pymunk.SlideJoint(near, far, (0.0, 0.0), (0.0, 0.0), 0.0, 2.0 + slack)
    space.add(cart, near, far, *(pymunk.Circle(one, RADIUS) for one in (cart, near, far)))
    space.add(pymunk.PivotJoint(cart, near, (0.0, 0.0), (0.0, 0.0)), limit)
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    carry(A, J, next(i for i in range(3) if A.STATE[i].island == i and A.MEMBER[i].jointed > 0), 0.02)
    left, right = sorted(float(A.BODY[i].x) for i in range(3) if A.BODY[i].inv_mass > 0.0)
    assert left == pytest.approx(-0.1, abs=1e-8)
    assert right == pytest.approx(min(2.0, 1.9 + slack), abs=1e-7)
    assert right - left <= 2.0 + slack + 1e-12


def test_the_path_is_looked_at_once_however_many_instants_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Instants before the impact are tried, from which the disk is seen to meet the floor."""
    A, J = falling(0.1, 1.0)
    seen, tried = [], []

    def looked(A: Scene, root: int, t: float) -> float:
        seen.append(root)
        return passes_through(A, root, t)

    def shortened(A: Scene, J: Joints, root: int, t: float) -> int:
        tried.append(root)
        return shorten(A, J, root, t)

    monkeypatch.setattr(meetings, "passes_through", looked)
    monkeypatch.setattr(meetings, "shorten", shortened)
    t, _ = locate_impact(A, J, 0, 1, 0.03)
    assert SPEED * t + 0.5 * G * t * t == pytest.approx(1.0 - RADIUS, rel=1e-6)
    assert tried.count(0) > 2
    assert seen.count(0) == 1


def test_pairs_of_an_island_are_looked_at_once_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of shapes that are in each other's lists; and looking through lists is work."""
    space, n = pymunk.Space(), 6
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(n)]
    for k, body in enumerate(bodies):
        body.position = k, 0.0
        space.add(body, pymunk.Circle(body, RADIUS))
    space.add(*(pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0.0, 9.0) for a, b in pairwise(bodies)))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    assert try_jointed(A, J, A.STATE[0].island, 0.0, 1e-9, True)[0] == 0
    pairs: list[tuple[int, int]] = []

    def met(A: Scene, a: int, b: int, t: float) -> tuple[float, bool]:
        pairs.append((min(a, b), max(a, b)))
        return math.inf, False

    monkeypatch.setattr(paths, "crossing_of_paths", met)
    A.COUNT.work = 0
    assert passes_through(A, A.STATE[0].island, 1e-9) == math.inf
    assert len(pairs) == len(set(pairs)) == n * (n - 1) // 2
    assert A.COUNT.work > 0

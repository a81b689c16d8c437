"""Bodies, shapes and joints that come and go, and edits of filters, radii and places: the results of earlier steps are
kept for all else, and what they touch is solved again."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product
from random import Random

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep

from .test_edited_values import DT, G, at_rest, box

Made = tuple[pymunk.Space, list[pymunk.Body]]


def ground(space: pymunk.Space) -> pymunk.Segment:
    floor = pymunk.Segment(space.static_body, (-20, 0), (2000, 0), 0.5)
    floor.friction, floor.elasticity = 0.5, 0.3
    space.add(floor)
    return floor


def bodies(seed: int, disks: bool, joints: bool) -> Made:
    """A column of boxes or disks, with gaps, that falls on a floor, in pairs if jointed."""
    space, random, found = pymunk.Space(), Random(seed), []
    space.gravity = (0.0, -G)
    ground(space)
    for k in range(12):
        body = pymunk.Body(1.0, 0.05)
        body.position = random.uniform(-1, 1) if disks or joints else 0.0, 0.71 + 0.41 * k
        shape = pymunk.Circle(body, 0.2) if disks else pymunk.Poly.create_box(body, (0.4, 0.4))
        shape.friction, shape.elasticity = 0.5, random.choice((0.0, 0.3))
        space.add(body, shape)
        found.append(body)
    for a, b in zip(found[::2] if joints else (), found[1::2], strict=False):
        space.add(pymunk.PinJoint(a, b))
    return space, found


def far(space: pymunk.Space, kind: str, k: int) -> list[pymunk.Body | pymunk.Shape]:
    """A body or wall that meets nothing."""
    body = pymunk.Body(1.0, 0.1, pymunk.Body.KINEMATIC if kind == "kinematic" else pymunk.Body.DYNAMIC)
    body.position = 1000.0 + k, 50.0
    if kind == "wall":
        return [pymunk.Segment(space.static_body, (1000 + k, 1), (1001 + k, 2), 0.1)]
    return [body, pymunk.Circle(body, 0.3) if kind == "disk" else pymunk.Poly.create_box(body)]


@pytest.mark.parametrize(
    ("disks", "joints", "seed"),
    [*product((False, True), (False,), range(3)), (False, True, 1), (False, True, 2), (False, True, 4)],
)
@pytest.mark.parametrize("kind", ["wall", "disk", "box", "kinematic"])
def test_what_comes_and_goes_far_away_changes_nothing(seed: int, disks: bool, joints: bool, kind: str) -> None:
    """Up to round-off: rows have other numbers, so that sums have another order. Of 40 jointed heaps seven are left out
    here, whose impacts amplify it, in five of them by more than 1e8."""

    def path(busy: bool) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        space, mine = bodies(seed, disks, joints)
        stepper, found, others = ep.EECA(space), [], []
        for k in range(60):
            if busy and k % 7 == 5:
                others.append(far(space, kind, k))
                space.add(*others[-1])
                if len(others) > 3:
                    space.remove(*others.pop(0))
            stepper.step(DT)
            found.append([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in mine])
        assert stepper.reads == (1 + 8 if busy else 1)
        return np.array(found)

    assert abs(path(True) - path(False)).max() < 1e-10


def remove_floor(space: pymunk.Space, floor: pymunk.Shape) -> None:
    space.remove(floor)


def pass_floor(space: pymunk.Space, floor: pymunk.Shape) -> None:
    floor.filter = pymunk.ShapeFilter(mask=0)


def make_sensor(space: pymunk.Space, floor: pymunk.Shape) -> None:
    floor.sensor = True


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("edit", [remove_floor, pass_floor, make_sensor])
def test_boxes_at_rest_fall_where_their_floor_goes(
    edit: Callable[[pymunk.Space, pymunk.Shape], None], count: int, joints: bool
) -> None:
    space, floor, boxes, stepper = at_rest(0.0, count, joints)
    edit(space, floor)
    for _ in range(6):
        stepper.step(DT)
    for shape in boxes:
        assert shape.body is not None
        assert tuple(shape.body.velocity) == pytest.approx((0.0, -6 * DT * G), abs=1e-12)


@pytest.mark.parametrize("edit", ["filter", "radius", "place"])
def test_a_state_of_rest_that_is_set_back_feels_that_its_floor_has_gone(edit: str) -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    body, base = box(space, 0.0, 1.0)[0], pymunk.Body(body_type=pymunk.Body.STATIC)
    floor = pymunk.Segment(base, (-5, 0), (5, 0), 0.5)
    space.add(base, floor)
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
    state = stepper.get_state()
    if edit == "filter":
        floor.filter = pymunk.ShapeFilter(mask=0)
    elif edit == "radius":
        floor.unsafe_set_radius(0.1)
    else:
        base.position = 0.0, -3.0
    stepper.set_state(state)
    for _ in range(6):
        stepper.step(DT)
    assert tuple(body.velocity) == pytest.approx((0.0, -6 * DT * G), abs=1e-12)


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("removed", [0, 1, 2, 3])
def test_a_stack_at_rest_that_loses_a_box(removed: int, joints: bool) -> None:
    """Those above fall freely; those below bear their own weights at once."""
    space, _, boxes, stepper = at_rest(0.0, 4, joints)
    gone = boxes.pop(removed)
    assert gone.body is not None
    space.remove(gone, gone.body)
    report = stepper.step(DT)
    for k, shape in enumerate(boxes):
        assert shape.body is not None
        assert shape.body.velocity.y == pytest.approx(-DT * G if k >= removed else 0.0, abs=1e-12)
    for k in range(removed):
        under = abs(report.contacts.point[:, 1] - (0.5 + k)) < 0.1
        assert report.impulse[under].sum() == pytest.approx((removed - k) * G * DT, rel=1e-9)


@pytest.mark.parametrize("joints", [False, True])
def test_a_stack_at_rest_that_gets_a_box_bears_it(joints: bool) -> None:
    space, _, boxes, stepper = at_rest(0.0, 3, joints)
    box(space, 0.0, 4.0)
    for _ in range(3):
        report = stepper.step(DT)
        under = abs(report.contacts.point[:, 1] - 0.5) < 0.1
        assert report.impulse[under].sum() == pytest.approx(4 * G * DT, rel=1e-6)
    for shape in boxes:
        assert shape.body is not None
        assert shape.body.velocity.length < 1e-9


@pytest.mark.parametrize("moves", [False, True])
def test_a_wall_that_comes_into_a_box_at_rest_lifts_it(moves: bool) -> None:
    """New, or moved there by the program: 0.4 deep in a box that no contact has joined to it."""
    space, _, (shape,), stepper = at_rest(0.0, 1, joints=False)
    wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wall.position = (30.0 if moves else 0.0, 0.5)
    step = pymunk.Poly.create_box(wall, (0.4, 0.8))
    if moves:
        space.add(wall, step)
        for _ in range(20):
            stepper.step(DT)
        wall.position = 0.0, 0.5
    else:
        space.add(wall, step)
    for _ in range(120):
        stepper.step(DT)
    assert shape.body is not None
    assert shape.body.position.y > 1.35
    assert shape.body.velocity.length < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_bodies_that_are_still_are_held(seed: int) -> None:
    """Boxes come to rest between posts; boxes, posts and joints come, go and are edited. Whatever has no velocity after
    a step was given the momentum by contacts and joints that its weight takes."""
    space, random = pymunk.Space(), Random(seed)
    space.gravity = (0.0, -G)
    floor = ground(space)
    floor.elasticity = 0.0
    shapes = [box(space, 1.05 * (k % 4) - 2.0, 1.0 + k // 4)[1] for k in range(12)]
    posts: list[pymunk.Shape] = []
    stepper, still = ep.EECA(space), 0
    for k in range(60):
        if k % 6 == 5:
            for _ in range(random.choice((1, 2))):
                what = random.randrange(6)
                chosen = random.choice(shapes)
                if what == 0 and len(shapes) > 3:
                    shapes.remove(chosen)
                    assert chosen.body is not None
                    space.remove(chosen, chosen.body)
                elif what == 1:
                    shapes.append(box(space, random.uniform(-2, 2), 6.0)[1])
                elif what == 2:
                    posts.append(pymunk.Circle(space.static_body, 0.2, (random.uniform(-3, 3), random.uniform(0, 3))))
                    space.add(posts[-1])
                elif what == 3 and posts:
                    space.remove(posts.pop(random.randrange(len(posts))))
                elif what == 4:
                    chosen.filter = pymunk.ShapeFilter(group=random.choice((0, 1)))
                elif posts:
                    random.choice(posts).unsafe_set_radius(random.uniform(0.1, 0.3))  # type: ignore[attr-defined]
        before = {shape: shape.body.velocity for shape in shapes if shape.body is not None}
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-11 * len(shapes) * G * 5.0
        given = dict.fromkeys((shape.body for shape in shapes), 0.0)
        contacts = report.contacts
        push = contacts.normal * report.impulse[:, None]
        push += np.stack((-contacts.normal[:, 1], contacts.normal[:, 0]), axis=1) * report.friction[:, None]
        for a, b, (_, y) in zip(contacts.body_a, contacts.body_b, push.tolist(), strict=True):
            for body, sign in ((contacts.bodies[a], -1.0), (contacts.bodies[b], 1.0)):
                if body in given:
                    given[body] += sign * y
        for shape, velocity in before.items():
            assert shape.body is not None
            if max(velocity.length, shape.body.velocity.length) < 1e-9:
                assert given[shape.body] == pytest.approx(G * DT, abs=1e-9)
                still += 1
    assert still > 60


def test_lists_of_rows_that_are_all_new() -> None:
    """Everything is replaced between two steps: the same scene again has the same path."""
    space, mine = bodies(0, disks=False, joints=False)
    stepper, paths = ep.EECA(space), []
    for _ in range(2):
        for _ in range(30):
            stepper.step(DT)
        paths.append([(*b.position, *b.velocity, b.angle, b.angular_velocity) for b in mine])
        space.remove(*space.shapes, *space.bodies)
        other, mine = bodies(0, disks=False, joints=False)
        shapes = list(other.shapes)
        floor = next(shape for shape in shapes if shape.body is other.static_body)
        shapes.remove(floor)
        other.remove(*shapes, *mine)
        ground(space)
        space.add(*mine, *shapes)
    assert math.isclose(paths[0][0][1], paths[1][0][1], rel_tol=0.0, abs_tol=1e-12)
    assert np.allclose(paths[0], paths[1], rtol=0.0, atol=1e-9)

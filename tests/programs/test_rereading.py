"""Bodies, shapes and joints come and go: paths are those of a stepper that reads every object anew, into new memory."""

from __future__ import annotations

import math
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.listing import Listing

from ..steppers import Forgetful, state
from .test_patching import DT, EDITS, PATCHED, Edit, ball, mover, one, scene


def wall(space: pymunk.Space, random: Random) -> None:
    body = random.choice((space.static_body, pymunk.Body(body_type=pymunk.Body.STATIC)))
    if body is not space.static_body:
        body.position = (random.uniform(-1, 1), 0.3)
        space.add(body)
    space.add(pymunk.Segment(body, (random.uniform(-1, 0), 0.1), (random.uniform(0.1, 1), 0.2), 0.02))


def lift(space: pymunk.Space, random: Random) -> None:
    body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    body.position, body.velocity = (random.uniform(-1, 1), 0.2), (0.0, 0.3)
    space.add(body, pymunk.Segment(body, (-0.3, 0.0), (0.3, 0.0), 0.03))


def part(space: pymunk.Space, random: Random) -> None:
    shape = pymunk.Circle(mover(space, random), 0.1, (random.uniform(-0.2, 0.2), 0.1))
    shape.sensor = random.random() < 0.3
    space.add(shape)


def remove_body(space: pymunk.Space, random: Random) -> None:
    body = mover(space, random)
    if sum(b.body_type == pymunk.Body.DYNAMIC for b in space.bodies) > 2:
        joints = [joint for joint in space.constraints if body in (joint.a, joint.b)]
        space.remove(*joints, *(shape for shape in space.shapes if shape.body is body), body)


def remove_shape(space: pymunk.Space, random: Random) -> None:
    if len(space.shapes) > 4:
        space.remove(one(space, random))


def tie(space: pymunk.Space, random: Random) -> None:
    a, b = mover(space, random), random.choice((space.static_body, mover(space, random)))
    if a is b:
        return
    kind = random.randrange(4)
    middle = (a.position + b.position) / 2
    joint: pymunk.Constraint = pymunk.SimpleMotor(a, b, random.uniform(-1, 1))
    if kind == 0:
        joint = pymunk.PivotJoint(a, b, tuple(middle))
    elif kind == 1:
        joint = pymunk.PinJoint(a, b)
    elif kind == 2:
        joint = pymunk.DampedSpring(a, b, (0, 0), (0, 0), 1.0, 20.0, 0.5)
    joint.collide_bodies = random.random() < 0.5
    space.add(joint)


def untie(space: pymunk.Space, random: Random) -> None:
    if space.constraints:
        space.remove(random.choice(list(space.constraints)))


FREE: dict[str, Edit] = {
    **{name: EDITS[name] for name in PATCHED}, "ball": ball, "wall": wall, "lift": lift, "part": part,
    "remove body": remove_body, "remove shape": remove_shape,
}  # fmt: skip
TIED: dict[str, Edit] = {**FREE, "tie": tie, "tie more": tie, "untie": untie}


def played(make: type[ep.EECA], seed: int, edits: dict[str, Edit], threshold: float) -> tuple[list[object], ep.EECA]:
    """Every state on the way of a random program, with lists, sides and contacts of the steps, and the stepper."""
    space, random = scene(seed, 8 if seed % 2 else 24, 4 if seed % 3 else 20), Random(seed)
    space.sleep_time_threshold = threshold
    stepper, path = make(space), list[object]()
    for _ in range(40):
        for _ in range(random.choice((0, 0, 1, 2))):
            edits[random.choice(list(edits))](space, random)
        report = stepper.step(DT)
        loop = stepper.event_loop
        assert loop is not None
        path.append((state(space), report.impulse.tobytes(), report.converged, loop.scene.SIDE.tobytes()))
    return path, stepper


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.parametrize("edits", [FREE, TIED], ids=["free", "tied"])
@pytest.mark.parametrize("threshold", [math.inf, 0.1])
def test_objects_that_are_known_need_not_be_read(seed: int, edits: dict[str, Edit], threshold: float) -> None:
    known, ours = played(ep.EECA, seed, edits, threshold)
    anew, theirs = played(Forgetful, seed, edits, threshold)
    assert known == anew
    assert ours.objects_read < theirs.objects_read / 2


@pytest.mark.parametrize("seed", range(6))
def test_constraints_are_listed_as_if_read_for_the_first_time(seed: int) -> None:
    space, random = scene(seed, 8, 4), Random(seed)
    listing = Listing(space, None)
    for _ in range(30):
        random.choice((tie, tie, untie))(space, random)
        listing = Listing(space, listing)
        new = Listing(space, None)
        assert {**vars(listing), "ends": listing.ends.tolist(), "fresh": 0} == {
            **vars(new), "ends": new.ends.tolist(), "fresh": 0,
        }  # fmt: skip


def test_readings_patches_and_objects_are_counted() -> None:
    space = scene(1, 6, 2)
    stepper = ep.EECA(space)
    before = stepper.objects_read
    assert (stepper.reads, stepper.patches, before) == (1, 0, len(space.bodies) + 1 + len(space.shapes))
    stepper.step(DT)
    ball(space, Random(1))
    stepper.step(DT)
    assert (stepper.reads, stepper.patches, stepper.objects_read) == (2, 0, before + 2)
    next(iter(space.shapes)).friction += 0.1
    stepper.step(DT)
    assert (stepper.reads, stepper.patches, stepper.objects_read) == (2, 1, before + 3)
    next(iter(space.shapes)).filter = pymunk.ShapeFilter(1)
    stepper.step(DT)
    assert (stepper.reads, stepper.patches, stepper.objects_read) == (2, 2, before + 4)
    space.add(pymunk.PinJoint(mover(space, Random(1)), space.static_body))
    stepper.step(DT)
    assert (stepper.reads, stepper.patches, stepper.objects_read) == (2, 3, before + 5)

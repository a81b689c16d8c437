"""Steps of pymunk that would call no handler are left out: calls, paths and arbiters are those of steps with them."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.rehearsing import place_for_rehearsal
from eeca_pymunk.space.handled_pairs import HandledPairs
from eeca_pymunk.space.rehearsal import Rehearsal
from scenes.scene import add_disk

DT = 1 / 60
PHASES = "begin", "pre_solve", "post_solve", "separate"


def room(seed: int) -> pymunk.Space:
    """Disks and boxes of five types that bounce in a wide box, with a sensor and a kinematic bar."""
    space, chance = pymunk.Space(), random.Random(seed)
    space.gravity = (0.0, -200.0 * chance.random())
    for a, b in (((0, 0), (400, 0)), ((400, 0), (400, 300)), ((400, 300), (0, 300)), ((0, 300), (0, 0))):
        wall = pymunk.Segment(space.static_body, a, b, 2.0)
        wall.elasticity, wall.collision_type = 1.0, 7
        space.add(wall)
    watched = pymunk.Poly(space.static_body, [(180, 150), (220, 150), (200, 190)])
    watched.sensor, watched.collision_type = True, 8
    bar = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    bar.position, bar.angular_velocity = (100.0, 100.0), 1.0
    beam = pymunk.Segment(bar, (-30, 0), (30, 0), 1.0)
    beam.collision_type = 9
    space.add(watched, bar, beam)
    for k in range(6):
        body = pymunk.Body(1.0, 50.0)
        body.position = 40.0 + 60.0 * k, 60.0 + 150.0 * chance.random()
        body.velocity, body.angular_velocity = (300.0 * chance.uniform(-1, 1), 300.0 * chance.uniform(-1, 1)), 2.0
        shape: pymunk.Shape = pymunk.Circle(body, 6.0, (1.0, 0.0)) if k % 2 else pymunk.Poly.create_box(body, (12, 8))
        shape.elasticity, shape.friction, shape.collision_type = 0.9, 0.3, k
        space.add(body, shape)
    return space


PAIRS: dict[str, tuple[int | None, int | None]] = {
    "two bodies": (1, 2), "a wall": (3, 7), "a sensor": (2, 8), "a kinematic body": (4, 9), "one type": (5, None),
}  # fmt: skip


def played(
    seed: int, types: tuple[int | None, int | None], each: Callable[[pymunk.Space, list[Any]], None]
) -> tuple[list[Any], int]:
    """What handlers and `each` have told, with the path; and how many steps were left out."""
    space, left_out = room(seed), 0
    told: list[Any] = []
    step = [0]

    def telling(phase: str) -> Callable[..., None]:
        def tell(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
            told.append((step[0], phase, *(shape.collision_type for shape in arbiter.shapes)))

        return tell

    space.on_collision(*types, **{phase: telling(phase) for phase in PHASES})
    stepper = ep.EECA(space)
    for step[0] in range(300):
        if step[0] == 150:
            for shape in space.shapes:
                shape.collision_type = (shape.collision_type + 1) % 10
        if step[0] % 40 == 20:  # comes and goes
            extra = pymunk.Body(1.0, 50.0)
            extra.position, extra.velocity = (200.0, 20.0 + step[0] / 2), (100.0, -50.0)
            disk = pymunk.Circle(extra, 5.0)
            disk.elasticity, disk.collision_type = 0.5, step[0] // 40
            space.add(extra, disk)
        elif step[0] % 40 == 0 and step[0] > 0:
            space.remove(extra, disk)
        told.append(stepper.step(DT).ledger)
        world = stepper._world
        left_out += world is not None and world.rehearsal.left_out > 0
        told.append([(*body.position, *body.velocity, body.angle) for body in space.bodies])
        each(space, told)
    return told, left_out


def nothing(space: pymunk.Space, told: list[Any]) -> None:
    pass


def touching(space: pymunk.Space, told: list[Any]) -> None:
    """Tells who touches, now and then."""
    if len(told) % 7 == 0:
        for body in space.bodies:
            body.each_arbiter(lambda arbiter: told.append([shape.collision_type for shape in arbiter.shapes]))


def driven(space: pymunk.Space, told: list[Any]) -> None:
    """With damping 0 the program sets velocities."""
    space.damping = 0.0
    for k, body in enumerate(space.bodies):
        body.velocity = 300.0 * math.sin(len(told) / (20.0 + k)), 300.0 * math.cos(len(told) / (30.0 + k))


@pytest.mark.skipif(not hasattr(pymunk.Space, "on_collision"), reason="handlers of pymunk 6 are made otherwise")
@pytest.mark.parametrize("each", [nothing, touching, driven], ids=["unread", "read", "driven"])
@pytest.mark.parametrize("name", PAIRS)
def test_calls_paths_and_arbiters_are_those_of_all_steps(
    name: str, each: Callable[[pymunk.Space, list[Any]], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Compared are the calls in their order, the paths and ledgers bit by bit, and the pairs that arbiters tell."""
    if each is driven and name == "one type":
        pytest.skip("pymunk's order of two contacts in a step depends on the history of its broad phase")
    for seed in range(4):
        with_all, without = [], []
        found, left_out = played(seed, PAIRS[name], each)
        without.append(found)
        with monkeypatch.context() as patched:
            patched.setattr(Rehearsal, "_calls_none", lambda self, dt: False)
            found, none = played(seed, PAIRS[name], each)
            with_all.append(found)
        assert none == 0
        assert without == with_all
        assert left_out > 50 or name == "one type"


def test_a_step_of_pymunk_in_between_is_heard() -> None:
    """What a step of pymunk's own has begun, the next one separates."""
    space, told = pymunk.Space(), []
    for x in (-0.4, 0.4):
        add_disk(space, (x, 0.0), 0.5)
    for shape in space.shapes:
        shape.collision_type = 1
    functions = {phase: lambda *_, phase=phase: told.append(phase) or True for phase in ("begin", "separate")}
    if hasattr(space, "on_collision"):
        space.on_collision(1, 1, **functions)
    else:
        handler = space.add_collision_handler(1, 1)
        handler.begin, handler.separate = functions["begin"], functions["separate"]
    bodies, stepper = list(space.bodies), ep.EECA(space)
    bodies[1].position = 9.0, 0.0
    for _ in range(10):
        stepper.step(DT)
    assert told == []
    bodies[1].position = 0.4, 0.0
    space.step(DT)
    bodies[1].position = 9.0, 0.0
    stepper.step(DT)
    assert told == ["begin", "separate"]


@pytest.mark.parametrize("read_anew", [False, True])
def test_what_begin_decided_in_a_step_of_pymunk_holds(read_anew: bool) -> None:
    """pymunk does not call `begin` again as long as the shapes touch."""
    space, calls = pymunk.Space(), []
    floor = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0.1)
    disk = add_disk(space, (0.0, 0.64), 0.5, velocity=(0.0, -10.0))
    space.add(floor)
    for shape in space.shapes:
        shape.collision_type = 1

    def begin(arbiter: pymunk.Arbiter, *_: object) -> bool:
        calls.append(arbiter)
        arbiter.process_collision = False
        return False

    if hasattr(space, "on_collision"):
        space.on_collision(1, 1, begin=begin)
    else:
        space.add_collision_handler(1, 1).begin = begin
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(1e-4)
    space.step(0.01)
    if read_anew:
        add_disk(space, (10.0, 5.0), 0.5)
    for _ in range(30):
        stepper.step(0.01)
    assert len(calls) == 1
    assert disk.position.y == pytest.approx(0.64 - 10.0 * (3e-4 + 0.31), rel=1e-12)


def hear(space: pymunk.Space, a: int, b: int, told: list[str]) -> None:
    """Tell when shapes of types a and b begin to touch."""

    def begin(*_: object) -> bool:
        told.append(f"{a} {b}")
        return True

    if hasattr(space, "on_collision"):
        space.on_collision(a, b, begin=begin)
    else:
        space.add_collision_handler(a, b).begin = begin


def test_handlers_of_other_types_are_heard_though_steps_were_left_out() -> None:
    space, told = pymunk.Space(), list[str]()
    for k, x in enumerate((0.0, 3.0, 50.0)):
        (shape,) = add_disk(space, (x, 0.0), 0.5, velocity=(1.0 - k, 0.0)).shapes
        shape.collision_type = k
    hear(space, 0, 2, told)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    assert stepper._world is not None
    assert stepper._world.rehearsal.left_out
    hear(space, 0, 1, told)
    for _ in range(200):
        stepper.step(DT)
    assert told == ["0 1"]


def hanging(reads: bool) -> tuple[pymunk.Body, pymunk.Body, Callable[[], None]]:
    """A disk that hangs on a body outside the space, with a handler that nobody meets, and its step; `reads`: arbiters
    are asked after each."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    disk, nail = add_disk(space, (1.0, 0.0), 0.1), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(pymunk.PinJoint(nail, disk))
    hear(space, 7, 8, [])
    stepper = ep.EECA(space)

    def step() -> None:
        stepper.step(DT)
        if reads:
            disk.each_arbiter(lambda arbiter: None)

    return disk, nail, step


@pytest.mark.parametrize("reads", [False, True], ids=["left out", "rehearsed"])
def test_steps_whose_handlers_nobody_meets_are_those_without_handlers(
    reads: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Path, energy and impulses of a pendulum, bit by bit; no function is prepared for, but in the first steps."""
    disk, _, step = hanging(reads)
    plain = pymunk.Space()
    plain.gravity = (0.0, -10.0)
    other = add_disk(plain, (1.0, 0.0), 0.1)
    (pin,) = disk.constraints
    plain.add(same := pymunk.PinJoint(pymunk.Body(body_type=pymunk.Body.KINEMATIC), other))
    beside, hooked = ep.EECA(plain), [0]
    whole = ep.EECA._hooked_step

    def counted(self: ep.EECA, *arguments: Any) -> Any:
        hooked[0] += 1
        return whole(self, *arguments)

    monkeypatch.setattr(ep.EECA, "_hooked_step", counted)
    for _ in range(100):
        step()
        beside.step(DT)
        assert (disk.position, disk.angle, disk.velocity) == (other.position, other.angle, other.velocity)
        assert pin.impulse == same.impulse
    assert hooked[0] < 10


def test_a_step_that_fails_after_its_rehearsal_changes_nothing() -> None:
    disk, nail, step = hanging(reads=True)
    for _ in range(20):
        step()
    before = disk.position, disk.velocity, disk.angle
    nail.position = math.nan, 0.0
    with pytest.raises(ValueError, match="constraint holds"):
        step()
    assert (disk.position, disk.velocity, disk.angle) == before
    nail.position = 0.0, 0.0
    step()
    assert disk.position.length == pytest.approx(1.0, abs=1e-12)


def test_what_may_be_heard_is_found_again_after_edits_of_sizes() -> None:
    space, told = pymunk.Space(), list[str]()
    one, two = (add_disk(space, (x, 0.0), 0.5) for x in (0.0, 9.0))
    (first,), (second,) = one.shapes, two.shapes
    first.collision_type, second.collision_type = 0, 1
    hear(space, 0, 1, told)
    stepper = ep.EECA(space)
    found = []
    for radius in (0.51, 0.52, 0.53):
        for _ in range(10):
            stepper.step(DT)
        world = stepper._world
        assert world is not None
        found.append((world, world.rehearsal._pairs))
        first.unsafe_set_radius(radius)
    for friction in (0.1, 0.2):
        first.friction = friction
        stepper.step(DT)
    assert stepper._world is found[1][0] is found[2][0]  # the first edit of a size lets the space be read again
    assert found[2][1] is not None
    first.unsafe_set_radius(8.4)
    for speed in (0.0, 1.3):
        one.velocity = speed, 0.0
        for _ in range(10):
            stepper.step(DT)
    assert stepper._world is world
    assert told == ["0 1"]


@pytest.mark.parametrize("moved", ["body", "centre", "vertices"])
def test_what_may_be_heard_is_found_again_after_readings(moved: str) -> None:
    space, told = pymunk.Space(), list[str]()
    wall, one = pymunk.Body(body_type=pymunk.Body.STATIC), add_disk(space, (0.0, 0.0), 0.5, velocity=(1.0, 0.0))
    bar = pymunk.Poly(wall, [(9, -1), (10, -1), (10, 1), (9, 1)])
    space.add(wall, bar)
    bar.collision_type = 1
    hear(space, 0, 1, told)
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
    assert told == []
    if moved == "body":
        wall.position = -6.0, 0.0
    elif moved == "centre":  # about it the disk swings to the bar
        one.center_of_gravity = 4.5, 0.0
        one.velocity, one.angular_velocity = (0.0, 0.0), 1.0
    else:
        bar.unsafe_set_vertices([(3, -1), (4, -1), (4, 1), (3, 1)])
    space.reindex_static()
    add_disk(space, (0.0, 99.0), 0.5)
    reads = stepper.reads
    for _ in range(200):
        stepper.step(DT)
    assert stepper.reads > reads
    assert told[0] == "0 1"


def near_at_the_end(space: pymunk.Space, dt: float) -> bool:
    """Whether a pair with handlers is near at the end of free flight over dt."""
    world = ep.EECA(space)._world
    assert world is not None
    pairs = HandledPairs(world, None)
    assert pairs.arrays is not None
    place = place_for_rehearsal.bind(world.reading, *pairs.arrays)
    world.gather()
    return place(dt, 0.0, 0.0, 1.0) > 0


def two_shapes(seed: int) -> tuple[pymunk.Space, list[str]]:
    """Two shapes of random kinds on bodies that spin about centres of mass elsewhere, one of which may be static; and a
    list that gets an item when they meet."""
    chance, space, met = random.Random(seed), pymunk.Space(), []

    def point(size: float) -> tuple[float, float]:
        return chance.uniform(-size, size), chance.uniform(-size, size)

    for k in range(2):
        body = pymunk.Body(1.0, 1.0) if k == 0 or seed % 3 else pymunk.Body(body_type=pymunk.Body.STATIC)
        body.center_of_gravity, body.angle, body.position = point(1.0), chance.uniform(-3.0, 3.0), point(4.0)
        if body.body_type == pymunk.Body.DYNAMIC:
            body.velocity, body.angular_velocity = point(1.0), chance.uniform(-1.0, 1.0)
        kind, radius = chance.randrange(3), chance.choice((0.0, 0.3))
        shape: pymunk.Shape = (
            pymunk.Circle(body, 0.5 + radius, point(1.0)),
            pymunk.Segment(body, point(2.0), point(2.0), radius),
            pymunk.Poly(body, [(-1.0, -0.1), (1.5, -0.1), (1.5, 0.2), (-1.0, 0.2)], radius=radius),
        )[kind]
        space.add(body, shape)
    space.on_collision(None, None, begin=lambda *_: met.append("begin"))
    return space, met


@pytest.mark.parametrize("dt", [0.01, 0.3, 1.0])
def test_every_pair_that_overlaps_at_the_end_of_free_flight_is_near(dt: float) -> None:
    overlapping = apart = 0
    for seed in range(400):
        space, met = two_shapes(seed)
        near = near_at_the_end(space, dt)
        space.step(dt)  # pymunk's, which moves the bodies, and then finds the pairs that overlap
        overlapping, apart = overlapping + len(met), apart + (not near)
        assert near or not met, seed
    assert min(overlapping, apart) > 20


@pytest.mark.parametrize(("speed", "spin"), [(1.0, 0.0), (0.0, 0.0), (0.0, 0.3), (2.0, -0.2)])
@pytest.mark.parametrize(("more", "near"), [(0.001, False), (-0.001, True)])
def test_pairs_are_near_within_twice_their_ways(speed: float, spin: float, more: float, near: bool) -> None:
    """Two rods of length 10 that rotate with each other, one of which moves towards the other one along its normal: far
    within the circles and the upright boxes around them."""
    space, dt, size = pymunk.Space(), 0.01, 5.1
    end = 0.25 * math.pi + spin * dt
    normal = pymunk.Vec2d(0.0, 1.0).rotated(end)
    reach = 2.0 * (0.1 + 0.01 * size + 2.0 * size * abs(spin) * dt) + 2.0 * speed * dt
    for k in range(2):
        body = pymunk.Body(1.0, 1.0)
        body.angle, body.angular_velocity = 0.25 * math.pi, spin
        body.position, body.velocity = k * (reach + speed * dt + more) * normal, (1 - k) * speed * normal
        space.add(body, pymunk.Segment(body, (-5.0, 0.0), (5.0, 0.0), 0.1))
    space.on_collision(None, None, begin=lambda *_: None)
    assert near_at_the_end(space, dt) is near


@pytest.mark.parametrize("spin", [0.0, 0.2])
@pytest.mark.parametrize(("more", "near"), [(0.01, False), (-0.01, True)])
def test_what_turns_about_its_centre_of_mass_has_no_other_way(spin: float, more: float, near: bool) -> None:
    """A rod of length 10 whose centre of mass is its right end turns by .3 in the step, by its spin and a torque."""
    space, turn, size = pymunk.Space(), 0.3, 5.1
    rod = pymunk.Body(1.0, 2.0)
    rod.center_of_gravity, rod.position = (5.0, 0.0), (0.0, 0.0)
    rod.angular_velocity, rod.torque = spin, 2.0 * 2.0 * (turn - spin)
    reach = 0.1 + 0.01 * size + 2.0 * (5.0 + size) * turn + 1.01
    along = pymunk.Vec2d(1.0, 0.0).rotated(turn)
    place = pymunk.Vec2d(5.0, 0.0) - 5.0 * along + (reach + more) * along.perpendicular()
    space.add(rod, pymunk.Segment(rod, (-5.0, 0.0), (5.0, 0.0), 0.1), pymunk.Circle(space.static_body, 1.0, place))
    space.on_collision(None, None, begin=lambda *_: None)
    assert near_at_the_end(space, 1.0) is near


def test_a_law_of_shapes_that_was_edited_is_no_decision_of_a_handler() -> None:
    """pymunk keeps the arbiter of a disk that has left the floor, with the friction that it had there."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    space.add(floor)
    disk = add_disk(space, (0.0, 0.1), 0.1)
    (round_one,) = disk.shapes
    floor.friction = round_one.friction = 1.0
    hear(space, 7, 8, [])
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
        disk.each_arbiter(lambda arbiter: None)
    disk.velocity = 0.0, 5.0
    stepper.step(DT)
    round_one.friction = 0.5
    for _ in range(4):
        stepper.step(DT)
        assert stepper._world is not None
        assert not stepper._world.rules.changed

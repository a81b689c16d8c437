"""Bodies fall asleep with a certificate of statics, sleep like walls, and wake in the step that touches them."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.values import DYNAMIC, KINEMATIC, STATIC
from eeca_pymunk.sleepers import approaches, connect

DT = 1.0 / 60.0


def ground(space: pymunk.Space) -> pymunk.Segment:
    segment = pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.1)
    segment.friction = 0.5
    space.add(segment)
    return segment


def box(space: pymunk.Space, x: float, y: float, size: float = 1.0) -> pymunk.Body:
    body = pymunk.Body(1.0, size * size / 6.0)
    body.position = x, y
    shape = pymunk.Poly.create_box(body, (size, size))
    shape.friction = 0.5
    space.add(body, shape)
    return body


def ball(space: pymunk.Space, place: tuple[float, float], velocity: tuple[float, float]) -> pymunk.Body:
    body = pymunk.Body(0.5, 0.01)
    body.position, body.velocity = place, velocity
    shape = pymunk.Circle(body, 0.2)
    shape.elasticity = 1.0
    space.add(body, shape)
    return body


def stack(n: int = 3, threshold: float = 0.2) -> tuple[pymunk.Space, list[pymunk.Body]]:
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), threshold
    ground(space)
    return space, [box(space, 0.0, 0.6 + i) for i in range(n)]


def asleep(n: int = 3) -> tuple[pymunk.Space, list[pymunk.Body], ep.EECA]:
    space, bodies = stack(n)
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(DT)
    assert all(body.is_sleeping for body in bodies)
    return space, bodies, stepper


def still(bodies: list[pymunk.Body]) -> list[tuple[float, ...]]:
    return [(*body.position, body.angle) for body in bodies]


def test_a_stack_at_rest_falls_asleep_after_the_threshold_and_stays_where_it_is() -> None:
    space, bodies = stack(threshold=0.2)
    stepper = ep.EECA(space)
    steps = 0
    while not bodies[0].is_sleeping:
        stepper.step(DT)
        steps += 1
        assert steps < 30
    assert steps >= 0.2 / DT
    assert all(body.is_sleeping for body in bodies)
    before = still(bodies)
    for _ in range(20):
        book = stepper.step(DT).ledger
        assert book is not None
        assert book.change == book.residual == 0.0
    assert still(bodies) == before
    assert "3 of 3 bodies asleep" in stepper.model
    assert stepper.time == pytest.approx((steps + 20) * DT)


@pytest.mark.parametrize("sync", [True, False])
def test_a_sleeper_is_like_a_wall_until_it_is_touched_and_then_takes_the_whole_impulse(sync: bool) -> None:
    """Two boxes sleep in the air: a ball passes, hits one of them, and no momentum is lost; nothing falls before."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 10.0
    hit, other = box(space, 0.0, 5.0), box(space, 0.0, 9.0)
    hit.sleep()
    other.sleep()
    flying = ball(space, (2.0, 5.0), (-15.0, 1.0))
    stepper = ep.EECA(space, sync=sync)
    for _ in range(20):
        was_asleep, start = hit.is_sleeping, hit.position
        stepper.step(DT)
        if hit.is_sleeping:
            assert hit.position == start
        elif was_asleep:
            assert flying.velocity.x > -15.0
            assert hit.velocity.x < 0.0
        assert hit.velocity.x + 0.5 * flying.velocity.x == pytest.approx(-7.5, rel=1e-12)
        assert hit.is_sleeping or other.is_sleeping
    assert not hit.is_sleeping
    assert other.is_sleeping
    assert other.position == (0.0, 9.0)
    assert "1 of 3 bodies asleep" in stepper.model


def test_sleeping_may_be_switched_on_between_steps() -> None:
    space, bodies = stack(threshold=math.inf)
    stepper = ep.EECA(space)
    for _ in range(5):
        stepper.step(DT)
    space.sleep_time_threshold = 0.2
    for _ in range(20):
        stepper.step(DT)
    assert all(body.is_sleeping for body in bodies)
    bodies[0].activate()
    assert not any(body.is_sleeping for body in bodies)


def test_it_wakes_as_it_would_have_been_hit_awake() -> None:
    """The step in which a sleeping stack is hit ends as that of the same stack awake."""
    space, _, stepper = asleep()
    twin, _ = stack(threshold=math.inf)
    other = ep.EECA(twin)
    for one in (space, twin):
        ball(one, (3.0, 1.1), (-20.0, 0.0))
    for _ in range(8):
        stepper.step(DT)
        other.step(DT)
    mine, theirs = ([*one.bodies] for one in (space, twin))
    assert not any(body.is_sleeping for body in mine)
    for a, b in zip(mine, theirs, strict=True):
        assert tuple(a.position) == pytest.approx(tuple(b.position), abs=1e-6)
        assert tuple(a.velocity) == pytest.approx(tuple(b.velocity), abs=1e-5)


def pendulum() -> tuple[pymunk.Space, pymunk.Body]:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 0.1)
    body.position = 1.0, 0.0
    space.add(body, pymunk.Circle(body, 0.1), pymunk.PinJoint(space.static_body, body))
    return space, body


def thrown() -> tuple[pymunk.Space, pymunk.Body]:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 0.1)
    body.velocity = 0.0, 1.0
    space.add(body, pymunk.Circle(body, 0.1))
    return space, body


@pytest.mark.parametrize("make", [pendulum, thrown])
@pytest.mark.parametrize("phase", [0.0, 0.5])
def test_nobody_falls_asleep_at_the_apex(make, phase: float) -> None:
    """Not at the threshold of one step either, whether the apex is at the end of a step or in the middle of one."""
    space, body = make()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 1e-9
    if phase:
        body.velocity *= 1.05
    stepper = ep.EECA(space)
    for _ in range(300):
        stepper.step(0.01)
        assert not body.is_sleeping


def test_what_hangs_at_rest_sleeps_and_an_impulse_wakes_it() -> None:
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    body = pymunk.Body(1.0, 0.1)
    body.position = 0.0, -1.0
    space.add(body, pymunk.Circle(body, 0.1), pymunk.PinJoint(space.static_body, body))
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(DT)
    assert body.is_sleeping
    body.apply_impulse_at_local_point((1.0, 0.0))
    stepper.step(DT)
    assert not body.is_sleeping
    assert body.velocity.x == pytest.approx(math.cos(DT), abs=3e-3)


def test_joints_go_on_holding_what_sleeps() -> None:
    """Their impulses are the weight times dt also in steps in which everything sleeps; pymunk's solver has others."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    body = pymunk.Body(2.0, 0.1)
    body.position = 0.0, -1.0
    joints = [
        pymunk.PivotJoint(space.static_body, body, (0.0, 0.0)),
        pymunk.GearJoint(space.static_body, body, 0.0, 1.0),
    ]
    space.add(body, pymunk.Circle(body, 0.1), *joints)
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(DT)
    assert body.is_sleeping
    for dt in (DT, 0.1, 0.1, 1 / 240, DT):
        stepper.step(dt)
        assert body.is_sleeping
        assert [joint.impulse for joint in joints] == pytest.approx([20.0 * dt, 0.0], abs=1e-9)


def test_what_is_jointed_sleeps_on_beside_others() -> None:
    """Also where joints, of bodies that sleep and of others, have forces, laws and functions of their own."""
    space = pymunk.Space()
    space.sleep_time_threshold = 0.1
    held = [box(space, 3.0 * i, 0.0) for i in range(3)]
    for body in held:
        pivot = pymunk.PivotJoint(space.static_body, body, body.position)
        pivot.max_force = 1000.0
        spring = pymunk.DampedRotarySpring(space.static_body, body, 0.0, 1.0, 0.0)
        spring.torque_func = lambda spring, angle: -angle
        space.add(pivot, spring)
    held[2].angular_velocity = 1.0
    flying = ball(space, (0.0, 5.0), (1.0, 0.0))
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
    assert [body.is_sleeping for body in held] == [True, True, False]
    assert flying.position.x == pytest.approx(20 * DT)
    flying.velocity = -3.0, -30.0
    for _ in range(20):
        stepper.step(DT)
    assert not held[0].is_sleeping
    assert held[1].is_sleeping


def remove_ground(space: pymunk.Space) -> None:
    space.remove(*space.static_body.shapes)


def lower_ground(space: pymunk.Space) -> None:
    space.static_body.position = 0.0, -1.0


def shorten_ground(space: pymunk.Space) -> None:
    next(iter(space.static_body.shapes)).unsafe_set_endpoints((-20.0, 0.0), (-10.0, 0.0))  # type: ignore[attr-defined]


def turn_gravity(space: pymunk.Space) -> None:
    space.gravity = 0.0, 10.0


def call(space: pymunk.Space) -> None:
    next(b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC).activate()


def forget_sleep(space: pymunk.Space) -> None:
    space.sleep_time_threshold = math.inf


@pytest.mark.parametrize(
    ("change", "falls"),
    [
        (remove_ground, True), (lower_ground, True), (shorten_ground, True), (turn_gravity, True), (call, False),
        (forget_sleep, False),
    ],
)  # fmt: skip
def test_what_wakes_a_body_wakes_its_group_in_the_same_step(change, falls: bool) -> None:
    space, bodies, stepper = asleep()
    change(space)
    stepper.step(DT)
    assert not any(body.is_sleeping for body in bodies)
    for body in bodies:
        assert abs(body.velocity.y) == pytest.approx(10.0 * DT if falls else 0.0, abs=1e-9)


@pytest.mark.parametrize("groups", [1, 2, 3, 6])
def test_changed_gravity_wakes_all_groups(groups: int) -> None:
    space, bodies = stack(1)
    bodies += [box(space, 3.0 * k, 0.6) for k in range(1, groups)]
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(DT)
    assert all(body.is_sleeping for body in bodies)
    space.gravity = 0.0, 10.0
    stepper.step(DT)
    for body in bodies:
        assert not body.is_sleeping
        assert body.velocity.y == pytest.approx(10.0 * DT, abs=1e-9)


def test_a_sleeping_body_that_is_moved_wakes_alone() -> None:
    space, bodies = stack(1)
    bodies.append(box(space, 3.0, 0.6))  # a group of its own
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(DT)
    assert all(body.is_sleeping for body in bodies)
    bodies[0].position += 0.0, 2.0
    stepper.step(DT)
    assert [body.is_sleeping for body in bodies] == [False, True]


class Attempts(ep.EECA):
    """EECA that notes the work of each attempt at a step, over the budget of a whole one."""

    works: list[float]

    def advance(self, *arguments: Any) -> int:
        status, loop = super().advance(*arguments), self.event_loop
        assert loop is not None
        self.works.append(float(loop.scene.COUNT.work / loop.scene.COUNT.budget))
        return status


def row_of_sleepers(count: int) -> tuple[pymunk.Space, Attempts]:
    """A fast ball between walls, and sleeping ones in its way, each a group of its own."""
    space = pymunk.Space()
    space.sleep_time_threshold = 10.0
    for x in (-1.0, 2.0 * count):
        wall = pymunk.Segment(space.static_body, (x, -1.0), (x, 1.0), 0.1)
        wall.elasticity = 1.0
        space.add(wall)
    ball(space, (0.0, 0.0), (200.0, 0.0))
    for i in range(1, count):
        ball(space, (0.8 * i, 0.0), (0.0, 0.0)).sleep()
    stepper = Attempts(space)
    stepper.works = []
    return space, stepper


def test_a_step_that_wakes_one_body_after_the_other_is_repeated_a_few_times() -> None:
    """Each attempt wakes the next ball of the row: the last attempt wakes all."""
    space, stepper = row_of_sleepers(12)
    report = stepper.step(DT)
    assert len(stepper.works) == 5
    assert not any(body.is_sleeping for body in space.bodies)
    assert report.converged
    assert ep.measure(space).energy == pytest.approx(0.25 * 200.0**2, rel=1e-14)
    assert len(report.contacts) >= 4


def test_all_attempts_at_a_step_spend_the_budget_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eeca_pymunk.impacts.scene.STEP_LOOKS", 50)
    monkeypatch.setattr("eeca_pymunk.impacts.scene.STEP_LOOKS_BODY", 0)
    space, stepper = row_of_sleepers(12)
    for body in space.bodies:
        if not body.is_sleeping:
            body.velocity = 1e4, 0.0
    for _ in range(3):
        stepper.works.clear()
        assert not stepper.step(DT).converged
        assert len(stepper.works) > 1
        assert 0.9 < sum(stepper.works) < 1.5
    for body in space.bodies:
        body.activate()
    stepper.works.clear()
    assert not stepper.step(DT).converged
    assert stepper.works == [pytest.approx(1.0, abs=0.2)]


def test_a_ball_far_away_wakes_nobody() -> None:
    space, bodies, stepper = asleep()
    thrown = ball(space, (10.0, 3.0), (1.0, 0.0))
    for _ in range(10):
        stepper.step(DT)
    assert all(body.is_sleeping for body in bodies)
    assert thrown.position.y == pytest.approx(3.0 - 5.0 * (10 * DT) ** 2, rel=1e-12)


def test_a_kinematic_body_keeps_awake_what_it_carries_and_wakes_what_it_meets() -> None:
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor = pymunk.Poly.create_box(lift, (4.0, 1.0))
    space.add(lift, floor)
    body = box(space, 0.0, 1.0)
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(DT)
    assert not body.is_sleeping
    lift.position, body.position = (-10.0, 0.0), (0.0, 0.6)
    ground(space)
    for _ in range(20):
        stepper.step(DT)
    assert body.is_sleeping
    lift.velocity = 20.0, 0.0
    for _ in range(20):
        stepper.step(DT)
    assert body.is_sleeping
    while body.velocity.x < 1.0:
        stepper.step(DT)
    assert not body.is_sleeping
    assert lift.position.x + 2.0 <= body.position.x


def test_handlers_see_a_sleeper_hit_awake() -> None:
    space, bodies, stepper = asleep(1)
    begun: list[bool] = []
    space.on_collision(begin=lambda arbiter, space, data: begun.append(True))
    ball(space, (3.0, 0.6), (-20.0, 0.0))
    for _ in range(10):
        stepper.step(DT)
    assert begun
    assert not bodies[0].is_sleeping
    assert bodies[0].velocity.x < -1.0


@pytest.mark.parametrize("first", [0, 1, 2])
def test_on_a_kinematic_body_a_rehearsal_wakes_what_the_program_has_put_to_sleep(first: int) -> None:
    """As pymunk's own step does; it has the bodies in another order then."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 5.0
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(plate, pymunk.Segment(plate, (-20.0, 0.0), (20.0, 0.0), 0.1))
    boxes = [box(space, 3.0 * k, 0.6) for k in range(3)]
    space.on_collision(post_solve=lambda arbiter, space, data: None)
    flying = ball(space, (-5.0, 5.0), (1.0, 0.0))
    stepper = ep.EECA(space)
    for k in range(3):
        boxes[(first + k) % 3].sleep()
    stepper.step(DT)
    assert not any(body.is_sleeping for body in boxes)
    assert flying.position == pytest.approx((-5.0 + DT, 5.0 - 5.0 * DT * DT), abs=1e-14)
    for _ in range(5):
        stepper.step(DT)
    for k, body in enumerate(boxes):
        assert body.position == pytest.approx((3.0 * k, 0.6), abs=1e-9)
        assert body.velocity.length < 1e-9


def test_who_is_woken_by_a_hit_falls_in_that_step_by_its_own_function() -> None:
    """The sleeper alone has a function of velocities; the step that wakes it is taken again, and calls it."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 1.0
    sleeper = ball(space, (0.0, 0.0), (0.0, 0.0))
    sleeper.velocity_func = lambda body, gravity, damping, dt: pymunk.Body.update_velocity(body, gravity, damping, dt)
    flying = ball(space, (0.5, 0.0), (-12.0, 0.0))
    stepper = ep.EECA(space)
    sleeper.sleep()
    before = ep.measure(space).energy
    report = stepper.step(DT)
    assert not sleeper.is_sleeping
    assert sleeper.velocity == pytest.approx((-12.0, -10.0 * DT), abs=1e-12)
    assert flying.velocity == pytest.approx((0.0, -10.0 * DT), abs=1e-12)
    assert report.ledger is not None
    assert ep.measure(space).energy == pytest.approx(before, abs=1e-12)


def test_a_step_that_wakes_sleepers_knows_the_sides_of_thin_shapes() -> None:
    """A rod without width slides on a floor, 1.6e-4 of its length below it; a ball hits a sleeper far away. The step
    that was taken back had moved the rod, so that it counted as placed by the program: it fell through the floor."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 5.0
    ground(space).unsafe_set_radius(0.0)
    rod = pymunk.Body(1.0, 0.1)
    rod.velocity = 1.0, 0.0
    space.add(rod, pymunk.Segment(rod, (-0.5, 0.0), (0.5, 0.0), 0.0))
    sleeper, flying = ball(space, (5.0, 9.0), (0.0, 0.0)), ball(space, (7.0, 9.0), (-1.0, 0.0))
    stepper = ep.EECA(space)
    sleeper.sleep()
    for _ in range(4):
        rod.position -= (0.0, 4e-5)
        stepper.step(DT)
    flying.position, flying.velocity = (5.5, 9.0), (-12.0, 0.0)
    stepper.step(DT)
    assert not sleeper.is_sleeping
    for _ in range(20):
        stepper.step(DT)
    assert abs(rod.position.y) <= 1.6e-4 + 1e-12


def aside(body: pymunk.Body, dt: float) -> None:
    """What pymunk does, and 1e-9 aside."""
    pymunk.Body.update_position(body, dt)
    body.position += (1e-9, 0.0)


@pytest.mark.parametrize("upward", [0.0, 0.5])
@pytest.mark.parametrize("function", [pymunk.Body.update_position, aside])
def test_a_rod_that_wakes_knows_on_which_side_of_its_floor_it_is(
    function: Callable[[pymunk.Body, float], None], upward: float
) -> None:
    """A rod without width, 1.6e-4 of its length below a floor without width, sleeps there. What its position function
    does counts as an edit, by which it is no other rod."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 5.0
    ground(space).unsafe_set_radius(0.0)
    rods = []
    for x in (0.0, 5.0):  # one stays awake, so that the scene has thin shapes that move
        rods.append(pymunk.Body(1.0, 0.1))
        rods[-1].position = x, 0.0
        space.add(rods[-1], pymunk.Segment(rods[-1], (-0.5, 0.0), (0.5, 0.0), 0.0))
    rods[0].position_func = function
    stepper = ep.EECA(space)
    for _ in range(4):
        rods[0].position -= (0.0, 4e-5)
        stepper.step(DT)
    rods[0].sleep()
    for _ in range(3):
        rods[1].velocity = 1.0, 0.0
        stepper.step(DT)
    assert rods[0].is_sleeping
    rods[0].activate()
    rods[0].velocity = 0.0, upward
    for _ in range(20):
        stepper.step(DT)
    assert -1.6e-4 - 1e-12 <= rods[0].position.y <= max(upward**2 / 20.0 - 1.6e-4, 0.0) + 1e-12


def test_whom_pymunk_wakes_where_all_sleep_gets_no_velocity_from_it() -> None:
    """A box that the program puts to sleep 1 mm deep in a kinematic plate, by itself."""
    space = pymunk.Space()
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 5.0
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(plate, pymunk.Segment(plate, (-20.0, 0.0), (20.0, 0.0), 0.1))
    body = box(space, 0.0, 0.599)
    stepper = ep.EECA(space)
    body.sleep()
    report = stepper.step(DT)
    assert body.velocity == (0.0, 0.0)
    assert body.position == (0.0, 0.599)
    assert report.ledger is not None
    assert report.ledger.change == 0.0


def test_islands_sleep_one_by_one() -> None:
    space, bodies = stack(2)
    late = box(space, 6.0, 2.0)
    stepper = ep.EECA(space)
    seen = set()
    for _ in range(120):
        stepper.step(DT)
        seen.add((bodies[0].is_sleeping and bodies[1].is_sleeping, late.is_sleeping))
    assert (True, False) in seen
    assert (True, True) in seen
    assert late.position.y == pytest.approx(0.6, abs=1e-9)


def test_a_step_of_sleepers_asks_pymunk_for_nothing() -> None:
    space, _, stepper = asleep()
    for _ in range(space.collision_persistence + 3):
        stepper.step(DT)
    taken = stepper._sleep._timestamp() if stepper._sleep else -1
    for _ in range(5):
        stepper.step(DT)
    assert stepper._sleep is not None
    assert stepper._sleep._timestamp() == taken


def test_a_pickled_stepper_of_sleepers_goes_on() -> None:
    space, _, stepper = asleep()
    other = pickle.loads(pickle.dumps(stepper))
    for one in (stepper, other):
        one.step(DT)
    heights = [sorted(body.position.y for body in one.bodies) for one in (space, other.space)]
    assert heights[0] == pytest.approx(heights[1], abs=1e-12)


WAYS: list[Callable[[ep.EECA], ep.EECA]] = [
    copy.deepcopy,
    lambda stepper: pickle.loads(pickle.dumps(stepper)),
    lambda stepper: pickle.loads(pickle.dumps((stepper.space, stepper)))[1],
]


@pytest.mark.parametrize("within", [False, True])
@pytest.mark.parametrize("through", WAYS)
def test_the_copy_of_a_stepper_sleeps_and_wakes_as_its_original(
    through: Callable[[ep.EECA], ep.EECA], within: bool
) -> None:
    """All bodies of pymunk's copies are awake: one that sleeps in mid-air would fall. `within`: in `with stepper`."""
    space, bodies = stack()
    bodies.append(box(space, 4.0, 3.0))
    bodies.append(box(space, -6.0, 0.6))
    stepper = ep.EECA(space)
    bodies[3].sleep()
    for _ in range(15):
        stepper.step(DT)
    bodies.append(ball(space, (-4.0, 0.9), (6.0, 1.0)))
    with stepper if within else nullcontext():
        for _ in range(9):
            stepper.step(DT)
        assert [body.is_sleeping for body in bodies] == [True, True, True, True, True, False]
        other = through(stepper)
    slept, paths = [], []
    for one in (stepper, other):
        ours = list(one.space.bodies)
        places = []
        for _ in range(90):
            one.step(DT)
            places.append([(b.is_sleeping, *b.position, b.angle, *b.velocity, b.angular_velocity) for b in ours])
        slept.append([[row[0] for row in rows] for rows in places])
        paths.append(places)
    assert slept[0] == slept[1]
    assert paths[0] == paths[1]
    assert slept[0][0] == [True] * 5 + [False]
    assert slept[0][40] == [False] * 3 + [True, True, False]


@pytest.mark.parametrize(
    ("start", "speed", "size", "free", "met"),
    [
        (-3.0, -2.0, 0.25, 1, [1]), (-3.2, -2.0, 0.25, 1, []), (math.nan, -2.0, 0.25, 1, []),
        (-3.0, math.inf, 0.25, 1, []), (-2.0, 0.0, 0.25, 1, [1]), (-2.0, 0.0, 0.25, 0, []), (-2.0, 0.1, 0.25, 0, [1]),
        (-3.0, -2.0, 0.0, 1, []),
    ],
)  # fmt: skip
def test_boxes_that_may_be_reached(start: float, speed: float, size: float, free: int, met: list[int]) -> None:
    """v dt + (|g| + |f| / m) dt^2 = 2 * .5 + (4 + 6 / 2) * .25 = 2.75, and a size of .25: 3 to the second box, at 0.
    Kinematic bodies at rest and bodies without shapes meet none."""
    STATES, MET = np.zeros((2, 2, 9)), np.full(2, -1)
    STATES[0, 1, [0, 3, 7]] = start, speed, 6.0
    FREE, SIZE, INVERSE = np.array([1, free]), np.array([9.0, size]), np.array([1.0, 0.5])
    BOXES = np.array([[0.0, 1.0e3, 1.0, 1.1e3], [0.0, -1.0, 1.0, 1.0]])
    count = approaches(STATES, np.array([1]), FREE, SIZE, INVERSE, BOXES, MET, 0.5, 4.0)
    assert MET[:count].tolist() == met


@pytest.mark.parametrize("turned", [False, True])
def test_groups_sleep_if_all_their_bodies_may_and_none_touches_a_kinematic_one(turned: bool) -> None:
    """On the static body 0: a column of 2 and 3, and 4 alone. On the kinematic body 1: 5, which carries 6. The body 7
    is not ready, and beside 8, which is."""
    kind = np.array([STATIC, KINEMATIC, *(7 * [DYNAMIC])])
    pairs = np.array([(0, 2), (2, 3), (0, 4), (1, 5), (5, 6), (7, 8), (0, 7), (0, 8), (0, 1)])
    ready, group = np.array([0, 0, 1, 1, 1, 1, 1, 0, 1]), np.zeros(9, np.int64)
    connect(np.ascontiguousarray(pairs[:, ::-1]) if turned else pairs, kind, ready, group)
    assert (group >= 0).tolist() == [False, False, True, True, True, False, False, False, False]
    assert group[2] == group[3]
    assert group[2] != group[4]


def test_what_the_program_puts_to_sleep_is_not_woken_by_what_has_left_it() -> None:
    """pymunk's arbiters of the first step, in which both touched, are made anew before the body falls asleep."""
    space, (left, *_) = stack(1, threshold=50.0)
    right, stepper = box(space, 1.0, 0.6), ep.EECA(space)
    for shape in space.shapes:
        shape.friction = 0.0
    left.velocity = -3.0, 0.0
    for _ in range(10):
        stepper.step(DT)
    assert left.position.x == pytest.approx(-0.5)
    right.sleep()
    for _ in range(3):
        stepper.step(DT)
    assert right.is_sleeping


@pytest.mark.parametrize("by_state", [False, True])
def test_what_is_set_back_falls_asleep_when_it_did_before(by_state: bool) -> None:
    """`refresh` and `set_state` from poses forget for how long bodies have been at rest, and when some fell asleep."""
    space, bodies = stack(threshold=0.5)
    far = box(space, 8.0, 0.6)
    stepper = ep.EECA(space)
    state = [(*body.position, body.angle, 0.0, 0.0, 0.0) for body in (*bodies, far)]
    counts = []
    for before in (20, 40, 5):
        for _ in range(before):
            stepper.step(DT)
        if by_state:
            stepper.set_state(state)
        else:
            for body in (*bodies, far):
                body.activate()
            stepper.refresh()
        count = 0
        while not far.is_sleeping:
            stepper.step(DT)
            count += 1
        counts.append(count)
        for body in (*bodies, far):
            body.activate()
    assert counts[0] == counts[1] == counts[2]
    assert counts[0] >= 0.5 / DT - 1


def test_a_body_outside_that_a_joint_holds_wakes_nobody() -> None:
    """Under pymunk it sleeps as soon as a space with sleeping bodies is stepped, and nothing wakes it."""
    space, _, stepper = asleep()
    inside, outside = box(space, 8.0, 0.6), pymunk.Body(1.0, 1.0)
    motor = pymunk.SimpleMotor(outside, inside, 0.0)
    motor.max_force = 0.1
    space.add(motor)
    for _ in range(3):
        stepper.step(DT)
    assert outside.is_sleeping
    box(space, -8.0, 0.6)
    stepper.step(DT)
    assert [body.is_sleeping for body in space.bodies] == [True] * 3 + [False] * 2


@pytest.mark.parametrize("later", [0, 2])
@pytest.mark.parametrize("change", ["shape", "body", "outline", "place", "sensor"])
def test_what_sleeps_falls_when_its_shelf_goes_also_just_after_it_has_fallen_asleep(change: str, later: int) -> None:
    space, shelf, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(1.0, 1.0)
    space.gravity, space.sleep_time_threshold = (0.0, -10.0), 0.1
    board = pymunk.Segment(shelf, (-5.0, 0.0), (5.0, 0.0), 0.1)
    box.position = (0.0, 0.6)
    space.add(shelf, board, box, pymunk.Poly.create_box(box, (1.0, 1.0)))
    stepper, steps = ep.EECA(space), 0
    while not box.is_sleeping and steps < 30:
        stepper.step(1 / 60)
        steps += 1
    assert box.is_sleeping
    for _ in range(later):
        stepper.step(1 / 60)
    if change == "shape":
        space.remove(board)
    elif change == "body":
        space.remove(board, shelf)
    elif change == "outline":
        board.unsafe_set_endpoints((4.0, 0.0), (5.0, 0.0))
    elif change == "place":
        shelf.position = (0.0, -3.0)
    else:
        board.sensor = True
    before = box.position.y
    for _ in range(12):
        stepper.step(1 / 60)
    assert before - box.position.y == pytest.approx(0.5 * 10.0 * 0.2**2, rel=1e-9)


@pytest.mark.parametrize("added", [False, True])
def test_sleeping_is_switched_off_just_after_a_body_has_fallen_asleep(added: bool) -> None:
    """Waking it changes pymunk's order of bodies: each keeps its own state, the ground too."""
    space, still, other = pymunk.Space(), pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    space.sleep_time_threshold = 0.1
    still.position, other.position, other.velocity = (3.0, 4.0), (-5.0, 0.0), (1.0, 0.0)
    space.add(still, pymunk.Circle(still, 0.1), other, pymunk.Circle(other, 0.1))
    stepper, steps = ep.EECA(space), 0
    while not still.is_sleeping and steps < 30:
        stepper.step(1 / 60)
        steps += 1
    assert still.is_sleeping
    if added:
        third = pymunk.Body(1.0, 1.0)
        space.add(third, pymunk.Circle(third, 0.1))
    space.sleep_time_threshold = math.inf
    space.on_collision(None, None, begin=lambda *_: None)
    for _ in range(3):
        stepper.step(1 / 60)
    assert (still.position, space.static_body.position) == ((3.0, 4.0), (0.0, 0.0))
    assert other.position.x == pytest.approx(-5.0 + (steps + 3) / 60, rel=1e-12)
    assert not still.is_sleeping

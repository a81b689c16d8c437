"""Large steps and thin shapes: nothing gets through, energy never rises, work is bounded."""

from __future__ import annotations

import math
import random

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.piles import R, deepest
from eeca_pymunk.model.parameters.events import RESOLUTION

from ..crowds import SHORT
from ..programs.compositions import Composition

G = 9.81


def world(floor: float = 0.0, elasticity: float = 0.0) -> pymunk.Space:
    """A space with a floor of this radius whose surface is y = 0."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    ground = pymunk.Segment(space.static_body, (-1e5, -floor), (1e5, -floor), floor)
    ground.friction, ground.elasticity = 0.5, elasticity
    space.add(ground)
    return space


def box(space: pymunk.Space, x: float, y: float, w: float, h: float, angle: float, e: float) -> pymunk.Body:
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (w, h)))
    body.position, body.angle = (x, y), angle
    shape = pymunk.Poly.create_box(body, (w, h))
    shape.friction, shape.elasticity = 0.5, e
    space.add(body, shape)
    return body


def rod(space: pymunk.Space, y: float, angle: float, e: float) -> pymunk.Body:
    body = pymunk.Body(1.0, pymunk.moment_for_segment(1.0, (-0.9, 0.0), (0.9, 0.0), 0.0))
    body.position, body.angle = (0.0, y), angle
    shape = pymunk.Segment(body, (-0.9, 0.0), (0.9, 0.0), 0.0)
    shape.friction, shape.elasticity = 0.4 * (1.0 - e), e
    space.add(body, shape)
    return body


def ends(body: pymunk.Body) -> float:
    """Height of a rod's lower end."""
    return min(float(body.local_to_world((x, 0.0)).y) for x in (-0.9, 0.9))


@pytest.mark.parametrize("dt", [1.0, 3.0, 10.0, 30.0])
def test_a_stack_at_rest_stays_in_any_step(dt: float) -> None:
    """Forces that are constant move nothing however long they last: round-off of a dt² is all there is."""
    space = world()
    bodies = [box(space, 0.0, 0.5 + i, 1.0, 1.0, 0.0, 0.0) for i in range(10)]
    stepper = ep.EECA(space)
    for _ in range(10):
        assert stepper.step(dt).converged
    assert max(abs(b.position.y - 0.5 - i) for i, b in enumerate(bodies)) < 1e-12 * G * dt * dt + 1e-12


@pytest.mark.parametrize(("count", "dt"), [(2, 1.0), (2, 3.0), (12, 1.0), (12, 3.0), (12, 10.0), (40, 0.25), (40, 1.0)])
@pytest.mark.parametrize("e", [0.0, 0.5])
def test_dropped_boxes_stay_above_the_floor(count: int, dt: float, e: float) -> None:
    """Centres of boxes of half height .3 and more stay above it, and no step gains energy beyond external work."""
    chance = random.Random(count)
    space = world()
    if SHORT and count > 2:
        count = 4
    bodies = [
        box(space, -2 + (i % 4) * 1.1, 0.8 + (i // 4) * 1.1, 0.8, 0.6, chance.uniform(-0.5, 0.5), e)
        for i in range(count)
    ]
    stepper = ep.EECA(space)
    before = ep.measure(space).energy
    for _ in range(6):
        report = stepper.step(dt)
        ledger = report.ledger
        assert ledger is not None
        after = ep.measure(space).energy
        assert after - before <= ledger.external + 1e-12 * count * G * count
        before = after
        assert min(b.position.y for b in bodies) > 0.1


@pytest.mark.parametrize(("dt", "least"), [(1.0, 0.01), (3.0, 1e-3), (10.0, 1e-3)])
@pytest.mark.parametrize("seed", range(20))
def test_a_box_that_is_dropped_in_a_long_step_does_not_rest_inside_the_floor(
    seed: int, dt: float, least: float
) -> None:
    """What its impacts have lost in the step pays for lifting it; else it stays a tenth of its height inside."""
    chance = random.Random(seed)
    space = world(0.5, chance.choice((0.0, 0.5)))
    w, h = chance.uniform(0.5, 1.5), chance.uniform(0.5, 1.0)
    body = box(space, 0.0, chance.choice((1.0, 3.0, 30.0)), w, h, chance.uniform(-3.0, 3.0), 0.5)
    body.angular_velocity = chance.choice((0.0, chance.uniform(-5.0, 5.0)))
    stepper = ep.EECA(space)
    last = ep.measure(space).energy
    for _ in range(6):
        stepper.step(dt)
        now = ep.measure(space).energy
        assert now <= last + 1e-12 * body.mass * G * 30.0
        corners = ((x, y) for x in (-w / 2, w / 2) for y in (-h / 2, h / 2))
        assert min(body.local_to_world(corner).y for corner in corners) >= -least * min(w, h)
        last = now


def tilted_boxes(seed: int) -> pymunk.Space:
    """Two to five boxes that turn, above one another."""
    chance, top = random.Random(seed), 0.2
    space = world(0.5)
    for _ in range(chance.randint(2, 5)):
        w, h, gap = chance.uniform(0.6, 1.4), chance.uniform(0.6, 1.2), chance.uniform(0.05, 1.0)
        body = box(space, chance.uniform(-0.3, 0.3), top + gap + h / 2, w, h, chance.uniform(-0.3, 0.3), 0.0)
        body.angular_velocity = chance.uniform(-1.0, 1.0)
        top += gap + h
    return space


@pytest.mark.parametrize("dt", [0.1, 1.0, 3.0])
def test_boxes_that_are_dropped_on_one_another_in_long_steps_do_not_rest_inside_one_another(dt: float) -> None:
    """Impacts of the first step pay for lifting what it has let sink, as later ones lose nothing. Of 20 stacks one
    may rest a hundredth deep (10 do at dt = 1, up to .07, if impacts only pay for single bodies)."""
    deep = []
    for seed in range(20):
        space = tilted_boxes(seed)
        stepper, last = ep.EECA(space), ep.measure(space).energy
        for _ in range(15):
            stepper.step(dt)
            now = ep.measure(space).energy
            assert now <= last + 1e-11 * len(space.bodies) * G * 5.0
            last = now
        deep.append(R * deepest(space))
    assert max(deep) <= 0.05
    assert sum(depth > 0.01 for depth in deep) <= 1


@pytest.mark.parametrize("dt", [1 / 60, 0.1, 1.0])
@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.3, math.pi / 2, 1.0, math.pi])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_rod_of_no_width_stays_on_a_floor_of_no_width(e: float, angle: float, dt: float) -> None:
    """Both gaps and sides are exact at 0: a rod that falls on its side, on its end or flush stays above, and its energy
    is that of its height at rest, kept for e = 1."""
    space = world(elasticity=1.0 if e == 1.0 else e)
    body = rod(space, 2.0, angle, e)
    start = ep.measure(space).energy
    stepper = ep.EECA(space)
    for _ in range(int(max(5.0, 3.0 / dt)) if not SHORT else 30):
        stepper.step(dt)
        assert ends(body) > -1e-3  # what contacts of its size that come to rest may go deep
    energy = ep.measure(space).energy
    assert energy <= start + 1e-12 * start
    if e == 1.0:
        assert energy == pytest.approx(start, rel=1e-11)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rod_put_exactly_on_a_segment_stays_on_the_side_from_which_it_is_pressed(side: float) -> None:
    space = world()
    space.gravity = 0.0, -side * G
    body = rod(space, 0.0, 0.0, 0.0)
    stepper = ep.EECA(space)
    for _ in range(50):
        stepper.step(1 / 60)
    assert abs(body.position.y) < 1e-9
    body.velocity = 0.0, side * 2.0
    stepper.step(0.1)
    assert body.position.y * side == pytest.approx(0.2 - 0.005 * G, rel=1e-9)


def test_thin_rods_at_high_speed_stay_in_a_thin_box() -> None:
    """Elastic, without friction: energy is kept, and nobody leaves."""
    chance = random.Random(4)
    space = pymunk.Space()
    corners = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0)]
    for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
        wall = pymunk.Segment(space.static_body, p, q, 0.0)
        wall.elasticity = 1.0
        space.add(wall)
    bodies = []
    for i in range(9):
        body = rod(space, 0.0, chance.uniform(0, 6), 1.0)
        body.position = -4 + 4 * (i % 3), -4 + 4 * (i // 3)
        body.velocity = chance.uniform(-60, 60), chance.uniform(-60, 60)
        body.angular_velocity = chance.uniform(-60, 60)
        bodies.append(body)
    energy = ep.measure(space).energy
    stepper = ep.EECA(space)
    for _ in range(20 if SHORT else 200):
        stepper.step(1 / 60)
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)
    assert max(max(abs(c) for c in b.local_to_world((x, 0.0))) for b in bodies for x in (-0.9, 0.9)) < 6.0 + 1e-9


def test_rods_that_lie_deep_in_walls_that_turn_are_solved_a_bounded_number_of_times() -> None:
    """A rod and a plank in a thin box that turns and shakes, dt 0.1 s."""
    scene = Composition(166)
    for k in range(20):
        scene.drive(k)
        report = scene.stepper.step(scene.dt)
        assert report.iterations < 4 * RESOLUTION
        assert all(u.name != "solves" for u in report.unmet)


@pytest.mark.parametrize("other", [False, True])
def test_contacts_of_many_intervals_of_a_step_are_not_kept(other: bool) -> None:
    """Each event looks through the contacts of all intervals: steps of many intervals took time by their square. Disks
    that are smaller than their way have many. `other`: a second one, whose intervals end in turn with those of the
    first."""
    space = world(0.1)
    for k in range(1 + other):
        ball = pymunk.Body(1.0, 1.0)
        ball.position, ball.velocity = (k, 1e-3), (30.0 + k, 0.0)
        space.add(ball, pymunk.Circle(ball, 1e-3))
    stepper = ep.EECA(space)
    stepper.step(0.1)
    assert stepper.event_loop is not None
    count = stepper.event_loop.scene.COUNT
    assert count.solves > 1000
    assert count.pushes < 200

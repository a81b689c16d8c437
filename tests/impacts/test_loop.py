"""The event loop through pymunk spaces: exact solutions, laws of conservation, and nobody meets unseen."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from comparisons.hard_cases import moving
from eeca_pymunk.impacts.scene import EventLoop
from eeca_pymunk.pairs.rules import circle_centre
from scenes.scene import add_disk, add_walls

from ..crowds import SHORT, box_of, deepest, positions, radii, reference, state


@pytest.mark.parametrize("dt", [0.005, 0.01, 0.4])
def test_gases_of_twenty_disks_are_exact_also_as_one_step(dt: float) -> None:
    errors = []
    for seed in range(3 if SHORT else 20):
        scene = scenes.build("gas", count=20, radius=0.03, seed=seed)
        exact = reference(scene.bodies)
        exact.run(0.4)
        stepper, energy = ep.EECA(scene.space), ep.measure(scene.space).energy
        impacts = sum(len(stepper.step(dt).contacts) for _ in range(round(0.4 / dt)))
        assert impacts == exact.events
        assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-13)
        errors.append(np.abs(positions(scene.bodies) - exact.position).max())
    assert max(errors) <= 1e-10
    assert np.median(errors) <= 1e-11


@pytest.mark.parametrize("steps", [1, 7])
def test_four_hundred_disks_in_few_steps(steps: int) -> None:
    count = 60 if SHORT else 400
    scene = scenes.build("gas", count=count, packing=0.3, seed=1)
    exact = reference(scene.bodies)
    exact.run(0.05)
    stepper = ep.EECA(scene.space)
    assert sum(len(stepper.step(0.05 / steps).contacts) for _ in range(steps)) == exact.events
    assert SHORT or exact.events > 2 * count
    np.testing.assert_allclose(positions(scene.bodies), exact.position, atol=1e-7)


def one_giant(seed: int) -> np.ndarray:
    return np.r_[0.3, np.full(30 if SHORT else 200, 0.004)]


def dust(seed: int) -> np.ndarray:
    """A few large disks and what is up to a thousand times smaller."""
    rng = np.random.default_rng(seed)
    return np.r_[np.full(8, 0.1), 10.0 ** rng.uniform(-4.0, -2.0, 20 if SHORT else 150)]


@pytest.mark.parametrize("sizes", [one_giant, dust])
@pytest.mark.parametrize("dt", [2e-3, 0.04])
def test_sizes_of_one_to_a_thousand(sizes: Callable[[int], np.ndarray], dt: float) -> None:
    for seed in range(2):
        space, bodies = box_of(sizes(seed), seed)
        exact, energy = reference(bodies), ep.measure(space).energy
        exact.run(0.04)
        stepper, impacts = ep.EECA(space, sync=False), 0
        for _ in range(round(0.04 / dt)):
            impacts += len(stepper.step(dt).contacts)
            assert deepest(bodies, 1.0) < 1e-8
        assert impacts == exact.events >= (2 if SHORT else 40)
        assert ep.measure(space).energy == pytest.approx(energy, rel=1e-13)
        # Each impact makes an error larger by about the way to it over the radius, up to a thousand times for dust.
        error = np.abs(positions(bodies) - exact.position)
        assert np.median(error) < 1e-13
        assert error.max() < 1e-6


@pytest.mark.parametrize("speed", [10.0, 1e4])
def test_a_fast_disk_across_a_sparse_crowd(speed: float) -> None:
    # Many margin circles are crossed in one step, and not one disk on the way is passed over.
    # Errors grow 50 times from one to the next, so that the way must be short.
    impacts = 0
    for seed in range(4 if SHORT else 20):
        space, bodies = box_of(np.full(40 if SHORT else 300, 0.004), seed)
        for body in bodies:
            body.velocity = 0.001 * body.velocity
        bodies[0].velocity = (speed, 0.7 * speed)
        exact = reference(bodies)
        exact.run(0.6 / speed)
        report = ep.EECA(space, sync=False).step(0.6 / speed)
        assert len(report.contacts) == exact.events
        impacts += exact.events
        np.testing.assert_allclose(positions(bodies), exact.position, atol=1e-7)
    assert SHORT or impacts > 60


@pytest.mark.parametrize("dt", [0.01, 0.5])
def test_carom_ends_where_its_mirror_images_say(dt: float) -> None:
    scene = scenes.build("carom", dt=dt)
    stepper = ep.EECA(scene.space, sync=False)
    for _ in range(round(5.0 / dt)):
        stepper.step(dt)
    np.testing.assert_allclose(positions(scene.bodies), scene.exact(5.0), atol=1e-11)


def test_time_runs_back() -> None:
    space, bodies = box_of(np.full(20, 0.04), 3)
    start, stepper = positions(bodies), ep.EECA(space, sync=False)
    impacts = sum(len(stepper.step(0.01).contacts) for _ in range(25))
    assert impacts > 20
    for body in bodies:
        body.velocity = -body.velocity
    assert sum(len(stepper.step(0.05).contacts) for _ in range(5)) == impacts
    np.testing.assert_allclose(positions(bodies), start, atol=1e-9)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_another_force_on_each_body(unit: float) -> None:
    # Paths are parabolas that bend apart: exact at any dt. Energy less the work of the constant forces stays.
    ends = []
    for dt in (0.04, 0.01):
        space, bodies = box_of(unit * np.full(12 if SHORT else 40, 0.03), 5, unit)
        rng = np.random.default_rng(0)
        forces = unit * rng.normal(size=(len(bodies), 2)) * 5.0
        stepper, start = ep.EECA(space, sync=False), positions(bodies)
        energy, impacts = ep.measure(space).energy, 0
        for _ in range(round(0.2 / dt)):
            for body, force in zip(bodies, forces.tolist(), strict=True):
                body.force = tuple(force)
            impacts += len(stepper.step(dt).contacts)
            work = float(np.sum(forces * (positions(bodies) - start)))
            assert ep.measure(space).energy - work == pytest.approx(energy, rel=1e-12)
            assert deepest(bodies, unit) < 1e-9
        assert impacts > (5 if SHORT else 20)
        ends.append((impacts, positions(bodies) / unit))
    assert ends[0][0] == ends[1][0]
    np.testing.assert_allclose(ends[0][1], ends[1][1], atol=1e-7)


@pytest.mark.parametrize("origin", [0.0, 1e6])
def test_nobody_meets_unseen_in_a_pulled_crowd(origin: float) -> None:
    space, bodies = box_of(np.full(40 if SHORT else 300, 0.015), 6, gravity=30.0)
    for body in bodies:
        body.position += pymunk.Vec2d(origin, 0.0)
    for wall in space.static_body.shapes:
        assert isinstance(wall, pymunk.Segment)
        shift = pymunk.Vec2d(origin, 0.0)
        wall.unsafe_set_endpoints(wall.a + shift, wall.b + shift)
    energy, stepper = ep.measure(space).energy, ep.EECA(space, sync=False)
    for _ in range(8 if SHORT else 40):
        stepper.step(0.01)
        assert deepest(bodies) < 1e-6 * max(1.0, 1e-3 * origin / 1e3)
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12 if origin == 0.0 else 1e-7)


def kick(bodies: list[pymunk.Body], rng: np.random.Generator) -> None:
    bodies[int(rng.integers(0, len(bodies)))].velocity = tuple(rng.normal(size=2).tolist())


def push(bodies: list[pymunk.Body], rng: np.random.Generator) -> None:
    bodies[int(rng.integers(0, len(bodies)))].force = tuple((20.0 * rng.normal(size=2)).tolist())


def still(bodies: list[pymunk.Body], rng: np.random.Generator) -> None:
    bodies[int(rng.integers(0, len(bodies)))].velocity = (0.0, 0.0)


def teleport(bodies: list[pymunk.Body], rng: np.random.Generator) -> None:
    """One goes to a free place, at rest every other time."""
    body = bodies[int(rng.integers(0, len(bodies)))]
    others, radius = [b for b in bodies if b is not body], radii(bodies)[0]
    while True:
        place = rng.uniform(1.1 * radius, 1.0 - 1.1 * radius, 2)
        if (np.hypot(*(positions(others) - place).T) > 2.1 * radius).all():
            break
    body.position = tuple(place.tolist())
    if rng.uniform() < 0.5:
        body.velocity = (0.0, 0.0)


def nothing(bodies: list[pymunk.Body], rng: np.random.Generator) -> None:
    pass


EDITS = {"nothing": nothing, "kick": kick, "push": push, "still": still, "teleport": teleport}


@pytest.mark.parametrize("edit", EDITS)
@pytest.mark.parametrize("gravity", [0.0, 10.0])
def test_what_the_user_changes_between_steps_is_as_if_read_for_the_first_time(edit: str, gravity: float) -> None:
    # One stepper keeps lists and forecasts of many steps, the other knows nothing of the steps before.
    count = 18 if SHORT else 150
    runs = []
    for fresh in (False, True):
        rng = np.random.default_rng(11)
        space, bodies = box_of(np.full(count, 0.3 / math.sqrt(count)), 8, gravity=gravity)
        stepper, states = ep.EECA(space, sync=False), []
        for _ in range(10 if SHORT else 60):
            EDITS[edit](bodies, rng)
            if fresh:
                stepper = ep.EECA(space, sync=False)
            stepper.step(4e-3)
            assert deepest(bodies, 1.0) < 1e-9
            states.append(state(space))
        runs.append(np.array(states))
    np.testing.assert_array_equal(runs[0], runs[1])


def test_one_put_at_rest_in_the_way_of_others_is_hit() -> None:
    # It is far outside its margin circle, and has no speed at which to leave it.
    space = pymunk.Space()
    for i in range(30):
        add_disk(space, (10.0 * i, 50.0), 0.5)
    moved = next(iter(space.bodies))
    runner = add_disk(space, (0.0, 0.0), 0.5, velocity=(10.0, 0.0))
    stepper = ep.EECA(space, sync=False)
    stepper.step(0.1)
    moved.position = (100.0, 0.0)
    for _ in range(110):
        stepper.step(0.1)
    assert runner.velocity == pytest.approx((0.0, 0.0), abs=1e-12)
    assert moved.velocity == pytest.approx((10.0, 0.0), abs=1e-12)


def test_a_saved_stepper_goes_on_bit_by_bit() -> None:
    space, _ = box_of(np.full(30 if SHORT else 200, 0.015), 9, gravity=5.0)
    stepper = ep.EECA(space, sync=False)
    for _ in range(10):
        stepper.step(5e-3)
    copy = pickle.loads(pickle.dumps(stepper))
    for _ in range(10):
        stepper.step(5e-3)
        copy.step(5e-3)
        np.testing.assert_array_equal(state(stepper.space), state(copy.space))


def test_bodies_come_and_go() -> None:
    space, bodies = box_of(np.full(30 if SHORT else 120, 0.02), 10)
    stepper, taken = ep.EECA(space, sync=False), list[pymunk.Body]()
    for k in range(12):
        exact = reference(bodies)
        exact.run(0.01)
        stepper.step(0.01)
        np.testing.assert_allclose(positions(bodies), exact.position, atol=1e-10)
        if k % 4 == 3:  # back again, if there is room where they stand
            for body in list(taken):
                if (np.hypot(*(positions(bodies) - body.position).T) > 0.0401).all():
                    space.add(body, *body.shapes)
                    taken.remove(body)
                    bodies.append(body)
        else:
            gone = bodies.pop(k)
            space.remove(gone, *gone.shapes)
            taken.append(gone)


@pytest.mark.parametrize("count", [1, 5, 40])
def test_terrain_of_a_thousand_segments(count: int) -> None:
    pieces, width = (200 if SHORT else 1000), 20.0
    x = np.linspace(0.0, width, pieces + 1)
    y = 0.4 * np.sin(2.0 * x) + 0.1 * np.sin(9.0 * x)
    outline = [(0.0, 30.0), *zip(x.tolist(), y.tolist(), strict=True), (width, 30.0)]
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    add_walls(space, list(pairwise(outline)))
    rng = np.random.default_rng(1)
    bodies = [
        add_disk(space, (0.3 + 0.45 * i, 3.0), 0.1, velocity=tuple((2.0 * rng.normal(size=2)).tolist()))
        for i in range(count)
    ]
    stepper, energy, impacts = ep.EECA(space, sync=False), ep.measure(space).energy, 0
    for _ in range(10 if SHORT else 200):
        impacts += len(stepper.step(1.0 / 30.0).contacts)
        place = positions(bodies)
        far = np.abs(place[:, :1] - x).min(axis=1)
        assert (far < 0.02).all() or SHORT
        # Distance from the corners is at least the radius, and nobody is below the ground.
        to_corners = np.hypot(place[:, :1] - x, place[:, 1:] - y).min(axis=1)
        assert (to_corners > 0.1 * (1.0 - 1e-9)).all()
        assert (place[:, 1] > np.interp(place[:, 0], x, y)).all()
    assert SHORT or impacts > count
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)


def test_walls_that_turn_are_looked_for_where_they_are() -> None:
    """However often bodies hit a drum, none of its walls leaves the circle in which its neighbours know it."""
    space = moving.drum(spin=3.0)
    stepper = ep.EECA(space)
    for _ in range(90):
        stepper.step(1 / 60)
        method = stepper._method
        assert isinstance(method, EventLoop)
        scene = method.scene
        for s in range(len(scene.LIST)):
            if scene.BODY["inv_mass"][scene.LINK["owner"][s]] > 0.0:
                continue
            x, y = circle_centre(scene, s, scene.BODY["since"][scene.LINK["owner"][s]])
            away = math.hypot(x - scene.MARK["x"][s], y - scene.MARK["y"][s])
            assert away <= scene.MARK["margin"][s] * (1 + 1e-9)


def test_what_orbits_its_body_fast_stays_in_one_circle() -> None:
    """A disk at 10 radii from the centre of its body, beside a crowd with margins of 1.4 radii: ten radians a step."""
    space = pymunk.Space()
    for k in range(400):
        add_disk(space, (0.25 * (k % 20), 0.25 * (k // 20)), 0.1)
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity, body.angular_velocity = (7.0, 2.0), (-1.0, 0.0), 1000.0
    shape = pymunk.Circle(body, 0.1, (1.0, 0.0))
    shape.elasticity = 1.0
    space.add(body, shape)
    stepper = ep.EECA(space)
    method = stepper._method
    assert isinstance(method, EventLoop)
    energy, hit, looks = ep.measure(space).energy, 0, 0
    stepper.step(0.01)
    for _ in range(119):
        report = stepper.step(0.01)
        looks += 0 if hit else int(method.scene.COUNT.work)
        hit += len(report.contacts)
    # The orbit of radius 1.1 comes to the crowd's disk of x = 4.75 after about 1.05 s, in about ten margins.
    assert hit > 0
    assert looks < 200
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)


def test_walls_of_a_container_that_turns_slowly_keep_margins_of_their_own_size() -> None:
    """Only what goes round its body's centre within a step has a circle about that; else the list of each of many walls
    would hold all that is inside."""
    space = pymunk.Space()
    drum = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drum.angular_velocity = 6.0
    space.add(drum)
    ends = [(5.0 * math.cos(a), 5.0 * math.sin(a)) for a in np.linspace(0.0, math.tau, 101)]
    space.add(*(pymunk.Segment(drum, a, b, 0.05) for a, b in pairwise(ends)))
    for k in range(36):
        add_disk(space, (k % 6 - 2.5, k // 6 - 2.5), 0.3, velocity=(1.0, 0.0))
    stepper = ep.EECA(space)
    method = stepper._method
    assert isinstance(method, EventLoop)
    margins = method.scene.MARK["margin"].copy()
    for _ in range(30):
        stepper.step(1 / 60)
    assert method.scene.GRID.renewals > 100
    assert (method.scene.MARK["margin"] == margins).all()

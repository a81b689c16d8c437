"""Shapes that turn: impulses with arms at the time of impact, kinematic bodies, faces that meet, rest."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eeca_pymunk as ep
import scenes
from eeca_pymunk._rounds import convex
from eeca_pymunk.energy.delassus import ArmedDelassus


def add_box(space: pymunk.Space, position: tuple[float, float], size=(1.0, 1.0), e: float = 1.0, angle: float = 0.0):
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, size))
    body.position, body.angle = position, angle
    shape = pymunk.Poly.create_box(body, size)
    shape.elasticity = e
    space.add(body, shape)
    return body


def add_floor(space: pymunk.Space, e: float = 1.0) -> None:
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    floor.elasticity = e
    space.add(floor)


@pytest.mark.parametrize("dt", [1e-3, 1 / 60, 0.3])
def test_rod_corner_first_onto_a_floor(dt: float) -> None:
    # lam = 2 |u| / (1/m + c²/I) at the arm c of the corner.
    space = pymunk.Space()
    add_floor(space)
    rod = add_box(space, (0.0, 1.0), (2.0, 0.1), angle=math.radians(30))
    rod.velocity = (0.0, -1.0)
    stepper = ep.EECA(space)
    while rod.velocity.y == -1.0:
        stepper.step(dt)
    assert rod.velocity.y == pytest.approx(-0.358291, abs=1e-6)
    assert abs(rod.angular_velocity) == pytest.approx(1.615042, abs=1e-6)
    assert ep.measure(space).energy == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize("bowl", [False, True])
def test_mixed_shapes_keep_energy(bowl: bool) -> None:
    scene = scenes.build("mixed", seed=1, bowl=bowl)
    stepper, start, impacts = ep.EECA(scene.space), ep.measure(scene.space).energy, 0
    for _ in range(250):
        impacts += len(stepper.step(scene.dt).impulse)
        assert abs(ep.measure(scene.space).energy / start - 1.0) <= 1e-12
    assert impacts > 50


def test_trajectories_of_turning_shapes_do_not_depend_on_dt() -> None:
    ends = []
    for dt in (0.02, 0.01, 0.004):
        scene = scenes.build("mixed", seed=0)
        stepper, impacts = ep.EECA(scene.space), 0
        for _ in range(round(0.8 / dt)):
            impacts += len(stepper.step(dt).impulse)
        assert impacts > 15
        ends.append(np.array([(*b.position, b.angle) for b in scene.bodies]))
    for end in ends[:-1]:
        np.testing.assert_allclose(end, ends[-1], atol=1e-9)


def test_free_pair_of_boxes_keeps_all_momenta() -> None:
    space = pymunk.Space()
    a, b = add_box(space, (0.0, 0.0), angle=0.3), add_box(space, (1.6, 0.3), (0.7, 1.1), angle=1.0)
    a.velocity, b.angular_velocity = (1.0, 0.2), -0.7
    before, stepper, impacts = ep.measure(space), ep.EECA(space), 0
    for _ in range(100):
        impacts += len(stepper.step(0.02).impulse)
    after = ep.measure(space)
    assert impacts >= 1
    assert after.energy == pytest.approx(before.energy, rel=1e-14)
    np.testing.assert_allclose(after.linear_momentum, before.linear_momentum, atol=1e-14)
    assert after.angular_momentum == pytest.approx(before.angular_momentum, abs=1e-12)


def test_flat_landing_meets_at_two_points_and_does_not_turn() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    add_floor(space)
    box = add_box(space, (0.0, 1.5))
    stepper = ep.EECA(space)
    start, most = ep.measure(space).energy, 0
    for _ in range(300):
        most = max(most, len(stepper.step(1 / 60).impulse))
    assert most == 2
    assert abs(box.angle) < 1e-12
    # Height after 5 s: the period is 2 sqrt(2 h / g).
    period = 2.0 * math.sqrt(0.2)
    assert box.position.y == pytest.approx(0.5 + height(5.0 % period, period), abs=1e-10)
    assert ep.measure(space).energy == pytest.approx(start, rel=1e-14)


def height(t: float, period: float) -> float:
    """Of a drop from 1 m, elastic, g = 10 m/s², after t < period, which begins at the top."""
    s = t if t < period / 2 else period - t
    return 1.0 - 5.0 * s * s


def test_stack_and_sliding_box_rest() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    add_floor(space, 0.0)
    boxes = [add_box(space, (0.0, 0.5 + k), e=0.0) for k in range(4)]
    slider = add_box(space, (5.0, 0.5), e=0.0)
    slider.velocity = (1.0, 0.0)
    stepper = ep.EECA(space)
    for _ in range(120):
        report = stepper.step(1 / 60)
    for k, box in enumerate(boxes):
        np.testing.assert_allclose(box.position, (0.0, 0.5 + k), atol=1e-9)
    np.testing.assert_allclose(slider.position, (7.0, 0.5), atol=1e-9)
    # The forces carry the weight: 5 kg on the floor.
    on_floor = report.contacts.body_b == stepper._twin.bodies.row[space.static_body]  # type: ignore[union-attr]
    assert report.impulse[on_floor].sum() == pytest.approx(5 * 10 / 60, rel=1e-9)


def test_tilted_box_comes_to_rest_and_its_energy_never_rises() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    add_floor(space, 0.5)
    box = add_box(space, (0.0, 1.5), e=0.5, angle=0.3)
    stepper, energy = ep.EECA(space), [ep.measure(space).energy]
    for _ in range(180):
        stepper.step(1 / 60)
        energy.append(ep.measure(space).energy)
    assert max(np.diff(energy)) <= 1e-9 * energy[0]
    assert box.position.y == pytest.approx(0.5, abs=1e-3)
    assert np.hypot(*box.velocity) + abs(box.angular_velocity) < 1e-6


def test_kinematic_plate_pushes_at_the_instant_it_arrives() -> None:
    space = pymunk.Space()
    plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    plate.velocity = (1.0, 0.0)
    face = pymunk.Segment(plate, (0.0, -1.0), (0.0, 1.0), 0.1)
    disk = pymunk.Body(1.0, 1.0)
    disk.position = (1.0, 0.0)
    ball = pymunk.Circle(disk, 0.2)
    ball.elasticity = face.elasticity = 1.0
    space.add(plate, face, disk, ball)
    stepper = ep.EECA(space)
    for _ in range(100):
        stepper.step(1 / 60)
    np.testing.assert_allclose(plate.position, (100 / 60, 0.0), atol=1e-12)
    np.testing.assert_allclose(disk.position, (1.0 + 2.0 * (100 / 60 - 0.7), 0.0), atol=1e-12)


def test_turning_drum_lets_nobody_out() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    drum = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    drum.angular_velocity = 1.0
    corners = [(3 * math.cos(a), 3 * math.sin(a)) for a in np.linspace(0.0, 2 * math.pi, 7)]
    walls = [pymunk.Segment(drum, p, q, 0.05) for p, q in pairwise(corners)]
    for wall in walls:
        wall.elasticity = 1.0
    space.add(drum, *walls)
    boxes = [add_box(space, (-1.0 + i, 0.0), (0.5, 0.3)) for i in range(3)]
    stepper = ep.EECA(space)
    for _ in range(240):
        stepper.step(1 / 60)
        assert max(np.hypot(*b.position) for b in boxes) < 3.0
    assert drum.angle == pytest.approx(4.0)


@settings(max_examples=60, deadline=None)
@given(shape=st.tuples(st.integers(1, 6), st.integers(1, 6)), seed=st.integers(0, 10**6), away=st.floats(1.3, 4.0))
def test_distance_of_convex_cores_against_sampled_boundaries(shape: tuple[int, int], seed: int, away: float) -> None:
    rng = np.random.default_rng(seed)
    cores = [hull(rng, n) for n in shape]
    turn = rng.uniform(0.0, 2 * math.pi)
    cores[1] = cores[1] + away * np.array([math.cos(turn), math.sin(turn)])
    width = max(len(c) for c in cores)
    a, b = (np.concatenate((c, np.repeat(c[-1:], width - len(c), axis=0)))[None] for c in cores)
    found = convex.closest(a, b)
    points = [boundary(c) for c in cores]
    sampled = np.linalg.norm(points[0][:, None] - points[1], axis=2).min()
    assert found.distance[0] == pytest.approx(sampled, abs=2e-2)
    assert found.distance[0] <= sampled + 1e-12
    assert np.hypot(*found.normal[0]) == pytest.approx(1.0)
    # The normal separates: along it the cores are as far apart as they are.
    apart = (cores[1] @ found.normal[0]).min() - (cores[0] @ found.normal[0]).max()
    assert apart == pytest.approx(found.distance[0], abs=1e-9)


def hull(rng: np.random.Generator, count: int) -> np.ndarray:
    """Corners of a convex polygon on the unit circle, counter-clockwise."""
    angle = 2 * math.pi * (np.arange(count) + rng.uniform(0.0, 0.8, count)) / count + rng.uniform(0.0, 2 * math.pi)
    return 0.6 * np.stack((np.cos(angle), np.sin(angle)), axis=1)


def boundary(core: np.ndarray) -> np.ndarray:
    s = np.linspace(0.0, 1.0, 101)[:, None, None]
    return np.asarray((core + s * (np.roll(core, -1, axis=0) - core)).reshape(-1, 2))


def test_depth_of_overlapping_boxes_is_the_shortest_way_out() -> None:
    box = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    found = convex.closest(box[None], (box + np.array((1.7, 0.4)))[None])
    assert found.distance[0] == pytest.approx(-0.3)
    np.testing.assert_allclose(found.normal[0], (1.0, 0.0))


def test_operator_with_arms_is_its_matrix_and_its_bound_holds() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.integers(0, 5, 12), 5 + rng.integers(0, 3, 12)
    mobility = rng.uniform(0.5, 2.0, (8, 3))
    mobility[7] = 0.0
    A = ArmedDelassus(a, b, (rng.normal(size=(12, 3)), rng.normal(size=(12, 3))), mobility)
    dense = A.dense()
    lam = rng.normal(size=12)
    np.testing.assert_allclose(A @ lam, dense @ lam, atol=1e-12)
    np.testing.assert_allclose(A.diagonal(), np.diag(dense))
    assert np.linalg.eigvalsh(np.diag(A.row_bound()) - dense).min() >= -1e-12
    some = np.array([1, 4, 7])
    np.testing.assert_allclose(A.take(some).dense(), dense[np.ix_(some, some)])

"""The margin twin: gaps against pymunk's arbiters, and completeness of the pair list."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from pymunk import batch

import eeca_pymunk as ep
import scenes
from eeca_pymunk.space.bodies import Bodies
from eeca_pymunk.space.shapes import Shapes
from eeca_pymunk.space.twin import MarginTwin
from scenes.scene import add_disk, add_walls

MARGIN = 2.0
SQUARE = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]


def wall(space: pymunk.Space, kind: str, grown: float) -> pymunk.Shape:
    body = pymunk.Body(body_type=pymunk.Body.STATIC)
    body.position, body.angle = (0.3, -0.2), 0.7
    shape: pymunk.Shape = {
        "circle": lambda: pymunk.Circle(body, 0.4 + grown, (0.1, 0.2)),
        "segment": lambda: pymunk.Segment(body, (-0.5, 0.0), (0.6, 0.1), grown),
        "capsule": lambda: pymunk.Segment(body, (-0.5, 0.0), (0.6, 0.1), 0.15 + grown),
        "box": lambda: pymunk.Poly(body, SQUARE, radius=grown),
        "rounded": lambda: pymunk.Poly(body, SQUARE, radius=0.2 + grown),
    }[kind]()
    space.add(body, shape)
    return shape


@pytest.mark.parametrize("kind", ["circle", "segment", "capsule", "box", "rounded"])
@pytest.mark.parametrize("seed", range(12))
def test_gap_normal_and_point_are_those_of_grown_arbiters(kind: str, seed: int) -> None:
    # pymunk reports distance, normal and points of the shapes grown by half a margin each: an independent geometry.
    rng = np.random.default_rng(seed)
    angle, distance = rng.uniform(0, 2 * np.pi), rng.uniform(0.75, 1.1)
    position = (0.3 + distance * np.cos(angle), -0.2 + distance * np.sin(angle))
    grown, plain = pymunk.Space(), pymunk.Space()
    for space, growth in ((grown, MARGIN / 2), (plain, 0.0)):
        add_disk(space, position, 0.1 + growth)
        wall(space, kind, growth)
    grown.step(1e-30)
    buffer = batch.Buffer()
    fields = batch.ArbiterFields
    batch.get_space_arbiters(
        grown, fields.BODY_A_ID | fields.NORMAL | fields.DISTANCE_1 | fields.POINT_A_1 | fields.POINT_B_1, buffer
    )
    data = np.frombuffer(buffer.float_buf())
    disk = next(b for b in grown.bodies if b.body_type == pymunk.Body.DYNAMIC)
    first = np.frombuffer(buffer.int_buf(), dtype=np.uintp)[0] == disk.id
    normal = data[:2] if first else -data[:2]
    # Fields come in the order of their declaration: normal, point a, point b, distance.
    middle = 0.5 * (data[2:4] + data[4:6])

    bodies = Bodies(plain)
    state = bodies.gather()
    assert state is not None
    twin = MarginTwin(bodies, Shapes(plain, bodies), state)
    pairs = twin.candidates(state[:, :2], np.zeros((len(bodies), 2)), np.full(len(bodies), 2.0))
    at = pairs.at(state[:, :2])
    assert len(pairs) == 1
    assert at.gap[0] == pytest.approx(data[6] + MARGIN, abs=1e-12)
    np.testing.assert_allclose(at.normal[0], normal, atol=1e-12)
    np.testing.assert_allclose(at.point[0], middle, atol=1e-12)


def test_disk_inside_polygon_leaves_through_nearest_side() -> None:
    space = pymunk.Space()
    space.add(pymunk.Poly(space.static_body, SQUARE))
    add_disk(space, (0.4, 0.1), 0.05)
    bodies = Bodies(space)
    state = bodies.gather()
    assert state is not None
    twin = MarginTwin(bodies, Shapes(space, bodies), state)
    pairs = twin.candidates(state[:, :2], np.zeros((len(bodies), 2)), np.zeros(len(bodies)))
    at = pairs.at(state[:, :2])
    assert at.gap[0] == pytest.approx(-0.15)
    np.testing.assert_allclose(at.normal[0], (-1.0, 0.0), atol=1e-15)


@pytest.mark.parametrize("disks", [10, 30, 400])  # without the moving frame, with it, and with a spatial hash
@pytest.mark.parametrize("wind", [0.0, 3.0])
def test_list_holds_every_pair_that_can_meet(disks: int, wind: float) -> None:
    rng = np.random.default_rng(7)
    space = pymunk.Space()
    radius = rng.uniform(0.005, 0.02, disks)
    x = rng.uniform(0, 1, (disks, 2))
    v = rng.normal(size=(disks, 2)) * rng.choice([0.1, 10.0], (disks, 1))  # slow ones and a few fast ones
    v[:, 0] += wind
    for xi, ri in zip(x, radius, strict=True):
        add_disk(space, tuple(xi), ri)
    add_walls(space, [((1.0, -1.0), (1.0, 2.0))])
    bodies = Bodies(space)
    state = bodies.gather()
    assert state is not None
    twin = MarginTwin(bodies, Shapes(space, bodies), state)
    rows = np.array([bodies.row[b] for b in space.bodies])
    position, displacement = np.zeros((len(bodies), 2)), np.zeros((len(bodies), 2))
    meetings = 0
    for _ in range(60):
        position[rows], displacement[rows] = x, 1e-3 * v
        pairs = twin.candidates(position, displacement, np.zeros(len(bodies)))
        listed = set(zip(pairs.row_a.tolist(), pairs.row_b.tolist(), strict=True))
        # Closest approach of the straight paths within the step.
        d, move = x[None] - x[:, None], 1e-3 * (v[None] - v[:, None])
        s = np.clip(-(d * move).sum(axis=2) / np.maximum((move**2).sum(axis=2), 1e-300), 0.0, 1.0)
        meets = np.linalg.norm(d + s[..., None] * move, axis=2) <= radius[:, None] + radius
        for i, j in np.argwhere(np.triu(meets, 1)):
            a, b = int(rows[i]), int(rows[j])
            assert (a, b) in listed or (b, a) in listed
        at_wall = np.abs(np.stack((x[:, 0], x[:, 0] + 1e-3 * v[:, 0])) - 1.0).min(axis=0) <= radius
        for i in np.flatnonzero(at_wall & (np.abs(x[:, 1] - 0.5) < 1.4)):
            assert (int(rows[i]), bodies.row[space.static_body]) in listed
        meetings += int(at_wall.sum()) + int(np.triu(meets, 1).sum())
        x = x + 1e-3 * v
    assert meetings >= 3


def test_crowd_that_falls_together_is_detected_rarely() -> None:
    scene = scenes.build("hopper", dt=5e-4)
    stepper = ep.EECA(scene.space)
    for _ in range(100):
        stepper.step(scene.dt)
    assert stepper._twin is not None
    assert stepper._twin.detections <= 25


def test_slow_scene_is_detected_rarely() -> None:
    space = pymunk.Space()
    for i in range(20):
        add_disk(space, (i, 0.0), 0.1)
    bodies = Bodies(space)
    state = bodies.gather()
    assert state is not None
    twin = MarginTwin(bodies, Shapes(space, bodies), state)
    x = state[:, :2].copy()
    for _ in range(60):
        twin.candidates(x, np.tile((1e-3, 0.0), (len(x), 1)), np.zeros(len(x)))
        x[:, 0] += 1e-3
    assert twin.detections <= 15


def test_one_disk_of_absurd_speed_among_many_does_not_hang_the_hash() -> None:
    space = pymunk.Space()
    for i in range(300):
        add_disk(space, (0.3 * (i % 20), 0.3 * (i // 20)), 0.1)
    bullet = add_disk(space, (-1.0, 0.15), 0.01, velocity=(1e9, 0.0))
    stepper = ep.EECA(space)
    stepper.step(1.0)
    assert bullet.velocity.length > 0

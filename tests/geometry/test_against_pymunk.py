"""Gaps, normals and points against what pymunk's own collision detection says of shapes that are grown: overlap."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from pymunk import batch

from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.space.world import World
from scenes.scene import add_disk
from tests.packed import core_room, scene_with

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


def between(space: pymunk.Space) -> tuple[float, float, float, float, float]:
    """Gap, normal and point of the disk and the static shape of a space."""
    world = World(space)
    world.load()
    scene = scene_with(
        BODY=world.BODY, SHAPE=world.SHAPE, LINK=world.LINK, VERTEX=world.VERTEX, CORE=core_room(world.LINK)
    )
    return gap(scene, 0, 1, 0.0)


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
    g, nx, ny, px, py = between(plain)
    assert g == pytest.approx(data[6] + MARGIN, abs=1e-12)
    np.testing.assert_allclose((nx, ny), normal, atol=1e-12)
    np.testing.assert_allclose((px, py), middle, atol=1e-12)


def test_disk_inside_polygon_leaves_through_nearest_side() -> None:
    space = pymunk.Space()
    space.add(pymunk.Poly(space.static_body, SQUARE))
    add_disk(space, (0.4, 0.1), 0.05)
    g, nx, ny, _, _ = between(space)
    assert g == pytest.approx(-0.15)
    np.testing.assert_allclose((nx, ny), (-1.0, 0.0), atol=1e-15)

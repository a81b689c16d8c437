"""Contact points of faces: where they are, in which order, and that they do not depend on who is called a."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eeca_pymunk.compiled.records import columns
from eeca_pymunk.geometry.gap import gap
from eeca_pymunk.geometry.manifold import face, manifold
from eeca_pymunk.model.bodies import POSE
from eeca_pymunk.model.contacts import ContactPoint
from tests.packed import Thing, World, box, disk, hull

UNITS = [1e-3, 1.0, 1e3]


def rows(world: World, a: int, b: int, reach: float, tolerance: float = 1e-9) -> np.ndarray:
    """The rows of `manifold`, bodies where their paths start; shape numbers are body numbers."""
    out = np.zeros(2, ContactPoint.TYPE)
    count = manifold(world.scene, a, b, columns(world.body, *POSE), a, b, reach, tolerance, out)
    return out.view(float).reshape(2, 5)[:count]


def common(world: World, a: int, b: int, tolerance: float) -> np.ndarray:
    out = np.zeros(2, ContactPoint.TYPE)
    count = face(world.scene, a, b, columns(world.body, *POSE), a, b, tolerance, out)
    return out.view(float).reshape(2, 5)[:count]


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("rounding", "turn"), [(0.0, 0.0), (0.1, 0.0), (0.0, 0.7), (0.1, 2.3)])
def test_box_on_a_wider_box_has_both_its_corners(rounding: float, turn: float, unit: float) -> None:
    c, s = math.cos(turn), math.sin(turn)
    up = 1.0 + 2.0 * rounding + 0.01
    lower = Thing(box(3.0 * unit, unit, rounding * unit), (0.0, 0.0, turn))
    upper = Thing(box(unit, unit, rounding * unit), (unit * (0.2 * c - up * s), unit * (0.2 * s + up * c), turn))
    found = rows(World([lower, upper]), 0, 1, 0.1 * unit)
    height = 0.5 + rounding + 0.005
    assert len(found) == 2
    # In the order of t = (-n_y, n_x), here to the left.
    for row, x in zip(found, (0.7, -0.3), strict=True):
        expected = (-s, c, unit * (x * c - height * s), unit * (x * s + height * c), 0.01 * unit)
        np.testing.assert_allclose(row, expected, atol=2e-15 * max(unit, 1.0))
    assert len(rows(World([lower, upper]), 0, 1, 0.005 * unit)) == 0
    ends = common(World([lower, upper]), 0, 1, 1e-11 * unit)
    np.testing.assert_allclose(ends, found, atol=2e-15 * max(unit, 1.0))


def test_tilted_faces_and_single_corners() -> None:
    floor = [([(-9.0, 0.0), (9.0, 0.0)], 0.0)]
    tilt = 0.01
    height = 0.5 * math.cos(tilt) + 0.5 * math.sin(tilt)
    world = World([Thing(box(1.0, 1.0), (0.0, height, tilt))], floor)
    found = rows(world, 0, 1, 0.1)
    assert len(found) == 2
    np.testing.assert_allclose(found[:, 4], (0.0, math.sin(tilt)), atol=1e-15)  # t points to +x, n down
    np.testing.assert_allclose(found[:, 0], 0.0, atol=1e-15)
    assert len(rows(world, 0, 1, 0.005)) == 1
    assert len(common(world, 0, 1, 1e-6)) == 1
    assert len(common(world, 0, 1, 0.02)) == 2
    # On an edge of its own, and corner to corner.
    world = World([Thing(box(1.0, 1.0), (0.0, math.sqrt(0.5), math.pi / 4))], floor)
    found = rows(world, 0, 1, 0.1)
    assert len(found) == 1
    np.testing.assert_allclose(found[0], (0.0, -1.0, 0.0, 0.0, 0.0), atol=2e-16)
    world = World([Thing(box(1.0, 1.0)), Thing(box(1.0, 1.0), (1.1, 1.2, 0.0))])
    found = rows(world, 0, 1, 0.5)
    assert len(found) == 1
    np.testing.assert_allclose(found[0, :4], (0.1 / math.hypot(0.1, 0.2), 0.2 / math.hypot(0.1, 0.2), 0.55, 0.6))


@pytest.mark.parametrize(("x", "y"), [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
def test_corners_that_touch_are_one_point(x: float, y: float) -> None:
    for away in (0.0, 1e-13):
        world = World([Thing(box(1.0, 1.0)), Thing(box(1.0, 1.0), (x * (1.0 + away), y * (1.0 + away), 0.0))])
        found = rows(world, 0, 1, 1e-3)
        assert len(found) == 1
        np.testing.assert_allclose(found[0, 2:], (0.5 * x, 0.5 * y, away), atol=1e-12)


def test_a_beam_longer_than_its_support_stands_on_the_support_s_corners() -> None:
    world = World([Thing(box(4.0, 0.2), (0.3, 0.6, 0.0)), Thing(box(1.0, 1.0))])
    for a, b, left in ((0, 1, -0.5), (1, 0, 0.5)):
        found = rows(world, a, b, 1e-3)
        np.testing.assert_allclose(found[:, 2], (left, -left), atol=1e-15)
        np.testing.assert_allclose(found[:, 3], 0.5, atol=1e-15)
        np.testing.assert_allclose(found[:, 4], 0.0, atol=1e-15)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("off", [-3e-6, 0.0, 3e-6])
@pytest.mark.parametrize("tilt", [-1e-5, 0.0, 1e-5])
def test_an_end_that_is_hardly_beside_a_face_touches_it(tilt: float, off: float, unit: float) -> None:
    """A rod and a box beside each other, all but across the face: the rod's end is below the corner by less than what
    tells corners from faces. Contacts of such pairs were lost, and they hit each other again and again."""
    rod = Thing([([(0.0, 0.0), (0.5 * unit, 0.0)], 0.05 * unit)], (0.6 * unit, -0.5 * unit + off * unit, tilt))
    world = World([Thing(box(1.0 * unit, unit, 0.05 * unit)), rod])
    nearest = gap(world.scene, 0, 1, 0.0)[0]
    for a, b in ((0, 1), (1, 0)):
        found = rows(world, a, b, 0.1 * unit, 1e-9 * unit)
        assert len(found) == 1
        assert found[0, 4] == pytest.approx(nearest, abs=1e-9 * unit)


@pytest.mark.parametrize("rounding", [0.0, 0.05])
def test_exchange_and_reflection_of_random_shapes(rounding: float) -> None:
    rng = np.random.default_rng(5)
    twice = 0
    for _ in range(200):
        shapes = [[(hull(rng, int(rng.integers(1, 6))), rounding)] for _ in range(2)]
        poses = [(0.0, 0.0, rng.uniform(-3, 3)), (*rng.uniform(-1.2, 1.2, 2), rng.uniform(-3, 3))]
        world = World([Thing(s, p) for s, p in zip(shapes, poses, strict=True)])
        found, other = rows(world, 0, 1, 0.3), rows(world, 1, 0, 0.3)
        twice += len(found) == 2
        # From b to a: normals turned, rows in the order of the turned tangent; bit for bit.
        flip = np.array((-1.0, -1.0, 1.0, 1.0, 1.0))
        assert (other == flip * found[::-1]).all()
        renumbered = rows(World(world.things[::-1]), 1, 0, 0.3)
        np.testing.assert_allclose(renumbered, found, atol=1e-13)
        mirrored = World([
            Thing([([(-x, y) for x, y in v][::-1], r) for v, r in s], (-p[0], p[1], -p[2]))
            for s, p in zip(shapes, poses, strict=True)
        ])  # fmt: skip
        mirror = np.array((-1.0, 1.0, -1.0, 1.0, 1.0))
        np.testing.assert_allclose(rows(mirrored, 0, 1, 0.3), mirror * found[::-1], atol=1e-13)
        # The nearer row is the gap; its point lies where it says.
        g = gap(world.scene, 0, 1, 0.0)[0]
        assert len(found) == 0 if g > 0.3 else found[:, 4].min() == pytest.approx(g, abs=1e-13)
        if len(found) == 2:
            along = found[:, 3] * found[:, 0] - found[:, 2] * found[:, 1]
            assert along[1] >= along[0] - 1e-14
    assert twice > 40


def test_reference_face_is_steady_under_round_off() -> None:
    # A box on a larger one, shaken by less than the tolerance: the normal stays that of the larger.
    rng = np.random.default_rng(2)
    for _ in range(50):
        shake = 1e-10 * rng.normal(size=3)
        world = World([Thing(box(1.0, 1.0), (shake[0], 1.0 + shake[1], shake[2])), Thing(box(2.0, 1.0))])
        found = rows(world, 0, 1, 1e-3)
        assert len(found) == 2
        assert (found[:, :2] == (0.0, -1.0)).all()


def test_round_shapes_have_one_point() -> None:
    world = World([Thing(disk(0.5)), Thing(box(1.0, 1.0), (0.2, -1.0, 0.0))])
    for found in (rows(world, 0, 1, 0.1), common(world, 0, 1, 1e-6)):
        np.testing.assert_allclose(found, [(0.0, -1.0, 0.0, -0.5, 0.0)], atol=1e-16)


def test_in_overlap_the_corners_inside_make_a_face() -> None:
    world = World(
        [Thing(box(1.0, 1.0), (0.0, 0.98, 0.01))], [([(-9.0, 0.0), (9.0, 0.0), (9.0, 0.5), (-9.0, 0.5)], 0.0)]
    )
    assert len(common(world, 0, 1, 1e-12)) == 2

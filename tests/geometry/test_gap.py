"""Gaps, normals and points of placed shapes against the support functions of their cores."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eeca_pymunk.compiled import table_of
from eeca_pymunk.geometry.flight import pose, rate
from eeca_pymunk.geometry.gap import gap, gap_at, gaps
from tests.packed import Thing, World, box, disk, hull, outline, placed

UNITS = [1e-3, 1.0, 1e3]


def signed_distance(a: np.ndarray, b: np.ndarray) -> float:
    """Of convex cores (k, 2): max over unit n of min_b n . q - max_a n . p. A maximum has the direction of an edge's
    normal or, apart, that between two vertices; every other direction gives less."""
    candidates = [(b[None] - a[:, None]).reshape(-1, 2)]
    for core in (a, b):
        edge = np.roll(core, -1, axis=0) - core
        normal = np.stack((edge[:, 1], -edge[:, 0]), axis=1)
        candidates += [normal, -normal]
    n = np.concatenate(candidates)
    size = np.hypot(n[:, 0], n[:, 1])
    n = n[size > 0.0] / size[size > 0.0, None]
    return float(((n @ b.T).min(axis=1) - (n @ a.T).max(axis=1)).max(initial=-math.inf))


def random_world(rng: np.random.Generator, unit: float, counts: tuple[int, int]) -> World:
    """Two things of that many vertices, near each other, turned, rounded, off their centres of mass."""
    away, angle = rng.uniform(0.0, 2.0), rng.uniform(0.0, 2 * math.pi)
    things = []
    for k, count in enumerate(counts):
        vertices = [(unit * (x + 0.3), unit * (y - 0.2)) for x, y in hull(rng, count)]
        pose = (k * unit * away * math.cos(angle), k * unit * away * math.sin(angle), rng.uniform(-3.0, 3.0))
        things.append(Thing([(vertices, unit * rng.choice([0.0, 0.1]))], pose, (unit * 0.3, -unit * 0.1, 0.2)))
    return World(things)


def cores(world: World) -> tuple[np.ndarray, np.ndarray]:
    a, b = (placed(t.shapes[0][0], t.pose) for t in world.things)
    return a, b


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(
    "counts", [(1, 1), (1, 2), (1, 5), (2, 1), (2, 2), (2, 4), (3, 2), (3, 5), (4, 4), (6, 1), (9, 30), (100, 40)]
)
def test_gap_normal_and_point_of_random_shapes(counts: tuple[int, int], unit: float) -> None:
    rng = np.random.default_rng(7)
    for _ in range(60):
        world = random_world(rng, unit, counts)
        a, b = cores(world)
        r_a, r_b = (t.shapes[0][1] for t in world.things)
        g, nx, ny, px, py = gap(world.scene, 0, 1, 0.0)
        distance, n, point = signed_distance(a, b), np.array((nx, ny)), np.array([(px, py)])
        assert g + r_a + r_b == pytest.approx(distance, abs=1e-14 * unit)
        assert math.hypot(nx, ny) == pytest.approx(1.0, abs=1e-15)
        assert (b @ n).min() - (a @ n).max() == pytest.approx(distance, abs=1e-14 * unit)
        if g > 0.0:
            assert signed_distance(a, point) - r_a == pytest.approx(0.5 * g, abs=1e-13 * unit)
            assert signed_distance(b, point) - r_b == pytest.approx(0.5 * g, abs=1e-13 * unit)
            sampled = np.linalg.norm(outline(a)[:, None] - outline(b), axis=2).min()
            assert distance - 1e-14 * unit <= sampled <= distance + 2e-2 * unit


@pytest.mark.parametrize("counts", [(1, 1), (1, 3), (2, 2), (2, 5), (4, 4)])
def test_exchange_scale_and_reflection(counts: tuple[int, int]) -> None:
    rng = np.random.default_rng(3)
    for _ in range(40):
        world = random_world(rng, 1.0, counts)
        poses = [t.pose for t in world.things]
        g, nx, ny, px, py = gap_at(world.scene, 0, *poses[0], 1, *poses[1])
        # The same pair from b to a, bit for bit.
        assert gap_at(world.scene, 1, *poses[1], 0, *poses[0]) == (g, -nx, -ny, px, py)
        # A unit that is a power of 2 changes no digit.
        larger = World([
            Thing([(8.0 * np.array(v), 8.0 * r) for v, r in t.shapes], (8.0 * t.pose[0], 8.0 * t.pose[1], t.pose[2]))
            for t in world.things
        ])  # fmt: skip
        assert gap(larger.scene, 0, 1, 0.0) == (8.0 * g, nx, ny, 8.0 * px, 8.0 * py)
        # The other order of numbers, and the mirror image (outlines then run the other way round).
        other = World(world.things[::-1])
        np.testing.assert_allclose(gap(other.scene, 1, 0, 0.0), (g, nx, ny, px, py), atol=1e-13)
        mirror = World([
            Thing([([(-x, y) for x, y in v][::-1], r) for v, r in t.shapes], (-t.pose[0], t.pose[1], -t.pose[2]))
            for t in world.things
        ])  # fmt: skip
        np.testing.assert_allclose(gap(mirror.scene, 0, 1, 0.0), (g, -nx, ny, -px, py), atol=1e-13)


def test_centred_disks_do_not_depend_on_their_angles() -> None:
    world = World([Thing(disk(0.5), (0.1, 0.2, 1.234)), Thing(disk(0.25), (3.3, 0.7, -987.6)), Thing(box(1.0, 1.0))])
    d = math.sqrt((3.3 - 0.1) ** 2 + (0.7 - 0.2) ** 2)
    assert gap(world.scene, 0, 1, 0.0)[0] == d - 0.5 - 0.25
    assert gap(world.scene, 1, 2, 0.0)[0] == pytest.approx(math.hypot(2.8, 0.2) - 0.25, abs=1e-15)


def test_shapes_that_touch_exactly_have_the_normal_of_the_face() -> None:
    boxes = World([Thing(box(1.0, 1.0)), Thing(box(1.0, 1.0))], [([(-9.0, 0.5), (9.0, 0.5)], 0.0)])
    for x, y, n in ((1.0, 0.0, (1.0, 0.0)), (1.0, 0.7, (1.0, 0.0)), (0.2, -1.0, (0.0, -1.0)), (0.3, 1.0, (0.0, 1.0))):
        for close in (-1e-14, 0.0, 1e-14):
            x_b, y_b = x + close * n[0], y + close * n[1]
            g, nx, ny, _, _ = gap_at(boxes.scene, 0, 0.0, 0.0, 0.0, 1, x_b, y_b, 0.0)
            assert (nx, ny) == n
            assert g == pytest.approx(close, abs=3e-16)
    # Corner on corner: some face's normal, no direction between points that are the same.
    for close in (0.0, 1e-15, -1e-15):
        g, nx, ny, _, _ = gap_at(boxes.scene, 0, 0.0, 0.0, 0.0, 1, 1.0 + close, 1.0 - 2.0 * close, 0.0)
        assert (nx, ny) in ((1.0, 0.0), (0.0, 1.0))
        assert abs(g) < 1e-14
    # So for a centre at a corner, up to round-off.
    point = World([Thing(disk(0.0)), Thing(box(1.0, 1.0))])
    assert gap_at(point.scene, 0, 0.5 + 2e-16, 0.5 + 4e-16, 0.0, 1, 0.0, 0.0, 0.0)[1:3] in (
        (-1.0, 0.0),
        (0.0, -1.0),
    )
    # A box on a segment, a corner on it, a segment's end on a face.
    assert gap_at(boxes.scene, 0, 0.0, 1.0, 0.0, 2, 0.0, 0.0, 0.0)[:3] == (0.0, 0.0, -1.0)
    g, nx, ny, px, py = gap_at(boxes.scene, 0, 0.0, 0.5 + math.sqrt(0.5), math.pi / 4, 2, 0.0, 0.0, 0.0)
    np.testing.assert_allclose((g, nx, ny, px, py), (0.0, 0.0, -1.0, 0.0, 0.5), atol=2e-16)


def test_segments_in_one_line() -> None:
    rod = [([(-1.0, 0.0), (1.0, 0.0)], 0.25)]
    for angle in (0.0, 0.3, 1e-17):
        c, s = math.cos(angle), math.sin(angle)
        world = World([Thing(rod, (0.0, 0.0, angle)), Thing(rod, (3.0 * c, 3.0 * s, angle))])
        g, nx, ny, px, py = gap(world.scene, 0, 1, 0.0)
        np.testing.assert_allclose((g, nx, ny, px, py), (0.5, c, s, 1.5 * c, 1.5 * s), atol=1e-15)
        world = World([Thing(rod, (0.0, 0.0, angle)), Thing(rod, (1.0 * c, 1.0 * s, angle))])
        g, nx, ny, _, _ = gap(world.scene, 0, 1, 0.0)
        assert g == pytest.approx(-0.5, abs=1e-15)
        assert abs(-s * nx + c * ny) == pytest.approx(1.0)
    crossed = World([Thing(rod), Thing(rod, (0.2, 0.0, math.pi / 2))])
    assert gap(crossed.scene, 0, 1, 0.0)[0] == pytest.approx(-0.8 - 0.5)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_parallel_segments_that_overlap_in_part(side: float) -> None:
    rod = [([(-1.0, 0.0), (1.0, 0.0)], 0.1)]
    for x in (-1.5, 0.0, 1.5):
        world = World([Thing(rod), Thing(rod, (x, 0.5 * side, 0.0))])
        g, nx, ny, _, py = gap(world.scene, 0, 1, 0.0)
        np.testing.assert_allclose((g, nx, ny, py), (0.3, 0.0, side, 0.25 * side), atol=1e-16)


def test_coincident_points_and_depth() -> None:
    world = World([Thing(disk(0.5)), Thing(disk(0.25)), Thing(box(2.0, 2.0), (1.7, 0.4, 0.0)), Thing(box(2.0, 2.0))])
    assert gap(world.scene, 0, 1, 0.0) == (-0.75, 1.0, 0.0, 0.125, 0.0)
    # The shortest way out.
    g, nx, ny, _, _ = gap(world.scene, 3, 2, 0.0)
    assert (g, nx, ny) == (pytest.approx(-0.3), 1.0, 0.0)
    assert gap(world.scene, 0, 2, 0.0)[:3] == (pytest.approx(0.2), 1.0, 0.0)


def test_many_pairs_at_once() -> None:
    rng = np.random.default_rng(1)
    world = World(
        [Thing(disk(0.3)), Thing([(hull(rng, 5), 0.1)]), Thing(box(1.0, 0.5))], [([(0.0, 0.0), (4.0, 0.0)], 0.0)]
    )
    poses = np.concatenate((rng.normal(size=(3, 3)), np.zeros((1, 3))))
    a, b = np.array([0, 0, 1, 2, 1]), np.array([1, 3, 2, 0, 3])
    out = np.zeros((5, 5))
    gaps(table_of(world.scene), np.stack((a, b), axis=1), poses[a], poses[b], out)
    for k in range(5):
        assert tuple(out[k]) == gap_at(world.scene, a[k], *poses[a[k]], b[k], *poses[b[k]])


def test_path_of_a_body_is_its_parabola() -> None:
    world = World([Thing(disk(1.0), (0.1, 0.2, 0.3), (0.7, -0.9, 1.1), (0.0, -9.81, 0.13), since=0.37)])
    assert pose(world.body, 0, 0.37) == (0.1, 0.2, 0.3)
    assert rate(world.body, 0, 0.37) == (0.7, -0.9, 1.1)
    s = 0.5
    expected = (0.1 + 0.7 * s, 0.2 - 0.9 * s - 0.5 * 9.81 * s * s, 0.3 + 1.1 * s + 0.5 * 0.13 * s * s)
    np.testing.assert_allclose(pose(world.body, 0, 0.37 + s), expected, rtol=1e-15)
    np.testing.assert_allclose(rate(world.body, 0, 0.37 + s), (0.7, -0.9 - 9.81 * s, 1.1 + 0.13 * s), rtol=1e-15)

"""The cell list against brute force, and against pymunk's detection."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymunk
import pytest
from numpy.typing import NDArray

from eeca_pymunk._rounds.cells import CellList, Cells
from eeca_pymunk.space.bodies import Bodies
from eeca_pymunk.space.grown import GrownSpace
from eeca_pymunk.space.shapes import Shapes
from eeca_pymunk.space.twin import MarginTwin
from scenes.scene import add_disk, add_walls

Sizes = Callable[[np.random.Generator, int], NDArray[np.float64]]
SIZES: dict[str, Sizes] = {
    "equal": lambda rng, n: np.full(n, 0.02),
    "spread": lambda rng, n: rng.uniform(0.001, 0.05, n),
    "two kinds": lambda rng, n: rng.choice([0.01, 0.2], n, p=[0.97, 0.03]),
    "one absurd": lambda rng, n: np.where(np.arange(n) == 7, 1e200, 0.01),
    "half absurd": lambda rng, n: np.where(np.arange(n) < n // 2, 50.0, 0.01),
}


def brute(center: NDArray[np.float64], size: NDArray[np.float64]) -> set[tuple[int, int]]:
    d = center[:, None] - center
    near = np.hypot(d[..., 0], d[..., 1]) <= size[:, None] + size
    return {(int(i), int(j)) for i, j in np.argwhere(np.triu(near, 1))}


def found(first: NDArray[np.intp], second: NDArray[np.intp]) -> set[tuple[int, int]]:
    result = {(min(i, j), max(i, j)) for i, j in zip(first.tolist(), second.tolist(), strict=True)}
    assert len(result) == len(first)  # every pair once
    return result


@pytest.mark.parametrize("kind", SIZES)
@pytest.mark.parametrize("place", ["box", "line", "one flew away", "all at one point"])
def test_cells_find_every_pair_once(kind: str, place: str) -> None:
    rng = np.random.default_rng(3)
    center = rng.uniform(-1.0, 2.0, (400, 2))
    if place == "line":
        center[:, 1] = 0.0
    elif place == "one flew away":
        center[11] = (1e9, -1e12)
    elif place == "all at one point":
        center[:] = 0.5
    size = SIZES[kind](rng, len(center))
    cells = Cells(center, size)
    assert found(*cells.pairs()) == brute(center, size)
    # Some grow afterwards.
    which = np.array([3, 100, 7, 399])
    size[which] = 4.0 * size[which] + 0.1
    cells.grow(which, size[which])
    expected = {(i, j) for i, j in brute(center, size) if i in which or j in which}
    assert found(*cells.pairs_of(which)) == expected


def crowd(disks: int) -> tuple[Bodies, NDArray[np.float64], Shapes]:
    """Disks of two sizes and three filters, some with two shapes, between walls; one wall is slanted, one a box."""
    rng = np.random.default_rng(5)
    space = pymunk.Space()
    filters = [pymunk.ShapeFilter(), pymunk.ShapeFilter(group=1), pymunk.ShapeFilter(categories=2, mask=5)]
    for i in range(disks):
        body = add_disk(space, tuple(rng.uniform(0.0, 1.0, 2)), rng.choice([0.01, 0.03]))
        body.velocity = tuple(rng.normal(size=2))
        next(iter(body.shapes)).filter = filters[i % 3]
        if i % 50 == 0:
            space.add(pymunk.Circle(body, 0.02))
    add_walls(space, [((0.0, 0.0), (1.0, 0.2)), ((0.0, 1.0), (1.0, 1.0))])
    space.add(pymunk.Poly(space.static_body, [(0.4, 0.4), (0.6, 0.4), (0.5, 0.6)]))
    bodies = Bodies(space)
    state = bodies.gather()
    assert state is not None
    return bodies, state, Shapes(space, bodies)


def test_cells_and_pymunk_find_the_same() -> None:
    _bodies, state, shapes = crowd(300)
    moving = np.flatnonzero(shapes.wall < 0)
    center = state[shapes.row[moving], :2]
    backends: list[CellList | GrownSpace] = [
        CellList(shapes, moving),
        GrownSpace(shapes, moving, np.zeros((len(shapes), 2)), center, 0.0),
    ]
    keys = []
    for backend in backends:
        backend.grow(np.arange(len(moving)), np.linspace(0.0, 0.02, len(moving)))
        backend.grow_walls(0.01)
        keys.append(backend.find(center).key)
    assert len(keys[0]) > 300
    np.testing.assert_array_equal(keys[0], keys[1])


def test_a_longer_list_is_the_list_found_anew() -> None:
    bodies, state, shapes = crowd(300)
    still = np.zeros((len(bodies), 2))
    twins = [MarginTwin(bodies, shapes, state) for _ in range(2)]
    for twin in twins:
        before = twin.candidates(state[:, :2], still, np.zeros(len(bodies)))
    rows, way = np.array([4, 9]), np.full((2, 2), 0.1)
    assert not twins[0].covers(rows, way, np.zeros(2))
    longer = twins[0].widen(state[:, :2])
    place = before.places_in(longer)
    assert len(longer) > len(before)
    assert (place >= 0).all()
    np.testing.assert_array_equal(longer.key[place], before.key)
    # The second twin grows the same disks and looks at all of them.
    assert not twins[1].covers(rows, way, np.zeros(2))
    twins[1]._space.grow(np.arange(len(twins[0]._margin)), twins[0]._margin)
    np.testing.assert_array_equal(twins[1]._space.find(state[:, :2].take(twins[1]._row, axis=0)).key, longer.key)

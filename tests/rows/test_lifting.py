"""The penetration correction along normals: what has room comes apart, what has none goes into no wall."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Problem, Row
from eeca_pymunk.rows.build import normal_rate, place_row
from eeca_pymunk.rows.lifting import keep_walls, lift

from .block import Block


def row_of_disks(count: int, width: float, unit: float) -> tuple[Problem, NDArray[np.float64]]:
    """Disks of radius 1, side by side between two walls at x = 0 and `width`, and their gaps; in lengths of `unit`."""
    x = np.linspace(0.6, width - 0.6, count) * unit
    none = np.zeros((count, 2))
    at = np.column_stack((x, np.zeros(count)))
    block = Block.disks(at, none, np.linspace(1.0, 3.0, count), np.full(count, unit), touch=1.0)
    among, block.contacts = [c for c in block.contacts if c[1] == c[0] + 1], []
    block.wall(0, (-1.0, 0.0), unit)
    block.wall(count - 1, (1.0, 0.0), unit)
    block.contacts += among  # walls come first in a sweep: what is pushed later may go into them
    m = len(block.contacts)
    ROWS = rows(Row, m)
    for i, (a, b, nx, ny, px, py) in enumerate(block.contacts):
        ROWS[i].a, ROWS[i].b, ROWS[i].nx, ROWS[i].ny = a, b, nx, ny
        place_row(ROWS[i], px, py, block.pose, block.im, block.ii)
    gaps = np.append((x[0] - unit, width * unit - x[-1] - unit), np.diff(x) - 2.0 * unit)
    return Problem(ROWS, block.im, block.ii, block.pose, count, m), gaps


def after(problem: Problem, gaps: NDArray[np.float64], D: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaps after displacements D."""
    return np.array([g + normal_rate(problem.ROWS[i], D) for i, g in enumerate(gaps)])


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_disks_that_have_room_come_apart(unit: float) -> None:
    problem, gaps = row_of_disks(5, 11.0, unit)
    D, mu = np.zeros((6, 3)), np.zeros(problem.m)
    assert lift(problem, gaps, mu, D, 1e-13 * unit, 2000) <= 1e-13 * unit
    left = after(problem, gaps, D)
    assert left.min() >= -1e-11 * unit
    assert np.abs(mu * left).max() <= 1e-11 * mu.max() * unit
    assert mu.min() >= 0.0


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("sweeps", [1, 20, 200])
def test_disks_without_room_go_no_deeper_into_walls(sweeps: int, unit: float) -> None:
    problem, gaps = row_of_disks(5, 6.0, unit)
    D, mu = np.zeros((6, 3)), np.zeros(problem.m)
    assert lift(problem, gaps, mu, D, 1e-13 * unit, sweeps) > 1e-13 * unit
    keep_walls(problem, problem.n, gaps, np.minimum(gaps, 0.0), mu, D)
    left, walls = after(problem, gaps, D), problem.ROWS["b"] == 5
    assert (left[walls] >= np.minimum(gaps[walls], 0.0) - 1e-12 * unit).all()


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("turn", [-0.1, 0.0, 0.1])
def test_no_end_of_a_face_goes_deeper_into_a_wall(turn: float, unit: float) -> None:
    block = Block(np.array([[0.0, 0.5 * unit, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3)), np.ones(2), np.ones(2))
    block.im[1] = block.ii[1] = 0.0
    block.ii[0] = 1.0 / (0.4 * unit * unit)
    ROWS = rows(Row, 2)
    for i, x in enumerate((-unit, unit)):
        ROWS[i].a, ROWS[i].b = 0, 1
        ROWS[i].nx, ROWS[i].ny = 0.0, -1.0
        place_row(ROWS[i], x, 0.0, block.pose, block.im, block.ii)
    problem, gaps = Problem(ROWS, block.im, block.ii, block.pose, 1, 2), np.array([-0.1 * unit, -0.2 * unit])
    D = np.array([[0.0, -0.1 * unit, turn], [0.0, 0.0, 0.0]])  # what other bodies have displaced it by
    keep_walls(problem, problem.n, gaps, gaps, np.zeros(2), D)
    assert (after(problem, gaps, D) >= gaps - 1e-5 * unit).all()

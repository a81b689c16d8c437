"""One contact problem over two operators: columns of free bodies answer as their inverse masses do."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Columns, JointedProblem, Problem, Solved
from eeca_pymunk.rows.blocks import solve_block
from eeca_pymunk.rows.bounded import room_for_rows
from eeca_pymunk.rows.dense import matrix
from eeca_pymunk.rows.lifting import lift
from eeca_pymunk.rows.sweeps import push, sweep

from .block import Block


def pyramid(seed: int, e: float, mu: float) -> Block:
    """Disks on the floor, some on others, that fall and spin."""
    rng = np.random.default_rng(seed)
    place = np.array([[0.0, 0.5], [1.0, 0.5], [2.0, 0.5], [0.5, 0.5 + 0.75**0.5], [1.5, 0.5 + 0.75**0.5]])
    velocity = np.column_stack((0.3 * rng.normal(size=(5, 2)) - [0.0, 1.0], rng.normal(size=5)))
    block = Block.disks(place, velocity, rng.uniform(0.5, 2.0, 5), np.full(5, 0.5))
    for i in range(3):
        block.wall(i, (0.0, -1.0), 0.5)
    block.solve(e, mu)
    return block


def problems(block: Block) -> tuple[Problem, JointedProblem]:
    """The problem of a block over inverse masses, and over columns that say the same."""
    m, n = len(block.rows), len(block.pose) - 1
    free = Problem(block.rows.copy(), block.im, block.ii, block.pose, n, m)
    entries = [(i, q) for i in range(m) for q in (block.rows[i].a, block.rows[i].b) if block.im[q] > 0.0]
    at = np.searchsorted([i for i, _ in entries], np.arange(m + 1)).astype(np.int64)
    columns = Columns(
        at, np.array([q for _, q in entries], np.int64), np.zeros((len(entries), 3)), np.zeros((len(entries), 3)),
        np.zeros(m, np.int64), np.zeros(1),
    )  # fmt: skip
    for w, (i, q) in enumerate(entries):
        for tangent, table in enumerate((columns.N, columns.T)):
            L, V = np.zeros((m, 2)), np.zeros_like(block.pose)
            L[i, tangent] = 1.0
            push(free, L, 1.0, V)
            table[w] = V[q]
    return free, JointedProblem(block.rows.copy(), columns, room_for_rows(0, 0), m)


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_impacts_are_those_of_free_bodies(e: float, mu: float) -> None:
    for seed in range(3):
        block, found = pyramid(seed, e, mu), []
        for problem in problems(block):
            m, V = problem.m, block.velocity.copy()
            solve_block(problem, np.zeros((m, 2)), V, 0.0, False, rows(Solved, 1))
            found.append(V)
        assert np.abs(found[1] - found[0]).max() <= 1e-9


def test_sweeps_and_matrices_are_those_of_free_bodies() -> None:
    block = pyramid(5, 0.3, 0.4)
    m, found = len(block.rows), []
    for problem in problems(block):
        L, V = np.zeros((m, 2)), block.velocity.copy()
        changes = [sweep(problem, L, V) for _ in range(5)]
        at, kind, W = np.repeat(np.arange(m), 2), np.tile([0, 1], m), np.zeros((2 * m, 2 * m))
        matrix(problem, np.zeros(m), at, kind, 2 * m, W)
        found.append((L, V, np.array(changes), W))
    for one, other in zip(*found, strict=True):
        assert np.abs(one - other).max() <= 1e-7 * np.abs(one).max()


def test_the_matrix_keeps_its_digits_on_fast_surfaces() -> None:
    """Velocities of surfaces are no part of it, not even as terms that cancel."""
    block, found = pyramid(5, 0.3, 0.4), []
    m = len(block.rows)
    for surface in (0.0, 1e9):
        for problem in problems(block):
            problem.ROWS["surface"] = surface
            at, kind, W = np.repeat(np.arange(m), 2), np.tile([0, 1], m), np.zeros((2 * m, 2 * m))
            matrix(problem, np.zeros(m), at, kind, 2 * m, W)
            found.append(W)
    assert (found[2] == found[0]).all()
    assert (found[3] == found[1]).all()


@pytest.mark.parametrize("beta", [0.0, -1.0, 1.0])
def test_an_inactive_contact_stays_so_whatever_its_own_impulses_are(beta: float) -> None:
    """It becomes active where the others let it close faster than `wake`; arms turn its own impulse along the tangent
    into a velocity along the normal, too."""
    block = Block(
        np.zeros((2, 3)), np.array([[0.0, -0.9, 0.0], [0.0, 0.0, 0.0]]), np.array([1.0, 0.0]), np.array([2.0, 0.0]),
        [(0, 1, 0.0, -1.0, -0.5, -0.5)],
    )  # fmt: skip
    block.solve(0.0, 1.0)
    for problem in problems(block):
        problem.ROWS[0].activation = -1.0
        assert problem.ROWS[0].a_nt != 0.0
        L, V = np.array([[1.0, beta]]), block.velocity.copy()
        push(problem, L, 1.0, V)
        sweep(problem, L, V)
        assert problem.ROWS[0].activation == -1.0
        assert (L == 0.0).all()
        assert pytest.approx(block.velocity, abs=1e-15) == V


def test_bodies_are_lifted_as_free_ones() -> None:
    block = pyramid(1, 0.0, 0.0)
    m, found = len(block.rows), []
    gaps = -0.01 * np.random.default_rng(2).uniform(size=m)
    for problem in problems(block):
        D, mu = np.zeros_like(block.pose), np.zeros(m)
        assert lift(problem, gaps, mu, D, 1e-15, 2000) <= 1e-15
        found.append(D)
        assert (mu >= 0.0).all()
    assert np.abs(found[1] - found[0]).max() <= 1e-13

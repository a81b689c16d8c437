"""The complementarity solver against enumeration of all active sets, and its parts against each other."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from eeca_pymunk.energy.complementarity import pivot, project, solve
from eeca_pymunk.energy.delassus import Delassus


def random_contacts(seed: int, bodies: int = 6, contacts: int = 7) -> tuple[Delassus, np.ndarray]:
    rng = np.random.default_rng(seed)
    pairs = rng.permutation(np.array([(i, j) for i in range(bodies) for j in range(i)]))[:contacts]
    angle = rng.uniform(0, 2 * np.pi, contacts)
    normal = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    inverse_mass = rng.uniform(0.1, 2.0, bodies)
    inverse_mass[0] = 0.0
    return Delassus(pairs[:, 0], pairs[:, 1], normal, inverse_mass), rng.normal(size=contacts)


def enumerate_solution(A: np.ndarray, q: np.ndarray) -> np.ndarray:
    for closed in product((False, True), repeat=len(q)):
        k = np.flatnonzero(closed)
        lam = np.zeros(len(q))
        lam[k] = np.linalg.solve(A[np.ix_(k, k)], -q[k])
        if (lam >= -1e-12).all() and (A @ lam + q >= -1e-12).all():
            return lam
    raise AssertionError("no solution")


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("compliance", [0.0, 0.3])
def test_agrees_with_enumeration(seed: int, compliance: float) -> None:
    A, q = random_contacts(seed)
    dense = A.dense() + compliance * np.eye(A.size)
    if np.linalg.cond(dense) > 1e8:
        pytest.skip("redundant contacts: impulses are not unique")
    exact = enumerate_solution(dense, q)
    found = solve(A, q, compliance)
    assert found.converged
    np.testing.assert_allclose(found.lam, exact, atol=1e-9)
    gradients = project(dense.dot, A.row_bound() + compliance, q, np.zeros(A.size), 1e-11, 20_000)
    assert gradients.converged
    np.testing.assert_allclose(dense @ gradients.lam, dense @ exact, atol=1e-9)


def test_operator_matches_its_matrix() -> None:
    A, q = random_contacts(1)
    np.testing.assert_allclose(A @ q, A.dense() @ q, atol=1e-14)
    np.testing.assert_allclose(A.diagonal(), A.dense().diagonal(), atol=1e-14)
    v = np.random.default_rng(0).normal(size=(len(A.inverse_mass), 2))
    assert np.dot(A.relative(v), q) == pytest.approx(np.sum(A.impulse(q) * v), abs=1e-13)
    assert (np.linalg.eigvalsh(np.diag(A.row_bound()) - A.dense()) > -1e-12).all()
    part = A.take(np.array([1, 4]))
    np.testing.assert_allclose(part.dense(), A.dense()[np.ix_([1, 4], [1, 4])], atol=1e-14)


def test_redundant_contacts_reach_the_unique_velocities() -> None:
    # One disk pressed on two coincident walls: impulses may be shared in any way, their sum is 2.
    A = Delassus(np.array([0, 0]), np.array([1, 2]), np.array([[0.0, -1.0]] * 2), np.array([1.0, 0.0, 0.0]))
    q = np.array([-2.0, -2.0])
    assert pivot(A.dense(), q) is None
    found = solve(A, q)
    assert found.converged
    assert found.lam.sum() == pytest.approx(2.0, abs=1e-11)


def test_long_chain_converges() -> None:
    # 400 touching disks in a line hit from the left: too many for pivoting.
    n = 400
    A = Delassus(np.arange(n - 1), np.arange(1, n), np.tile((1.0, 0.0), (n - 1, 1)), np.ones(n))
    q = np.zeros(n - 1)
    q[0] = -2.0
    found = solve(A, q, tolerance=1e-9, max_iterations=50_000)
    assert found.converged
    velocity = A.impulse(found.lam)[:, 0]
    # Simultaneous law: the hit disk meets the mass of all others at once.
    expected = np.full(n, 2 / n)
    expected[0] = -2 * (n - 1) / n
    np.testing.assert_allclose(velocity, expected, atol=1e-5)


def test_coupled_contacts_that_open_need_nothing_beside_a_lone_one_that_closes() -> None:
    row_a, row_b = np.array([0, 1, 3]), np.array([1, 2, 4])
    A = Delassus(row_a, row_b, np.tile((1.0, 0.0), (3, 1)), np.ones(5))
    found = solve(A, np.array([1.0, 0.5, -2.0]))
    np.testing.assert_array_equal(found.lam, (0.0, 0.0, 1.0))

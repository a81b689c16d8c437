"""Contact laws by pivots: against solutions by all modes of contact, and scenes whose sweeps go round in circles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eeca_pymunk.jointed.pivoting import lemke


@pytest.mark.parametrize("seed", range(20))
def test_pivots_solve_complementarity(seed: int) -> None:
    """0 <= z _|_ M z + q >= 0 of a positive semidefinite matrix, of half its rank, whose range q is in."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 12))
    J = rng.normal(size=(n, max(n // 2, 1)))
    M, q, z = J @ J.T + 1e-10 * np.eye(n), J @ rng.normal(size=J.shape[1]), np.empty(n)
    if lemke(M, q, n, z):
        w = M @ z + q
        assert z.min() >= 0.0
        assert w.min() >= -1e-7 * np.abs(q).max()
        assert abs(z @ w) <= 1e-7 * max(1.0, float(z.max())) * np.abs(q).max() * n
    else:  # no solution: some y >= 0 has M y = 0 and y.q < 0, which a small term of the matrix hides from nobody
        assert not lemke(M + 1e-6 * np.eye(n), q, n, z) or z.max() > 1e3


@pytest.mark.parametrize("mu", [0.3, 1.0, 2.25])
@pytest.mark.parametrize("seed", range(10))
def test_pivots_solve_coulombs_law(mu: float, seed: int) -> None:
    """Of two contacts that answer along their tangents: lam, beta+, beta- and gamma of each."""
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(4, 4))
    A, u = J @ J.T, rng.normal(size=4)  # rows n, t of one, then of the other
    M, q = np.zeros((8, 8)), np.zeros(8)
    for i in range(2):
        n, t = 2 * i, 2 * i + 1
        q[4 * i : 4 * i + 3] = u[n], u[t], -u[t]
        for j in range(2):
            m, s = 2 * j, 2 * j + 1
            M[4 * i, 4 * j : 4 * j + 3] = A[n, m], A[n, s], -A[n, s]
            M[4 * i + 1, 4 * j : 4 * j + 3] = A[t, m], A[t, s], -A[t, s]
            M[4 * i + 2, 4 * j : 4 * j + 3] = -A[t, m], -A[t, s], A[t, s]
        M[4 * i + 1, 4 * i + 3] = M[4 * i + 2, 4 * i + 3] = 1.0
        M[4 * i + 3, 4 * i : 4 * i + 3] = mu, -1.0, -1.0
    z = np.empty(8)
    assert lemke(M, q, 8, z)
    impulse = np.array([z[0], z[1] - z[2], z[4], z[5] - z[6]])
    after = A @ impulse + u
    for i in range(2):
        lam, beta, un, ut = impulse[2 * i], impulse[2 * i + 1], after[2 * i], after[2 * i + 1]
        assert lam >= 0.0
        assert un >= -1e-9
        assert lam * un == pytest.approx(0.0, abs=1e-9)
        assert abs(beta) <= mu * lam + 1e-9
        assert abs(ut) <= 1e-9 or beta == pytest.approx(-math.copysign(mu * lam, ut), abs=1e-9)

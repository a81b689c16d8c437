"""Two impulses in a disc: what iterations with an approximate answer end at obeys the law."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.rows.bounded import on_disc, on_half_disc


@pytest.mark.parametrize("bound", [0.003, 0.0181, 0.2])
def test_answers_that_are_not_symmetric_leave_impulses_against_the_velocity(bound: float) -> None:
    # W of a joint that others let give way in one direction only: its symmetric part has a negative eigenvalue
    # (random scene 26000352, whose joints opened by this error).
    W, free = np.array([[0.0256, 0.0322], [0.0395, 0.0497]]), np.array([-0.803, -0.106])
    assert np.linalg.eigvalsh(0.5 * (W + W.T))[0] < 0.0
    p = np.zeros(2)
    for _ in range(60):
        u, cross = free + W @ p, 0.5 * (W[0, 1] + W[1, 0])
        p = np.array(on_disc(W[0, 0], cross, W[1, 1], u[0], u[1], p[0], p[1], bound))
    u = free + W @ p
    assert np.hypot(*p) == pytest.approx(bound, rel=1e-14)
    assert abs(u[0] * p[1] - u[1] * p[0]) < 1e-15 * np.hypot(*u) * bound * 10.0
    assert u @ p < 0.0


def test_inside_the_disc_impulses_stop_the_velocity() -> None:
    W, free = np.array([[2.0, 0.3], [0.3, 1.0]]), np.array([0.7, -0.2])
    p = np.array(on_disc(W[0, 0], W[0, 1], W[1, 1], free[0], free[1], 0.0, 0.0, 1.0))
    assert np.abs(free + W @ p).max() < 1e-15


@pytest.mark.parametrize("half", [(0.0, 0.5), (-0.5, 0.0), (-0.5, 0.5)])
@pytest.mark.parametrize("seed", range(20))
def test_impulses_on_half_a_disc_obey_the_law(seed: int, half: tuple[float, float]) -> None:
    """u (q - p) >= 0 for all impulses q that are allowed: none of them takes more energy than p."""
    rng = np.random.default_rng(seed)
    root, free, start = rng.standard_normal((2, 2)), rng.standard_normal(2), 0.1 * rng.standard_normal(2)
    W = root @ root.T + 0.1 * np.eye(2)
    u = free + W @ start
    p = np.array(on_half_disc(W[0, 0], W[0, 1], W[1, 1], u[0], u[1], start[0], start[1], 0.5, half))
    turns = np.linspace(0.0, 2.0 * np.pi, 1000)
    allowed = 0.5 * np.column_stack((np.cos(turns), np.clip(np.sin(turns), 2.0 * half[0], 2.0 * half[1])))
    assert np.hypot(*p) <= 0.5 * (1.0 + 1e-14)
    assert half[0] <= p[1] <= half[1] or half == (-0.5, 0.5)
    assert ((allowed - p) @ (free + W @ p)).min() >= -1e-13

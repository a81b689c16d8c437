"""The event-driven reference itself: an analytic case, energy, reversibility."""

from __future__ import annotations

import numpy as np
import pytest

from comparisons.exact import Gas
from scenes.ball import bounce


def gas(seed: int, count: int = 12) -> Gas:
    rng = np.random.default_rng(seed)
    cells = np.stack((np.arange(count) % 4, np.arange(count) // 4), axis=1)
    x = 0.125 + 0.25 * cells + rng.uniform(-0.05, 0.05, (count, 2))
    return Gas(x, rng.normal(size=(count, 2)), rng.uniform(0.03, 0.06, count), rng.uniform(0.5, 2.0, count))


def test_two_bodies_head_on_then_walls() -> None:
    # Masses 1 and 3 close at 2 m/s over a gap of .4 m: they meet at .2 s with a at .45 m and leave with (-2, 0) m/s;
    # a turns at its wall .2125 s later.
    x, v = np.array([[0.25, 0.5], [0.7, 0.5]]), np.array([[1.0, 0.0], [-1.0, 0.0]])
    two = Gas(x, v, np.full(2, 0.025), np.array([1.0, 3.0]))
    two.run(0.5)
    assert two.events == 2
    np.testing.assert_allclose(two.velocity, [[2.0, 0.0], [0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(two.position, [[0.025 + 2.0 * 0.0875, 0.5], [0.5, 0.5]], atol=1e-15)


def test_oblique_hit_reflects_along_the_centre_line() -> None:
    # Equal disks, offset of centres half their distance at contact: n = (sqrt(3)/2, 1/2), u = -sqrt(3)/2.
    r = 0.05
    two = Gas(np.array([[0.3, 0.5], [0.6, 0.55]]), np.array([[1.0, 0.0], [0.0, 0.0]]), np.full(2, r), np.ones(2))
    two.run(0.3)
    n = np.array([np.sqrt(3.0) / 2.0, 0.5])
    np.testing.assert_allclose(two.velocity[1], n[0] * n, atol=1e-14)
    np.testing.assert_allclose(two.velocity[0], np.array([1.0, 0.0]) - n[0] * n, atol=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_energy_and_reversibility(seed: int) -> None:
    g = gas(seed)
    x, v = g.position.copy(), g.velocity.copy()
    energy = float(np.sum(g.mass[:, None] * v**2))
    g.run(0.5)
    assert g.events > 10
    assert float(np.sum(g.mass[:, None] * g.velocity**2)) == pytest.approx(energy, rel=1e-13)
    g.velocity *= -1.0
    g.run(0.5)
    np.testing.assert_allclose(g.position, x, atol=1e-8)
    np.testing.assert_allclose(g.velocity, -v, atol=1e-7)


def test_ball_bounces_with_its_period() -> None:
    at_floor = np.sqrt(2.0 * 9.81 * 2.0)
    for n in range(3):
        t = (at_floor + n * 2.0 * at_floor) / 9.81
        assert bounce(2.0, 0.0, 9.81, t) == pytest.approx(0.0, abs=1e-9)
        assert bounce(2.0, 0.0, 9.81, t + at_floor / 9.81) == pytest.approx(2.0, rel=1e-12)

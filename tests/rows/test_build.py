"""A contact row from a point and a normal: rates are those of points of rigid bodies, masses those of pushes."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled import records
from eeca_pymunk.model.contacts import Row
from eeca_pymunk.rows.build import normal_rate, place_row, tangent_rate


def cross(x: np.ndarray, y: np.ndarray) -> float:
    return float(x[0] * y[1] - x[1] * y[0])


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(5))
def test_rates_and_masses_are_those_of_points_of_rigid_bodies(seed: int, unit: float) -> None:
    rng = np.random.default_rng(seed)
    pose, v = rng.normal(size=(2, 3)), rng.normal(size=(2, 3))
    pose[:, :2] *= unit
    v[:, :2] *= unit
    im, ii = rng.uniform(0.1, 2.0, 2), rng.uniform(0.1, 2.0, 2) / unit**2
    angle, surface = rng.uniform(0.0, 6.0), unit * rng.normal()
    n, t = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    point = unit * rng.normal(size=2)
    rows = records.rows(Row, 1)
    row = rows[0]
    row.a, row.b, row.nx, row.ny, row.elasticity, row.friction, row.surface = 0, 1, *n, 0.5, 0.3, surface
    place_row(row, *point, pose, im, ii)

    arm = point - pose[:, :2]
    speed = v[:, :2] + v[:, 2:] * np.stack((-arm[:, 1], arm[:, 0]), axis=1)
    apart = speed[1] - speed[0]
    assert normal_rate(rows[0], v) == pytest.approx(n @ apart, rel=1e-12, abs=1e-13 * unit)
    assert tangent_rate(rows[0], v) == pytest.approx(t @ apart + surface, rel=1e-12, abs=1e-13 * unit)
    for direction, column in ((n, "k_n"), (t, "k_t")):
        given = sum(im[i] + ii[i] * cross(arm[i], direction) ** 2 for i in range(2))
        assert rows[column][0] == pytest.approx(1.0 / given, rel=1e-12)

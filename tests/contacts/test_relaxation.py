"""Islands of few contacts are solved to round-off, whatever their masses: a light body wedged between heavy ones, whose
sweeps hardly move the heavy one, and whose direct solutions do not find the active contacts."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.contacts.relaxation import relax
from eeca_pymunk.model.bodies import Rest
from eeca_pymunk.model.contacts import Problem, Row, Solved
from eeca_pymunk.model.parameters.joints import HOMOTOPY_WORK, MATRIX_WORK
from eeca_pymunk.rows.build import normal_rate, place_row, rates
from eeca_pymunk.rows.sweeps import velocities

SOLVED = 1e-11  # of the speed: round-off of impulses on masses 1 : 10 000
MU = 0.9


def wedged(seed: int, unit: float) -> tuple[Problem, np.ndarray]:
    """A body of mass 1 with a face on the ground, and with a face of a body of mass 10 000 above it, which moves down
    on it; and velocities (3, 3) before, the ground's last."""
    rng = np.random.default_rng(seed)
    pose = np.array([[0.0, 0.3, 0.0], [0.0, 1.2, 0.0], [0.0, -1.0, 0.0]]) * (unit, unit, 1.0)
    inverse, moments = np.array([1.0, 1e-4, 0.0]), np.array([6.0, 6e-4, 0.0]) / unit**2
    tilt = rng.uniform(-0.5, 0.5)
    ROWS = rows(Row, 4)
    ends = np.sort(rng.uniform(-0.5, 0.5, (2, 2)), axis=1)
    for i in range(4):
        turn, x = (np.pi, ends[0, i]) if i < 2 else (tilt, ends[1, i - 2])
        row = ROWS[i]
        row.a, row.b, row.nx, row.ny = 0, 2 if i < 2 else 1, np.sin(turn), np.cos(turn)
        row.friction, row.activation = MU, np.inf
        point = (x * unit, 0.0) if i < 2 else (x * np.cos(tilt) * unit, (0.6 - x * np.sin(tilt)) * unit)
        place_row(row, *point, pose, inverse, moments)
    V = rng.normal(size=(3, 3)) * (unit, unit, 1.0)
    V[1, 1], V[2] = -3.0 * unit, 0.0
    problem = Problem(ROWS, inverse, moments, pose, 2, 4)
    rates(ROWS, V, 4)
    return problem, V


def off(problem: Problem, L: np.ndarray, V: np.ndarray) -> float:
    """By how much contacts close, pull, or exceed the limit of friction: a velocity."""
    ROWS, m = problem.ROWS, problem.m
    worst = 0.0
    for i in range(m):
        (lam, beta), a_nn = L[i], ROWS[i].a_nn
        un = normal_rate(ROWS[i], V) - ROWS[i].target
        worst = max(worst, -un, -lam * a_nn, (abs(beta) - MU * lam) * a_nn, abs(un) if lam > 0.0 else 0.0)
    return float(worst)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_light_body_wedged_between_heavy_ones_is_solved(unit: float) -> None:
    homotopies = 0
    for seed in range(40):
        problem, V = wedged(seed, unit)
        free, L, rest = V.copy(), np.zeros((4, 2)), rows(Rest, 1)
        rest[0].augmentation = 8.0
        out = rows(Solved, 1)[0]
        relax(problem, L, V, free, 20, SOLVED * unit, 0.0, rest[0], 40, out)
        assert out.operations == 0.0 or out.operations >= HOMOTOPY_WORK + MATRIX_WORK * (2 * problem.m) ** 2
        homotopies += out.operations > 0.0
        after = np.empty_like(V)
        velocities(problem, L, free, after)
        assert off(problem, L, after) <= 10.0 * SOLVED * unit, seed
    assert homotopies > 0

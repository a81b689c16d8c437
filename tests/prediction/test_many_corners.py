"""Polygons of many corners: bounds of their gaps are those by all pairs of vertices, and time goes on."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eeca_pymunk as ep
from comparisons.program_scenes import PROGRAMS
from eeca_pymunk.prediction import axes
from eeca_pymunk.prediction.axes import Closing, MotionState, fixed_axis
from tests.packed import hull


def core(rng: np.random.Generator, count: int, x: float, y: float) -> np.ndarray:
    """Vertices of a polygon and the outward normals of its edges."""
    vertices = np.add(hull(rng, count), (x, y))
    edges = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack((edges[:, 1], -edges[:, 0]), axis=1) / np.hypot(*edges.T)[:, None]
    return np.hstack((vertices, normals))


@pytest.mark.parametrize("seed", range(10))
def test_vertices_that_are_left_out_decide_nothing(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(10):
        p, q = rng.integers(9, 60, 2)
        way, apart = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.5, 3.0)
        x, y = apart * math.cos(way), apart * math.sin(way)
        speeds = [rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, 2.0) for _ in range(2)]
        one, two = MotionState(0.0, 0.0, 0.0, *speeds[0]), MotionState(x, y, 0.0, *speeds[1])
        bend = rng.choice((0.0, 1.0)) * 10.0 ** rng.uniform(-3.0, 3.0)
        of = Closing(rng.choice((0.0, 0.1)), bend, 1e-12, 1e-6, 1e-12)
        axis = way + 0.2 * rng.normal()
        arguments = core(rng, p, 0.0, 0.0), p, core(rng, q, x, y), q, math.cos(axis), math.sin(axis), one, two, of
        found = fixed_axis.python(*arguments)
        with monkeypatch.context() as patch:
            patch.setattr(axes, "MANY_CORNERS", 1000)
            assert found == fixed_axis.python(*arguments)


def test_a_pile_of_polygons_of_a_hundred_corners_comes_down() -> None:
    """Looks at all pairs of their vertices had spent the work of a step before its first event, in every step."""
    space, dt, _ = PROGRAMS["a hundred corners"]()
    stepper = ep.EECA(space)
    assert np.mean([stepper.step(dt).converged for _ in range(60)]) > 0.9

"""The law of two shapes, which Python and kernels state."""

from __future__ import annotations

import numpy as np

from eeca_pymunk.compiled.records import put, rows
from eeca_pymunk.model.shapes import SURFACE_FIELDS, Shape
from eeca_pymunk.pairs.rules import law
from eeca_pymunk.space.decisions import _own_law
from tests.packed import scene_with


def test_handlers_begin_with_the_law_that_kernels_compute() -> None:
    shapes = rows(Shape, 6)
    put(shapes, np.random.default_rng(1).uniform(-1.0, 1.0, (6, len(SURFACE_FIELDS))), *SURFACE_FIELDS)
    A = scene_with(SHAPE=shapes)
    for a in range(6):
        for b in range(6):
            assert _own_law(shapes, a, b) == law(A, a, b)

"""A pyramid or a stack of boxes that stands still."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_box, add_walls

GRAVITY = 9.81


def build(rows: int = 10, columns: int | None = None, dt: float = 1 / 60, duration: float = 5.0) -> Scene:
    """`rows` rows of unit boxes of 1 kg, friction .5, the lowest of `columns` (as many as rows; 1 is a stack)."""
    columns = rows if columns is None else columns
    if rows < 1 or columns < 1:
        raise ValueError(f"rows = {rows}, columns = {columns}: give numbers >= 1")
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    add_walls(space, [((-9.0, 0.0), (2.0 * columns + 9.0, 0.0))])
    places = [
        (1.1 * (i + (0.5 * j if columns > 1 else 0.0)), 0.5 + j)
        for j in range(rows)
        for i in range(max(columns - j, 1 if columns == 1 else 0))
    ]
    bodies = [add_box(space, place, 1.0, 1.0) for place in places]
    for shape in space.shapes:
        shape.friction, shape.elasticity = 0.5**0.5, 0.0

    def exact(t: float) -> FloatArray:
        return np.array(places)

    parameters = {"rows": rows, "columns": columns, "dt": dt}
    return Scene("pyramid", space, bodies, dt, duration, 1e6, exact, parameters)

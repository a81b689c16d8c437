"""Signorini problem (paper section 5, Figs. 1, 4, 5): a disk meets a rigid floor."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_disk, add_walls

RADIUS = 0.1


def build(dt: float = 0.002, height: float = 0.0) -> Scene:
    """Unit mass, v = (0, -1) m/s, K = 1e6 N/m, no gravity; starts `height` (m) above the floor y = 0."""
    space = pymunk.Space()
    disk = add_disk(space, (0.0, RADIUS + height), RADIUS, velocity=(0.0, -1.0))
    add_walls(space, [((-1.0, 0.0), (1.0, 0.0))])

    def exact(t: float) -> FloatArray:
        return np.array([[0.0, RADIUS + abs(height - t)]])

    return Scene("signorini", space, [disk], dt, 0.02, 1e6, exact, {"dt": dt, "height": height})

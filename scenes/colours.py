"""800 disks of many sizes and masses that fly through each other's ranks in a box."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import Scene, add_disk, add_walls

SIDE = 10.0


def build(count: int = 800, seed: int = 0, dt: float = 1 / 60, duration: float = 2.0) -> Scene:
    """`count` elastic disks of r = .05 to .12 m, mass by area, normal velocities (m/s), in a box of side 10 m."""
    if not 1 <= count <= 1000:
        raise ValueError(f"count = {count}: give a number from 1 to 1000")
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    columns = int(np.ceil(np.sqrt(count)))
    pitch = SIDE / columns
    bodies = []
    for k in range(count):
        radius = float(rng.uniform(0.05, 0.12))
        position = ((k % columns + 0.5) * pitch, (k // columns + 0.5) * pitch)
        velocity = (float(rng.normal()), float(rng.normal()))
        bodies.append(add_disk(space, position, radius, 100.0 * radius**2, velocity))
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    return Scene("colours", space, bodies, dt, duration, 1e6, parameters={"count": count, "seed": seed, "dt": dt})

"""Elastic gas: disks with normal velocities in a unit box, without gravity."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import Scene, add_disk, add_walls

SIDE = 1.0


def build(
    count: int = 20, radius: float | None = None, seed: int = 0, dt: float = 1e-2, duration: float = 0.4,
    packing: float = 0.3,
) -> Scene:  # fmt: skip
    """`count` disks of unit mass, each velocity component normal with unit spread (m/s), in a box of side 1 m.

    Disks start on a jittered grid, clear of each other. `radius` (m) fixes the size; without it the disks cover the
    part `packing` of the box. Every seed is another start.
    """
    if count < 1:
        raise ValueError(f"count = {count}: give a number >= 1")
    if radius is None:
        if not 0.0 < packing < math.pi / 4:
            raise ValueError(f"packing = {packing}: give a number between 0 and pi/4, what a square grid can hold")
        radius = math.sqrt(packing * SIDE**2 / (math.pi * count))
    columns = math.ceil(math.sqrt(count))
    pitch = SIDE / columns
    if not 0.0 < radius < 0.5 * pitch:
        raise ValueError(f"radius = {radius}: give a length between 0 and {0.5 * pitch} for {count} disks")
    rng = np.random.default_rng(seed)
    cells = rng.permutation(columns * columns)[:count]
    # The last per mille keeps neighbours from touching exactly.
    jitter = rng.uniform(-1.0, 1.0, (count, 2)) * (0.5 * pitch - radius) * 0.999
    center = (np.stack((cells % columns, cells // columns), axis=1) + 0.5) * pitch + jitter
    velocity = rng.normal(size=(count, 2))
    space = pymunk.Space()
    bodies = [
        add_disk(space, (float(x), float(y)), radius, velocity=(float(u), float(v)))
        for (x, y), (u, v) in zip(center, velocity, strict=True)
    ]
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    parameters = {"count": count, "radius": radius, "seed": seed, "dt": dt}
    return Scene("gas", space, bodies, dt, duration, 1e6, parameters=parameters)

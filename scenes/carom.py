"""Carom (paper section 6.1, Figs. 6, 7): one disk in a square box, exact by unfolding the reflections."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import FloatArray, Point, Scene, add_disk, add_walls

RADIUS, SIDE = 0.01, 1.0


def build(dt: float = 0.0025, position: Point = (0.25, 0.25), velocity: Point = (4.0, -4.0)) -> Scene:
    """Unit mass, radius 1 cm, box of side 1 m, K = 1e6 N/m; positions in m, velocities in m/s.

    The paper's start reaches the first wall at t = .06 s, a multiple of the paper's dt: other starts and other dt tell
    more about a stepper.
    """
    space = pymunk.Space()
    disk = add_disk(space, position, RADIUS, velocity=velocity)
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    free = SIDE - 2 * RADIUS
    start, speed = np.array(position) - RADIUS, np.array(velocity)

    def exact(t: float) -> FloatArray:
        # In mirrored copies of the box the path is straight; folding back gives the reflections.
        unfolded = np.mod(start + speed * t, 2 * free)
        return np.array([RADIUS + np.where(unfolded > free, 2 * free - unfolded, unfolded)])

    parameters = {"dt": dt, "position": position, "velocity": velocity}
    return Scene("carom", space, [disk], dt, 10.0, 1e6, exact, parameters)

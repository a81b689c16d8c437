"""Hopper filling (paper section 6.4, Figs. 12-15): 665 disks fall into a V of two inclined walls."""

from __future__ import annotations

import math

import pymunk

from .scene import Scene, add_disk, add_walls

COLUMNS, LAYERS, RADIUS, SIDE, ANGLE, GRAVITY = 35, 19, 0.004, 1.0, math.radians(30.0), 9.81
SPACING = 1.05  # centre distance of the staggered array in diameters: "slightly separated"
BOTTOM = 0.32  # height of the lowest layer above the apex, where the array is narrower than the hopper


def build(dt: float = 0.0025, columns: int = COLUMNS, layers: int = LAYERS) -> Scene:
    """665 disks of r = 4 mm and 1 kg, walls of 1 m at 30 degrees from the vertical, g = 9.81 m/s², K = 1e6 N/m.

    The apex is the origin and closed. The paper gives neither the array's size nor its place: 35 x 19 disks, 10 %
    apart, start inside the hopper.
    """
    if columns < 1 or layers < 1:
        raise ValueError(f"columns = {columns}, layers = {layers}: give numbers >= 1")
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    add_walls(space, walls())
    pitch = 2 * RADIUS * SPACING
    bodies = []
    for layer in range(layers):
        for column in range(columns):
            x = (column - 0.5 * (columns - 1) + (0.25 if layer % 2 else -0.25)) * pitch
            bodies.append(add_disk(space, (x, BOTTOM + layer * pitch * math.sqrt(0.75)), RADIUS))
    parameters = {"dt": dt, "columns": columns, "layers": layers}
    return Scene("hopper", space, bodies, dt, 1.0, 1e6, parameters=parameters)


def walls() -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """The two walls, from the apex up."""
    x, y = SIDE * math.sin(ANGLE), SIDE * math.cos(ANGLE)
    return [((0.0, 0.0), (-x, y)), ((0.0, 0.0), (x, y))]

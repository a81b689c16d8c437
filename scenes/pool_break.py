"""Breaking of pool balls (paper section 6.2, Figs. 8, 9, Table II): a cue disk hits a triangle of 55 disks."""

from __future__ import annotations

import math

import pymunk

from .scene import Scene, add_disk

ROWS, RADIUS, SMALL_RADIUS, CUE_RADIUS, MASS, SPEED = 10, 0.030, 0.029, 0.025, 0.15, 10.0
# (row, column) of the 58 mm disks: mirror images of each other in case ii, not so in case iii.
SMALL = {"i": (), "ii": ((4, 1), (4, 3)), "iii": ((3, 1), (5, 4), (6, 2))}
CUE_GAP = 0.01


def build(case: str = "i", dt: float = 2.5e-4) -> Scene:
    """Cue of 50 mm at v = (0, 10) m/s, 55 disks of 60 mm in contact, 0.15 kg each, K = 1e6 N/m, no gravity.

    Case i: all disks equal. Case ii: two disks of 58 mm placed symmetrically about the line of impact; case iii: three
    placed asymmetrically (the paper shades them without coordinates: rows and columns are in `SMALL`). The cue starts
    1 cm before the first disk; body 0 is the cue. The line of impact is x = 0.
    """
    if case not in SMALL:
        raise ValueError(f"case = {case!r}: choose one of {', '.join(SMALL)}")
    space = pymunk.Space()
    bodies = [add_disk(space, (0.0, -RADIUS - CUE_RADIUS - CUE_GAP), CUE_RADIUS, MASS, (0.0, SPEED))]
    for row in range(ROWS):
        for column in range(row + 1):
            radius = SMALL_RADIUS if (row, column) in SMALL[case] else RADIUS
            position = ((2 * column - row) * RADIUS, row * math.sqrt(3.0) * RADIUS)
            bodies.append(add_disk(space, position, radius, MASS))
    return Scene("pool_break", space, bodies, dt, 1.0, 1e6, parameters={"case": case, "dt": dt})


def mirror() -> list[int]:
    """For each body the index of its mirror image about the line of impact."""
    index = [0]
    for row in range(ROWS):
        first = 1 + row * (row + 1) // 2
        index.extend(first + row - column for column in range(row + 1))
    return index

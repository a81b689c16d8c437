"""How the bodies of an island move over a step, and where they are at its end."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import merged, uncounted
from .layout import ANCHOR_AX
from .scratch import (
    AFTER,
    BEFORE,
    BEND,
    CAYLEY,
    COS,
    FREE,
    GOT,
    L_JOINT,
    LEAD,
    LEVER,
    MEAN,
    MOBILITY,
    PER,
    POSE,
    ROOT,
    SIN,
    SLOPE,
    TRAVEL,
    TURN_COS,
    TURN_SIN,
    TURNED,
    UNROOT,
    WAY,
)


@uncounted
def size_up(
    joint: FloatArray, link: IntArray, first: int, last: int, local: FloatArray, bodies: int, h: float
) -> float:  # fmt: skip
    """Complete the bodies whose pose, velocity and mobility are in the scratch of an island; its size, the length that
    errors are measured by, from them and from the joints of rows first ... last of `link`."""
    length = 0.0
    for i in range(bodies):
        for c in range(3):
            root = np.sqrt(local[i, MOBILITY + c])
            local[i, ROOT + c], local[i, UNROOT + c] = root, 1.0 / root if root > 0.0 else 0.0
        local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
        for c in range(2):
            length = max(length, abs(local[i, POSE + c]), abs(h * local[i, BEFORE + c]))
    for k in range(first, last):
        for c in range(4):
            length = max(length, abs(joint[link[k, L_JOINT], ANCHOR_AX + c]))
    return length if length > 0.0 else 1.0


@merged
def move(local: FloatArray, bodies: int, h: float) -> None:
    """Fill in WAY and what follows from it, of the present velocities at the end, but for the angle itself (`turn`)."""
    for i in range(bodies):
        for c in range(3):
            local[i, WAY + c] = 0.5 * h * (local[i, BEFORE + c] + local[i, AFTER + c])
        chi = local[i, WAY + 2]
        t = 0.5 * chi
        if local[i, CAYLEY] > 0.0 or chi == 0.0:
            slope = 1.0 / (1.0 + t * t)
            local[i, TURN_COS] = (1.0 - t * t) * slope
            local[i, TURN_SIN] = chi * slope
            local[i, SLOPE] = slope
            local[i, LEVER] = 1.0
        else:
            local[i, TURN_COS] = np.cos(chi)
            local[i, TURN_SIN] = np.sin(chi)
            local[i, SLOPE] = 1.0
            local[i, LEVER] = np.tan(t) / t if abs(t) > 1e-3 else 1.0 + t * t / 3.0 + 2.0 * t**4 / 15.0


@uncounted
def turn(local: FloatArray, i: int) -> None:
    """Fill in the angle that body i turns by, over chi too, after `move`: for joints of angles."""
    chi = local[i, WAY + 2]
    t = 0.5 * chi
    if local[i, CAYLEY] > 0.0:
        slope, turned = local[i, SLOPE], 2.0 * np.arctan(t)
        local[i, TURNED] = turned
        if abs(t) < 1e-3:
            local[i, PER] = 1.0 - t * t / 3.0 + t**4 / 5.0
            local[i, BEND] = -t / 3.0 + 0.4 * t**3
        else:
            local[i, PER] = turned / chi
            local[i, BEND] = (slope - turned / chi) / chi
    else:
        local[i, TURNED] = chi
        local[i, PER] = 1.0
        local[i, BEND] = 0.0


@merged
def settle(local: FloatArray, bodies: int, h: float) -> None:
    """Velocities at the end from the balance of momentum, to round-off, and the way that they make."""
    for i in range(bodies):
        for c in range(3):
            change = h * local[i, FREE + c] + local[i, MOBILITY + c] * local[i, GOT + c]
            local[i, AFTER + c] = local[i, BEFORE + c] + change
    move(local, bodies, h)


@merged
def advance(local: FloatArray, bodies: int, h: float) -> None:
    """Make the end of a part h of the step the start of the next."""
    per = 1.0 / h
    for i in range(bodies):
        for c in range(3):
            local[i, LEAD + c] = (local[i, AFTER + c] - local[i, BEFORE + c]) * per - local[i, FREE + c]
            local[i, TRAVEL + c] += local[i, WAY + c]
        local[i, MEAN] += h * (local[i, POSE] + 0.5 * local[i, WAY])
        local[i, MEAN + 1] += h * (local[i, POSE + 1] + 0.5 * local[i, WAY + 1])
        local[i, POSE] += local[i, WAY]
        local[i, POSE + 1] += local[i, WAY + 1]
        chi = local[i, WAY + 2]
        for c in range(3):
            local[i, BEFORE + c] = local[i, AFTER + c]
        if chi != 0.0:
            local[i, POSE + 2] += 2.0 * np.arctan(0.5 * chi) if local[i, CAYLEY] > 0.0 else chi
            # As of that angle, to the round-off of the parts of a step.
            x, y, turn_x, turn_y = local[i, COS], local[i, SIN], local[i, TURN_COS], local[i, TURN_SIN]
            local[i, COS], local[i, SIN] = x * turn_x - y * turn_y, y * turn_x + x * turn_y

"""Energy that a step of joints has gained without anything having worked: taken from what moves against each other.

A step whose joints did not hold (elastic stand-ins, linear rows), and closing what it left apart, may gain energy. Of
all velocities with the same momentum and angular momentum those of a rigid body have the least energy, and no joint
minds them. So velocities go part of the way to these, v = v_r + s (v - v_r), K = K_r + s^2 K_rel, until the gain is
gone; where a component hangs on what stands still v_r = 0.
"""

from __future__ import annotations

import math

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .scratch import BEFORE, FREEDOMS, MOBILITY, POSE


@uncounted
def lock_energy(local: FloatArray, node: IntArray, bodies: int, gain: float) -> float:
    """Take energy `gain` > 0 from the velocities at BEFORE; how much of it could be. Nothing where supports move: these
    work."""
    mass = x = y = vx = vy = 0.0
    hangs = False
    for i in range(bodies):
        if node[i, FREEDOMS] == 0:
            hangs = True
            for c in range(3):
                if local[i, BEFORE + c] != 0.0:
                    return 0.0
        elif local[i, MOBILITY] > 0.0:
            m = 1.0 / local[i, MOBILITY]
            mass += m
            x, y = x + m * local[i, POSE], y + m * local[i, POSE + 1]
            vx, vy = vx + m * local[i, BEFORE], vy + m * local[i, BEFORE + 1]
    if mass > 0.0:
        x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
    turning, inertia = 0.0, 0.0
    for i in range(bodies):
        if node[i, FREEDOMS] > 0 and local[i, MOBILITY] > 0.0:
            m, dx, dy = 1.0 / local[i, MOBILITY], local[i, POSE] - x, local[i, POSE + 1] - y
            turning += m * (dx * (local[i, BEFORE + 1] - vy) - dy * (local[i, BEFORE] - vx))
            inertia += m * (dx * dx + dy * dy)
        if node[i, FREEDOMS] > 2 and local[i, MOBILITY + 2] > 0.0:
            turning += local[i, BEFORE + 2] / local[i, MOBILITY + 2]
            inertia += 1.0 / local[i, MOBILITY + 2]
    spin = turning / inertia if inertia > 0.0 else 0.0
    if hangs:
        vx = vy = spin = 0.0
    apart = against(local, node, bodies, x, y, vx, vy, spin, -1.0)
    s = math.sqrt(max(0.0, 1.0 - gain / apart)) if apart > 0.0 else 0.0
    against(local, node, bodies, x, y, vx, vy, spin, s)
    return (1.0 - s * s) * apart


@uncounted
def against(
    local: FloatArray, node: IntArray, bodies: int, x: float, y: float, vx: float, vy: float, spin: float, s: float
) -> float:  # fmt: skip
    """Kinetic energy of the motion against that of a rigid body with velocity (vx, vy) at (x, y); s >= 0: let there be
    s times as much of this motion."""
    total = 0.0
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            if local[i, MOBILITY + c] > 0.0:
                rigid = spin
                if c == 0:
                    rigid = vx - spin * (local[i, POSE + 1] - y)
                elif c == 1:
                    rigid = vy + spin * (local[i, POSE] - x)
                off = local[i, BEFORE + c] - rigid
                total += 0.5 * off * off / local[i, MOBILITY + c]
                if s >= 0.0:
                    local[i, BEFORE + c] = rigid + s * off
    return total

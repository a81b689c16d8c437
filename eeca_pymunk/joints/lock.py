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
from .scratch import BEFORE, COS, FREE, FREEDOMS, MEAN, MOBILITY, POSE, SAVED, SHIFT, SIN, TRAVEL

_TURNS = 8  # fixed-point iterations of the mean arms


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
def stands(local: FloatArray, node: IntArray, bodies: int) -> bool:
    """Whether nothing that the component hangs on moves."""
    still = True
    for i in range(bodies):
        for c in range(3):
            still = still and (node[i, FREEDOMS] > 0 or local[i, BEFORE + c] == 0.0)
    return still


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


@uncounted
def move_rigidly(local: FloatArray, node: IntArray, bodies: int, h: float) -> None:
    """The end of a step h from SAVED to which no joint has an objection, and at which there is no more energy than at
    the start: all move as one rigid body under their accelerations, or stand still where they hang on something.

    r1 - r0 = chi z x r_m: with torques about r_m the work of the accelerations is exact.
    """
    mass = x = y = vx = vy = ax = ay = 0.0
    hangs = False
    for i in range(bodies):
        hangs = hangs or node[i, FREEDOMS] == 0
        if node[i, FREEDOMS] > 0 and local[i, MOBILITY] > 0.0:
            m = 1.0 / local[i, MOBILITY]
            mass += m
            x, y = x + m * local[i, SAVED], y + m * local[i, SAVED + 1]
            vx, vy = vx + m * local[i, SAVED + 3], vy + m * local[i, SAVED + 4]
            ax, ay = ax + m * local[i, FREE], ay + m * local[i, FREE + 1]
    if mass > 0.0:
        x, y, vx, vy, ax, ay = x / mass, y / mass, vx / mass, vy / mass, ax / mass, ay / mass
    chi, spin, after = 0.0, 0.0, 0.0
    for _ in range(0 if hangs else _TURNS):
        turning = inertia = torque = 0.0
        for i in range(bodies):
            if node[i, FREEDOMS] > 0 and local[i, MOBILITY] > 0.0:
                m, dx, dy = 1.0 / local[i, MOBILITY], local[i, SAVED] - x, local[i, SAVED + 1] - y
                turning += m * (dx * (local[i, SAVED + 4] - vy) - dy * (local[i, SAVED + 3] - vx))
                inertia += m * (dx * dx + dy * dy)
                over = 1.0 / (1.0 + 0.25 * chi * chi)
                mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
                torque += m * (mx * (local[i, FREE + 1] - ay) - my * (local[i, FREE] - ax))
            if node[i, FREEDOMS] > 2 and local[i, MOBILITY + 2] > 0.0:
                turning += local[i, SAVED + 5] / local[i, MOBILITY + 2]
                inertia += 1.0 / local[i, MOBILITY + 2]
                torque += local[i, FREE + 2] / local[i, MOBILITY + 2]
        spin = turning / inertia if inertia > 0.0 else 0.0
        after = spin + h * torque / inertia if inertia > 0.0 else 0.0
        chi = 0.5 * h * (spin + after)
    over = 1.0 / (1.0 + 0.25 * chi * chi)
    turned = 2.0 * math.atan(0.5 * chi)
    for i in range(bodies):
        for c in range(6):
            local[i, POSE + c] = local[i, SAVED + c]
        for c in range(3):
            local[i, TRAVEL + c] = local[i, SHIFT + c]
        local[i, MEAN], local[i, MEAN + 1] = h * local[i, POSE], h * local[i, POSE + 1]
        if node[i, FREEDOMS] == 0:
            continue
        if hangs:
            for c in range(node[i, FREEDOMS]):
                local[i, BEFORE + c] = 0.0
        else:
            dx, dy = local[i, SAVED] - x, local[i, SAVED + 1] - y
            mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
            wx, wy = h * (vx + 0.5 * h * ax) - chi * my, h * (vy + 0.5 * h * ay) + chi * mx
            local[i, POSE], local[i, POSE + 1] = local[i, SAVED] + wx, local[i, SAVED + 1] + wy
            local[i, MEAN], local[i, MEAN + 1] = local[i, MEAN] + 0.5 * h * wx, local[i, MEAN + 1] + 0.5 * h * wy
            local[i, TRAVEL], local[i, TRAVEL + 1] = local[i, TRAVEL] + wx, local[i, TRAVEL + 1] + wy
            rx, ry = 2.0 * mx - dx, 2.0 * my - dy
            local[i, BEFORE], local[i, BEFORE + 1] = vx + h * ax - after * ry, vy + h * ay + after * rx
            if node[i, FREEDOMS] > 2:
                local[i, POSE + 2], local[i, BEFORE + 2] = local[i, SAVED + 2] + turned, after
                local[i, TRAVEL + 2] += chi
        if node[i, FREEDOMS] < 3:
            way = h * (local[i, SAVED + 5] + 0.5 * h * local[i, FREE + 2])
            local[i, POSE + 2] = local[i, SAVED + 2] + way
            local[i, BEFORE + 2] = local[i, SAVED + 5] + h * local[i, FREE + 2]
            local[i, TRAVEL + 2] += way
        local[i, COS], local[i, SIN] = math.cos(local[i, POSE + 2]), math.sin(local[i, POSE + 2])

"""Energy that a step of joints has gained without work is taken from the relative motion of the bodies.

A step whose joints did not hold (elastic or linear rows), and closing what it left apart, may gain energy. Of all
velocities with the same momentum and angular momentum, those of a rigid body have the least energy, and they satisfy
all joints. So v = v_r + s (v - v_r), K = K_r + s^2 K_rel, with s such that the gain is gone; if the component has a
partner at rest, v_r = 0.
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import BodyStep
from ..model.parameters.joints import LOCK_ITERATIONS


@nonallocating
def centre_of(local: Rows[BodyStep], bodies: int) -> tuple[bool, float, float, float, float, float, float]:
    """Whether the component has a partner (`hangs`), and the centre of mass (x, y) of its moving bodies with its
    velocity (vx, vy) and acceleration (ax, ay)."""
    mass = x = y = vx = vy = ax = ay = 0.0
    hangs = False
    for i in range(bodies):
        hangs = hangs or local[i].freedoms == 0
        if local[i].freedoms > 0 and local[i].mobility[0] > 0.0:
            m = 1.0 / local[i].mobility[0]
            mass += m
            x, y = x + m * local[i].pose[0], y + m * local[i].pose[1]
            vx, vy = vx + m * local[i].v0[0], vy + m * local[i].v0[1]
            ax, ay = ax + m * local[i].acceleration[0], ay + m * local[i].acceleration[1]
    if mass > 0.0:
        x, y, vx, vy, ax, ay = x / mass, y / mass, vx / mass, vy / mass, ax / mass, ay / mass
    return hangs, x, y, vx, vy, ax, ay


@nonallocating
def spin_about(local: Rows[BodyStep], bodies: int, x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    """Spin of a rigid body with the angular momentum of the component about its centre of mass (x, y), of velocity (vx,
    vy), and its moment of inertia; 0 if that is 0."""
    turning, inertia = 0.0, 0.0
    for i in range(bodies):
        if local[i].freedoms > 0 and local[i].mobility[0] > 0.0:
            m, dx, dy = 1.0 / local[i].mobility[0], local[i].pose[0] - x, local[i].pose[1] - y
            turning += m * (dx * (local[i].v0[1] - vy) - dy * (local[i].v0[0] - vx))
            inertia += m * (dx * dx + dy * dy)
        if local[i].freedoms > 2 and local[i].mobility[2] > 0.0:
            turning += local[i].v0[2] / local[i].mobility[2]
            inertia += 1.0 / local[i].mobility[2]
    return turning / inertia if inertia > 0.0 else 0.0, inertia


@nonallocating
def lock_energy(local: Rows[BodyStep], bodies: int, gain: float) -> float:
    """Take the energy `gain` > 0 from the velocities v0; returns how much was taken. Nothing if partners move: they do
    work."""
    if not supports_rest(local, bodies):
        return 0.0
    hangs, x, y, vx, vy, _, _ = centre_of(local, bodies)
    spin, _ = spin_about(local, bodies, x, y, vx, vy)
    if hangs:
        vx = vy = spin = 0.0
    apart = relative_energy(local, bodies, x, y, vx, vy, spin, -1.0)
    s = math.sqrt(max(0.0, 1.0 - gain / apart)) if apart > 0.0 else 0.0
    relative_energy(local, bodies, x, y, vx, vy, spin, s)
    return (1.0 - s * s) * apart


@nonallocating
def supports_rest(local: Rows[BodyStep], bodies: int) -> bool:
    """Whether all partners of the component are at rest."""
    for i in range(bodies):
        for c in range(3):
            if local[i].freedoms == 0 and local[i].v0[c] != 0.0:
                return False
    return True


@nonallocating
def relative_energy(
    local: Rows[BodyStep], bodies: int, x: float, y: float, vx: float, vy: float, spin: float, s: float
) -> float:
    """Kinetic energy of the motion relative to a rigid body with velocity (vx, vy) at (x, y) and `spin`; s >= 0: scale
    this motion by s."""
    total = 0.0
    for i in range(bodies):
        for c in range(local[i].freedoms):
            if local[i].mobility[c] > 0.0:
                rigid = spin
                if c == 0:
                    rigid = vx - spin * (local[i].pose[1] - y)
                elif c == 1:
                    rigid = vy + spin * (local[i].pose[0] - x)
                off = local[i].v0[c] - rigid
                total += 0.5 * off * off / local[i].mobility[c]
                if s >= 0.0:
                    local[i].v0[c] = rigid + s * off
    return total


@nonallocating
def move_rigidly(local: Rows[BodyStep], bodies: int, h: float) -> None:
    """Move all bodies over a step h as one rigid body under their accelerations, or stop them if the component has a
    partner: joints keep their shape, and energy does not rise except by the work of the accelerations.

    r1 - r0 = chi z x r_m for the arms r about the common centre: with torques about r_m that work is exact. Bodies that
    joints do not turn keep their own spin.
    """
    hangs, x, y, vx, vy, ax, ay = centre_of(local, bodies)
    spin, inertia = spin_about(local, bodies, x, y, vx, vy)
    chi, after = 0.0, 0.0
    for _ in range(0 if hangs else LOCK_ITERATIONS):
        torque, over = 0.0, 1.0 / (1.0 + 0.25 * chi * chi)
        for i in range(bodies):
            if local[i].freedoms > 0 and local[i].mobility[0] > 0.0:
                m, dx, dy = 1.0 / local[i].mobility[0], local[i].pose[0] - x, local[i].pose[1] - y
                mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
                torque += m * (mx * (local[i].acceleration[1] - ay) - my * (local[i].acceleration[0] - ax))
            if local[i].freedoms > 2 and local[i].mobility[2] > 0.0:
                torque += local[i].acceleration[2] / local[i].mobility[2]
        after = spin + h * torque / inertia if inertia > 0.0 else 0.0
        chi = 0.5 * h * (spin + after)
    over = 1.0 / (1.0 + 0.25 * chi * chi)
    turned = 2.0 * math.atan(0.5 * chi)
    for i in range(bodies):
        local[i].mean[0], local[i].mean[1] = h * local[i].pose[0], h * local[i].pose[1]
        if local[i].freedoms == 0:
            continue
        if hangs:
            for c in range(local[i].freedoms):
                local[i].v0[c] = 0.0
        else:
            dx, dy = local[i].pose[0] - x, local[i].pose[1] - y
            mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
            wx, wy = h * (vx + 0.5 * h * ax) - chi * my, h * (vy + 0.5 * h * ay) + chi * mx
            local[i].pose[0], local[i].pose[1] = local[i].pose[0] + wx, local[i].pose[1] + wy
            local[i].mean[0], local[i].mean[1] = local[i].mean[0] + 0.5 * h * wx, local[i].mean[1] + 0.5 * h * wy
            local[i].travel[0], local[i].travel[1] = local[i].travel[0] + wx, local[i].travel[1] + wy
            rx, ry = 2.0 * mx - dx, 2.0 * my - dy
            local[i].v0[0], local[i].v0[1] = vx + h * ax - after * ry, vy + h * ay + after * rx
            if local[i].freedoms > 2:
                local[i].pose[2], local[i].v0[2] = local[i].pose[2] + turned, after
                local[i].travel[2] += chi
        if local[i].freedoms < 3:
            way = h * (local[i].saved_velocity[2] + 0.5 * h * local[i].acceleration[2])
            local[i].pose[2] = local[i].saved_pose[2] + way
            local[i].v0[2] = local[i].saved_velocity[2] + h * local[i].acceleration[2]
            local[i].travel[2] += way
        local[i].cos, local[i].sin = math.cos(local[i].pose[2]), math.sin(local[i].pose[2])

"""Energy that a step of joints has gained without work is taken from the relative motion of the bodies.

A step whose joints did not hold (elastic or linear rows), and closing what it left apart, may gain energy. Of all
velocities with the same momentum and angular momentum, those of a rigid body have the least energy, and they satisfy
all joints. So v = v_r + s (v - v_r), K = K_r + s^2 K_rel, with s such that the gain is gone. Gears of another ratio
than 1 do not keep angular momentum: v_r then is that of the centre of mass. If the component has supports, v_r is the
velocity of their frame (`frame`): 0 if they are at rest.

The momenta are those of the start and of the accelerations. Impulses that are large, as those of joints that contradict
one another, change them by their round-off: a component is moved or turned as a whole, which no relative motion pays.
So this is undone before (`restore_momenta`).
"""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..model.joint_steps import JointLedger
from ..model.joints import Workspace
from ..model.parameters.joints import LOCK_ITERATIONS, MOMENTUM_LEFT
from .frame import acted_on, centre_of, frame_of, has_ratio, is_led, relative_energy, spin_about, supports


@nonallocating
def turns_freely(W: Workspace) -> bool:
    """Whether no joint changes the angular momentum of the component: it has no support, and no gear whose torques,
    -T/ratio and T, are not opposite."""
    for i in range(W.bodies):
        for c in range(3):
            if supports(W.J.LOCAL[i], c):
                return False
    return not has_ratio(W)


@nonallocating
def restore_momenta(W: Workspace, h: float, projected: bool) -> float:
    """Change the velocities v0 at the end of the step h by those of a rigid body, so that the momentum of a component
    without partners, and its angular momentum if it `turns_freely`, are those of the start and of the accelerations;
    with h = 0 those of the start, from which poses have been displaced; if velocities were `projected`, those of
    `v_before` at the same poses. Returns the change of the kinetic energy. Nothing changes where momenta are right to
    MOMENTUM_LEFT of the sums of their magnitudes.

    L1 = L0 + sum m x_m x a h + I alpha h with the means x_m of the places over the time h, as the arms of joints are
    those of the middle.
    """
    local = W.J.LOCAL
    hangs, x, y, vx, vy, _, _ = centre_of(W)
    if hangs:
        return 0.0
    mass = px = py = turning = size = arms = 0.0
    for i in range(W.bodies):
        body = local[i]
        m = 1.0 / body.mobility[0] if is_led(body, 0) else 0.0
        rx, ry, now = body.pose[0] - x, body.pose[1] - y, body.v0
        before, sx, sy, ax, ay, spun = body.v_before, rx, ry, 0.0, 0.0, 0.0
        if not projected:
            before, sx, sy = body.saved_velocity, body.saved_pose[0] - x, body.saved_pose[1] - y
        if h > 0.0:
            ax, ay, spun = body.acceleration[0], body.acceleration[1], h * body.acceleration[2]
            turning -= m * ((body.mean[0] - h * x) * ay - (body.mean[1] - h * y) * ax)
        mass += m
        px += m * (now[0] - before[0] - h * ax)
        py += m * (now[1] - before[1] - h * ay)
        turning += m * (rx * now[1] - ry * now[0]) - m * (sx * before[1] - sy * before[0])
        moved = m * (abs(now[0]) + abs(now[1]) + abs(before[0]) + abs(before[1]) + h * (abs(ax) + abs(ay)))
        size, arms = size + moved, arms + moved * (abs(rx) + abs(ry))
        if is_led(body, 2):
            turning += (now[2] - before[2] - spun) / body.mobility[2]
            arms += (abs(now[2]) + abs(before[2]) + abs(spun)) / body.mobility[2]
    was, inertia = spin_about(W, x, y, vx, vy)
    spin = -turning / inertia if inertia > 0.0 and turns_freely(W) else 0.0
    if not (abs(px) + abs(py) > MOMENTUM_LEFT * size or abs(spin) * inertia > MOMENTUM_LEFT * arms):
        return 0.0
    ux, uy = (-px / mass, -py / mass) if mass > 0.0 else (0.0, 0.0)
    for i in range(W.bodies):
        if is_led(local[i], 0):
            local[i].v0[0] += ux - spin * (local[i].pose[1] - y)
            local[i].v0[1] += uy + spin * (local[i].pose[0] - x)
        local[i].v0[2] += spin if is_led(local[i], 2) else 0.0
    return mass * (ux * (vx + 0.5 * ux) + uy * (vy + 0.5 * uy)) + inertia * spin * (was + 0.5 * spin)


@nonallocating
def lock_energy(W: Workspace, gain: float, ledger: JointLedger) -> float:
    """Take the energy `gain` > 0 from the velocities v0; returns how much was taken. Supports that move do work in
    this, which enters `ledger`. Nothing if they have no frame."""
    F = frame_of(W)
    if not F.rigid:
        return 0.0
    apart, work = relative_energy(W, F, -1.0)
    s = math.sqrt(max(0.0, 1.0 - gain / apart)) if apart > 0.0 else 0.0
    relative_energy(W, F, s)
    ledger.supports, ledger.frame_work = ledger.supports + (1.0 - s) * work, ledger.frame_work + (1.0 - s) * work
    return (1.0 - s * s) * apart


@nonallocating
def move_rigidly(W: Workspace, h: float) -> None:
    """Move all bodies over a step h as one rigid body under their accelerations, without turning if gears do not let
    it, or with the frame of their supports: joints keep their shape, and energy does not rise except by the work of the
    accelerations, and of supports that move.

    r1 - r0 = chi z x r_m for the arms r about the common centre: with torques about r_m that work is exact. Bodies that
    joints do not push, or turn, go their own way, or turn by their own spin.
    """
    local, bodies, F = W.J.LOCAL, W.bodies, frame_of(W)
    held, x, y, vx, vy, spin = F.hangs or F.turns, F.x, F.y, F.vx, F.vy, F.spin
    _, _, _, _, _, ax, ay = centre_of(W)
    if F.hangs:
        ax = ay = 0.0
    _, inertia = spin_about(W, x, y, vx, vy)
    chi, after = (2.0 * math.tan(0.5 * h * spin), spin) if held else (0.0, 0.0)
    for _ in range(0 if held or has_ratio(W) else LOCK_ITERATIONS):
        torque, over = 0.0, 1.0 / (1.0 + 0.25 * chi * chi)
        for i in range(bodies):
            if is_led(local[i], 0):
                m, dx, dy = 1.0 / local[i].mobility[0], local[i].pose[0] - x, local[i].pose[1] - y
                mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
                torque += m * (mx * (local[i].acceleration[1] - ay) - my * (local[i].acceleration[0] - ax))
            if is_led(local[i], 2):
                torque += local[i].acceleration[2] / local[i].mobility[2]
        after = spin + h * torque / inertia if inertia > 0.0 else 0.0
        chi = 0.5 * h * (spin + after)
    over = 1.0 / (1.0 + 0.25 * chi * chi)
    turned = 2.0 * math.atan(0.5 * chi)
    for i in range(bodies):
        before, own = local[i].saved_velocity, local[i].acceleration
        local[i].mean[0], local[i].mean[1] = h * local[i].pose[0], h * local[i].pose[1]
        dx, dy = local[i].pose[0] - x, local[i].pose[1] - y
        mx, my = over * (dx - 0.5 * chi * dy), over * (dy + 0.5 * chi * dx)
        wx, wy = h * (vx + 0.5 * h * ax) - chi * my, h * (vy + 0.5 * h * ay) + chi * mx
        rx, ry = 2.0 * mx - dx, 2.0 * my - dy
        ux, uy = vx + h * ax - after * ry, vy + h * ay + after * rx
        if not acted_on(local[i], 0):
            ux, uy = before[0] + h * own[0], before[1] + h * own[1]
            wx, wy = 0.5 * h * (before[0] + ux), 0.5 * h * (before[1] + uy)
        local[i].pose[0], local[i].pose[1] = local[i].pose[0] + wx, local[i].pose[1] + wy
        local[i].mean[0], local[i].mean[1] = local[i].mean[0] + 0.5 * h * wx, local[i].mean[1] + 0.5 * h * wy
        local[i].travel[0], local[i].travel[1] = local[i].travel[0] + wx, local[i].travel[1] + wy
        local[i].v0[0], local[i].v0[1] = ux, uy
        if is_led(local[i], 2):
            local[i].pose[2], local[i].v0[2] = local[i].pose[2] + turned, after
            local[i].travel[2] += chi
        else:
            way = h * (before[2] + 0.5 * h * own[2])
            local[i].pose[2] = local[i].saved_pose[2] + way
            local[i].v0[2] = before[2] + h * own[2]
            local[i].travel[2] += way
        local[i].cos, local[i].sin = math.cos(local[i].pose[2]), math.sin(local[i].pose[2])

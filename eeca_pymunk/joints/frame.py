"""The frame of a component: the rigid motion of its supports, to which joints hold the other bodies.

Supports are partners, and what has infinite mass or moment, as far as joints act on it: on the angle alone of a body
that only gears hold, on the place alone of one that is held at its centre. If they move as one rigid body, of velocity
u(r) = V + w z x (r - c), what joints between it and the other bodies do in its frame is no work. The work of the
supports then is sum p . u, of the impulses p = M (v1 - v0 - h a) of all joints on each body. It needs no impulse of a
joint, whose works cancel only up to round-off if joints contradict one another. What is gained beside it, sum p . (v_m
- u), is no work of supports, and is taken from the motion relative to the frame: Jacobi's integral K - V . P - w L does
not grow. Supports at rest are such a frame; without supports it is that of the momenta. Supports that move apart have
none: they can do any work.

Over a part h bodies move by h v_m, so u is that at the mean place r_m, with 2 tan(w h/2)/h for w: then r1 - r0 = h
u(r_m). Bodies that turn by chi itself (`BodyStep`) have w.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compiled import inlined, nonallocating
from ..model.joint_steps import BodyStep
from ..model.joints import FORCES_ON, GEAR, TORQUES_ON, Workspace


class Frame(NamedTuple):
    """Place (x, y), velocity (vx, vy) and spin of a frame."""

    rigid: bool  # whether supports move as one
    hangs: bool  # whether a support has a place: then (x, y) is its, else the centre of mass
    turns: bool  # whether a support has the spin; else it is that of the momenta, or 0 if these are not kept
    x: float
    y: float
    vx: float
    vy: float
    spin: float


@inlined
def acted_on(body: BodyStep, c: int) -> bool:
    """Whether joints act on this coordinate of a body: those of angles leave its place alone."""
    return bool(body.acted & (FORCES_ON if c < 2 else TORQUES_ON))


@inlined
def supports(body: BodyStep, c: int) -> bool:
    """Whether joints act on this coordinate of a body, and do not change it."""
    return acted_on(body, c) and not body.mobility[c] > 0.0


@inlined
def is_led(body: BodyStep, c: int) -> bool:
    """Whether joints act on this coordinate of a body, and change it."""
    return acted_on(body, c) and body.mobility[c] > 0.0


@nonallocating
def has_prescribed_motion(W: Workspace) -> bool:
    """Whether anything moves in the component that impulses do not change: a partner, or a spin of infinite moment,
    whether joints act on it or not."""
    for i in range(W.bodies):
        for c in range(3):
            body = W.J.LOCAL[i]
            if not body.mobility[c] > 0.0 and (body.v0[c] != 0.0 or body.acceleration[c] != 0.0):
                return True
    return False


@nonallocating
def has_ratio(W: Workspace) -> bool:
    """Whether a gear has another ratio than 1: its torques, -T/ratio and T, are not opposite."""
    for k in range(W.joints):
        if W.link[k].kind == GEAR and W.J.JOINT[W.link[k].joint].ratio != 1.0:
            return True
    return False


@nonallocating
def centre_of(W: Workspace) -> tuple[bool, float, float, float, float, float, float]:
    """Whether the component hangs on a support that has a place, and the centre of mass (x, y) of the bodies that its
    joints push, with its velocity (vx, vy) and acceleration (ax, ay)."""
    mass = x = y = vx = vy = ax = ay = 0.0
    hangs = False
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        hangs = hangs or supports(body, 0)
        if is_led(body, 0):
            m = 1.0 / body.mobility[0]
            mass += m
            x, y = x + m * body.pose[0], y + m * body.pose[1]
            vx, vy = vx + m * body.v0[0], vy + m * body.v0[1]
            ax, ay = ax + m * body.acceleration[0], ay + m * body.acceleration[1]
    if mass > 0.0:
        x, y, vx, vy, ax, ay = x / mass, y / mass, vx / mass, vy / mass, ax / mass, ay / mass
    return hangs, x, y, vx, vy, ax, ay


@nonallocating
def spin_about(W: Workspace, x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    """Spin of a rigid body with the angular momentum of the component about its centre of mass (x, y), of velocity (vx,
    vy), and its moment of inertia; 0 if that is 0."""
    turning, inertia = 0.0, 0.0
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        if is_led(body, 0):
            m, dx, dy = 1.0 / body.mobility[0], body.pose[0] - x, body.pose[1] - y
            turning += m * (dx * (body.v0[1] - vy) - dy * (body.v0[0] - vx))
            inertia += m * (dx * dx + dy * dy)
        if is_led(body, 2):
            turning += body.v0[2] / body.mobility[2]
            inertia += 1.0 / body.mobility[2]
    return turning / inertia if inertia > 0.0 else 0.0, inertia


@nonallocating
def frame_of(W: Workspace) -> Frame:
    """The frame of a component at its present poses and velocities v0."""
    local, rigid, hangs, turns = W.J.LOCAL, True, False, False
    x = y = vx = vy = spin = 0.0
    for i in range(W.bodies):
        body = local[i]
        if supports(body, 2):
            rigid = rigid and not (turns and body.v0[2] != spin) and body.acceleration[2] == 0.0
            spin, turns = body.v0[2], True
    for i in range(W.bodies):
        body = local[i]
        if supports(body, 0):
            rigid = rigid and not (hangs and (body.v0[0] != vx or body.v0[1] != vy))
            rigid = rigid and body.acceleration[0] == 0.0 and body.acceleration[1] == 0.0
            rigid = rigid and not (hangs and spin != 0.0 and (body.pose[0] != x or body.pose[1] != y))
            x, y, vx, vy, hangs = body.pose[0], body.pose[1], body.v0[0], body.v0[1], True
    if rigid and not hangs:
        _, x, y, vx, vy, _, _ = centre_of(W)
        if not turns and not has_ratio(W):
            spin, _ = spin_about(W, x, y, vx, vy)
    return Frame(rigid and not (spin != 0.0 and has_ratio(W)), hangs, turns, x, y, vx, vy, spin)


@nonallocating
def move_apart(W: Workspace) -> bool:
    """Whether supports move, but not as one: they have no frame, and can do any work."""
    return has_prescribed_motion(W) and not frame_of(W).rigid


@nonallocating
def account_frame(W: Workspace, h: float) -> None:
    """Add the work of moving supports in a solved part h, by the balance of momentum, to RUNG_LEDGER: 0 without a
    frame."""
    if not has_prescribed_motion(W):
        return
    F = frame_of(W)
    if not (F.rigid and (F.hangs or F.turns)):
        return
    wide = 2.0 * math.tan(0.5 * F.spin * h) / h
    x, y = F.x + 0.5 * h * F.vx, F.y + 0.5 * h * F.vy
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        for c in range(3):
            if is_led(body, c):
                speed = wide if body.cayley > 0 else F.spin
                if c == 0:
                    speed = F.vx - wide * (body.pose[1] + 0.5 * body.way[1] - y)
                elif c == 1:
                    speed = F.vy + wide * (body.pose[0] + 0.5 * body.way[0] - x)
                impulse = (body.v1[c] - body.v0[c] - h * body.acceleration[c]) / body.mobility[c]
                W.J.RUNG_LEDGER.frame_work += impulse * speed


@nonallocating
def velocity_in(F: Frame, body: BodyStep, c: int) -> float:
    """Velocity of a frame at the place of a body."""
    if c == 2:
        return F.spin
    return float(F.vx - F.spin * (body.pose[1] - F.y) if c == 0 else F.vy + F.spin * (body.pose[0] - F.x))


@nonallocating
def work_of_change(W: Workspace) -> float:
    """The work of moving supports while velocities change from `v_before` to v0 by impulses of joints."""
    F, work = frame_of(W), 0.0
    if not (F.rigid and (F.hangs or F.turns)):
        return 0.0
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        for c in range(3):
            if is_led(body, c):
                work += (body.v0[c] - body.v_before[c]) * velocity_in(F, body, c) / body.mobility[c]
    return work


@nonallocating
def work_of_shift(W: Workspace) -> float:
    """The work of supports that turn while bodies move from their saved places without a change of velocity: what holds
    them there in the frame is the change of their angular momentum about it."""
    F, turning = frame_of(W), 0.0
    if not (F.rigid and F.hangs):
        return 0.0
    for i in range(W.bodies):
        body = W.J.LOCAL[i]
        if is_led(body, 0):
            x, y = body.pose[0] - body.saved_pose[0], body.pose[1] - body.saved_pose[1]
            turning += (x * (body.v0[1] - F.vy) - y * (body.v0[0] - F.vx)) / body.mobility[0]
    return F.spin * turning


@nonallocating
def relative_energy(W: Workspace, F: Frame, s: float) -> tuple[float, float]:
    """Kinetic energy of the motion relative to a frame; s >= 0: scale this motion by s. Also the work that supports do
    if it vanishes."""
    local, total, work = W.J.LOCAL, 0.0, 0.0
    for i in range(W.bodies):
        for c in range(3):
            if is_led(local[i], c):
                rigid = velocity_in(F, local[i], c)
                off = local[i].v0[c] - rigid
                total += 0.5 * off * off / local[i].mobility[c]
                work -= off * rigid / local[i].mobility[c]
                if s >= 0.0:
                    local[i].v0[c] = rigid + s * off
    return total, work if F.hangs or F.turns else 0.0

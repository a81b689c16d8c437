"""One joint at a time, by closed forms: what holds must hold, what turns must turn as fast as its torque makes it."""

from __future__ import annotations

import math

import numpy as np
import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes import linkages
from scenes.scene import add_box, add_walls

from .case import DT, G, case, go, heavy, matter


def energy(space: pymunk.Space) -> float:
    """Of motion, of gravity, and of springs."""
    held = 0.0
    for c in space.constraints:
        if isinstance(c, pymunk.DampedSpring):
            length = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
            held += 0.5 * c.stiffness * (length - c.rest_length) ** 2
        elif isinstance(c, pymunk.DampedRotarySpring):
            held += 0.5 * c.stiffness * (c.a.angle - c.b.angle - c.rest_angle) ** 2
    return ep.measure(space).energy + held


def apart(space: pymunk.Space) -> float:
    """How far pivots and pins are from what they hold, and ropes longer or shorter than they may be."""
    worst = 0.0
    for c in space.constraints:
        if isinstance(c, pymunk.PivotJoint | pymunk.PinJoint | pymunk.SlideJoint):
            length = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
            if isinstance(c, pymunk.SlideJoint):
                worst = max(worst, length - c.max, c.min - length)
            else:
                worst = max(worst, abs(length - (c.distance if isinstance(c, pymunk.PinJoint) else 0.0)))
    return worst


def past(space: pymunk.Space) -> float:
    """How far bodies have turned past the limits of their joints (rad)."""
    worst = 0.0
    for c in space.constraints:
        if isinstance(c, pymunk.RotaryLimitJoint):
            turned = c.b.angle - c.a.angle
            worst = max(worst, turned - c.max, c.min - turned)
    return worst


def kept(space: pymunk.Space, make: runs.Make, steps: int, scale: float, dt: float = DT) -> float:
    """The largest of how far joints come apart (m, rad) and how far the energy, in units of `scale` (J), is off."""
    stepper, start, worst = make(space), energy(space), 0.0
    for _ in range(steps):
        stepper.step(dt)
        worst = max(worst, apart(space), abs(energy(space) - start) / scale)
    return worst if math.isfinite(worst) else math.inf


def not_gained(space: pymunk.Space, make: runs.Make, steps: int, scale: float, dt: float = DT) -> float:
    """The same where energy may be lost: how far it rises in a step."""
    stepper, before, worst = make(space), energy(space), 0.0
    for _ in range(steps):
        stepper.step(dt)
        now = energy(space)
        worst, before = max(worst, apart(space), past(space), (now - before) / scale), now
    return worst if math.isfinite(worst) else math.inf


def wheel(space: pymunk.Space, x: float = 0.0, moment: float = 0.5) -> pymunk.Body:
    """A body that turns about its centre, which is held."""
    body = pymunk.Body(1.0, moment)
    body.position = (x, 0.0)
    space.add(body, pymunk.PivotJoint(space.static_body, body, (x, 0.0), (0.0, 0.0)))
    return body


@case("pendulum slows (pymunk 216)", "amplitude, energy or length off (relative)", 1e-10)
def pendulum(make: runs.Make) -> float:
    """L = 300, g = 981, from horizontal, 20 s: the height that its energy takes it to, and its rod."""
    space = linkages.pendulum(300.0, 981.0)
    bob, stepper, worst = next(iter(space.bodies)), make(space), 0.0
    for _ in range(1200):
        stepper.step(DT)
        reach = bob.position.y + 0.5 * bob.velocity.length**2 / 981.0
        worst = max(worst, abs(reach) / 300.0, abs(bob.position.length / 300.0 - 1.0))
    return worst


@case("hanging weight", "impulse/dt / (m g) off", 1e-9)
def hanging(make: runs.Make) -> float:
    """By a pin, a pivot and a rope: what breakable joints read."""
    worst = 0.0
    for kind in range(3):
        space = heavy()
        body = pymunk.Body(2.5, 1.0)
        body.position = (0.0, -1.0)
        top = space.static_body
        joint: pymunk.Constraint
        if kind == 0:
            joint = pymunk.PinJoint(top, body, (0.0, 0.0), (0.0, 0.0))
        elif kind == 1:
            joint = pymunk.PivotJoint(top, body, (0.0, 0.0), (0.0, 1.0))
        else:
            joint = pymunk.SlideJoint(top, body, (0.0, 0.0), (0.0, 0.0), 0.0, 1.0)
        space.add(body, joint)
        stepper = go(space, make, 60)  # which holds what `impulse` reads
        worst = max(worst, abs(joint.impulse / DT / (2.5 * G) - 1.0))
        del stepper
    return worst


@case("spring, 100 s", "energy off (relative)", 1e-11)
def spring(make: runs.Make) -> float:
    space = linkages.empty(0.0)
    body = linkages.body(space, 2.0, 1.0, (1.5, 0.0))
    space.add(pymunk.DampedSpring(space.static_body, body, (0.0, 0.0), (0.0, 0.0), 1.0, 30.0, 0.0))
    return kept(space, make, 6000, 0.5 * 30.0 * 0.25)


@case("spring with max_force (Chipmunk2D 245, 248)", "speed after 1 s over F t/m, less 1", 1e-9)
def weak_spring(make: runs.Make) -> float:
    """It would pull with 150 N and may with 2."""
    space = linkages.empty(0.0)
    body = linkages.body(space, 1.0, 1.0, (4.0, 0.0))
    joint = pymunk.DampedSpring(space.static_body, body, (0.0, 0.0), (0.0, 0.0), 1.0, 50.0, 0.0)
    joint.max_force = 2.0
    space.add(joint)
    go(space, make, 60)
    return abs(body.velocity.length / 2.0 - 1.0)


@case("gear under torque", "ratio off (rad)", 1e-12)
def gear(make: runs.Make) -> float:
    """Two wheels, 3 to 1, one of them pulled."""
    space = linkages.empty(0.0)
    a, b = wheel(space), wheel(space, 3.0, 0.2)
    space.add(pymunk.GearJoint(a, b, 0.3, 3.0))
    b.angle = 0.1
    stepper, worst = make(space), 0.0
    for _ in range(300):
        a.torque = 2.0
        stepper.step(DT)
        worst = max(worst, abs(b.angle - (a.angle + 0.3) / 3.0))
    return worst


@case("motor spins up", "rate over F t/I, less 1", 1e-12)
def motor(make: runs.Make) -> float:
    """max_force 1.5 on I = .5: 3 rad/s², until its rate of 4 rad/s is reached, and kept."""
    space = linkages.empty(0.0)
    body = wheel(space)
    drive = pymunk.SimpleMotor(space.static_body, body, -4.0)
    drive.max_force = 1.5
    space.add(drive)
    stepper, worst = make(space), 0.0
    for k in range(1, 121):
        stepper.step(DT)
        worst = max(worst, abs(body.angular_velocity / min(3.0 * k * DT, 4.0) - 1.0))
    return worst


@case("ratchet", "turned back (rad)", 1e-9)
def ratchet(make: runs.Make) -> float:
    """Turned on freely by .9 rad, then back: it stops at the click it has passed, .8."""
    space = linkages.empty(0.0)
    body = wheel(space)
    space.add(pymunk.RatchetJoint(space.static_body, body, 0.0, 0.4))
    body.angular_velocity = 1.8
    stepper = make(space)
    for _ in range(30):
        stepper.step(DT)
    free = abs(body.angle - 0.9)
    body.angular_velocity = -1.0
    lowest = math.inf
    for _ in range(60):
        stepper.step(DT)
        lowest = min(lowest, body.angle)
    return max(free, 0.8 - lowest, abs(body.angle - 0.8))


@case("bead in a groove", "g sin(a) t²/2 off (m)", 1e-11)
def bead(make: runs.Make) -> float:
    """Of 25°, a second; and how far it is from the line."""
    slope = math.radians(25.0)
    along = np.array((math.cos(slope), -math.sin(slope)))
    space = linkages.empty()
    body = linkages.body(space, 3.0, 1.0, (0.0, 0.0))
    space.add(pymunk.GrooveJoint(space.static_body, body, (0.0, 0.0), tuple(9.0 * along), (0.0, 0.0)))
    stepper = make(space)
    worst = 0.0
    for k in range(1, 61):
        stepper.step(DT)
        off = np.array(body.position) - 0.5 * G * math.sin(slope) * (k * DT) ** 2 * along
        worst = max(worst, float(np.hypot(*off)))
    return worst


@case("rope never longer than its max", "longer (relative)", 1e-10)
def rope(make: runs.Make) -> float:
    """A weight thrown about at its end, hung so that it falls a long way first."""
    space = linkages.empty()
    body = linkages.body(space, 5.0, 1.0, (0.3, 1.2))
    body.velocity = (3.0, 2.0)
    joint = pymunk.SlideJoint(space.static_body, body, (0.0, 0.0), (0.0, 0.0), 0.0, 2.0)
    space.add(joint)
    stepper, worst = make(space), 0.0
    for _ in range(600):
        stepper.step(DT)
        worst = max(worst, body.position.length / 2.0 - 1.0)
    return worst


@case("door with a limit", "past the limit (rad), off its hinge (m), or energy risen (relative)", 1e-9)
def door(make: runs.Make) -> float:
    """Two boxes fall on it, and slide off."""
    space = heavy()
    add_walls(space, [((-9.0, -4.0), (9.0, -4.0))])
    leaf = add_box(space, (1.0, 0.0), 2.0, 0.15, 2.0)
    ground = space.static_body
    space.add(
        pymunk.PivotJoint(ground, leaf, (0.0, 0.0), (-1.0, 0.0)), pymunk.RotaryLimitJoint(ground, leaf, -0.3, 0.3)
    )
    add_box(space, (1.2, 0.6), 0.4, 0.4)
    add_box(space, (1.2, 1.1), 0.4, 0.4)
    matter(space, 0.6)
    return not_gained(space, make, 300, 4.0 * G * 5.0)


@case("free jointed pair", "momenta off (relative)", 1e-11)
def pair(make: runs.Make) -> float:
    """A pivot and a damped rotary spring between two bodies that spin: momentum and angular momentum."""
    space = linkages.empty(0.0)
    a, b = linkages.body(space, 1.0, 0.3, (0.1, 0.2), 0.4), linkages.body(space, 2.0, 0.5, (1.0, -0.3), -1.0)
    a.velocity, a.angular_velocity, b.velocity, b.angular_velocity = (0.5, 1.0), 7.0, (-0.2, 0.3), -4.0
    space.add(pymunk.PivotJoint(a, b, (0.5, 0.1)), pymunk.DampedRotarySpring(a, b, 0.2, 3.0, 0.1))

    def momenta() -> np.ndarray:
        now = ep.measure(space)
        return np.array((*now.linear_momentum, now.angular_momentum))

    # Where velocities contradict the joint they are made to fit in the first step, which keeps momenta too.
    start = momenta()
    go(space, make, 1200)
    return float(np.abs(momenta() - start).max()) / 3.0

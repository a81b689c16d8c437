"""Impacts of single bodies and of few: restitution, simultaneous hits, grazing, corners, heavy on light."""

from __future__ import annotations

import math

import numpy as np
import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes.scene import add_disk, add_walls

from .case import DT, G, case, go


def apexes(e: float, make: runs.Make, height: float, radius: float, floor: float, dt: float, bounces: int) -> float:
    """Height of the apex after so many bounces of a disk that starts `height` above the floor's zero."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    ball = add_disk(space, (0.0, height), radius)
    add_walls(space, [((-9.0, floor), (9.0, floor))])
    next(iter(ball.shapes)).elasticity = e
    # Till the middle of the flight after the last bounce.
    fall = math.sqrt(2.0 * (height - radius - floor) / G)
    flights = sum(2.0 * e**k * fall for k in range(1, bounces + 1)) - e**bounces * fall
    go(space, make, max(round((fall + flights) / dt), math.ceil(fall / dt) + 5), dt)
    return float(ball.position.y + 0.5 * ball.velocity.y**2 / G)


@case("bounce height, 100 bounces", "apex off (m)", 1e-9)
def bounce_height(make: runs.Make) -> float:
    return abs(apexes(1.0, make, 2.3, 0.2, 0.1, DT, 100) - 2.3)


@case("restitution 0 to .95", "apex ratio off e²", 1e-9)
def restitution(make: runs.Make) -> float:
    rise = {e: apexes(e, make, 2.3, 0.2, 0.1, DT, 1) - 0.3 for e in (0.0, 0.3, 0.5, 0.8, 0.95)}
    return max(abs(high / 2.0 - e * e) for e, high in rise.items())


@case("high drop, 50 bounces", "apex off (m)", 1e-9)
def high_drop(make: runs.Make) -> float:
    return abs(apexes(1.0, make, 10.0, 0.5, 0.0, 1 / 240, 50) - 10.0)


@case("slow ball, v = 1 to 1e-4", "speed off (relative)", 1e-12)
def slow_ball(make: runs.Make) -> float:
    worst = 0.0
    for v in (1.0, 0.1, 0.01, 1e-4):
        space = pymunk.Space()
        ball = add_disk(space, (-0.5 - 10.3 * v * DT, 0.0), 0.5, velocity=(v, 0.0))
        add_walls(space, [((0.0, -2.0), (0.0, 2.0))])
        go(space, make, 30)
        worst = max(worst, abs(ball.velocity.x / v + 1.0))
    return worst


@case("swap of velocities", "velocity off", 1e-12)
def swap(make: runs.Make) -> float:
    space = pymunk.Space()
    a, b = add_disk(space, (0.0, 0.0), 0.5, 10.0, (1.0, 0.0)), add_disk(space, (1.3, 0.0), 0.5, 10.0)
    go(space, make, 60)
    return abs(a.velocity.x) + abs(b.velocity.x - 1.0)


@case("touching line of three", "off (-2/3, 4/3, 4/3)", 1e-9)
def touching_line(make: runs.Make) -> float:
    space = pymunk.Space()
    line = [add_disk(space, (float(x), 0.0), 0.5, velocity=(2.0 * (x == 0), 0.0)) for x in range(3)]
    go(space, make, 1)
    return float(np.abs([b.velocity.x - v for b, v in zip(line, (-2 / 3, 4 / 3, 4 / 3), strict=True)]).max())


@case("Bernoulli: one onto two", "velocity off", 1e-9)
def bernoulli(make: runs.Make) -> float:
    space = pymunk.Space()
    a = add_disk(space, (-math.sqrt(0.75) - 0.1, 0.0), 0.5, velocity=(2.0, 0.0))
    b, c = add_disk(space, (0.0, 0.5), 0.5), add_disk(space, (0.0, -0.5), 0.5)
    go(space, make, 12)
    v = np.array([x.velocity for x in (a, b, c)])
    y = 1.2 / math.sqrt(3.0)
    return float(np.abs(v - [(-0.4, 0.0), (1.2, y), (1.2, -y)]).max())


@case("seam of two segments", "energy off (relative)", 1e-12)
def seam(make: runs.Make) -> float:
    space = pymunk.Space()
    tilt = math.tan(math.radians(0.25))
    add_walls(space, [((-3.0, 3.0 * tilt), (0.0, 0.0)), ((0.0, 0.0), (3.0, 3.0 * tilt))])
    add_disk(space, (-1.5 * math.sqrt(3.0), 2.0), 0.5, velocity=(math.sqrt(3.0), -1.0))
    go(space, make, 150)
    return abs(ep.measure(space).kinetic / 2.0 - 1.0)


def pi_hits(make: runs.Make, mass: float, dt: float) -> int:
    """Hits of two balls, one of which runs against a wall; a mass ratio of 100^n tells n + 1 digits of pi."""
    space = pymunk.Space()
    small = add_disk(space, (2.0, 0.0), 0.1)
    add_disk(space, (4.0, 0.0), 0.5, mass, (-1.0, 0.0))
    add_walls(space, [((0.0, -1.0), (0.0, 1.0))])
    stepper, hits, before = make(space), 0, small.velocity.x
    for _ in range(round(20.0 / dt)):
        report = stepper.step(dt)
        # Native does not tell its contacts: a step in which the velocity changes is a hit.
        hits += int((report.impulse > 1e-12).sum()) if len(report.impulse) else int(small.velocity.x != before)
        before = small.velocity.x
    return hits


@case("pi, mass ratio 1e4", "hits off 314", 0.0)
def pi_blocks(make: runs.Make) -> float:
    return abs(pi_hits(make, 1e4, 1e-3) - 314)


@case("pi, mass ratio 1e6", "hits off 3141", 0.0)
def pi_blocks_heavy(make: runs.Make) -> float:
    return abs(pi_hits(make, 1e6, 1e-3) - 3141)


@case("tunnelling, v = 5 to 1000", "passed through", 0.0)
def tunnelling(make: runs.Make) -> float:
    passed = 0
    for v in (5.0, 23.0, 50.0, 400.0, 1000.0):
        space = pymunk.Space()
        disk = add_disk(space, (-2.0, 0.0), 0.2, velocity=(v, 0.0))
        add_walls(space, [((0.0, -2.0), (0.0, 2.0))])
        go(space, make, math.ceil(3.0 / (v * DT)))
        passed += disk.velocity.x > 0.0 or disk.position.x > 0.0
    return passed


@case("grazing hits, 1e-9 deep", "missed", 0.0)
def grazing(make: runs.Make) -> float:
    missed = 0
    for depth in (1e-3, 1e-6, 1e-9):
        space = pymunk.Space()
        add_disk(space, (-2.03, 0.0), 0.5, velocity=(3.0, 0.0))
        other = add_disk(space, (0.0, 1.0 - depth), 0.5)
        go(space, make, 80)
        missed += other.velocity.length == 0.0
    return missed


@case("corners of 90°, 60° and 120°", "velocity not reversed", 1e-6)
def corner(make: runs.Make) -> float:
    worst = 0.0
    for degrees in (90.0, 60.0, 120.0):
        # Off the middle of 120°, which does not divide 180°, exact mechanics does not reverse it: two hits, not one.
        for offset in (0.0, 1e-9, 1e-3) if degrees < 120.0 else (0.0,):
            space = pymunk.Space()
            half = math.radians(degrees / 2.0)
            ends = [(4.0 * math.cos(half), s * 4.0 * math.sin(half)) for s in (1.0, -1.0)]
            add_walls(space, [((0.0, 0.0), end) for end in ends])
            disk = add_disk(space, (2.5, offset), 0.2, velocity=(-1.0, 0.0))
            go(space, make, 240)
            worst = max(worst, float(np.hypot(disk.velocity.x - 1.0, disk.velocity.y)))
    return worst


@case("rod onto its corner", "velocity and spin off", 1e-6)
def rod(make: runs.Make) -> float:
    space = pymunk.Space()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    body = pymunk.Body(1.0, (2.0**2 + 0.1**2) / 12.0)
    body.position, body.angle, body.velocity = (0.0, 1.0), math.radians(30.0), (0.0, -1.0)
    box = pymunk.Poly.create_box(body, (2.0, 0.1))
    box.elasticity = 1.0
    space.add(body, box)
    stepper = make(space)
    for _ in range(60):
        stepper.step(DT)
        if body.velocity.y != -1.0:
            break
    return max(abs(body.velocity.y + 0.35829141), abs(abs(body.angular_velocity) - 1.61504207))


@case("thousand contacts on one body", "momentum and energy off", 1e-9)
def thousand(make: runs.Make) -> float:
    space = pymunk.Space()
    big = add_disk(space, (0.0, 0.0), 10.0, 100.0, (1.0, 0.0))
    for a in np.linspace(0.0, 2.0 * math.pi, 1000, endpoint=False):
        add_disk(space, (10.03 * math.cos(a), 10.03 * math.sin(a)), 0.03, 0.01)
    go(space, make, 5)
    now = ep.measure(space)
    momentum = float(now.linear_momentum[0])
    return max(abs(now.energy / 50.0 - 1.0), abs(momentum / 100.0 - 1.0), abs(big.position.y))

"""Impacts with friction, and of bodies that turn: closed forms of rigid impacts."""

from __future__ import annotations

import math

import numpy as np
import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, LONG, G, case, go, heavy, matter

FLOOR = [((-90.0, 0.0), (90.0, 0.0))]


@case("disk hits rough floor, sticks or slips", "velocity and spin off", 1e-12)
def oblique(make: runs.Make) -> float:
    """Sticks iff |u| <= 3 mu (1 + e) v, p_t = -(m/3) u; else p_t = -mu (1 + e) m v sign u."""
    worst = 0.0
    for e in (0.0, 0.5, 0.9, 1.0):
        for mu in (0.1, 0.3, 1.0):
            for vx, spin in ((1.0, 0.0), (0.2, 0.0), (0.0, 7.0), (2.0, -9.0), (-1.0, -0.5)):
                space = pymunk.Space()
                add_walls(space, FLOOR)
                disk = add_disk(space, (0.0, 0.71), 0.5, 1.0, (vx, -1.5))
                disk.angular_velocity = spin
                matter(space, mu, e)
                go(space, make, 20)
                u = vx + 0.5 * spin
                p = -u / 3.0 if abs(u) <= 3.0 * mu * (1.0 + e) * 1.5 else -math.copysign(mu * (1.0 + e) * 1.5, u)
                found = (disk.velocity.x, disk.velocity.y, disk.angular_velocity)
                worst = max(worst, float(np.abs(np.array(found) - (vx + p, 1.5 * e, spin + 4.0 * p)).max()))
    return worst


def spinning_bounces(e: float, mu: float, until: float) -> tuple[float, float]:
    """Place x and spin of a disk (r = .5) let fall from .8 m with spin 10 at .2 m/s, at time `until`; exact."""
    x, vx, spin, t = 0.0, 0.2, 10.0, 0.0
    flight, down = math.sqrt(1.6 / G), math.sqrt(1.6 * G)
    while t + flight < until:
        t += flight
        x += vx * flight
        u = vx + 0.5 * spin
        p = -u / 3.0 if abs(u) <= 3.0 * mu * (1.0 + e) * down else -math.copysign(mu * (1.0 + e) * down, u)
        vx, spin, down = vx + p, spin + 4.0 * p, e * down
        flight = 2.0 * down / G
    return x + vx * (until - t), spin


@case("bounces with spin, any dt", "place and spin off", 1e-9)
def spins(make: runs.Make) -> float:
    worst = 0.0
    for e, mu in ((1.0, 0.1), (0.9, 0.05), (0.8, 0.5)):
        for dt in (1 / 20, 1 / 60, 1 / 1000):
            space = heavy()
            add_walls(space, FLOOR)
            disk = add_disk(space, (0.0, 1.3), 0.5, 1.0, (0.2, 0.0))
            disk.angular_velocity = 10.0
            matter(space, mu, e)
            go(space, make, round(2.0 / dt), dt)
            x, spin = spinning_bounces(e, mu, 2.0)
            worst = max(worst, abs(disk.position.x - x), abs(disk.angular_velocity - spin))
    return worst


@case("rod on its end, 45° and 60°", "velocity and spin off", 1e-9)
def rod_on_its_end(make: runs.Make) -> float:
    """v'/v = -1 + (1 + e)/(1 + 3 c²), spin' l/v = 3 c (1 + e)/(1 + 3 c²)."""
    worst = 0.0
    for degrees in (30.0, 45.0, 60.0, 85.0):
        for e in (0.0, 0.5, 1.0):
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            space = pymunk.Space()
            add_walls(space, FLOOR)
            body = pymunk.Body(1.0, 1.0 / 3.0)
            body.position, body.velocity, body.angle = (0.0, s + 0.1), (0.0, -1.0), math.radians(degrees)
            space.add(body, pymunk.Segment(body, (-1.0, 0.0), (1.0, 0.0), 0.0))
            matter(space, 0.0, e)
            stepper = make(space)
            for _ in range(60):
                stepper.step(1 / 240)
                if body.angular_velocity != 0.0:
                    break
            share = (1.0 + e) / (1.0 + 3.0 * c * c)
            worst = max(worst, abs(body.velocity.y - (share - 1.0)), abs(abs(body.angular_velocity) - 3.0 * c * share))
    return worst


def rests_at(make: runs.Make, e: float, height: float, dt: float) -> float:
    """When a ball that falls from a height comes to rest."""
    space = heavy()
    add_walls(space, FLOOR)
    ball = add_disk(space, (0.0, 0.5 + height), 0.5)
    matter(space, 0.0, e)
    stepper, last = make(space), 0.0
    exact = math.sqrt(2.0 * height / G) * (1.0 + e) / (1.0 - e)
    for k in range(1, round(1.3 * exact / dt) + 10):
        stepper.step(dt)
        if abs(ball.velocity.y) > 1e-6:
            last = k * dt
    return last + dt


@case("rest after bounces, e = .5, .8, .9", "time off (steps)", 1.0)
def rest(make: runs.Make) -> float:
    """t = sqrt(2 h/g) (1 + e)/(1 - e), within a step."""
    worst = 0.0
    for e, height, t in ((0.5, 1.0, 1.354570922957), (0.8, 1.0, 4.063712768871), (0.9, 0.9, 8.1387058006840)):
        for dt in (DT, 1 / 240):
            found = rests_at(make, e, height, dt)
            # Within a step: the first end of a step after that instant, or its neighbours.
            worst = max(worst, abs(found - 0.5 * dt - t) / dt - 0.5)
    return worst


def thing(rng: np.random.Generator, space: pymunk.Space, x: float, y: float) -> pymunk.Body:
    """A disk, box, triangle, capsule or rod of about a metre, turned and spinning at random."""
    kind = int(rng.integers(0, 5))
    mass = float(rng.uniform(0.2, 5.0))
    body = pymunk.Body(mass, mass * float(rng.uniform(0.03, 0.2)))
    shapes: list[pymunk.Shape] = [
        pymunk.Circle(body, 0.4),
        pymunk.Poly.create_box(body, (0.8, 0.4)),
        pymunk.Poly(body, [(-0.4, -0.3), (0.4, -0.3), (0.1, 0.5)]),
        pymunk.Segment(body, (-0.4, 0.0), (0.4, 0.0), 0.15),
        pymunk.Poly.create_box(body, (1.0, 0.05)),
    ]
    shape = shapes[kind]
    body.position, body.angle = (x, y), float(rng.uniform(-math.pi, math.pi))
    body.angular_velocity = float(rng.normal(scale=4.0))
    shape.elasticity, shape.friction = min(1.0, float(rng.uniform(0.0, 2.0))), float(rng.uniform(0.0, 1.5))
    space.add(body, shape)
    return body


@case("random frictional impacts", "energy gained (relative)", 1e-12)
def random_impacts(make: runs.Make) -> float:
    worst, rng = 0.0, np.random.default_rng(7)
    for _ in range(max(1, LONG["random impacts"] // 50)):
        space, pairs = pymunk.Space(), []
        for k in range(50):
            a = thing(rng, space, 100.0 * k, 0.0)
            b = thing(rng, space, 100.0 * k + 1.5, float(rng.uniform(-0.4, 0.4)))
            a.velocity = (float(rng.uniform(2.0, 6.0)), float(rng.normal(scale=2.0)))
            pairs.append((a, b, a.kinetic_energy + b.kinetic_energy))
        go(space, make, 30)
        for a, b, before in pairs:
            worst = max(worst, (a.kinetic_energy + b.kinetic_energy) / before - 1.0)
        # Thin rods on a rough floor at a slant, where Newton's law with Coulomb's gains the most.
        space, rods = pymunk.Space(), []
        add_walls(space, [((-90.0, 0.0), (9000.0, 0.0))])
        for k in range(50):
            rod = add_box(space, (100.0 * k, 1.2), 2.0, 0.02)
            rod.angle, rod.velocity = float(rng.uniform(-1.3, 1.3)), (float(rng.normal(scale=3.0)), -1.0)
            rod.angular_velocity = float(rng.normal())
            rods.append((rod, rod.kinetic_energy))
        matter(space, float(rng.uniform(0.0, 2.0)), float(rng.uniform(0.8, 1.0)))
        stepper = make(space)
        for _ in range(60):
            stepper.step(DT)
            worst = max(worst, max(rod.kinetic_energy / before for rod, before in rods) - 1.0)
    return worst


@case("Painleve's rod, mu = 1.5 at 63°", "energy gained, or not finite", 1e-12)
def painleve(make: runs.Make) -> float:
    """Beyond mu = 4/3 at tan = 2 no force is consistent with sliding; an impulse must do."""
    worst = 0.0
    for degrees, mu, v in ((63.0, 1.5, -3.0), (63.4, 1.4, -1.0), (60.0, 2.5, -4.0), (63.0, 1.5, 3.0)):
        s = math.sin(math.radians(degrees))
        space = heavy()
        add_walls(space, FLOOR)
        body = pymunk.Body(1.0, 1.0 / 3.0)
        body.position, body.velocity, body.angle = (0.0, s), (v, 0.0), math.radians(degrees)
        space.add(body, pymunk.Segment(body, (-1.0, 0.0), (1.0, 0.0), 0.0))
        matter(space, mu)
        stepper, scale = make(space), ep.measure(space).energy
        highest = scale
        for _ in range(60):
            stepper.step(1 / 240)
            now = ep.measure(space).energy
            worst = max(worst, (now - highest) / scale) if math.isfinite(now) else math.inf
            highest = now
        low = min(body.position.y - abs(math.sin(body.angle)), 0.0)
        worst = worst if low > -1e-2 else math.inf
    return worst


@case("one onto two, e = 0, .5, 1 (SCISim)", "v' off .4, .1, -.2", 1e-9)
def three_disks(make: runs.Make) -> float:
    worst = 0.0
    for e, after in ((0.0, 0.4), (0.5, 0.1), (1.0, -0.2)):
        space = pymunk.Space()
        a = add_disk(space, (-math.sqrt(0.75) - 0.1, 0.0), 0.5, velocity=(1.0, 0.0))
        add_disk(space, (0.0, 0.5), 0.5)
        add_disk(space, (0.0, -0.5), 0.5)
        matter(space, 0.0, e)
        go(space, make, 12)
        worst = max(worst, abs(a.velocity.x - after), abs(a.velocity.y))
    return worst


def rock(make: runs.Make, dt: float, theta: float, seconds: float, half: float = 0.25) -> list[float]:
    """Tilts of a rocking block, half sizes `half` x 1, that is let go at theta, at the end of each step."""
    space = heavy()
    add_walls(space, FLOOR)
    body = add_box(space, (0.0, 0.0), 2.0 * half, 2.0)
    matter(space, 5.0)
    alpha = math.atan(half)
    size = math.hypot(half, 1.0)
    # It stands on its right lower corner, which is at the origin; leaning to the right is a negative angle.
    body.position, body.angle = (-size * math.sin(alpha - theta), size * math.cos(alpha - theta)), -theta
    stepper, tilts = make(space), [theta]
    for _ in range(round(seconds / dt)):
        stepper.step(dt)
        tilts.append(-body.angle)
    return tilts


@case("rocking block: quarter period", "off .4938 s (relative)", 1e-3)
def rocking(make: runs.Make) -> float:
    dt, alpha = 1 / 1000, 0.244978663127
    tilts = rock(make, dt, 0.5 * alpha, 0.7)
    first = next((k for k, tilt in enumerate(tilts) if tilt <= 1e-9), len(tilts))
    before = tilts[first - 2] - tilts[first - 1]
    quarter = dt * (first - 1 + tilts[first - 1] / before)
    return abs(quarter / 0.493803215079 - 1.0)


@case("rocking block: next amplitude", "off .7734 (relative)", 1e-2)
def rocks_on(make: runs.Make) -> float:
    alpha = 0.244978663127
    tilts = rock(make, 1 / 1000, 0.5 * alpha, 1.6)
    return abs(-min(tilts) / (0.5 * alpha) / 0.773428933864 - 1.0)


@case("broad block does not rock on", "rocks (rad)", 1e-6)
def does_not_rock(make: runs.Make) -> float:
    """tan >= sqrt(2): the impact takes all."""
    tilts = rock(make, 1 / 240, 0.05, 2.0, 1.5)
    return max(abs(min(tilts)), abs(tilts[-1]))

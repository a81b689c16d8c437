"""Coulomb friction of one body on a plane: closed forms (I = m r²/2 for disks, g = 9.81 m/s²).

Forces are constant within a step, so that only a step in which sliding ends may err, by mu g dt²/8 in place.
"""

from __future__ import annotations

import math

import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, LONG, G, case, go, heavy, matter

Plane = tuple[pymunk.Space, pymunk.Body]  # the body that is on it
FLOOR = [((-50.0, 0.0), (200.0, 0.0))]


def on_plane(slope: float, mu: float, kind: str, velocity: float = 0.0, spin: float = 0.0) -> Plane:
    """A cube of side 1 or a disk of radius .5 on a plane."""
    space = heavy(slope=slope)
    add_walls(space, FLOOR)
    if kind == "box":
        body = add_box(space, (0.0, 0.5), 1.0, 1.0, 1.0, (velocity, 0.0))
    else:
        body = add_disk(space, (0.0, 0.5), 0.5, 1.0, (velocity, 0.0))
    body.angular_velocity = spin
    matter(space, mu)
    return space, body


def after(plane: Plane, make: runs.Make, seconds: float, dt: float = DT) -> pymunk.Body:
    """The body, so much later."""
    go(plane[0], make, round(seconds / dt), dt)
    return plane[1]


@case("block slides down 30°", "way off (relative)", 1e-12)
def slide(make: runs.Make) -> float:
    slope, mu, worst = math.radians(30.0), 0.3, 0.0
    for dt in (1 / 30, 1 / 60, 1 / 1000):
        body = after(on_plane(slope, mu, "box"), make, 1.0, dt)
        way = 0.5 * G * (math.sin(slope) - mu * math.cos(slope))
        worst = max(worst, abs(body.position.x / way - 1.0), abs(body.angle))
    return worst


@case("block on an inclined segment", "way off (relative)", 1e-9)
def inclined(make: runs.Make) -> float:
    slope, mu = math.radians(30.0), 0.3
    space = heavy()
    down, up = (math.cos(slope), -math.sin(slope)), (math.sin(slope), math.cos(slope))
    add_walls(space, [((-9 * down[0], -9 * down[1]), (90 * down[0], 90 * down[1]))])
    body = add_box(space, (0.5 * up[0], 0.5 * up[1]), 1.0, 1.0)
    body.angle = -slope
    matter(space, mu)
    go(space, make, 60)
    way = (body.position.x - 0.5 * up[0]) * down[0] + (body.position.y - 0.5 * up[1]) * down[1]
    return abs(way / (0.5 * G * (math.sin(slope) - mu * math.cos(slope))) - 1.0)


@case("block sticks on 20°, 1e5 steps", "moved (m)", 1e-9)
def stick(make: runs.Make) -> float:
    space, body = on_plane(math.radians(20.0), 0.5, "box")
    go(space, make, LONG["stick"])
    return math.hypot(body.position.x, body.position.y - 0.5)


@case("block on its angle of friction", "moved in 10 s (m)", 1e-9)
def threshold(make: runs.Make) -> float:
    """SCISim: tan slope = mu = .3 must stay; here to one part in 1e6."""
    body = after(on_plane(math.atan(0.3 * (1.0 - 1e-6)), 0.3, "box"), make, 10.0)
    return math.hypot(body.position.x, body.position.y - 0.5)


@case("block topples at tan = width/height", "wrong of 4", 0.0)
def topple(make: runs.Make) -> float:
    wrong = 0
    for ratio, falls in ((0.4995, False), (0.5005, True), (0.49, False), (0.51, True)):
        space = heavy(slope=math.atan(ratio))
        add_walls(space, FLOOR)
        body = add_box(space, (0.0, 0.5), 0.5, 1.0)
        matter(space, 5.0)
        go(space, make, 480)
        wrong += (abs(body.angle) > 0.3) != falls
    return wrong


@case("disk rolls down", "speed off 2/3 g sin t, or lost", 1e-12)
def roll(make: runs.Make) -> float:
    worst = 0.0
    for degrees, mu in ((5.0, 0.1), (30.0, 0.3), (60.0, 0.6)):
        slope = math.radians(degrees)
        space, body = on_plane(slope, mu, "disk")
        go(space, make, 60)
        speed = 2.0 / 3.0 * G * math.sin(slope)
        worst = max(worst, abs(body.velocity.x / speed - 1.0), abs(body.angular_velocity * 0.5 / speed + 1.0))
        worst = max(worst, abs(ep.measure(space).energy / (0.5 * G * math.cos(slope)) - 1.0))
    return worst


@case("disk slips down, tan > 3 mu", "speed and spin off (relative)", 1e-12)
def slip(make: runs.Make) -> float:
    slope, mu = math.radians(50.0), 0.2
    body = after(on_plane(slope, mu, "disk"), make, 1.0)
    speed, spin = G * (math.sin(slope) - mu * math.cos(slope)), -2.0 * mu * G * math.cos(slope) / 0.5
    return max(abs(body.velocity.x / speed - 1.0), abs(body.angular_velocity / spin - 1.0))


def _energy(body: pymunk.Body) -> float:
    return 0.5 * (body.mass * body.velocity.length**2 + body.moment * body.angular_velocity**2)


@case("sliding disk comes to roll", "off 2/3 v, loss off 1/3", 1e-12)
def slide_to_roll(make: runs.Make) -> float:
    worst = 0.0
    for v, dt in ((2.0, 1 / 60), (5.0, 1 / 60), (3.0, 1 / 17)):
        body = after(on_plane(0.0, 0.3, "disk", v), make, 2.0 * v / (3.0 * 0.3 * G), dt)
        worst = max(worst, abs(body.velocity.x / v * 1.5 - 1.0), abs(_energy(body) / (v * v / 3.0) - 1.0))
    return worst


@case("where it comes to roll", "place off / (mu g dt²)", 0.125)
def rolls_from(make: runs.Make) -> float:
    """x = 5 v²/(18 mu g), and 2/3 v from then on."""
    worst = 0.0
    for v, dt in ((2.0, 1 / 60), (3.1, 1 / 60), (2.0, 1 / 240)):
        mu, steps = 0.3, round(1.0 / dt)
        body = after(on_plane(0.0, mu, "disk", v), make, 1.0, dt)
        x = 5.0 * v * v / (18.0 * mu * G) + 2.0 / 3.0 * v * (steps * dt - v / (3.0 * mu * G))
        worst = max(worst, abs(body.position.x - x) / (mu * G * dt * dt))
    return worst


@case("disk with back-spin", "speed and spin left", 1e-12)
def back_spin(make: runs.Make) -> float:
    body = after(on_plane(0.0, 0.3, "disk", 2.0, 8.0), make, 2.0)
    return max(abs(body.velocity.x), abs(body.angular_velocity))


@case("spun disk set down", "speed off omega r/3 (relative)", 1e-12)
def spun(make: runs.Make) -> float:
    body = after(on_plane(0.0, 0.3, "disk", 0.0, -6.0), make, 2.0)
    return abs(body.velocity.x - 1.0)


@case("stopping distance v²/(2 mu g)", "off / (mu g dt²)", 0.1251)
def stopping(make: runs.Make) -> float:
    worst = 0.0
    for mu, way in ((0.2, 1.019367991845), (0.4, 0.509683995923), (0.7, 0.29124799767)):
        for dt in (1 / 60, 1 / 250):
            body = after(on_plane(0.0, mu, "box", 2.0), make, 2.0, dt)
            worst = max(worst, abs(body.position.x - way) / (mu * G * dt * dt))
    return worst


@case("rolling disk, 1000 turns", "speed lost (relative)", 1e-10)
def rolls_on(make: runs.Make) -> float:
    """Rolling without slip loses nothing: a ball that rolls does not stop."""
    body = after(on_plane(0.0, 0.5, "disk", 2.0, -4.0), make, 25.0)
    return max(abs(body.velocity.x / 2.0 - 1.0), abs(body.position.x / 50.0 - 1.0))


@case("ladder at a smooth wall", "wrong of 4, tan = 1/(2 mu)", 0.0)
def ladder(make: runs.Make) -> float:
    """A thin rod of length 2 between a rough floor and a smooth wall stands iff tan >= 1/(2 mu)."""
    wrong = 0
    for mu in (0.3, 0.6):
        for factor, falls in ((1.002, False), (0.998, True)):
            theta = math.atan(factor / (2.0 * mu))
            space = heavy()
            c, s = math.cos(theta), math.sin(theta)
            floor = pymunk.Segment(space.static_body, (-9.0, -1.0), (9.0, -1.0), 1.0)
            wall = pymunk.Segment(space.static_body, (-1.0, 0.0), (-1.0, 9.0), 1.0)
            floor.friction, wall.friction = 1.0, 0.0
            body = pymunk.Body(1.0, 4.0 / 12.0)
            body.position = (c, s)
            rod = pymunk.Segment(body, (-c, s), (c, -s), 0.0)
            rod.friction = mu
            space.add(floor, wall, body, rod)
            go(space, make, 240)
            wrong += (body.position.y < s - 1e-3) != falls
    return wrong

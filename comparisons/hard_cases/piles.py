"""Piles that stand, or fall, by statics: what rests must not move, and what cannot stand must fall."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from comparisons import runs
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, LONG, G, case, go, heavy, matter

FLOOR = [((-99.0, 0.0), (99.0, 0.0))]


def moved(space: pymunk.Space, make: runs.Make, steps: int, dt: float = DT) -> float:
    """The farthest that any body's centre has moved."""
    bodies = list(space.bodies)
    start = np.array([b.position for b in bodies])
    go(space, make, steps, dt)
    found = float(np.hypot(*(np.array([b.position for b in bodies]) - start).T).max())
    return found if math.isfinite(found) else math.inf


def stack_of(masses: list[float], mu: float = 0.5) -> pymunk.Space:
    """Unit boxes on each other, the first at the bottom."""
    space = heavy()
    add_walls(space, FLOOR)
    for k, mass in enumerate(masses):
        add_box(space, (0.0, 0.5 + k), 1.0, 1.0, mass)
    matter(space, mu)
    return space


@case("stack of five boxes, smooth", "moved (m)", 1e-9)
def stack(make: runs.Make) -> float:
    return moved(stack_of([1.0] * 5, 0.0), make, 300)


@case("stack of 10", "moved in 20 s (m)", 1e-6)
def stack_10(make: runs.Make) -> float:
    return moved(stack_of([1.0] * 10), make, 1200)


@case("stack of 50", "moved in 10 s (m)", 1e-6)
def stack_50(make: runs.Make) -> float:
    return moved(stack_of([1.0] * 50), make, 600)


@case("pyramid of 325 boxes", "moved in 10 s (m)", 1e-6)
def pyramid(make: runs.Make) -> float:
    space, rows = heavy(), LONG["pyramid rows"]
    add_walls(space, FLOOR)
    for j in range(rows):
        for i in range(rows - j):
            add_box(space, (1.1 * (i + 0.5 * j), 0.5 + j), 1.0, 1.0)
    matter(space, 0.5)
    return moved(space, make, LONG["pyramid"])


@case("mass ratio 1000, both orders", "moved in 5 s (m)", 1e-6)
def heavy_on_light(make: runs.Make) -> float:
    masses = [1.0, 10.0, 100.0, 1000.0]
    return max(moved(stack_of(order), make, 300) for order in (masses, masses[::-1], [1.0, 1000.0]))


@case("force on the floor = weight", "off (relative)", 1e-9)
def weight(make: runs.Make) -> float:
    """Impulses at the floor in a step, of a stack, and of a disk in a V of 45°."""
    worst = 0.0
    space = stack_of([3.0, 1.0, 2.0])
    disk = heavy()
    add_walls(disk, [((-3.0, 3.0), (0.0, 0.0)), ((0.0, 0.0), (3.0, 3.0))])
    add_disk(disk, (0.0, math.sqrt(0.5)), 0.5, 2.0)
    matter(disk, 0.0)
    for at, pull in ((space, 6.0 * G), (disk, 2.0 * G * math.sqrt(2.0))):
        stepper = make(at)
        for _ in range(60):
            report = stepper.step(DT)
        if len(report.contacts):
            fixed = np.array([b.body_type == pymunk.Body.STATIC for b in report.contacts.bodies])
            floor = fixed[report.contacts.body_a] | fixed[report.contacts.body_b]
            found = float(report.impulse[floor].sum())
        else:
            # Native's arbiters.
            found = sum(_impulse(body) for body in at.bodies)
        worst = max(worst, abs(found / DT / pull - 1.0))
    return worst


def _impulse(body: pymunk.Body) -> float:
    found: list[float] = []

    def note(arbiter: pymunk.Arbiter) -> None:
        if any(s.body is not None and s.body.body_type == pymunk.Body.STATIC for s in arbiter.shapes):
            found.append(arbiter.total_impulse.length)

    body.each_arbiter(note)
    return sum(found)


@case("overhang of five bricks", "wrong of 2: stands .999, falls 1.001", 0.0)
def overhang(make: runs.Make) -> float:
    """Harmonic: .5, .75, .916667, 1.041667, 1.141667 lengths."""
    wrong = 0
    for factor, falls in ((0.999, False), (1.001, True)):
        space = heavy()
        add_walls(space, [((-3.0, 0.0), (0.0, 0.0))])
        x, bricks = 0.0, []
        # From the bottom: brick k from the top overhangs what is below it by 1/(2 k).
        for level, k in enumerate((5, 4, 3, 2, 1)):
            x += factor * 0.5 / k
            bricks.append(add_box(space, (x - 0.5, 0.1 + 0.2 * level), 1.0, 0.2))
        matter(space, 0.8)
        wrong += (moved(space, make, 180) > 1e-3) != falls
    return wrong


@case("pile of three disks", "wrong of 3: mu = .268 and .0893", 0.0)
def three_disks(make: runs.Make) -> float:
    """Stands iff mu >= tan 15° between disks and >= a third of that at the floor."""
    wrong, between, below = 0, 0.2679491924, 0.0893163975
    for a, b, falls in ((1.002, 1.002, False), (0.99, 1.1, True), (1.1, 0.99, True)):
        space = heavy()
        floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
        space.add(floor)
        for where in ((-0.5, 0.5), (0.5, 0.5), (0.0, 0.5 + math.sqrt(0.75))):
            add_disk(space, where, 0.5)
        matter(space, a * between)
        floor.friction = b * below / math.sqrt(a * between)
        wrong += (moved(space, make, 180) > 1e-3) != falls
    return wrong


def arch_of(thickness: float, blocks: int = 20) -> pymunk.Space:
    """A half circle of wedges, mean radius 1."""
    space = heavy()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    inner, outer = 1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness
    for k in range(blocks):
        a, b = math.pi * k / blocks, math.pi * (k + 1) / blocks
        corners = [(r * math.cos(t), r * math.sin(t)) for r, t in ((inner, a), (outer, a), (outer, b), (inner, b))]
        corners = [(x, 0.0 if abs(y) < 1e-12 else y) for x, y in corners]
        body = pymunk.Body()
        shape = pymunk.Poly(body, corners)
        shape.density = 1.0
        space.add(body, shape)
        # The body's place is its centre of mass.
        centre = shape.center_of_gravity
        space.remove(body, shape)
        body = pymunk.Body()
        body.position = centre
        shape = pymunk.Poly(body, [(x - centre.x, y - centre.y) for x, y in corners])
        shape.density = 1.0
        space.add(body, shape)
    matter(space, 1.0)
    return space


@case("half-circle arch, t/R = .12 and .09", "wrong of 2", 0.0)
def arch(make: runs.Make) -> float:
    """Stands above t/R = .1075, falls below (joints where it breaks: at the crown and 54° from it)."""
    return sum((moved(arch_of(t), make, 240) > 1e-3) != falls for t, falls in ((0.12, False), (0.09, True)))


def card_house(levels: int = 3) -> pymunk.Space:
    """Tents of two rounded cards each at 60°, a plank over the tents of each level."""
    space, r, length, tilt = heavy(), 0.02, 1.0, math.radians(60.0)
    c, s = length * math.cos(tilt), length * math.sin(tilt)
    add_walls(space, FLOOR)
    pitch = 2.0 * (c + 2.0 * r) + 0.1

    def card(ax: float, ay: float, bx: float, by: float) -> None:
        half = 0.5 * math.hypot(bx - ax, by - ay)
        body = pymunk.Body(half, half * (half * half / 3.0 + r * r / 4.0))
        body.position, body.angle = (0.5 * (ax + bx), 0.5 * (ay + by)), math.atan2(by - ay, bx - ax)
        space.add(body, pymunk.Segment(body, (-half, 0.0), (half, 0.0), r))

    y = r
    for level in range(levels):
        tents = levels - level
        middles = [pitch * (k - 0.5 * (tents - 1)) for k in range(tents)]
        for x in middles:
            card(x - r - c, y, x - r, y + s)
            card(x + r + c, y, x + r, y + s)
        if level < levels - 1:
            card(middles[0] - 0.1, y + s + 2.0 * r, middles[-1] + 0.1, y + s + 2.0 * r)
        y += s + 4.0 * r
    matter(space, 0.8)
    return space


@case("card house of 3 levels", "moved in 5 s (m)", 1e-6)
def cards(make: runs.Make) -> float:
    return moved(card_house(), make, 300)

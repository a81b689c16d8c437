"""What needs no literature: a scene and its mirror image, in other units, order or frame, are the same."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes.scene import FloatArray, add_box, add_disk

from .case import DT, LONG, G, case, go, matter
from .oblique import thing


@dataclass(frozen=True)
class View:
    """How a scene is looked at: units, side, speed of the frame, order in which bodies are added."""

    unit: float = 1.0
    side: float = 1.0
    drift: float = 0.0
    order: int = 1


def tumble(make: runs.Make, view: View, steps: int = 40, elasticity: float = 0.4) -> FloatArray:
    """(n, 3) places and angles of boxes and disks that fall on a rough floor, as seen in the plain view."""
    unit, side = view.unit, view.side
    space = pymunk.Space()
    space.gravity = (0.0, -G * unit)
    floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    floor.velocity = (view.drift * unit, 0.0)
    space.add(floor, pymunk.Segment(floor, (-50.0 * unit, 0.0), (50.0 * unit, 0.0), 0.0))
    bodies = {}
    for k in list(range(6))[:: view.order]:
        x, y, vx = 1.7 * k + 0.05 * (k % 3), 0.8 + 0.17 * k, 1.1 * (k - 2)
        mass = 1.0 + 0.3 * k
        at, v = (side * x * unit, y * unit), ((side * vx + view.drift) * unit, -0.4 * unit)
        if k % 2:
            body = add_disk(space, at, 0.4 * unit, mass, v)
        else:
            body = add_box(space, at, 0.9 * unit, 0.5 * unit, mass, v)
        body.angle, body.angular_velocity = side * 0.3 * k, side * (1.5 - k)
        bodies[k] = body
    matter(space, 0.4, elasticity)
    go(space, make, steps)
    shift = view.drift * steps * DT
    found = [
        (side * (b.position.x / unit - shift), b.position.y / unit, side * b.angle) for _, b in sorted(bodies.items())
    ]
    return np.array(found)


def differ(make: runs.Make, *views: View) -> float:
    """By how much a scene differs from itself in other views."""
    plain = tumble(make, View())
    return max(float(np.abs(tumble(make, view) - plain).max()) for view in views)


@case("friction: mirror image", "paths differ (m)", 1e-9)
def mirror(make: runs.Make) -> float:
    return differ(make, View(side=-1.0))


@case("friction: units 1e-3 and 1e3", "paths differ (relative)", 1e-9)
def units(make: runs.Make) -> float:
    return differ(make, View(unit=1e-3), View(unit=1e3))


@case("friction: order of insertion", "paths differ (m)", 1e-9)
def order(make: runs.Make) -> float:
    return differ(make, View(order=-1))


@case("friction: moving frame (Galilei)", "paths differ (m)", 1e-9)
def frame(make: runs.Make) -> float:
    return differ(make, View(drift=3.0), View(drift=-0.7))


def cluster(seed: int, mu: float, e: float) -> pymunk.Space:
    """Disks and boxes that fly at each other, free of walls."""
    rng, space = np.random.default_rng(seed), pymunk.Space()
    for k in range(12):
        where = (1.1 * (k % 4) - 1.6, 1.1 * (k // 4) - 1.1)
        body = add_disk(space, where, 0.4) if k % 3 else add_box(space, where, 0.7, 0.5)
        body.velocity = (-1.5 * where[0] + float(rng.normal()), -1.5 * where[1] + float(rng.normal()))
        body.angular_velocity = float(rng.normal(scale=3.0))
    matter(space, mu, e)
    return space


def whirl(space: pymunk.Space) -> tuple[float, float]:
    """Angular momentum about the origin, and the sum of its parts' sizes."""
    bodies = space.bodies
    parts = [b.mass * b.position.cross(b.velocity) for b in bodies] + [b.moment * b.angular_velocity for b in bodies]
    return math.fsum(parts), math.fsum(map(abs, parts))


@case("frictional gas, free cluster", "angular momentum off", 1e-12)
def free_cluster(make: runs.Make) -> float:
    worst = 0.0
    for seed, mu, e in ((0, 0.5, 0.8), (1, 1.0, 0.3), (2, 0.2, 1.0), (3, 0.6, 0.0)):
        space = cluster(seed, mu, e)
        start, scale = whirl(space)
        go(space, make, 120)
        worst = max(worst, abs(whirl(space)[0] - start) / scale)
    return worst


@case("frictional gas, dt 1/1000 to 1/20", "paths differ (m)", 1e-9)
def any_dt(make: runs.Make) -> float:
    ends = []
    for dt in (1 / 20, 1 / 60, 1 / 1000):
        space = cluster(4, 0.3, 0.9)
        go(space, make, round(0.4 / dt), dt)
        ends.append(np.array([(*b.position, b.angle) for b in space.bodies]))
    return float(max(np.abs(end - ends[0]).max() for end in ends))


def rack(side: float, friction: float) -> pymunk.Space:
    """Fifteen balls that touch, and a cue ball with spin; `side` = -1 is the mirror image."""
    space, r = pymunk.Space(), 0.03
    cue = add_disk(space, (-0.4, side * 0.004), r, 0.17, (6.0, 0.0))
    cue.angular_velocity = side * 40.0
    for row in range(5):
        for k in range(row + 1):
            # Clear of each other by less than any size that matters, so that impacts follow one another.
            add_disk(space, (row * 1.7321 * r, side * (2.0 * k - row) * r * 1.0001), r, 0.17)
    matter(space, friction, 0.95)
    return space


@case("billiard break with spin", "angular momentum off", 1e-12)
def break_with_spin(make: runs.Make) -> float:
    space = rack(1.0, 0.06)
    start, scale = whirl(space)
    go(space, make, 200, 1e-3)
    return abs(whirl(space)[0] - start) / scale


@case("random lossy scenes with friction", "energy rise (relative)", 1e-9)
def random_scenes(make: runs.Make) -> float:
    """Bodies that turn fall on a floor between walls: energy never rises in a step."""
    worst = 0.0
    for seed in range(LONG["random scenes"]):
        rng, space = np.random.default_rng(seed), pymunk.Space()
        space.gravity = (0.0, -G)
        for a, b in (((-4.0, 0.0), (4.0, 0.0)), ((-4.0, 0.0), (-4.0, 20.0)), ((4.0, 0.0), (4.0, 20.0))):
            wall = pymunk.Segment(space.static_body, a, b, 0.0)
            wall.elasticity, wall.friction = float(rng.uniform(0.0, 1.0)), float(rng.uniform(0.0, 1.5))
            space.add(wall)
        for k in range(int(rng.integers(1, 10))):
            body = thing(rng, space, -2.6 + 1.3 * (k % 5), 0.9 + 1.3 * (k // 5))
            body.velocity = (float(rng.normal(scale=2.0)), float(rng.normal(scale=2.0)))
        worst = max(worst, rise(space, make, 90))
    return worst


def rise(space: pymunk.Space, make: runs.Make, steps: int) -> float:
    """The largest rise of the energy in a step, relative to the energy at the start."""
    stepper, before, worst = make(space), ep.measure(space).energy, 0.0
    scale = abs(before)
    for _ in range(steps):
        stepper.step(DT)
        now = ep.measure(space).energy
        if not math.isfinite(now):
            return math.inf
        worst, before = max(worst, (now - before) / scale), now
    return worst

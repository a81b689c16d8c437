"""Crowds whose steps end early: the part of its time that each takes, what a step costs, whether it is solved.

A step ends early when its budget of work is spent (`report.unmet`: `solves`): energy and momentum hold, but bodies move
as in slow motion. A body that falls beside the crowd tells how much time was taken. A step of up to 200 bodies may
take 20 ms or 100 steps of pymunk, whichever is more.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from functools import partial
from random import Random

import numpy as np
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons.hard_cases.case import matter
from comparisons.output import Output, Row
from scenes import linkages
from scenes.scene import add_walls

G = 9.81
STEPS = 240
RUNS = 2
SPANS = (1 / 60, 1 / 30)  # s


def container(half: float, high: float, friction: float = 0.5, elasticity: float = 0.1) -> pymunk.Space:
    """A space with a floor and two walls, 2 `half` apart."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    left, right = (-half, 0.0), (half, 0.0)
    add_walls(space, [(left, right), (left, (-half, high)), (right, (half, high))])
    for wall in space.shapes:
        wall.friction, wall.elasticity = friction, elasticity
    return space


def put(
    space: pymunk.Space, make: Callable[[pymunk.Body], pymunk.Shape], place: tuple[float, float], mass: float = 1.0,
    angle: float = 0.0, friction: float = 0.5, elasticity: float = 0.1,
) -> pymunk.Body:  # fmt: skip
    """Add a body with one shape, which gives it mass and moment."""
    body = pymunk.Body()
    body.position, body.angle = place, angle
    shape = make(body)
    shape.mass, shape.friction, shape.elasticity = mass, friction, elasticity
    space.add(body, shape)
    return body


def _polygon(corners: list[tuple[float, float]], body: pymunk.Body) -> pymunk.Shape:
    return pymunk.Poly(body, corners)


def needles(count: int = 80) -> pymunk.Space:
    """Triangles, 2 long, of heights from 1e-4 to .1."""
    chance, space = Random(count), container(4.0, 80.0, 0.4)
    for i in range(count):
        corners = [(-1.0, 0.0), (1.0, 0.0), (chance.uniform(-0.9, 0.9), 10.0 ** chance.uniform(-4.0, -1.0))]
        place = -2.8 + (i % 3) * 2.15, 1.2 + (i // 3) * 0.9
        put(space, partial(_polygon, corners), place, angle=chance.uniform(0.0, 6.28), friction=0.4)
    return space


def rods(count: int = 200) -> pymunk.Space:
    """Segments of radius 0, 1.8 long, that spin as they fall."""
    chance, space = Random(count), container(4.0, 90.0, 0.4)
    for i in range(count):
        place, angle = (-2.9 + (i % 3) * 2.05, 1.2 + (i // 3) * 0.95), chance.uniform(0.0, 6.28)
        body = put(space, lambda b: pymunk.Segment(b, (-0.9, 0.0), (0.9, 0.0), 0.0), place, angle=angle, friction=0.4)
        body.moment, body.angular_velocity = 0.27, chance.uniform(-9.0, 9.0)
    return space


def polygons(count: int = 150) -> pymunk.Space:
    """Regular polygons of 3 to 8 corners, masses from 1 to 10 000."""
    chance, space = Random(count), container(5.0, 100.0)
    for i in range(count):
        n, size = chance.randint(3, 8), chance.uniform(0.3, 0.55)
        corners = [(size * math.cos(math.tau * k / n), size * math.sin(math.tau * k / n)) for k in range(n)]
        place = -4.3 + (i % 8) * 1.22, 0.7 + (i // 8) * 1.25
        mass, angle = 10.0 ** chance.uniform(0.0, 4.0), chance.uniform(0.0, 3.0)
        put(space, partial(_polygon, corners), place, mass, angle)
    return space


def net(count: int = 60, stiffness: float = 500.0) -> pymunk.Space:
    """Disks in rows of nine, with springs to their neighbours, and six boxes that fall on them."""
    chance, space = Random(1), container(5.0, 60.0, elasticity=0.0)
    disks: list[pymunk.Body] = []
    for i in range(count):
        place, mass = (-4.2 + (i % 9) * 1.05, 0.8 + i // 9), chance.choice((0.3, 1.0, 3.0))
        disks.append(put(space, lambda b: pymunk.Circle(b, 0.35), place, mass, elasticity=0.0))
        for other in ((disks[-2],) if i % 9 else ()) + ((disks[-10],) if i >= 9 else ()):
            space.add(pymunk.DampedSpring(other, disks[-1], (0.0, 0.0), (0.0, 0.0), 1.0, stiffness, 1.0))
    for i in range(6):
        put(space, lambda b: pymunk.Poly.create_box(b, (1.0, 1.0)), (-3.0 + 1.2 * i, 20.0), 5.0, elasticity=0.0)
    return space


def chains(count: int = 12, links: int = 5, most: float = math.inf) -> pymunk.Space:
    """Chains of rods on pivots, with a `max_force` of `most`, that fall on each other, and ten disks on them."""
    chance, space = Random(3), container(6.0, 80.0, elasticity=0.0)
    for k in range(count):
        x, y = -5.0 + (k % 4) * 2.9, 1.0 + (k // 4) * 0.7
        bodies = [
            put(space, lambda b: pymunk.Segment(b, (-0.22, 0.0), (0.22, 0.0), 0.08), (x + 0.5 * i, y), elasticity=0.0)
            for i in range(links)
        ]
        for i, (a, b) in enumerate(itertools.pairwise(bodies)):
            pivot = pymunk.PivotJoint(a, b, (x + 0.5 * i + 0.25, y))
            pivot.collide_bodies, pivot.max_force = False, most
            space.add(pivot)
    for k in range(10):
        place, mass = (chance.uniform(-4.0, 4.0), 12.0 + 1.3 * k), chance.choice((1.0, 20.0))
        put(space, lambda b: pymunk.Circle(b, 0.5), place, mass, elasticity=0.0)
    return space


def slack_rope(bars: int) -> pymunk.Space:
    """A rope of bars, whose ends slides of length 0 to .03 join, that falls over disks."""
    space = linkages.empty(10.0)
    last = None
    for k in range(bars):
        bar = pymunk.Body(0.1, pymunk.moment_for_segment(0.1, (-0.1, 0.0), (0.1, 0.0), 0.03))
        bar.position = 0.22 * k - 0.11 * bars, 1.5 + 0.01 * math.sin(7.0 * k)
        space.add(bar, pymunk.Segment(bar, (-0.1, 0.0), (0.1, 0.0), 0.03))
        if last is not None:
            joint = pymunk.SlideJoint(last, bar, (0.1, 0.0), (-0.1, 0.0), 0.0, 0.03)
            joint.collide_bodies = False
            space.add(joint)
        last = bar
    for k in range(5):
        space.add(pymunk.Circle(space.static_body, 0.3, (0.9 * k - 1.8, 0.5 * math.sin(3.0 * k))))
    space.add(pymunk.Segment(space.static_body, (-30.0, -1.2), (30.0, -1.2), 0.1))
    for shape in space.shapes:
        shape.friction = 0.5
    return space


def cloth(side: int, friction: float = 0.5) -> pymunk.Space:
    """A cloth of side² knots that falls over a disk."""
    space = linkages.draped(side)
    matter(space, friction)
    return space


CROWDS: dict[str, Callable[[], pymunk.Space]] = {
    "needles": needles, "rods of radius 0": rods, "polygons, 1 : 10 000": polygons, "net of springs": net,
    "net of 180": lambda: net(180), "chains": chains, "chains, bounded pivots": lambda: chains(most=300.0),
    "36 chains": lambda: chains(36), "36 chains, bounded": lambda: chains(36, most=300.0),
    "12 chains of 15": lambda: chains(12, 15), "6 chains of 30": lambda: chains(6, 30),
    "rope of 90 slack links": lambda: slack_rope(90), "rope of 180": lambda: slack_rope(180),
    "cloth of 81 knots": lambda: cloth(9), "cloth of 121, smooth": lambda: cloth(11, 0.0),
    "cloth of 144, smooth": lambda: cloth(12, 0.0), "cloth of 196": lambda: cloth(14),
}  # fmt: skip


def play(make: Callable[[], pymunk.Space], dt: float, steps: int = STEPS) -> Row:
    """The part of its time that a crowd takes, in all steps and in the last third of these; the part of steps that
    converge; the mean and the longest processor time of a step (ms, the least of RUNS runs of each step), and what a
    step may take: 20 ms or 100 times the mean of pymunk's."""
    taken, converged = np.empty(steps), 0
    spent, theirs, bodies = np.full(steps, np.inf), np.full(steps, np.inf), 0
    for _ in range(RUNS):
        space, native = make(), make()
        bodies = len(native.bodies)
        clock = pymunk.Body(1.0, 1.0)
        clock.position = 1e4, 0.0
        space.add(clock, pymunk.Circle(clock, 0.1))
        stepper, other, converged = ep.EECA(space), ep.Native(native), 0
        for k in range(steps):
            before, begun = clock.velocity.y, time.thread_time()
            report = stepper.step(dt)
            spent[k] = min(spent[k], time.thread_time() - begun)
            taken[k] = (clock.velocity.y - before) / (space.gravity.y * dt)
            converged += report.converged
            begun = time.thread_time()
            other.step(dt)
            theirs[k] = min(theirs[k], time.thread_time() - begun)
    return {
        "bodies": bodies, "1/dt": round(1.0 / dt), "taken": float(np.mean(taken)),
        "in the last third": float(np.mean(taken[-(steps // 3) :])), "converged": converged / steps,
        "ms/step": 1e3 * float(np.mean(spent)), "worst ms": 1e3 * float(np.max(spent)),
        "allowed ms": max(20.0, 100e3 * float(np.mean(theirs))),
    }  # fmt: skip


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV."""
    output.parameters({"steps": STEPS, "runs": RUNS})
    cases = list(itertools.product(CROWDS, SPANS))
    rows: list[Row] = [{"crowd": name, **play(CROWDS[name], dt)} for name, dt in tqdm(cases, unit="run")]
    output.table(f"Crowds, {STEPS} steps", rows)

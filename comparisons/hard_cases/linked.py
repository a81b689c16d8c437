"""Chains, linkages, bridges and figures: joints hold, and energy is not made, however the bodies are thrown about."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pymunk

from comparisons import runs
from scenes import linkages, linked, rods
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, G, case, go, heavy, matter
from .joints import apart, kept, not_gained
from .piles import FLOOR

BOTH = "joints apart (m, rad) or energy risen (relative)"


@case("double pendulum, 20 s (matter-js 423)", "joints apart (m) or energy off (relative)", 1e-10)
def double(make: runs.Make) -> float:
    return kept(linked.double_pendulum().space, make, 1200, 4.0 * G)


@case("four-bar with redundant rows", "joints apart (m) or energy off (relative)", 1e-10)
def four_bar(make: runs.Make) -> float:
    """Three cranks on one rod turn over for 10 s: three rows more than it needs."""
    return kept(linkages.braced_four_bar(), make, 600, 3.0 * G)


@case("chain with a heavy end, 1:1000 (box2d 246)", "joints apart (m) or energy off (relative)", 1e-9)
def heavy_end(make: runs.Make) -> float:
    return kept(linkages.chain(20, 1000.0, 0.5), make, 180, 1000.0 * G * 20.0)


@case("chain of 20 swings", "joints apart (m) or energy off (relative)", 1e-10)
def chain(make: runs.Make) -> float:
    return kept(linkages.chain(20, lean=0.3), make, 300, 20.0 * G * 10.0)


@case("cradle on rods, 10 s", "energy off, or the inner balls move (relative)", 1e-3)
def cradle(make: runs.Make) -> float:
    """Gaps of 1e-6 between five balls: for a swing of the last one the inner three hang still, but for the gaps."""
    scene = rods.cradle()
    space, worst = scene.space, 0.0
    stepper = make(space)
    for k in range(70):
        stepper.step(DT)
        if k > 35:  # the first has hit
            worst = max(worst, *(b.velocity.length for b in scene.bodies[1:4]))
    return max(worst / math.sqrt(2.0 * G), kept(space, make, 530, G))


@case("chain that falls and lies on the ground", BOTH, 1e-9)
def lying(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    last, half = None, 0.25
    for i in range(20):
        link = add_box(space, (0.5 * i * math.cos(0.4), 0.6 + 0.5 * i * math.sin(0.4)), 0.5, 0.1)
        link.angle = 0.4
        if last is not None:
            space.add(pymunk.PivotJoint(last, link, (half, 0.0), (-half, 0.0)))
        last = link
    together(space)
    matter(space, 0.5)
    return not_gained(space, make, 300, 20.0 * G * 4.0)


@case("chain that lies on the ground rests", "moved in 3 s (m)", 1e-9)
def rests(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    links = [add_box(space, (0.5 * i, 0.05), 0.5, 0.1) for i in range(10)]
    for a, b in itertools.pairwise(links):
        space.add(pymunk.PivotJoint(a, b, (0.25, 0.0), (-0.25, 0.0)))
    together(space)
    matter(space, 0.5)
    start = np.array([b.position for b in links])
    go(space, make, 180)
    return float(np.hypot(*(np.array([b.position for b in links]) - start).T).max())


@case("bridge with boxes", BOTH, 1e-9)
def bridge(make: runs.Make) -> float:
    """Twelve planks that sag between two banks, and six boxes that fall on them."""
    space = heavy()
    deck(space, 11.5)
    together(space)
    for i in range(6):
        add_box(space, (-2.5 + i, 0.5 + 0.1 * i), 0.6, 0.6)
    matter(space, 0.5)
    return not_gained(space, make, 300, 18.0 * G)


@case("bridge exactly as long as its gap", "a box of five planks' mass in it (m)", 1e-3)
def taut_bridge(make: runs.Make) -> float:
    """To first order nothing holds it: only the pull of the planks, which turns as they do. The box is put on it."""
    space, worst = heavy(), 0.0
    planks = deck(space, 12.0)
    together(space)
    box = add_box(space, (0.0, 0.4), 0.6, 0.6, 5.0)
    matter(space, 0.5)
    stepper = make(space)
    for _ in range(300):
        stepper.step(DT)
        for x in np.linspace(-0.3, 0.3, 7):
            corner = box.local_to_world((float(x), -0.3))
            for at in (plank.world_to_local(corner) for plank in planks):
                worst = max(worst, 0.1 - at.y if abs(at.x) <= 0.5 else 0.0)
    return worst


def deck(space: pymunk.Space, span: float) -> list[pymunk.Body]:
    """Twelve planks of 1 m on pivots between two banks that are `span` apart, on an arc."""
    bodies, planks = [], 12
    low, high = 0.0, 0.5
    for _ in range(60 if span < planks else 0):
        bend = 0.5 * (low + high)
        low, high = (bend, high) if np.cos((np.arange(planks) - 5.5) * bend).sum() > span else (low, bend)
    before, anchor, place = space.static_body, (-0.5 * span, 0.0), np.array((-0.5 * span, 0.0))
    for k in range(planks):
        angle = (k - 5.5) * low
        along = np.array((math.cos(angle), math.sin(angle)))
        middle = place + 0.5 * along
        plank = add_box(space, (float(middle[0]), float(middle[1])), 1.0, 0.2)
        plank.angle = angle
        space.add(pymunk.PivotJoint(before, plank, anchor, (-0.5, 0.0)))
        bodies.append(plank)
        before, anchor, place = plank, (0.5, 0.0), place + along
    space.add(pymunk.PivotJoint(before, space.static_body, anchor, (0.5 * span, 0.0)))
    return bodies


@case("ragdoll falls on stairs", "joints apart (m)", 1e-9)
def ragdoll(make: runs.Make) -> float:
    space, worst = figure_on_stairs(), 0.0
    stepper = make(space)
    for _ in range(300):
        stepper.step(DT)
        worst = max(worst, apart(space))
    return worst


@case("ragdoll's limits", "past a limit (rad) or energy risen (relative)", 1e-9)
def limits(make: runs.Make) -> float:
    return not_gained(figure_on_stairs(), make, 300, 11.0 * G * 8.0)


def figure_on_stairs() -> pymunk.Space:
    """Ten parts on pivots with limits, above stairs."""
    space = heavy()
    add_walls(space, [((-60.0, -6.0), (60.0, -6.0))])
    for k in range(8):
        edge, top = -4.0 + 1.2 * k, -0.7 * k
        space.add(pymunk.Poly(space.static_body, [(-6.0, -6.0), (edge, -6.0), (edge, top), (-6.0, top)]))
    x, y = -5.0, 2.2
    torso, head = add_box(space, (x, y), 0.5, 1.0, 4.0), add_disk(space, (x, y + 0.75), 0.22)
    joined(space, torso, head, (0.0, 0.5), (0.0, -0.25), (-0.5, 0.5))
    for side in (-1.0, 1.0):
        upper = add_box(space, (x + 0.3 * side, y + 0.2), 0.15, 0.5, 0.6)
        lower = add_box(space, (x + 0.3 * side, y - 0.3), 0.13, 0.5, 0.5)
        thigh = add_box(space, (x + 0.15 * side, y - 0.8), 0.2, 0.6, 1.2)
        shank = add_box(space, (x + 0.15 * side, y - 1.4), 0.16, 0.6, 0.8)
        joined(space, torso, upper, (0.3 * side, 0.45), (0.0, 0.25), (-1.5, 1.5))
        joined(space, upper, lower, (0.0, -0.25), (0.0, 0.25), (0.0, 2.0))
        joined(space, torso, thigh, (0.15 * side, -0.5), (0.0, 0.3), (-0.8, 1.2))
        joined(space, thigh, shank, (0.0, -0.3), (0.0, 0.3), (-1.8, 0.0))
    for body in space.bodies:
        body.velocity = (2.5, 0.0)
    together(space)
    matter(space, 0.4)
    return space


def joined(
    space: pymunk.Space, a: pymunk.Body, b: pymunk.Body, at_a: tuple[float, float], at_b: tuple[float, float],
    limits: tuple[float, float],
) -> None:  # fmt: skip
    """A pivot that turns only so far."""
    space.add(pymunk.PivotJoint(a, b, at_a, at_b), pymunk.RotaryLimitJoint(a, b, *limits))


def together(space: pymunk.Space) -> None:
    """The bodies that are there pass through each other."""
    for shape in space.shapes:
        if shape.body is not space.static_body:
            shape.filter = pymunk.ShapeFilter(group=1)

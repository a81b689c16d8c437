"""Where joints meet contacts: named scenes, and ropes without slack under loads; each measure by its law."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from comparisons import program_joints
from comparisons.hard_cases import joints
from comparisons.output import Row

DT = 1 / 60
G = 9.81
UNMET, APART, WORK, THROUGH = 0.01, 1e-9, 1e-11, 1e-3  # share of steps; of a part; of the scale of energy; of the load
HOLDING = pymunk.PivotJoint | pymunk.PinJoint | pymunk.SlideJoint | pymunk.GrooveJoint
LINKS, LOADS = (20, 60), (1.0, 5.0, 20.0)
THICK, SIDE = 0.04, 0.6  # half the width of a link of length 1, side of the load


def six_legs() -> pymunk.Space:
    """A hull on six legs that one crank with a motor of bounded torque drives by pins; 14 bodies."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    floor = pymunk.Segment(space.static_body, (-1e3, 0.0), (1e3, 0.0), 0.0)
    floor.friction = 1.5
    space.add(floor)
    hull = pymunk.Body(5.0, pymunk.moment_for_box(5.0, (3.0, 0.5)))
    crank = pymunk.Body(1.0, 0.18)
    hull.position = crank.position = 0.0, 3.0
    shapes: list[pymunk.Shape] = [pymunk.Poly.create_box(hull, (3.0, 0.5)), pymunk.Circle(crank, 0.6)]
    motor = pymunk.SimpleMotor(crank, hull, 4.0)
    motor.max_force = 400.0
    space.add(hull, crank, pymunk.PivotJoint(hull, crank, (0.0, 3.0)), motor)
    for k, side in itertools.product(range(3), (-1.0, 1.0)):
        end = pymunk.Vec2d(0.0, 3.0) + pymunk.Vec2d(0.6, 0.0).rotated(2.0 * math.pi * k / 3.0)
        hip, knee, foot = (pymunk.Vec2d(side * x, y) for x, y in ((2.0, 3.0), (2.2, 4.2), (2.6, 0.3)))
        thigh, leg = pymunk.Body(0.5, 0.2), pymunk.Body(0.5, 0.4)
        thigh.position, leg.position = 0.5 * (hip + knee), 0.5 * (hip + foot)
        space.add(thigh, leg, pymunk.PivotJoint(hull, thigh, tuple(hip)))
        shapes += [
            pymunk.Circle(leg, 0.2, leg.world_to_local(foot)),
            pymunk.Segment(leg, leg.world_to_local(hip), leg.world_to_local(foot), 0.05),
        ]
        for a, b, p, q in (
            (crank, leg, end, (side * 1.2, 2.2)),
            (crank, thigh, end, knee),
            (thigh, leg, hip, (side * 2.1, 1.8)),
        ):
            space.add(pymunk.PinJoint(a, b, a.world_to_local(p), b.world_to_local(q)))
    for shape in shapes:
        shape.friction, shape.filter = 1.5, pymunk.ShapeFilter(group=1)
    space.add(*shapes)
    return space


NAMED: dict[str, tuple[Callable[[], pymunk.Space], float, float]] = {  # the scene, its dt, the length of a part
    "walker with six legs": (six_legs, DT, 1.0),
    "soft rings": (lambda: program_joints.soft_rings().space, 1 / 120, 40.0),
    "bridge with boxes": (lambda: program_joints.bridge().space, DT, 1.0),
    "car": (lambda: program_joints.car().space, DT, 100.0),
}


def apart(space: pymunk.Space) -> float:
    """How far points of joints are from what they hold, and points from the lines of their grooves."""
    worst = joints.apart(space)
    for c in space.constraints:
        if isinstance(c, pymunk.GrooveJoint):
            a, b = c.groove_a, c.groove_b
            point = c.a.world_to_local(c.b.local_to_world(c.anchor_b))
            along = max(0.0, min(1.0, (point - a).dot(b - a) / (b - a).dot(b - a)))
            worst = max(worst, (point - a - along * (b - a)).length)
    return worst


def law(what: str, measured: str, value: float, most: float) -> Row:
    """A row: a value that is no number does not hold."""
    return {"what": what, "measured": measured, "value": value, "at most": most, "holds": value <= most}


def named(steps: int) -> list[Row]:
    """Steps that have not converged and how far joints come apart, of each scene of NAMED."""
    rows: list[Row] = []
    for name, (make, dt, part) in NAMED.items():
        space = make()
        stepper, unmet, worst = ep.EECA(space), 0, 0.0
        for _ in range(steps):
            unmet += not stepper.step(dt).converged
            worst = max(worst, apart(space) / part)
        rows.append(law(name, "steps that have not converged (share)", unmet / steps, UNMET))
        if any(isinstance(c, HOLDING) for c in space.constraints):  # springs hold nothing
            rows.append(law(name, "joints apart (of a part)", worst, APART))
    return rows


def rope(links: int, load: float) -> tuple[pymunk.Space, pymunk.Body]:
    """Links of length and mass 1 on pivots between two points as far apart as they are long; a box above the middle."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    before = space.static_body
    for i in range(links):
        link = pymunk.Body(1.0, 1.0 / 12.0)
        link.position = i + 0.5, 0.0
        shape = pymunk.Segment(link, (-0.5, 0.0), (0.5, 0.0), THICK)
        shape.filter = pymunk.ShapeFilter(group=1)
        space.add(link, shape, pymunk.PivotJoint(before, link, (float(i), 0.0)))
        before = link
    space.add(pymunk.PivotJoint(before, space.static_body, (float(links), 0.0)))
    box = pymunk.Body(load, load * SIDE**2 / 6.0)
    box.position = 0.5 * links, THICK + 0.5 * SIDE + 0.1
    space.add(box, pymunk.Poly.create_box(box, (SIDE, SIDE)))
    for one in space.shapes:
        one.elasticity, one.friction = 0.3, 0.8
    return space, box


def ropes(steps: int) -> list[Row]:
    """Work from nowhere, joints apart, and how far the load is through, of each rope and load."""
    rows: list[Row] = []
    for links, load in itertools.product(LINKS, LOADS):
        space, box = rope(links, load)
        stepper, scale = ep.EECA(space), load * G * SIDE
        work, worst, through = 0.0, 0.0, 0.0
        for _ in range(steps):
            ledger = stepper.step(DT).ledger
            assert ledger is not None
            work, worst = work + abs(ledger.external), max(worst, apart(space))
            half = 0.5 * SIDE
            lowest = min(box.local_to_world((x, y)).y for x in (-half, half) for y in (-half, half))
            through = max(through, (THICK - lowest) / SIDE)
        name = f"rope of {links} links, load {load:g}"
        rows += [
            law(name, "work from nowhere (of the load's m g side)", work / scale, WORK),
            law(name, "joints apart (of a link)", worst, APART),
            law(name, "load through (of its side)", through, THROUGH),
        ]
    return rows


def table(steps: int = 240) -> list[Row]:
    """All rows; those whose law does not hold say so."""
    return named(steps) + ropes(steps)

"""Named scenes where joints, contacts and loads meet: how many steps converge, how far joints open, what nobody did."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import program_joints
from comparisons.hard_cases.joints import apart
from comparisons.output import Row

DT, STEPS = 1 / 60, 300
CONVERGED, APART, WORK = 0.99, 1e-9, 1e-9  # share of the steps; joints, over the size; energy from nowhere, over m g l
G, LONG = 9.81, 0.5


def walker() -> pymunk.Space:
    """A crank with a motor of bounded torque moves six legs, of two bars each: 14 bodies."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    floor = pymunk.Segment(space.static_body, (-100.0, 0.0), (100.0, 0.0), 0.0)
    floor.friction = 1.5
    trunk = pymunk.Body(5.0, pymunk.moment_for_box(5.0, (3.0, 0.5)))
    crank = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0.0, 0.6))
    trunk.position = crank.position = 0.0, 3.0
    motor = pymunk.SimpleMotor(crank, trunk, 4.0)
    motor.max_force = 400.0
    space.add(floor, trunk, pymunk.Poly.create_box(trunk, (3.0, 0.5)), crank, pymunk.Circle(crank, 0.6))
    space.add(pymunk.PivotJoint(trunk, crank, (0.0, 3.0)), motor)
    for k, side in itertools.product(range(3), (-1.0, 1.0)):
        arm = pymunk.Vec2d(0.6, 0.0).rotated(2.0 * math.pi * k / 3.0)
        thigh, leg = pymunk.Body(0.5, 0.2), pymunk.Body(0.5, 0.4)
        hip, knee, foot = (2.0 * side, 3.0), (2.2 * side, 4.2), (2.6 * side, 0.3)
        thigh.position, leg.position = (2.1 * side, 3.6), (2.3 * side, 1.65)
        to = leg.world_to_local
        shapes = pymunk.Circle(leg, 0.2, to(foot)), pymunk.Segment(leg, to(hip), to(foot), 0.05)
        shapes[0].friction, shapes[1].friction = 1.5, 1.0
        space.add(
            thigh, leg, *shapes,
            pymunk.PinJoint(crank, leg, arm, to((1.2 * side, 2.2))),
            pymunk.PinJoint(crank, thigh, arm, thigh.world_to_local(knee)),
            pymunk.PivotJoint(trunk, thigh, hip),
            pymunk.PinJoint(thigh, leg, thigh.world_to_local(hip), to((2.1 * side, 1.8))),
        )  # fmt: skip
    for shape in space.shapes:
        if shape.body is not None and shape.body.body_type == pymunk.Body.DYNAMIC:
            shape.filter = pymunk.ShapeFilter(group=1)
    return space


def straight(links: int, load: float, pins: bool) -> pymunk.Space:
    """A rope of balls on pins, or a bridge of planks on pivots, as long as its gap; a box falls on its middle."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    before, anchor = space.static_body, (0.0, 0.0)
    for k in range(links):
        body = pymunk.Body(1.0, LONG**2 / 12)
        body.position = (k + 0.5) * LONG, 0.0
        shape: pymunk.Shape = pymunk.Segment(body, (-0.5 * LONG, 0.0), (0.5 * LONG, 0.0), 0.04)
        if pins:
            shape = pymunk.Circle(body, 0.2)
        shape.filter = pymunk.ShapeFilter(group=1)
        here = (0.0, 0.0) if pins else (-0.5 * LONG, 0.0)
        space.add(body, shape, (pymunk.PinJoint if pins else pymunk.PivotJoint)(before, body, anchor, here))
        before, anchor = body, (0.0, 0.0) if pins else (0.5 * LONG, 0.0)
    last = pymunk.PinJoint if pins else pymunk.PivotJoint
    space.add(last(before, space.static_body, anchor, (links * LONG, 0.0)))
    box = pymunk.Body(load, load * 0.36 / 6)
    box.position = 0.5 * links * LONG, 1.0
    space.add(box, pymunk.Poly.create_box(box, (0.6, 0.6)))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.0 if pins else 0.8
    return space


NAMED: dict[str, Callable[[], pymunk.Space]] = {
    "walker, six legs on a crank": walker,
    "three soft rings": lambda: program_joints.soft_rings().space,
    "bridge of 20 planks, five boxes": lambda: program_joints.bridge().space,
    "car with suspension": lambda: program_joints.car().space,
}


def named() -> list[Row]:
    """A row for each of NAMED: steps that converge; pivots, pins and slides apart, over the length of the scene."""
    rows: list[Row] = []
    for name, make in NAMED.items():
        space = make()
        stepper, good, worst = ep.EECA(space), 0, 0.0
        length = max(1.0, max(p.get_distance(q) for p, q in itertools.pairwise(b.position for b in space.bodies)))
        for _ in tqdm(range(STEPS), desc=name, unit="step", disable=None):
            good += stepper.step(DT).converged
            worst = max(worst, apart(space) / length)
        rows.append({
            "scene": name, "converged": good / STEPS, "joints apart": worst,
            "holds": good / STEPS > CONVERGED and worst <= APART,
        })  # fmt: skip
    return rows


def taut() -> list[Row]:
    """Ropes and bridges without slack: energy from nowhere, joints apart, how far the load is below."""
    rows: list[Row] = []
    for pins, links, load in itertools.product((True, False), (20, 60), (1.0, 5.0, 20.0)):
        space = straight(links, load, pins)
        box = list(space.bodies)[-1]
        stepper, good, gained, worst, low = ep.EECA(space), 0, 0.0, 0.0, 0.0
        before = ep.measure(space).energy
        for _ in range(STEPS):
            report = stepper.step(DT)
            now = ep.measure(space).energy
            external = 0.0 if report.ledger is None else abs(report.ledger.external)
            good, gained, before = good + report.converged, max(gained, now - before, external), now
            worst = max(worst, apart(space))
            if 0.0 < box.position.x < links * LONG:
                low = max(low, -box.position.y)
        scale = load * G
        rows.append({
            "scene": f"{'rope' if pins else 'bridge'} of {links}", "load (links)": load, "converged": good / STEPS,
            "work from nowhere": gained / scale, "joints apart (m)": worst, "below (m)": low,
            "holds": good == STEPS and gained <= WORK * scale and worst <= APART and low <= 0.0,
        })  # fmt: skip
    return rows

"""Named scenes where joints, contacts and loads meet: how many steps converge, how far joints open, what nobody did."""

from __future__ import annotations

import itertools
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
    "walker, six legs on a crank": lambda: program_joints.six_legs().space,
    "three soft rings": lambda: program_joints.soft_rings().space,
    "three rings of planks": lambda: program_joints.rings_of_planks().space,
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

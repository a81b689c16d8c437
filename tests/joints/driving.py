"""Steps a space of joints and measures what tests compare."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk

from .jointed import JointedSpace


def run(space: pymunk.Space, dt: float, steps: int, order: int = 2) -> JointedSpace:
    """Step `space` so often."""
    stepper = JointedSpace(space, order)
    for _ in range(steps):
        stepper.step(dt)
    return stepper


def drift(space: pymunk.Space, dt: float, steps: int, order: int = 2) -> tuple[float, float, JointedSpace]:
    """The worst change of energy beside what motors, supports and losses explain; the worst error of a joint."""
    stepper = JointedSpace(space, order)
    stepper.step(dt)
    start, worst, apart = stepper.energy() - stepper.gain() + stepper.ledger.closed, 0.0, 0.0
    for k in range(steps):
        stepper.components.step(stepper.bodies, dt)
        stepper.book()
        worst = max(worst, abs(stepper.energy() - stepper.gain() + stepper.ledger.closed - start))
        if k % 50 == 0:
            stepper._scatter()
            apart = max(apart, error(space))
    return worst, apart, stepper


def error(space: pymunk.Space) -> float:
    """The largest gap of pins and pivots (length), and error of gears (rad)."""
    worst = 0.0
    for c in space.constraints:
        if isinstance(c, (pymunk.PinJoint, pymunk.PivotJoint)):
            apart = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
            worst = max(worst, abs(apart - (c.distance if isinstance(c, pymunk.PinJoint) else 0.0)))
        elif isinstance(c, pymunk.GearJoint):
            worst = max(worst, abs(c.b.angle - (c.a.angle + c.phase) / c.ratio))
    return worst


def slopes(
    make: Callable[[], pymunk.Space], place: Callable[[pymunk.Space], tuple[float, ...]], exact: tuple[float, ...],
    time: float, steps: list[int], order: int,
) -> tuple[list[float], list[float]]:  # fmt: skip
    """Errors at `time` with so many steps, and the slopes between them."""
    errors = []
    for n in steps:
        space = make()
        run(space, time / n, n, order)
        errors.append(float(np.abs(np.subtract(place(space), exact)).max()))
    ratios = [math.log(errors[i] / errors[i + 1]) / math.log(steps[i + 1] / steps[i]) for i in range(len(steps) - 1)]
    return errors, ratios


def momenta(space: pymunk.Space) -> tuple[float, float, float]:
    """Momentum, and angular momentum about the origin."""
    px = sum(b.mass * b.velocity.x for b in space.bodies)
    py = sum(b.mass * b.velocity.y for b in space.bodies)
    spin = 0.0
    for b in space.bodies:
        centre = b.local_to_world(b.center_of_gravity)
        spin += b.mass * centre.cross(b.velocity) + b.moment * b.angular_velocity
    return px, py, spin


def ledger_closes(stepper: JointedSpace, start: float, scale: float) -> None:
    """Assert that energy changed by what the ledger says, that nothing is unexplained, and losses are losses."""
    assert abs(stepper.energy() - start - stepper.gain()) < 1e-12 * scale
    assert abs(stepper.ledger.closed) < 1e-12 * scale
    assert min(stepper.losses()) >= -1e-15 * scale

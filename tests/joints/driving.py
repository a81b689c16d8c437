"""Steps spaces of jointed bodies without shapes, and measures what tests compare."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk

import eeca_pymunk as ep
from eeca_pymunk.model.joints import Joints

from ..jointed.measures import energy, moving


class Driven:
    """EECA steps of a space, their ledgers summed.

    Attributes:
        space, stepper.  report: of the last step.
        order: 2 or 4 (where a component allows it).  status: of the last step, the worst of its components.
        restitution: what limits and projections have lost.  friction: bounded joints.  damping: springs.
        external: work of motors and supports, and of joints that hold, which is round-off.
        start: energy before the first step.
    """

    def __init__(self, space: pymunk.Space, order: int = 4) -> None:
        self.space, self.stepper, self.order = space, ep.EECA(space), order
        self.restitution = self.friction = self.damping = self.external = 0.0
        self.start = energy(space)

    @property
    def joints(self) -> Joints:
        """The arrays of the joints."""
        assert self.stepper.event_loop is not None
        return self.stepper.event_loop.joints

    @property
    def status(self) -> int:
        return self.joints.TALLY.worst

    def step(self, dt: float) -> None:
        """Step the space by dt."""
        self.joints.TALLY.order = self.order
        self.report = self.stepper.step(dt)
        ledger = self.report.ledger
        assert ledger is not None
        self.restitution += ledger.restitution
        self.friction += ledger.friction
        self.damping += ledger.damping
        self.external += ledger.external

    def losses(self) -> tuple[float, float, float]:
        """All that has been lost so far."""
        return self.damping, self.restitution, self.friction

    def gain(self) -> float:
        """Energy that the ledgers say has come in since the start."""
        return self.external - sum(self.losses())

    def unexplained(self) -> float:
        """Change of energy since the start beside what the ledgers say."""
        return energy(self.space) - self.start - self.gain()


def run(space: pymunk.Space, dt: float, steps: int, order: int = 4) -> Driven:
    """Step `space` so often."""
    stepper = Driven(space, order)
    for _ in range(steps):
        stepper.step(dt)
    return stepper


def drift(space: pymunk.Space, dt: float, steps: int, order: int = 4) -> tuple[float, float, Driven]:
    """The worst change of energy, of a space without motors and supports, beside its losses; the worst error of a
    joint."""
    stepper = Driven(space, order)
    worst = apart = 0.0
    for k in range(steps):
        stepper.step(dt)
        worst = max(worst, abs(stepper.unexplained() + stepper.external))
        if k % 50 == 0:
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
    bodies = moving(space)
    px = sum(b.mass * b.velocity.x for b in bodies)
    py = sum(b.mass * b.velocity.y for b in bodies)
    spin = 0.0
    for b in bodies:
        centre = b.local_to_world(b.center_of_gravity)
        spin += b.mass * centre.cross(b.velocity) + b.moment * b.angular_velocity
    return px, py, spin


def ledger_closes(stepper: Driven, scale: float, external: float = 0.0) -> None:
    """Assert that energy changed by what the ledger says, that nothing is unexplained beside the `external` work, and
    losses are losses."""
    assert abs(stepper.unexplained()) < 1e-12 * scale
    assert abs(stepper.external - external) < 1e-12 * scale
    assert min(stepper.losses()) >= -1e-15 * scale

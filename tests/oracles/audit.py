"""A stepper that looks at the ledger of each of its steps."""

from __future__ import annotations

import numpy as np
import pymunk

import eeca_pymunk as ep
from eeca_pymunk.report import StepReport


class Audit(ep.EECA):
    """EECA that remembers the worst residual and the most negative loss of all its steps, relative to the energies and
    works of the step, and the sum of each entry."""

    def __init__(self, space: pymunk.Space) -> None:
        super().__init__(space)
        self.residual = self.loss = 0.0
        self.total = dict.fromkeys(("change", "external", "restitution", "friction", "damping"), 0.0)

    def step(self, dt: float) -> StepReport:
        before = self.scale()
        report = super().step(dt)
        book = report.ledger
        if book is None or dt == 0.0:
            return report
        for name in self.total:
            self.total[name] += getattr(book, name)
        works = abs(book.external) + abs(book.restitution) + abs(book.friction) + abs(book.damping)
        scale = max(before, self.scale(), works) or 1.0
        self.residual = max(self.residual, abs(book.residual) / scale)
        self.loss = min(self.loss, min(book.restitution, book.friction, book.damping) / scale)
        return report

    def scale(self) -> float:
        """Energies of the bodies, each by its size."""
        gravity = np.hypot(*self.space.gravity)
        whole = 0.0
        for body in self.space.bodies:
            if body.body_type == pymunk.Body.DYNAMIC:
                speed2 = body.velocity.length**2
                turns = body.moment * body.angular_velocity**2 if np.isfinite(body.moment) else 0.0
                whole += 0.5 * (body.mass * speed2 + turns)
                whole += body.mass * gravity * body.position.length
        return whole


def auditor(made: list[Audit]):
    """A maker of steppers that are audited, which are put into a list."""

    def make(space: pymunk.Space) -> Audit:
        made.append(Audit(space))
        return made[-1]

    return make

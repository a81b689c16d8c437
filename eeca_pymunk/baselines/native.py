"""Native: pymunk's own solver as a Stepper, the baseline of every comparison."""

from __future__ import annotations

import pymunk

from ..errors import NotFiniteError
from ..packed_space import TOO_FAR
from ..report import StepReport
from ..space.bodies import Bodies
from ..space.checks import settings, shape_body
from ..stepper import Stepper, check_dt


class Native(Stepper):
    """`space.step(dt)`, with errors for invalid input, which pymunk accepts silently or ends the process for.

    If a state is not finite at the end, the bodies are put back; what callbacks have done stays.
    """

    def __init__(self, space: pymunk.Space) -> None:
        super().__init__(space)
        self._bodies: Bodies | None = None

    def step(self, dt: float) -> StepReport:
        dt = check_dt(dt)
        if dt == 0.0:
            return StepReport.without_contacts(self.time)
        settings(self.space)
        # Bodies checks masses, and shape_body the owners, on which pymunk would fail with an assertion or an abort.
        if self._bodies is None or (state := self._bodies.gather()) is None:
            self._bodies = Bodies(self.space)
            state = self._bodies.start
            for shape in self.space.shapes:
                shape_body(shape)
        self._bodies.check_finite(state)
        self.space.step(dt)
        end = self._bodies.gather()
        if end is not None:  # else callbacks have added or removed bodies: the next step checks them
            try:
                self._bodies.check_finite(end, TOO_FAR)
            except NotFiniteError:
                self._bodies.scatter(state)
                for body in self._bodies.items:
                    self.space.reindex_shapes_for_body(body)
                raise
        self.time += dt
        return StepReport.without_contacts(self.time, self._bodies.items)

    @property
    def model(self) -> str:
        return "all that pymunk models, by its own solver"


def tune(space: pymunk.Space, iterations: int = 50) -> None:
    """Settings for impacts: no slop, no memory of old contacts, more iterations ("pymunk tuned")."""
    space.collision_slop = 0.0
    space.collision_persistence = 1
    space.iterations = iterations

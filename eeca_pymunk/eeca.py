"""EECA: the energy-conserving stepper. Its closure detects, solves and locks; the rest is shared with all steppers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from .array_stepper import ArrayStepper
from .closures.motion import Motion, Start
from .closures.time_of_impact import TimeOfImpact
from .space.bodies import Bodies
from .space.twin import MarginTwin

if TYPE_CHECKING:
    import pymunk


class Closure(Protocol):
    """Chooses psi2, the one parameter that conservation leaves free: when impulses act (design sections 3, 4).

    `advance` moves the bodies over one step, energy and momentum exact; pure arrays, the space is not touched.
    """

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion: ...


class EECA(ArrayStepper):
    """Conserves energy, linear and angular momentum through every contact, at any dt (paper; design section 2).

    Args:
        space: a pymunk space.
        closure: what chooses psi2; `TimeOfImpact()` if None.
        sync, ignore: see `ArrayStepper`.
    """

    @property
    def centred_disks(self) -> bool:  # type: ignore[override]
        return not isinstance(self.closure, TimeOfImpact)

    def __init__(
        self, space: pymunk.Space, closure: Closure | None = None, *, sync: bool = True, ignore: Sequence[str] = ()
    ) -> None:
        self.closure: Closure = TimeOfImpact() if closure is None else closure
        super().__init__(space, sync=sync, ignore=ignore)

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        return self.closure.advance(bodies, start, twin)

"""TimeOfImpact: the closure that puts every impulse at its computed time of impact (design sections 3, 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..space.bodies import Bodies
    from ..space.twin import MarginTwin
    from .motion import Motion, Start


@dataclass(frozen=True)
class TimeOfImpact:
    """psi2 = 1 - 2 tau / dt with tau the time of impact, and the normal there: exact for disks and flat walls.

    The step follows the paths of the bodies from impact to impact, in rounds: every round takes the contacts that are
    the earliest of both their bodies, all at once, kinks the paths there, and looks anew at the pairs of these bodies.
    Impacts of one body at one instant, up to round-off, and contacts that touch then are solved together. Exact up to
    round-off for elastic and inelastic impacts of disks with disks and walls under constant forces, at any dt; second
    order where contacts rest on curved shapes.

    Args:
        max_rounds: of a step. What is left after them stays for the next step, and the report says not converged.
    """

    max_rounds: int = 100_000

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        from .._rounds.steps import advance

        return advance(bodies, start, twin, self.max_rounds)

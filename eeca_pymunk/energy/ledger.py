"""The ledger: where the energy of a step has gone.

    change = external - restitution - friction - damping + residual

The change is that of kinetic energy and of potential energy in the uniform gravity. Losses are booked as impulses
times means of velocities before and after, or forces times ways, so that the sum closes by identity: the residual is
round-off of the energies and works that are summed.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import FloatArray

BOOK = 7  # entries of a book: restitution, friction, external, damping, (free), energy before and after
DAMPED, AFTER = 3, 6


@dataclass(frozen=True)
class Ledger:
    """Energies of one step, mass length²/time².

    Attributes:
        change: of kinetic and potential energy.
        external: work of forces on bodies, of velocity functions, of kinematic bodies and moving surfaces.
        restitution, friction, damping: lost, >= 0. Bounces too small for a step are booked as restitution at once.
        residual: what does not add up.
    """

    change: float
    external: float
    restitution: float
    friction: float
    damping: float
    residual: float


def ledger(book: FloatArray) -> Ledger:
    """The ledger of a step from its (7,) book."""
    restitution, friction, external, damping, _, before, after = (float(x) for x in book)
    change = after - before
    residual = change - (external - restitution - friction - damping)
    return Ledger(change, external, restitution, friction, damping, residual)

"""The ledger: where the energy of a step has gone.

    change = external - restitution - friction - damping + residual

The change is that of kinetic energy, of potential energy in the uniform gravity, and of the energy stored in springs.
Losses are impulses times means of velocities before and after, or forces times displacements, so that the sum closes by
identity: the residual is round-off of the energies and works that are summed. A *book* is the list of seven numbers
from which a ledger is made.
"""

from __future__ import annotations

from dataclasses import dataclass

# Entries of a book: restitution, friction, external, damping, change of the energy in springs (part of the energy
# after), energy before and after.
DAMPED, AFTER = 3, 6


@dataclass(frozen=True)
class Ledger:
    """Energies of one step, mass length²/time².

    Attributes:
        change: of kinetic and potential energy, that of springs included.
        external: work of forces on bodies, of velocity functions, of kinematic bodies and moving surfaces.
        restitution, friction, damping: losses, >= 0. Bounces too small for a step count as restitution at once.
        residual: change less the other entries: round-off.
    """

    change: float
    external: float
    restitution: float
    friction: float
    damping: float
    residual: float


def ledger(book: list[float]) -> Ledger:
    """The ledger of a step from its book."""
    restitution, friction, external, damping, _, before, after = book
    change = after - before
    residual = change - (external - restitution - friction - damping)
    return Ledger(change, external, restitution, friction, damping, residual)

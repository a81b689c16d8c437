"""The ledger: where the energy of a step has gone.

    change = external - restitution - friction - damping + residual

The change is that of kinetic energy, of potential energy in the uniform gravity, and of the energy stored in springs.
Losses are impulses times means of velocities before and after, or forces times displacements, so that the sum closes by
identity: the residual is round-off of the energies and works that are summed. A *book* is the list of seven numbers
from which a ledger is made.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields

import numpy as np

from ..arrays import FloatArray
from ..model.step import Step

_STEP = Step.TYPE.names or ()
BOOK = slice(_STEP.index("restitution"), _STEP.index("after") + 1)  # the fields of Step that are the book
BOOK_DAMPING, BOOK_AFTER = (_STEP[BOOK].index(name) for name in ("damped", "after"))


@dataclass(frozen=True)
class Ledger:
    """Energies of one step, mass length²/time².

    Attributes:
        change: of kinetic and potential energy, that of springs included, but for rotary springs that cannot turn
            either body.
        external: work of forces on bodies, of velocity functions, of kinematic bodies and moving surfaces.
        restitution, friction, damping: losses, >= 0; damping is negative, a gain, with `space.damping` above 1. Bounces
            too small for a step count as restitution at once.
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


@dataclass
class LedgerTrace:
    """Sums of the ledgers of all steps up to each of T moments, zero at the start; names as of `Ledger`. NaN from the
    first step without a ledger on: pymunk's own solver, the penalty steppers and EECA with `Dashpot` have none.

    Attributes:
        change, external, restitution, friction, damping, residual: (T,) mass length²/time².
    """

    change: FloatArray = field(default_factory=lambda: np.zeros(0))
    external: FloatArray = field(default_factory=lambda: np.zeros(0))
    restitution: FloatArray = field(default_factory=lambda: np.zeros(0))
    friction: FloatArray = field(default_factory=lambda: np.zeros(0))
    damping: FloatArray = field(default_factory=lambda: np.zeros(0))
    residual: FloatArray = field(default_factory=lambda: np.zeros(0))

    @staticmethod
    def unknown(moments: int) -> LedgerTrace:
        """Of a run without ledgers."""
        return LedgerTrace(*(np.full(moments, np.nan) for _ in fields(LedgerTrace)))

    @property
    def kept(self) -> bool:
        """Whether there is a ledger of every moment."""
        return len(self.change) > 0 and bool(np.isfinite(self.change).all())

    def put(self, moment: int, total: FloatArray) -> None:
        """Write sums (6,), in the order of the fields, at a moment."""
        for f, value in zip(fields(self), total, strict=True):
            getattr(self, f.name)[moment] = value


def as_array(one: Ledger | None) -> FloatArray:
    """(6,) fields of a ledger in their order; NaN if there is none."""
    return np.full(6, np.nan) if one is None else np.array(astuple(one))

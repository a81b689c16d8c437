"""The ledger of a run: those of its steps, summed."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields

import numpy as np

from ..arrays import FloatArray
from .ledger import Ledger


@dataclass
class LedgerTrace:
    """Sums of the ledgers of all steps up to each of T moments, zero at the start; names as of `Ledger`. NaN from the
    first step without a ledger on: pymunk's own solver and the penalty steppers have none.

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


def entries(one: Ledger | None) -> FloatArray:
    """(6,) fields of a ledger in their order; NaN if there is none."""
    return np.full(6, np.nan) if one is None else np.array(astuple(one))

"""Rollouts as data: named arrays, in a file with their parameters and a hash of the content."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .arrays import FloatArray, IntArray
from .energy.ledger import Ledger
from .events import Events
from .files import ArrayFile


@dataclass
class Rollouts(ArrayFile):
    """The results of K rollouts of b bodies, T frames each.

    Attributes:
        states: (K, b, 6) position (2; length), angle (rad), velocity (2; length/time), spin (rad/time) at the start.
        frames: (K, T, b, 6) the same at the end of each frame.
        ledger: (K, T, 6) energies, summed from the start of the rollout to the end of each frame, in the order of the
            fields of `Ledger`.
        unmet: (K,) number of steps that did not meet all budgets and tolerances.
        events: the impacts of all rollouts, rollout after rollout, each in the order of time since its start. Indices
            of bodies are those in `frames`.
        first: (K + 1,) the impacts of rollout k are [first[k], first[k + 1]).
        error: (K,) length, an estimate of the largest position error in any frame; NaN until `certify` is called.
        parameters: arguments of `rollout`, versions, and what the user adds (seeds, units, licence).
    """

    _PARTS = {"events": Events}  # noqa: RUF012

    states: FloatArray
    frames: FloatArray
    ledger: FloatArray
    unmet: IntArray
    events: Events
    first: IntArray
    error: FloatArray = field(default_factory=lambda: np.zeros(0))
    parameters: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.error) != len(self.states):
            self.error = np.full(len(self.states), np.nan)

    def __len__(self) -> int:
        return len(self.states)

    def events_of(self, k: int) -> Events:
        """The impacts of rollout k."""
        return self.events.part(int(self.first[k]), int(self.first[k + 1]))

    def ledger_of(self, k: int, t: int = -1) -> Ledger:
        """The ledger of rollout k from its start to frame t."""
        return Ledger(*self.ledger[k, t].tolist())

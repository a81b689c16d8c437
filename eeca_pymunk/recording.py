"""Recording: the trajectory of a run, in memory and in files."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import numpy as np

from .arrays import FloatArray
from .energy.ledger import LedgerTrace
from .events import Events
from .files import ArrayFile
from .space.outlines import Outlines


@dataclass
class Recording(ArrayFile):
    """T moments of N bodies: those of `space.bodies` that are not static, in that order.

    A body that is removed during the run is NaN from then on. At the end of a notebook cell a recording is shown as a
    player.

    Attributes:
        time: (T,) from the start.
        position: (T, N, 2) length.
        angle: (T, N) rad.
        velocity: (T, N, 2) length/time.
        energy: (T,) kinetic energy, and potential energy of gravity.
        kinetic: (T,) kinetic energy.
        momentum: (T, 2) linear, mass length/time.
        ledger: ledgers summed since the start, arrays (T,); NaN for steppers that have none.
        mass: (N,) infinite for kinematic bodies.
        outlines: the shapes at the start.
        spin: (T, N) rad/time.
        events: the impacts, each at its instant.
        parameters: stepper, dt, duration, every, and versions.
    """

    _PARTS = {"outlines": Outlines, "ledger": LedgerTrace, "events": Events}  # noqa: RUF012

    time: FloatArray
    position: FloatArray
    angle: FloatArray
    velocity: FloatArray
    energy: FloatArray
    momentum: FloatArray
    mass: FloatArray = field(default_factory=lambda: np.zeros(0))
    outlines: Outlines = field(default_factory=Outlines)
    parameters: dict[str, Any] = field(default_factory=dict)
    kinetic: FloatArray = field(default_factory=lambda: np.zeros(0))
    ledger: LedgerTrace = field(default_factory=LedgerTrace)
    spin: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    events: Events = field(default_factory=Events)

    def __post_init__(self) -> None:
        # Files of older versions lack these.
        if len(self.kinetic) != len(self.time):
            self.kinetic = np.full(len(self.time), np.nan)
        if self.spin.shape != self.angle.shape:
            self.spin = np.full_like(self.angle, np.nan)
        if len(self.ledger.change) != len(self.time):
            self.ledger = LedgerTrace.unknown(len(self.time))

    def __len__(self) -> int:
        return len(self.time)

    def _repr_html_(self) -> str:
        if len(self.outlines) == 0:
            return f"<p>{len(self)} moments of {self.position.shape[1]} bodies, without shapes</p>"
        # The only import of a higher room: a recording in a notebook is shown as a player.
        return str(import_module(".render", __package__).player(self))

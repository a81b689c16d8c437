"""Arrays of a step: its start, its motion, and the pairs that are near."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._rounds.contacts import ROUND_OFF, Pairs
from .._rounds.features import distance_from_axes, length
from .._rounds.geometry import Geometry
from ..arrays import FloatArray
from ..report import StepReport
from ..space.twin import MarginTwin


@dataclass(frozen=True)
class Start:
    """The N bodies at the start of a step: position, velocity and acceleration (N, d), the last with gravity.

    d = 2 where bodies are centred disks and contacts have no arms. d = 3 otherwise: centres of mass, and the angle with
    its derivatives.

    `time` is that of the end of the step; `pulled` tells whether anything accelerates.
    """

    time: float
    dt: float
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pulled: bool

    def at(self, time: float) -> FloatArray:
        """(N, d) positions on the free flight at one instant."""
        way = self.position + time * self.velocity
        return way + (0.5 * time * time) * self.acceleration if self.pulled else way

    @property
    def free_velocity(self) -> FloatArray:
        """(N, d) velocity at the end of the free flight."""
        return self.velocity + self.dt * self.acceleration if self.pulled else self.velocity.copy()

    @property
    def free_displacement(self) -> FloatArray:
        """(N, d) displacement of the free flight over the step."""
        with np.errstate(over="ignore", invalid="ignore"):  # refused before anything is made of it
            way = self.dt * self.velocity
            return way + (0.5 * self.dt**2) * self.acceleration if self.pulled else way


@dataclass(frozen=True)
class Motion:
    """Velocity and displacement (N, d) of all bodies over a step, and its report."""

    velocity: FloatArray
    displacement: FloatArray
    report: StepReport


def flight(start: Start, pairs: Pairs, time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m, 2) centres of a and of b on the free flight, every pair at its own (m,) instant."""
    t = time[:, None]
    a, b = (
        start.position.take(r, axis=0)
        + t * start.velocity.take(r, axis=0)
        + (0.5 * t * t) * start.acceleration.take(r, axis=0)
        for r in (pairs.row_a, pairs.row_b)
    )
    return a, b


def near_pairs(
    twin: MarginTwin, start: Start, displacement: FloatArray, extra: FloatArray | float = 0.0
) -> tuple[Pairs, Geometry]:
    """The pairs that can meet within the step, and their geometry at its start.

    A body's reach is the length of its free flight and `extra` (N,). Impulses can send it twice as far (an elastic
    hit by a heavier body), which the factor 2 covers for the contacts that impulses close.
    """
    # The path of a thrown body leaves its chord.
    bow = (0.125 * start.dt**2) * length(start.acceleration)
    slack = bow + ROUND_OFF * distance_from_axes(start.position) + extra
    reach = length(displacement) + slack
    pairs = twin.candidates(start.position, displacement, slack)
    before = pairs.at(start.position)
    near = np.flatnonzero(before.gap <= 2.0 * (reach[pairs.row_a] + reach[pairs.row_b]))
    return pairs.take(near), before.take(near)

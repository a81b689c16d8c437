"""Traces below the panels of a film: energy and momentum, or the ledger."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.recording import Recording

from .drawing import ARROW_COLOR

FONT = 12  # points: readable at half size too
_CEILING = 4.0  # upper limit of the axis, relative to the start
_WORTH = 1e-9  # of the energy: least loss or external work for which the ledger is shown
_COLORS = {
    "kinetic": "#0072B2",
    "potential": "#56B4E9",
    "bounces": "#E69F00",
    "friction": "#D55E00",
    "damping": "#999999",
}


class Trace(ABC):
    """Curves below a panel, up to the moment shown. `top` is the largest value shown."""

    top: float
    moving: list[Artist]

    def __init__(self, ax: Axes, recording: Recording) -> None:
        self.ax, self.time = ax, recording.time
        readable(ax)
        ax.set_xlabel("time (s)", fontsize=FONT)

    @abstractmethod
    def show(self, i: int) -> None:
        """Draw up to moment i."""

    def _legend(self, columns: int, size: float) -> None:
        self.ax.legend(
            loc="lower left", bbox_to_anchor=(-0.05, 0.98), ncol=columns, fontsize=size, frameon=False, borderpad=0.0,
            handlelength=1.5, columnspacing=1.0,
        )  # fmt: skip


def trace(ax: Axes, recording: Recording) -> Trace:
    """The stack of a ledger with losses or external work; otherwise energy and momentum."""
    ledger, size = recording.ledger, float(np.abs(recording.energy).max(initial=0.0))
    if ledger.kept and np.isfinite(recording.kinetic).all():
        most = max(
            float(np.abs(x).max()) for x in (ledger.restitution, ledger.friction, ledger.damping, ledger.external)
        )
        if most > _WORTH * size:
            return Stack(ax, recording)
    return Lines(ax, recording)


class Lines(Trace):
    """Energy relative to the start, and the size of the momentum relative to its largest. If the potential energy is
    negative at any time, it counts from its minimum."""

    def __init__(self, ax: Axes, recording: Recording) -> None:
        super().__init__(ax, recording)
        size = np.linalg.norm(recording.momentum, axis=1)
        lowest = float((recording.energy - recording.kinetic).min(initial=0.0))
        energy = recording.energy - (lowest if math.isfinite(lowest) else 0.0)
        start = abs(float(energy[0])) or float(np.abs(energy).max()) or 1.0
        self.values = (energy / start, size / (float(size.max()) or 1.0))
        self.top = min(max(1.0, float(np.nanmax(self.values[0]))), _CEILING)
        self.lines = ax.plot([], [], color="black", linewidth=2, label="E / E(0)")
        self.lines += ax.plot([], [], color=ARROW_COLOR, linewidth=1.2, linestyle="--", label="|p| / max |p|")
        self.moving = [*self.lines]
        self._legend(2, FONT)

    def show(self, i: int) -> None:
        for line, value in zip(self.lines, self.values, strict=True):
            line.set_data(self.time[: i + 1], value[: i + 1])


class Stack(Trace):
    """Kinetic and potential energy, and on them what was lost to restitution (bounces), friction and damping.

    All relative to the energy at the start; a negative potential energy counts from its minimum. The dashed line is the
    energy at the start and the external energy since: the stack ends there if the ledger closes.
    """

    def __init__(self, ax: Axes, recording: Recording) -> None:
        super().__init__(ax, recording)
        potential, ledger = recording.energy - recording.kinetic, recording.ledger
        potential = potential - min(0.0, float(potential.min()))
        start = float(recording.kinetic[0] + potential[0])
        parts = {
            "kinetic": recording.kinetic, "potential": potential, "bounces": ledger.restitution,
            "friction": ledger.friction, "damping": ledger.damping,
        }  # fmt: skip
        given = start + ledger.external
        whole = sum(parts.values(), np.zeros(len(given)))
        scale = start or float(np.abs(given).max()) or 1.0
        self.levels: list[tuple[FloatArray, FloatArray]] = []
        self.layers: list[Polygon] = []
        below: FloatArray = np.zeros(len(given))
        for name, part in parts.items():
            if float(np.abs(part).max()) > _WORTH * float(np.abs(given).max()):
                self.levels.append((below, below + part / scale))
                below = self.levels[-1][1]
                layer = Polygon(np.zeros((1, 2)), color=_COLORS[name], lw=0, label=name)
                ax.add_patch(layer)
                self.layers.append(layer)
        self.given = given / scale
        label = "start + external" if float(np.abs(ledger.external).max()) > _WORTH * abs(scale) else "start"
        self.lines = ax.plot([], [], color="black", linewidth=1.5, linestyle="--", label=label)
        self.moving = [*self.layers, *self.lines]
        self.top = min(max(1.0, float(whole.max()) / scale, float(self.given.max())), _CEILING)
        ax.set_ylabel("energy / start", fontsize=FONT)
        self._legend(3, 0.75 * FONT)

    def show(self, i: int) -> None:
        time = self.time[: i + 1]
        across = np.concatenate((time, time[::-1]))
        for layer, (low, high) in zip(self.layers, self.levels, strict=True):
            layer.set_xy(np.column_stack((across, np.concatenate((high[: i + 1], low[i::-1])))))
        self.lines[0].set_data(time, self.given[: i + 1])


def readable(ax: Axes) -> None:
    """Labels that can be read at half size."""
    ax.tick_params(labelsize=FONT)
    ax.title.set_fontsize(FONT + 1)
    ax.locator_params(nbins=5)

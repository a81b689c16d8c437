"""Stepper: the interface of all steppers. Method: what steps the arrays of one world."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np
from tqdm import tqdm

from .arguments import check_count
from .arrays import IntArray
from .compiled import Table
from .energy.ledger import Ledger, as_array
from .report import Details, Outcome, RunReport, StepReport

if TYPE_CHECKING:
    import pymunk


def check_dt(dt: float) -> float:
    """dt as a float; ValueError if it is negative, NaN or infinite."""
    dt = float(dt)
    if not (dt >= 0 and math.isfinite(dt)):
        raise ValueError(f"dt = {dt}: give a finite time step >= 0 (0 does nothing)")
    return dt


class Stepper(ABC):
    """Steps a pymunk space: `stepper.step(dt)` instead of `space.step(dt)`.

    A step completes, or raises and leaves the space unchanged. There is one exception: if a post-step callback raises,
    the step has been taken, and bodies and `time` are at its end, as under pymunk. Between steps shapes and bodies may
    be added, removed and edited. Functions that are called within a step cannot step the same space, nor can another
    thread meanwhile: RuntimeError.

    Attributes:
        space: the pymunk space.  time: sum of the dt of all steps so far.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self.space = space
        self.time = 0.0

    @abstractmethod
    def step(self, dt: float) -> StepReport:
        """Advance the space by dt >= 0; 0 does nothing. ValueError for any other dt and for states that are not finite,
        UnsupportedFeature for features that the stepper does not support."""

    def run(self, steps: int, dt: float, progress: bool = False) -> RunReport:
        """Advance the space by `steps` steps of dt, as a loop of `step` does, bit by bit.

        EECA takes them in one compiled call if no Python function has to be called in between, and updates pymunk's
        space once, at the end (`python -m comparisons rollouts` prints the time saved).

        Args:
            steps: number, >= 0.
            dt: time, >= 0.
            progress: show a progress bar.

        If a step raises, or after an interrupt, the space is at the end of the last complete step.
        """
        steps, dt = check_count("steps", steps), check_dt(dt)
        total, impacts, unmet, iterations, lock, done = np.zeros(6), 0, 0, 0, 1.0, 0
        for _ in tqdm(range(steps if dt > 0.0 else 0), desc=type(self).__name__, unit="step", disable=not progress):
            report = self.step(dt)
            total += as_array(report.ledger)
            contacts = report.contacts
            impacts += int(np.count_nonzero((contacts.duration == 0.0) & (report.impulse != 0.0)))
            unmet, iterations, done = unmet + (not report.converged), iterations + report.iterations, done + 1
            lock = max(lock, report.lock, key=lambda scale: abs(scale - 1.0))
        ledger = None if done == 0 or np.isnan(total).any() else Ledger(*total.tolist())
        return RunReport(self.time, done, ledger, impacts, unmet, iterations, lock)

    @property
    @abstractmethod
    def model(self) -> str:
        """One line: the features of the present space that are modelled."""

    def refresh(self) -> None:  # noqa: B027 - steppers that keep nothing have nothing to refresh
        """Read the whole space again at the next step, and forget results of earlier steps, such as contact forces.

        Needed after edits that bypass pymunk's setters, and for a reset: from the same positions and velocities, and
        the same `angle` of each ratchet, the space then follows bitwise the same path, whatever was run before."""


class Method(Protocol):
    """Steps the arrays of one world: an `EventLoop`, or `closures.motion.Disks`. It keeps results of earlier steps,
    such as contact forces, as long as the world is used."""

    def step(self, reading: Table, dt: float, gx: float, gy: float, half_damping: float) -> int:
        """Move the bodies from STATES[READ] to STATES[WRITTEN] and ENDS (`layout.py`), by the gravity (gx, gy) and the
        factor of half a step's damping. Returns status bits or a negative code of `model/step.py`."""

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Set the laws of pairs of rows of SHAPE (a < b) that differ from those of their shapes, by collision handlers
        or joints, from the next step on: elasticity (negative: no collision), friction, and surface velocity (2) of b
        relative to a."""

    def details(self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details | Callable[[], Details]:
        """The arrays of the report of the last step, or a function that makes them; `owner` (k,): index in `bodies` of
        the body of each shape."""

    def outcome(self) -> Outcome:
        """How the last step was solved; before the first step, that of a step without contacts."""

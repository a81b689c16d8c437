"""Stepper: the contract that all steppers share."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from .report import StepReport

if TYPE_CHECKING:
    import pymunk


def check_dt(dt: float) -> float:
    """dt as a float; ValueError if it is negative, NaN or infinite."""
    dt = float(dt)
    if not (dt >= 0 and math.isfinite(dt)):
        raise ValueError(f"dt = {dt}: give a finite time step >= 0 (0 does nothing)")
    return dt


class Stepper(ABC):
    """Steps a pymunk space: `stepper.step(dt)` in the place of `space.step(dt)`.

    A step completes or raises with the space as it was; but for what a post-step callback raises: these are called when
    the step has been taken, so that bodies and `time` are at its end, as under pymunk. Between steps shapes and bodies
    may be added, removed, edited. Functions that are called within a step cannot step the same space: RuntimeError.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self.space = space
        self.time = 0.0

    @abstractmethod
    def step(self, dt: float) -> StepReport:
        """Advance the space by dt >= 0; 0 is a no-op. ValueError for any other dt and for states that are not finite,
        UnsupportedFeature for what the stepper does not model."""

    @property
    @abstractmethod
    def model(self) -> str:
        """One line: what of the space as it is now is modelled, and therefore paid for."""

    def refresh(self) -> None:  # noqa: B027 - steppers that keep nothing have nothing to refresh
        """Read the whole space anew at the next step, and forget what earlier steps have found.

        For what was edited behind pymunk's setters; and to start again: from the same positions and velocities the
        space then goes bitwise the same way, whatever was run before."""

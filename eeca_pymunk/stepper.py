"""Stepper: the contract all steppers share, and the report of a step."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import pymunk

from .bodies import FloatArray
from .geometry import Contacts


@dataclass(frozen=True)
class StepReport:
    """What happened in one step; m contacts were active.

    Attributes:
        time: simulated time at the end of the step, since the stepper was made.
        contacts: the active contacts.
        impulse: (m,) normal impulse, mass length/time, >= 0.
        psi1, psi2: (m,) weights of the extra contact force and momentum (paper Eq. 11).
        gap_increment: (m,) Delta g of the balance (paper Eq. 20), length.
        iterations: of the solver.  substeps: the step was split into.
        lock: scale of the energy lock farthest from 1; 1.0 if none. |lock - 1| estimates the solver's error.
        converged: whether the solver met its tolerance. Energy and momentum are exact either way.
    """

    time: float
    contacts: Contacts
    impulse: FloatArray
    psi1: FloatArray
    psi2: FloatArray
    gap_increment: FloatArray
    iterations: int = 0
    substeps: int = 1
    lock: float = 1.0
    converged: bool = True

    @staticmethod
    def without_contacts(time: float, bodies: tuple[pymunk.Body, ...] = (), substeps: int = 1) -> StepReport:
        """The report of a step in which nothing touched, or of a stepper that does not tell."""
        rows, none, vectors = np.zeros(0, np.intp), np.zeros(0), np.zeros((0, 2))
        contacts = Contacts(bodies, rows, rows, vectors, vectors, none, none)
        return StepReport(time, contacts, none, none, none, none, substeps=substeps)


def check_dt(dt: float) -> float:
    """dt as a float; ValueError if it is negative, NaN or infinite."""
    dt = float(dt)
    if not (dt >= 0 and math.isfinite(dt)):
        raise ValueError(f"dt = {dt}: give a finite time step >= 0 (0 does nothing)")
    return dt


class Stepper(ABC):
    """Steps a pymunk space: `stepper.step(dt)` in the place of `space.step(dt)`.

    A step completes or raises with the space as it was. Shapes and bodies may be added and removed between steps; call
    `refresh()` after editing one in place (radius, elasticity, friction, filter, mass, moment, body type).
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
        """Read the space's shapes and masses anew at the next step."""

"""What a step reports: its contacts and how it was solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .arrays import FloatArray, IntArray

if TYPE_CHECKING:
    import pymunk


@dataclass(frozen=True)
class Contacts:
    """The contacts of one step as a struct of arrays; m contacts.

    `body_a` and `body_b` are rows of `bodies`, the pymunk bodies. Normal, point and gap are those of the
    instant `time` inside the step at which the impulse acts; `gap` is that of the start of the step.
    """

    bodies: tuple[pymunk.Body, ...]
    body_a: IntArray  # (m,) rows of bodies
    body_b: IntArray  # (m,) rows of bodies
    normal: FloatArray  # (m, 2) unit, from a to b
    point: FloatArray  # (m, 2) length, halfway between the two surfaces
    gap: FloatArray  # (m,) length, at the start of the step, negative in overlap
    time: FloatArray  # (m,) time of the impulse after the start of the step

    def __len__(self) -> int:
        return len(self.gap)


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

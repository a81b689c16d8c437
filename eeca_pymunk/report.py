"""The report of a step: its contacts, its ledger, and how it was solved. Arrays are made at the first access."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from .arrays import FloatArray, IntArray
from .compiled.records import Rows, columns
from .energy.ledger import Ledger, ledger
from .model.contacts import Impulse
from .unmet import Unmet

if TYPE_CHECKING:
    import pymunk


@dataclass(frozen=True)
class Contacts:
    """The contacts of one step as a struct of arrays; m contacts.

    `body_a` and `body_b` are indices into `bodies`, the pymunk bodies. Normal and point are those of the instant `time`
    inside the step at which the impulse acts; `gap` is that of the start of the step. The impulse of a persistent
    contact acts as a constant force over `duration`, centred at `time`.
    """

    bodies: tuple[pymunk.Body, ...]
    body_a: IntArray  # (m,) rows of bodies
    body_b: IntArray  # (m,) rows of bodies
    normal: FloatArray  # (m, 2) unit, from a to b
    point: FloatArray  # (m, 2) length, halfway between the two surfaces
    gap: FloatArray  # (m,) length, at the start of the step, negative in overlap
    time: FloatArray  # (m,) time of the impulse after the start of the step
    duration: FloatArray = field(default_factory=lambda: np.zeros(0))  # (m,) time, 0 for an impact

    def __post_init__(self) -> None:
        if len(self.duration) != len(self.gap):
            object.__setattr__(self, "duration", np.zeros(len(self.gap)))

    def __len__(self) -> int:
        return len(self.gap)


class Details(NamedTuple):
    """The arrays of a report, see `StepReport`."""

    contacts: Contacts
    impulse: FloatArray
    psi1: FloatArray
    psi2: FloatArray
    gap_increment: FloatArray
    friction: FloatArray | None = None


# How a step was solved: its book (`energy.ledger`; None if the stepper has none), the factor of the
# energy lock farthest from 1, whether all budgets and tolerances were met, and the number of iterations of the solver.
Outcome: TypeAlias = tuple[list[float] | None, float, bool, int]


class StepReport:
    """The report of one step with m active contacts. Read-only.

    Args:
        time: see the property.
        details: the arrays, or a function that makes them at the first access.
        iterations, lock, converged: see the properties.
        book: the seven entries from which `energy.ledger` makes the ledger; None if the stepper has none.
        unmet: budgets and tolerances that were not met, or a function that returns them at the first access.
    """

    __slots__ = ("_book", "_converged", "_details", "_iterations", "_lock", "_time", "_unmet")

    def __init__(
        self, time: float, details: Details | Callable[[], Details], iterations: int = 0, lock: float = 1.0,
        converged: bool = True, book: list[float] | None = None,
        unmet: tuple[Unmet, ...] | Callable[[], tuple[Unmet, ...]] = (),
    ) -> None:  # fmt: skip
        self._time = time
        self._details = details
        self._iterations = iterations
        self._lock = lock
        self._converged = converged
        self._book = book
        self._unmet = unmet

    @staticmethod
    def without_contacts(time: float, bodies: tuple[pymunk.Body, ...] = ()) -> StepReport:
        """The report of a step without contacts, or of a stepper that does not report them."""
        return StepReport(time, nothing(bodies))

    def _made(self) -> Details:
        details = self._details
        if not isinstance(details, Details):
            self._details = details = details()
        return details

    @property
    def time(self) -> float:
        """Sum of the dt of all steps since the stepper was made; a step that ended early (`unmet`: solves) counts with
        its whole dt."""
        return self._time

    @property
    def contacts(self) -> Contacts:
        """The active contacts."""
        return self._made().contacts

    @property
    def impulse(self) -> FloatArray:
        """(m,) normal impulse, mass length/time, >= 0."""
        return self._made().impulse

    @property
    def friction(self) -> FloatArray:
        """(m,) impulse of friction on b along t = (-n_y, n_x), mass length/time."""
        made = self._made()
        return np.zeros(len(made.impulse)) if made.friction is None else made.friction

    @property
    def psi1(self) -> FloatArray:
        """(m,) weight of the extra contact force (paper Eq. 11); infinite in the rigid limit."""
        return self._made().psi1

    @property
    def psi2(self) -> FloatArray:
        """(m,) weight of the extra momentum (paper Eq. 11)."""
        return self._made().psi2

    @property
    def gap_increment(self) -> FloatArray:
        """(m,) Delta g of the balance (paper Eq. 20), length."""
        return self._made().gap_increment

    @property
    def iterations(self) -> int:
        """Number of iterations of the solver in the step."""
        return self._iterations

    @property
    def substeps(self) -> int:
        """Always 1: no stepper splits a step."""
        return 1

    @property
    def lock(self) -> float:
        """Factor of the energy lock on impulses, of all its uses the one farthest from 1; 1.0 if it was not used.
        |lock - 1| estimates the solver's relative error."""
        return self._lock

    @property
    def ledger(self) -> Ledger | None:
        """Energy balance of the step; None if dt is 0, and for steppers that have none: `Native`, the penalty steppers,
        and EECA with `Dashpot`."""
        return None if self._book is None else ledger(self._book)

    @property
    def converged(self) -> bool:
        """Whether the solver met its budgets and tolerances. Otherwise forces and losses are approximate; energy does
        not rise, momentum and the ledger are exact."""
        return self._converged

    @property
    def unmet(self) -> tuple[Unmet, ...]:
        """Budgets and tolerances that were not met, for which bodies; of many the first. Empty if `converged`."""
        unmet = self._unmet
        if not isinstance(unmet, tuple):
            self._unmet = unmet = unmet()
        return unmet

    def __repr__(self) -> str:
        return f"StepReport(time={self.time}, {len(self.contacts)} contacts, converged={self.converged})"

    def __reduce__(self) -> tuple[type[StepReport], tuple[object, ...]]:
        # The function that makes the arrays refers to the stepper: a copy has the arrays instead.
        return StepReport, (self.time, self._made(), self.iterations, self.lock, self.converged, self._book, self.unmet)


@dataclass(frozen=True)
class RunReport:
    """The report of a run of many steps.

    Attributes:
        time: at its end, as `StepReport.time`.
        steps: number of steps taken.
        ledger: sum of the ledgers of all steps; None if the stepper has none, or has taken no step.
        impacts: number of impacts, without persistent contacts.
        unmet: number of steps that did not meet all budgets and tolerances, see `StepReport.converged`.
        iterations: number of iterations of the solver in all steps.
        lock: factor of the energy lock that was farthest from 1, as `StepReport.lock`.
    """

    time: float
    steps: int
    ledger: Ledger | None = None
    impacts: int = 0
    unmet: int = 0
    iterations: int = 0
    lock: float = 1.0

    @property
    def converged(self) -> bool:
        """Whether all steps met their budgets and tolerances."""
        return self.unmet == 0


def nothing(bodies: tuple[pymunk.Body, ...] = ()) -> Details:
    """The arrays of a report without contacts."""
    rows, none, vectors = np.zeros(0, np.intp), np.zeros(0), np.zeros((0, 2))
    return Details(Contacts(bodies, rows, rows, vectors, vectors, none, none), none, none, none, none)


def of_events(EVENT: Rows[Impulse], dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details:
    """The arrays of the impulses of a step, in the order of time.

    psi2 = 1 - 2 tau / dt for an impulse at the time tau after the start of the step; psi1 is infinite (rigid limit);
    Delta g is that of Eq. 20 with the change of momentum by this impulse alone.

    Args:
        EVENT: (m,) impulses of the step.
        dt: time.
        bodies: of the space.
        owner: (k,) index in `bodies` of each shape's body.
    """
    first, second = EVENT["first"].astype(np.intp), EVENT["second"].astype(np.intp)
    order = np.lexsort((second, first, EVENT["when"]))
    first, second, EVENT = first[order], second[order], EVENT[order]
    time, lam = EVENT["when"].copy(), EVENT["normal"].copy()
    psi2 = 1.0 - 2.0 * time / dt
    normal, point = columns(EVENT, "nx", "ny"), columns(EVENT, "px", "py")
    gap, duration = EVENT["gap"].copy(), EVENT["duration"].copy()
    contacts = Contacts(bodies, owner[first], owner[second], normal, point, gap, time, duration)
    increment = 0.5 * dt * psi2 * EVENT["change"]
    return Details(contacts, lam, np.full_like(lam, math.inf), psi2, increment, EVENT["tangential"].copy())

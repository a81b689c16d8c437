"""What a step reports: its contacts, and how it was solved. Made when it is asked for, not before."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .arrays import FloatArray, IntArray
from .compiled.records import Rows, columns
from .energy.ledger import Ledger, ledger
from .model.contacts import Impulse

if TYPE_CHECKING:
    import pymunk


@dataclass(frozen=True)
class Contacts:
    """The contacts of one step as a struct of arrays; m contacts.

    `body_a` and `body_b` are rows of `bodies`, the pymunk bodies. Normal, point and gap are those of the
    instant `time` inside the step at which the impulse acts; `gap` is that of the start of the step. A contact that
    lasts pushes with a constant force through `duration`, about the instant `time`.
    """

    bodies: tuple[pymunk.Body, ...]
    body_a: IntArray  # (m,) rows of bodies
    body_b: IntArray  # (m,) rows of bodies
    normal: FloatArray  # (m, 2) unit, from a to b
    point: FloatArray  # (m, 2) length, halfway between the two surfaces
    gap: FloatArray  # (m,) length, at the start of the step, negative in overlap
    time: FloatArray  # (m,) time of the impulse after the start of the step
    duration: FloatArray = field(default_factory=lambda: np.zeros(0))  # (m,) time, 0 for an impact; see below

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


class StepReport:
    """What happened in one step; m contacts were active. Read-only.

    Args:
        time: simulated time at the end of the step, since the stepper was made.
        details: the arrays, or what makes them when one is asked for.
        iterations, substeps, lock, converged: see the properties.  book: (7,) of `energy.ledger`.
    """

    __slots__ = ("_book", "_converged", "_details", "_iterations", "_lock", "_substeps", "_time")

    def __init__(
        self,
        time: float,
        details: Details | Callable[[], Details],
        iterations: int = 0,
        substeps: int = 1,
        lock: float = 1.0,
        converged: bool = True,
        book: FloatArray | None = None,
    ) -> None:
        self._time = time
        self._details = details
        self._iterations = iterations
        self._substeps = substeps
        self._lock = lock
        self._converged = converged
        self._book = book

    @staticmethod
    def without_contacts(time: float, bodies: tuple[pymunk.Body, ...] = (), substeps: int = 1) -> StepReport:
        """The report of a step in which nothing touched, or of a stepper that does not tell."""
        return StepReport(time, nothing(bodies), substeps=substeps)

    def _made(self) -> Details:
        details = self._details
        if not isinstance(details, Details):
            self._details = details = details()
        return details

    @property
    def time(self) -> float:
        """Simulated time at the end of the step, since the stepper was made."""
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
        """Iterations of the solver."""
        return self._iterations

    @property
    def substeps(self) -> int:
        """Parts that the step was split into."""
        return self._substeps

    @property
    def lock(self) -> float:
        """Scale of the energy lock farthest from 1; 1.0 if none. |lock - 1| estimates the solver's error."""
        return self._lock

    @property
    def ledger(self) -> Ledger | None:
        """Where the energy of the step has gone; None if the stepper does not tell."""
        return None if self._book is None else ledger(self._book)

    @property
    def converged(self) -> bool:
        """Whether the solver met its tolerance. Energy and momentum are exact either way."""
        return self._converged

    def __repr__(self) -> str:
        return f"StepReport(time={self.time}, {len(self.contacts)} contacts, converged={self.converged})"

    def __reduce__(self) -> tuple[type[StepReport], tuple[object, ...]]:
        # What would make the arrays holds the stepper: a copy holds the arrays.
        return StepReport, (
            self.time, self._made(), self.iterations, self.substeps, self.lock, self.converged, self._book,
        )  # fmt: skip


@dataclass(frozen=True)
class RunReport:
    """What happened in a run of many steps.

    Attributes:
        time: simulated time at its end, since the stepper was made.
        steps: how many were taken.
        ledger: where energy has gone, of all steps together; None if the stepper does not tell.
        impacts: how many there were; contacts that last are none.
        unmet: steps that did not meet all tolerances. Energy and momentum are exact either way.
        iterations: of the solver.  lock: scale of the energy lock that was farthest from 1.
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
        """Whether all steps met their tolerances."""
        return self.unmet == 0


def nothing(bodies: tuple[pymunk.Body, ...] = ()) -> Details:
    """The arrays of no contact."""
    rows, none, vectors = np.zeros(0, np.intp), np.zeros(0), np.zeros((0, 2))
    return Details(Contacts(bodies, rows, rows, vectors, vectors, none, none), none, none, none, none)


def of_events(EVENT: Rows[Impulse], dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details:
    """The arrays of the impulses of a step, in the order of time: psi2 = 1 - 2 tau / dt says when each acted, and
    Delta g is Eq. 20 with the impulse's own Delta p.

    Args:
        EVENT: (m,).  dt: time.  bodies: of the space.  owner: (k,) place in `bodies` of every shape.
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

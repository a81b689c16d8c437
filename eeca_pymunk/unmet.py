"""Budgets and tolerances that a step did not meet, as `StepReport.unmet` gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .arrays import IntArray
from .compiled.records import Rows
from .model.step import KINDS, Missed

if TYPE_CHECKING:
    import pymunk


class Unmet(NamedTuple):
    """A budget or tolerance that a step did not meet.

    Attributes:
        name: a word of the list below, which says what `value` is.
        value: the value that was reached.
        limit: the largest value allowed.
        bodies: the bodies concerned, as far as they are known.

    Names:
        "impacts": number of impacts on a body in a step. Further ones are ignored and may penetrate.
        "hits": number of impacts on an island. Further ones are ignored until the next step and may penetrate.
        "impact": residual velocity of a simultaneous impact, length/time.
        "solves": work of the step, in looks (see the glossary): that of its events, and the part of the limit that
            joints have taken of theirs. The step ends early.
        "contacts": residual velocity of the persistent contacts of an island of up to `COLUMN_CONTACTS` contacts, or
            with which joints force a contact deeper, or which loads that have changed within the step give bodies at
            rest, length/time.
        "joints": status of the solve of jointed bodies.
    """

    name: str
    value: float
    limit: float
    bodies: tuple[pymunk.Body, ...]


def of_missed(MISSED: Rows[Missed], bodies: tuple[pymunk.Body, ...], owner: IntArray) -> tuple[Unmet, ...]:
    """Budgets and tolerances that were not met, from rows (m,); `owner` (k,): index in `bodies` of each shape's
    body."""
    found: dict[tuple[str, tuple[int, ...]], Unmet] = {}
    for row in MISSED:
        shapes = [int(s) for s in (row["first"], row["second"]) if s >= 0]
        places = tuple(sorted({int(owner[s]) for s in shapes}))
        name = KINDS[int(row["kind"])]
        found[name, places] = Unmet(name, float(row["value"]), float(row["limit"]), tuple(bodies[i] for i in places))
    return tuple(found.values())

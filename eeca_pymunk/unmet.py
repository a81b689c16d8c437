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
        name: "impacts" (number for a body in a step; further ones are ignored and may penetrate), "hits" (number on an
            island; likewise, until the next step), "impact" (residual velocity of a simultaneous impact, length/time),
            "solves" (bodies of all solves; the step ends early), "contacts" (that persist: residual velocity,
            length/time, of up to 40 contacts; of jointed bodies no numbers), "joints" (status of their solve).
        value: reached.
        limit: largest allowed; nan if there is no such number.
        bodies: those concerned, as far as they are known.
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

"""Events: the impacts of a run, each at its instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np

from .arrays import FloatArray, IntArray
from .compiled.records import Rows, columns
from .model.contacts import Impulse
from .report import StepReport

if TYPE_CHECKING:
    import pymunk


@dataclass
class Events:
    """m impacts of bodies a and b in the order of time. Persistent contacts are not included.

    Attributes:
        time: (m,) since the start of the recording or rollout.
        bodies: (m, 2) indices of a and b among the recorded bodies, -1 for a body that is not recorded (a static one).
        point: (m, 2) length, halfway between the two surfaces.
        normal: (m, 2) unit, from a to b.
        impulse: (m,) on b along the normal n, >= 0: mass length/time.
        friction: (m,) impulse on b along t = (-n_y, n_x): mass length/time.
    """

    time: FloatArray = field(default_factory=lambda: np.zeros(0))
    bodies: IntArray = field(default_factory=lambda: np.zeros((0, 2), np.intp))
    point: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    normal: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    impulse: FloatArray = field(default_factory=lambda: np.zeros(0))
    friction: FloatArray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.time)

    def part(self, first: int, last: int) -> Events:
        """The impacts [first, last)."""
        return Events(*(getattr(self, f.name)[first:last] for f in fields(self)))

    def in_order(self) -> Events:
        """The same impacts sorted by time, at equal times by bodies."""
        order = np.lexsort((self.bodies[:, 1], self.bodies[:, 0], self.time))
        return Events(*(getattr(self, f.name)[order] for f in fields(self)))

    @staticmethod
    def of(EVENT: Rows[Impulse], place: IntArray) -> Events:
        """The impacts in (m,) records of kernels, in their order. `place` (k,): index of each shape's body among the
        recorded ones, -1 for others."""
        bodies = np.stack((place[EVENT["first"].astype(np.intp)], place[EVENT["second"].astype(np.intp)]), axis=-1)
        return Events(
            EVENT["when"].copy(), bodies, columns(EVENT, "px", "py"), columns(EVENT, "nx", "ny"),
            EVENT["normal"].copy(), EVENT["tangential"].copy(),
        )  # fmt: skip

    @staticmethod
    def of_report(report: StepReport, start: float, place: Mapping[pymunk.Body, int]) -> Events:
        """The impacts of a step that began at the time `start`; `place`: indices of the recorded bodies."""
        contacts = report.contacts
        impacts = np.flatnonzero((contacts.duration == 0.0) & (report.impulse != 0.0))
        indices = np.array([place.get(body, -1) for body in contacts.bodies] if len(impacts) else [], np.intp)
        bodies = np.stack((indices[contacts.body_a[impacts]], indices[contacts.body_b[impacts]]), axis=-1)
        return Events(
            start + contacts.time[impacts], bodies, contacts.point[impacts], contacts.normal[impacts],
            report.impulse[impacts], report.friction[impacts],
        )  # fmt: skip

    @staticmethod
    def joined(parts: Sequence[Events]) -> Events:
        """The impacts of several `Events`, one after the other."""
        if not parts:
            return Events()
        return Events(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Events)))

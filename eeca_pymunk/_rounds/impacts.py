"""Impacts: the impulses of lone contacts at the instants at which they close, and the record of all impulses."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..closures.motion import Start
from ..report import Contacts, Details, StepReport
from ..space.bodies import Bodies
from ..space.shapes import Shapes
from .contacts import ROUND_OFF, Pairs, pair_key
from .features import distance_from_axes, length
from .geometry import Geometry
from .paths import Paths

_SLOW = 0.05  # contacts slower than this part of |a| dt rest: they would bounce 1 / _SLOW times in a step


class Log:
    """The impulses of a step, which may be taken in parts, and how the closure came to them.

    Attributes:
        offset: start of the present part of the step, time.
        lock: the scale of an energy lock that was farthest from 1.
        rounds: of all parts.  windows: the step was taken in.  converged: whether nothing was left to do.
    """

    def __init__(self, bodies: Bodies, start: Start) -> None:
        self.bodies, self.start = bodies, start
        self.offset, self.lock = 0.0, 1.0
        self.rounds, self.windows, self.converged = 0, 0, True
        self._entries: list[tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]] = []

    def __len__(self) -> int:
        return len(self._entries)

    def forget(self, length: int) -> None:
        """Drop what was kept after there were `length` entries."""
        del self._entries[length:]

    def locked(self, scale: float) -> None:
        """Note the scale of an energy lock."""
        if abs(scale - 1.0) > abs(self.lock - 1.0):
            self.lock = scale

    def keep(
        self,
        first: IntArray,
        second: IntArray,
        normal: FloatArray,
        point: FloatArray,
        time: FloatArray,
        lam: FloatArray,
        change: FloatArray,
    ) -> None:
        """Note impulses `lam` (m,) between shapes `first` and `second` at instants `time` (m,) of this part, and by
        how much (m,) each alone changes the contact's velocity."""
        self._entries.append((first, second, normal, point, time + self.offset, lam, change))

    def report(self, shapes: Shapes) -> StepReport:
        """The report of the step, contacts in the order of time; Delta g is Eq. 20 with the impulse's own Delta p."""
        start = self.start
        if not self._entries:
            return StepReport.without_contacts(start.time, self.bodies.items, max(self.windows, 1))
        entries = zip(*self._entries, strict=True)
        first, second, normal, point, time, lam, change = (np.concatenate(part) for part in entries)
        # Pairs of two disks first, as `Pairs` wants it; the order of time after the gaps are known.
        kind = np.argsort(pair_key(shapes, first, second), kind="stable")
        gap = np.empty(len(time))
        gap[kind] = Pairs(shapes, first[kind], second[kind]).at(start.position).gap
        order = np.lexsort((second, first, time))
        a, b, time, lam = shapes.row[first[order]], shapes.row[second[order]], time[order], lam[order]
        psi2 = 1.0 - 2.0 * time / start.dt
        increment = 0.5 * start.dt * psi2 * change[order]
        contacts = Contacts(self.bodies.items, a, b, normal[order], point[order], gap[order], time)
        return StepReport(
            start.time, Details(contacts, lam, np.full_like(lam, math.inf), psi2, increment),
            iterations=self.rounds, substeps=self.windows, lock=self.lock, converged=self.converged,
        )  # fmt: skip


@dataclass(frozen=True)
class Meeting:
    """Pairs at the instants (m,) at which they close: their geometry, directions (m, d) and closing speeds (m,).

    `faces` (k,) are those that touch at two points at once.
    """

    pairs: Pairs
    time: FloatArray
    at: Geometry
    direction_a: FloatArray
    direction_b: FloatArray
    approach: FloatArray
    faces: IntArray

    def take(self, which: IntArray) -> Meeting:
        """The pairs number `which`, increasing."""
        J_a = self.direction_a.take(which, axis=0)
        J_b = J_a if self.direction_b is self.direction_a else self.direction_b.take(which, axis=0)
        return Meeting(
            self.pairs.take(which), self.time[which], self.at.take(which), J_a, J_b, self.approach[which],
            np.flatnonzero(np.isin(which, self.faces)),
        )  # fmt: skip


class Impacts:
    """Applies the impulses of lone contacts to the paths of the bodies: u' = -e u at the time of impact (design 4)."""

    def __init__(self, bodies: Bodies, start: Start, paths: Paths, log: Log, shapes: Shapes) -> None:
        self.bodies, self.start, self.paths, self.log, self.shapes = bodies, start, paths, log, shapes
        self.moves: BoolArray = bodies.dynamic
        self.kinematic: BoolArray = ~(bodies.dynamic | bodies.static)
        self.mobility: FloatArray = bodies.mobility(start.position.shape[1] == 3)
        # (N,) speed that round-off of a body's place is worth in a step.
        self.still: FloatArray = (ROUND_OFF / start.dt) * distance_from_axes(start.position)
        # (N,) and the speed that the body's acceleration takes back at once.
        self.slow = self.still + _SLOW * start.dt * length(start.acceleration) if paths.pulled else self.still

    def stays(self, pairs: Pairs, speed: FloatArray) -> BoolArray:
        """(m,) whether a contact that opens with `speed` (m,) is as good as closed."""
        result: BoolArray = speed <= np.maximum(self.slow[pairs.row_a], self.slow[pairs.row_b])
        return result

    def meet(self, pairs: Pairs, time: FloatArray) -> Meeting:
        """The pairs at their instants (m,)."""
        a, b, paths = pairs.row_a, pairs.row_b, self.paths
        x_a, x_b = paths.position(a, time), paths.position(b, time)
        at = pairs.between(x_a, x_b)
        faces = pairs.faces(at, x_a, x_b)[0]
        J_a, J_b = pairs.directions(at, x_a, x_b)
        if J_a is J_b:
            u = paths.rate(a, time) - paths.rate(b, time)
            approach = at.normal[:, 0] * u[:, 0] + at.normal[:, 1] * u[:, 1]
        else:
            approach = (J_a * paths.rate(a, time)).sum(axis=1) - (J_b * paths.rate(b, time)).sum(axis=1)
        return Meeting(pairs, time, at, J_a, J_b, approach, faces)

    def bounce(self, meeting: Meeting) -> None:
        """Reflect lone contacts, no moving body of which occurs twice: lam = (1 + e) |u| / (J_a M^-1 J_a + J_b M^-1
        J_b), which is (1 + e) |u| / (1/m_a + 1/m_b) without arms."""
        pairs, time, J_a, J_b = meeting.pairs, meeting.time, meeting.direction_a, meeting.direction_b
        a, b = pairs.row_a, pairs.row_b
        m_a, m_b = self.mobility.take(a, axis=0), self.mobility.take(b, axis=0)
        centred = J_a is J_b
        free = m_a[:, 0] + m_b[:, 0] if centred else (J_a * J_a * m_a).sum(axis=1) + (J_b * J_b * m_b).sum(axis=1)
        lam = (1.0 + pairs.elasticity) * np.maximum(meeting.approach, 0.0) / free
        moves = np.flatnonzero(self.moves[b])
        rows, instants = np.concatenate((a, b[moves])), np.concatenate((time, time[moves]))
        change_a, change_b = -m_a * (lam[:, None] * J_a), m_b * (lam[:, None] * J_b)
        self.paths.kick(rows, instants, np.concatenate((change_a, change_b.take(moves, axis=0))))
        self.log.keep(pairs.first, pairs.second, meeting.at.normal, meeting.at.point, time, lam, lam * free)
